"""The processes in which probes run.

``python -m rockshed.checking.server`` reads jobs from stdin, a line of JSON each, makes a process
for each by fork, waits for it, and answers with a line of how it ended. Where there is no fork,
``python -m rockshed.checking.server JOB`` does one job itself.
"""

import json
import os
import re
import signal
import sys
import time
from contextlib import suppress
from dataclasses import asdict, dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

from ..processes import end_with_parent
from .subject.calls import CallRefused, CannotLoad, NoInstance
from .subject.subject import Subject
from .table import function_of
from .verdicts import Seen, failed

_LOOK_EVERY = 2e-3
"""Time (s) between two looks whether a process has ended."""


@dataclass(frozen=True)
class ProbeJob:
    """One process of a probe.

    Attributes
    ----------
    probe : str
        Its name.
    stage : int
        Number of the process, for probes that take several.
    file, folder : str
        FMU, and where it is unpacked.
    shared : str
        Folder through which the processes of the probe pass things on.
    place : str
        Folder of this process; ``work`` in it is its working folder.
    step : float, optional
        Communication step (s).
    limit : float
        Time (s) after which the process is ended.
    """

    probe: str
    stage: int
    file: str
    folder: str
    shared: str
    place: str
    step: float | None
    limit: float

    def text(self) -> str:
        """Return the job as a line."""
        return json.dumps(asdict(self))


RESULT = "result.json"
"""File with the verdict of a process."""
TRAIL = "trail"
"""File with the name of the function that was called last."""
OUTPUT = "output"
"""File with what a process prints."""
WORK = "work"
"""Working folder of a process."""


def carry_out(job: ProbeJob) -> None:
    """Run a probe in this process and write down its verdict."""
    place = Path(job.place)
    subject = Subject(Path(job.file), Path(job.folder), Path(job.shared), place / TRAIL, job.step)
    try:
        seen = function_of(job.probe, job.stage)(subject)
    except (CallRefused, NoInstance, CannotLoad) as error:
        seen = _unexpected(error)
    (place / RESULT).write_text(json.dumps(None if seen is None else asdict(seen)), "utf-8")


def _unexpected(error: Exception) -> Seen:
    """Return the verdict of an FMU that refuses what it must do."""
    if isinstance(error, NoInstance):
        said = f": {error}" if str(error) else ", and gives no reason"
        return failed(f"makes no instance{said}", "let it be instantiated, or log the reason")
    if isinstance(error, CannotLoad):
        return failed(f"its library cannot be loaded: {error}", "export it for this machine")
    return failed(str(error), "let the FMU do what FMI asks for here")


_LARGEST_FILE = 1 << 28
"""Bytes of a file that a process may write: what it prints must not fill the disk."""


def _in_child(job: ProbeJob) -> None:
    """Become the process of a job: own group, own output, own working folder."""
    import resource  # Windows has none, and no fork either

    place = Path(job.place)
    os.setsid()
    end_with_parent()
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    out = os.open(place / OUTPUT, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o600)
    nothing = os.open(os.devnull, os.O_RDONLY)
    for number, target in ((out, 1), (out, 2), (nothing, 0)):
        os.dup2(number, target)
    resource.setrlimit(resource.RLIMIT_FSIZE, (_LARGEST_FILE, _LARGEST_FILE))
    os.chdir(place / WORK)
    if job.stage:  # another process than the first one also in the places of its memory
        os.execv(sys.executable, [sys.executable, "-P", "-m", __spec__.name, job.text()])
    carry_out(job)
    sys.stdout.flush()
    sys.stderr.flush()


def _forked(job: ProbeJob) -> dict[str, Any]:
    """Run a job in a process of its own; return how it ended."""
    child = os.fork()
    if child == 0:
        status = 70
        try:
            _in_child(job)
            status = 0
        except BaseException as error:
            with suppress(OSError):
                Path(job.place, "error").write_text(f"{type(error).__name__}: {error}", "utf-8")
        finally:
            os._exit(status)
    return _awaited(child, job.limit)


def _awaited(child: int, limit: float) -> dict[str, Any]:
    begin = time.monotonic()
    late = False
    while True:
        ended, status = os.waitpid(child, os.WNOHANG)
        seconds = time.monotonic() - begin
        if ended:
            return {"code": os.waitstatus_to_exitcode(status), "late": late, "seconds": seconds}
        if seconds > limit and not late:
            late = True
            with suppress(OSError):
                os.killpg(child, signal.SIGKILL)
        time.sleep(_LOOK_EVERY)


_HEAVY = ("numba", "pandas", "scipy")
"""Packages whose import takes longer than a probe."""


def _import_heavy(folder: Path) -> None:
    """Import once what the Python code in an FMU needs, before processes are made of this one."""
    code = "".join(file.read_text("utf-8", "replace") for file in folder.rglob("*.py"))
    for package in _HEAVY:
        if re.search(rf"^\s*(?:import|from) {package}\b", code, re.MULTILINE):
            with suppress(ImportError):
                import_module(package)


def main() -> None:
    """Do one job, or those that come through stdin."""
    if len(sys.argv) > 1:
        carry_out(ProbeJob(**json.loads(sys.argv[1])))
        return
    ready = False
    for line in sys.stdin:
        resources = Path(json.loads(line)["folder"], "resources")
        if not ready and resources.is_dir():
            _import_heavy(resources)
            ready = True
        print(json.dumps(_forked(ProbeJob(**json.loads(line)))), flush=True)


if __name__ == "__main__":
    main()
