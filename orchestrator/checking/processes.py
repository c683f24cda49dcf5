"""Processes of probes, seen from the check: each ends with a verdict, however it ends."""

import json
import os
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Any

from ..processes import ended_in_words, with_parent
from .server import OUTPUT, RESULT, TRAIL, WORK, ProbeJob
from .verdicts import LOADING, Seen, Verdict

_SERVER = [sys.executable, "-P", "-m", "rockshed.checking.server"]
_LONGEST_OUTPUT = 200
"""Characters of what a process printed that are shown."""


class Server:
    """Makes processes for jobs. A context manager."""

    def __init__(self) -> None:
        self._process: subprocess.Popen[str] | None = None

    def __enter__(self) -> "Server":
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._stop()

    def _stop(self) -> None:
        if self._process is not None:
            self._process.kill()
            self._process.communicate()
            self._process = None

    def run(self, job: ProbeJob) -> tuple[Seen | None, float]:
        """Carry out a job.

        Parameters
        ----------
        job : ProbeJob
            Its folder exists.

        Returns
        -------
        (Seen or None, float)
            Verdict, None of a stage that has none; and the time that it took (s).
        """
        Path(job.place, WORK).mkdir()
        ending = self._forked(job) if sys.platform != "win32" else _alone(job)
        return _verdict(job, ending), float(ending["seconds"])

    def _forked(self, job: ProbeJob) -> dict[str, Any]:
        if self._process is None:
            self._process = subprocess.Popen(
                _SERVER,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                text=True,
                env={**os.environ, "OPENBLAS_NUM_THREADS": "1"},  # no threads but those of the FMU
                preexec_fn=with_parent(),
                start_new_session=True,  # Ctrl-C is the check's
            )
        stdin, stdout = self._process.stdin, self._process.stdout
        if stdin is None or stdout is None:
            raise OSError("the process of the probes has no pipes")
        stdin.write(job.text() + "\n")
        stdin.flush()
        line = stdout.readline()
        if not line:
            raise OSError("the process that starts the probes has ended")
        return dict(json.loads(line))


def _alone(job: ProbeJob) -> dict[str, Any]:
    """Run a job where there is no fork."""
    begin = time.monotonic()
    with open(Path(job.place, OUTPUT), "wb") as output:
        process = subprocess.Popen(
            [*_SERVER, job.text()],
            stdin=subprocess.DEVNULL,
            stdout=output,
            stderr=output,
            cwd=Path(job.place, WORK),
        )
        late = False
        try:
            process.wait(job.limit)
        except subprocess.TimeoutExpired:
            late = True
            process.kill()
            process.wait()
    return {"code": process.returncode, "late": late, "seconds": time.monotonic() - begin}


def _verdict(job: ProbeJob, ending: dict[str, Any]) -> Seen | None:
    """Return the verdict of a process that has ended somehow."""
    place = Path(job.place)
    where = _text(place / TRAIL) or "the probe"
    if ending["late"]:
        what = f"{where} has not returned after {job.limit:g} s"
        return Seen(Verdict.TIMED_OUT, what, "let the call come to an end")
    with suppress(OSError, ValueError):
        told = json.loads((place / RESULT).read_text("utf-8"))
        if told is None:
            return None
        return Seen(Verdict(told["verdict"]), told["what"], told["remedy"])
    printed = " ".join(_end_of(place / OUTPUT).split())[-_LONGEST_OUTPUT:]
    said = f"; it printed: {printed}" if printed else ""
    if error := _text(place / "error"):
        what = f"the probe could not go on after {where}: {error}{said}"
        remedy = "correct what the FMU returned there; if it is right, this is a fault of the check"
        return Seen(Verdict.FAILED, what, remedy)
    remedy = "let the call return an error instead of ending the process"
    if where == LOADING:
        remedy = "export it again, if the library is damaged; else correct what it does there"
    return Seen(Verdict.CRASHED, f"{ended_in_words(int(ending['code']))} in {where}{said}", remedy)


def _end_of(file: Path) -> str:
    """Return the last letters that a process printed."""
    with suppress(OSError), file.open("rb") as printed:
        size = printed.seek(0, os.SEEK_END)
        printed.seek(max(0, size - 8 * _LONGEST_OUTPUT))
        return printed.read().decode("utf-8", "replace")
    return ""


def _text(file: Path) -> str:
    with suppress(OSError):
        return file.read_bytes().decode("utf-8", "replace").strip()
    return ""
