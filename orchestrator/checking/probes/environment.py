"""Probes of what an FMU does to the world around it."""

import hashlib
import locale
import math
import os
import signal
import sys
import tempfile
import threading
from pathlib import Path
from typing import Any

from ...core.fmu.slave import ERROR
from ..subject.subject import Subject
from ..subject.variables import listed
from ..verdicts import Seen, not_applicable, passed, warned

_MOST_READ = 1 << 16
"""Bytes of it that are read."""
_SHOWN = 60
"""Characters of what is printed that are shown."""


def _life(subject: Subject, logging: bool = False) -> list[Any]:
    """Live a short life; return its messages."""
    instance = subject.instantiate(logging=logging)
    instance.initialise(subject.start, subject.horizon)
    for _ in range(min(3, subject.steps)):
        if instance.step(subject.step).terminated:
            break
    instance.terminate()
    instance.free()
    return instance.messages


def printing(subject: Subject) -> Seen:
    """Look whether anything is printed in a life without logging."""
    sys.stdout.flush()
    sys.stderr.flush()
    file = Path("..", "output").resolve()
    before = file.stat().st_size
    _life(subject)
    _flush()
    with file.open("rb") as printed:
        printed.seek(before)
        output = printed.read(_MOST_READ)
    if output.strip():
        text = " ".join(output.decode("utf-8", "replace").split())[:_SHOWN]
        return warned(
            f"it prints: {text}", "use the logger that the tool gives: its stdout may be data"
        )
    return passed("prints nothing")


def _flush() -> None:
    sys.stdout.flush()
    sys.stderr.flush()
    if sys.platform != "win32":
        import ctypes

        ctypes.CDLL(None).fflush(None)


def _files(folder: Path) -> dict[str, str]:
    """Return the hashes of all files in a folder."""
    return {
        str(file.relative_to(folder)): hashlib.sha256(file.read_bytes()).hexdigest()
        for file in sorted(folder.rglob("*"))
        if file.is_file()
    }


def files(subject: Subject) -> Seen:
    """Look for files that a life leaves in its working folder, its own and the temporary one."""
    places = {"the working folder": Path.cwd(), "its own folder": subject.folder}
    temporary = subject.shared / "tmp"
    temporary.mkdir()
    places["the folder of temporary files"] = temporary
    os.environ["TMPDIR"] = str(temporary)
    tempfile.tempdir = None
    before = {name: _files(place) for name, place in places.items()}
    _life(subject)
    for name, place in places.items():
        after = _files(place)
        changed = [f for f, content in after.items() if before[name].get(f) != content]
        if changed or len(after) < len(before[name]):
            return warned(
                f"it leaves {listed(changed) or 'fewer files'} in {name}",
                "write nothing without being asked, and remove temporary files",
            )
    return passed("writes no files")


def process(subject: Subject) -> Seen:
    """Look whether a life changes the process: folder, signals, environment, arithmetic."""
    before = _traits()
    _life(subject)
    changed = [name for name, value in _traits().items() if before[name] != value]
    if changed:
        return warned(
            f"after a life the process has another {listed(changed)}",
            "leave the process to the tool: set back what has to be changed for a moment",
        )
    return passed("folder, signals, environment, locale and arithmetic stay as they were")


def _traits() -> dict[str, Any]:
    return {
        "working folder": os.getcwd(),
        **_signals(),
        "environment": dict(os.environ),
        "locale": locale.setlocale(locale.LC_ALL),
        "rounding or handling of tiny numbers": _arithmetic(),
        "number of threads": _threads(),
    }


def _signals() -> dict[str, Any]:
    """Return what happens at each signal: caught, ignored or blocked, as Linux tells it."""
    status = Path("/proc/self/status")
    if not status.is_file():
        return {"handler of SIGINT": str(signal.getsignal(signal.SIGINT))}
    lines = dict(line.split(":", 1) for line in status.read_text("utf-8").splitlines())
    masks = [int(lines[name], 16) for name in ("SigCgt", "SigIgn", "SigBlk")]
    return {
        f"handler of {known.name}": tuple(mask >> (known - 1) & 1 for mask in masks)
        for known in signal.Signals
    }


def _arithmetic() -> tuple[str, ...]:
    """Return results that show how numbers are rounded, and whether tiny ones are kept."""
    tiny = float.fromhex("0x1p-1022") / 2.0
    tenth = float(1) / float(int("10"))
    return (tiny.hex(), tenth.hex(), (-tenth).hex(), math.nextafter(0.0, 1.0).hex())


def _threads() -> int:
    tasks = Path("/proc/self/task")
    return len(list(tasks.iterdir())) if tasks.is_dir() else threading.active_count()


def messages(subject: Subject) -> Seen:
    """Look whether a refused call has a message, and a good life none of an error."""
    errors = [message.text for message in _life(subject, logging=True) if message.status >= ERROR]
    if errors:
        return warned(f"an ordinary life logs an error: {errors[0][:_SHOWN]}", "log what is true")
    instance = subject.begun()
    answer = instance.attempt(instance.call, "ExitInitializationMode")
    if not answer.refused:
        return not_applicable("no refused call was found")
    if not any(message.text.strip() for message in answer.said):
        return warned(
            "a call is refused without a message", "log the reason, so that users can act on it"
        )
    return passed("a refused call is told with a reason")


def logging(subject: Subject) -> Seen:
    """Ask for the declared log categories, all of them and each, and for none."""
    import ctypes

    names = [category.name.encode() for category in subject.model.logCategories]
    instance = subject.instantiate()
    for chosen in ([], names, *([name] for name in names)):
        held = (ctypes.c_char_p * max(1, len(chosen)))(*chosen)
        instance.call("SetDebugLogging", True, len(chosen), held)
    instance.call("SetDebugLogging", False, 0, None)
    instance.initialise(subject.start, subject.horizon)
    before = len(instance.messages)
    instance.step(subject.step)
    if len(instance.messages) > before:
        return warned("it logs although logging is off", "log only what is asked for")
    instance.free()
    return passed(f"{len(names)} categories can be chosen, and logging can be switched off")
