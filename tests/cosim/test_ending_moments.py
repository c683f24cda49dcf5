"""Commands that are ended from outside, or lose their disk, at moments all over their duration."""

import json
import os
import shutil
import signal
import subprocess
import sys
import time
import uuid
import zipfile
from dataclasses import dataclass
from pathlib import Path

import pytest

from rockshed.runs.kept import FINISHED
from tests.conftest import BUILT

MOMENTS = int(os.environ.get("ROCKSHED_ENDING_MOMENTS", "0"))
"""Moments at which each command is ended; the full test has 10."""
EXAMPLES = Path(__file__).parents[2] / "orchestrator" / "examples"
MARK = "ROCKSHED_TEST_MARK"
"""Environment variable by which all processes of a command are found."""
PATIENCE = 600.0
"""Time (s) that a command has to end, on a machine with much else to do."""
RESULTS = "thesis"
MINE = {
    "thesis/notes.txt": "mine",
    "thesis/more/data.csv": "mine too",
    "thesis.running/draft.txt": "not of a run",
    ".thesis.old/draft.txt": "of last year",
    "notes.txt": "beside it",
}
"""Files of the user in and beside the folder of the results."""
RESUMED = {
    "reproduce": {f"in results: {FINISHED}"},
    "rockfall": {f".{RESULTS}-finished-trials"},
    "rockfall on Dask": {f".{RESULTS}-finished-trials"},
}
"""What an ended command leaves, by its name, for the next one to go on from and to remove."""
DISK = 48 << 20
"""Size (bytes) of the disk that gets full."""

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(sys.platform != "linux", reason="finds processes in /proc"),
    pytest.mark.skipif(MOMENTS == 0, reason="takes long: set ROCKSHED_ENDING_MOMENTS"),
]


@dataclass(frozen=True)
class Command:
    """A command, and a quicker one that writes to the same place.

    Attributes
    ----------
    words, again : str
        Without the folder of the results.
    is_cold : bool
        Whether it begins without kept code.
    """

    words: str
    again: str
    is_cold: bool = False


COMMANDS = {
    "run": Command(
        "run lab-impact --stop-time 0.003", "run lab-impact --stop-time 0.0005 --no-figures"
    ),
    "rockfall": Command(
        "rockfall slope.toml --trials 5000 --workers 2",
        "rockfall slope.toml --trials 100 --no-figures",
    ),
    "rockfall on Dask": Command(
        "rockfall slope.toml --trials 5000 --scheduler local --workers 2 --no-figures",
        "rockfall slope.toml --trials 100 --no-figures",
    ),
    "pile": Command("pile spt.toml", "pile spt.toml --no-figures"),
    "reproduce": Command(
        "reproduce sonoda1993 --quick --only figs17-18 --workers 2",
        "reproduce sonoda1993 --quick --only figs17-18 --workers 2",
    ),
    "build": Command(
        "build FallingRock --runtime both", "build FallingRock --runtime both", is_cold=True
    ),
}


def started(place: Path, words: str, is_cold: bool) -> subprocess.Popen:
    """Start a command in a folder, with the temporary folder ``tmp`` in it."""
    environment = os.environ | {
        MARK: str(uuid.uuid4()),
        "TMPDIR": str(place / "tmp"),
        "ROCKSHED_FMU_DIR": str(BUILT),
    }
    if is_cold:
        environment["ROCKSHED_CACHE_DIR"] = str(place / "cache")
    process = subprocess.Popen(
        [sys.executable, "-P", "-m", "rockshed", *words.split(), "--output-dir", RESULTS],
        cwd=place,
        env=environment,
        stdout=subprocess.DEVNULL,
        stderr=(place.parent / f"{place.name}.err").open("w"),
        start_new_session=True,
    )
    process.mark = environment[MARK]
    return process


def living(mark: str) -> list[str]:
    """Command lines of the processes with this mark."""
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            if f"{MARK}={mark}".encode() in (folder / "environ").read_bytes():
                words = (folder / "cmdline").read_bytes().replace(b"\0", b" ").decode()
                found.append(f"{folder.name}: {words}")
        except OSError:
            continue
    return found


def ended(process: subprocess.Popen, patience: float = PATIENCE) -> int:
    """Wait for the end of a command and all its processes."""
    deadline = time.monotonic() + patience
    try:
        code = process.wait(patience)
        while (left := living(process.mark)) and time.monotonic() < deadline:
            time.sleep(0.1)
        assert not left, f"still running: {left}"
    finally:
        for line in living(process.mark):
            os.kill(int(line.partition(":")[0]), signal.SIGKILL)
    return code


def said(place: Path) -> str:
    return (place.parent / f"{place.name}.err").read_text()


def laid_out(place: Path) -> None:
    """Lay out input files and the user's own in a folder."""
    (place / "tmp").mkdir(parents=True)
    for file in ("slope.toml", "spt.toml"):
        shutil.copy(EXAMPLES / file, place)
    for name, text in MINE.items():
        (place / name).parent.mkdir(parents=True, exist_ok=True)
        (place / name).write_text(text)


@pytest.fixture(scope="module", params=COMMANDS)
def command(request, tmp_path_factory):
    """A command, its results, and the time (s) that it takes."""
    chosen = COMMANDS[request.param]
    place = tmp_path_factory.mktemp("reference") / "work"
    (place / "tmp").mkdir(parents=True)
    for file in ("slope.toml", "spt.toml"):
        shutil.copy(EXAMPLES / file, place)
    if not chosen.is_cold:  # its kernels and FMUs are made here
        assert ended(started(place, chosen.again, chosen.is_cold), 1000.0) == 0, said(place)
    began = time.monotonic()
    assert ended(started(place, chosen.words, chosen.is_cold)) == 0, said(place)
    return chosen, place / RESULTS, time.monotonic() - began


@pytest.fixture
def disk(tmp_path):
    """A folder on a disk of its own."""
    place = tmp_path / "work"
    place.mkdir()
    size = ["-o", f"size={DISK},mode=700"]
    mounted = subprocess.run(["mount", "-t", "tmpfs", *size, "tmpfs", place], capture_output=True)
    if mounted.returncode:
        pytest.skip("only root can make a small disk")
    yield place
    subprocess.run(["umount", "-l", place], check=True)


def filled(place: Path) -> Path:
    """Fill a disk to the last byte."""
    filler = place / "filler"
    with filler.open("wb", buffering=0) as file:
        for size in (1 << 20, 1 << 12, 1):
            try:
                while True:
                    file.write(bytes(size))
            except OSError:
                continue
    return filler


def is_sound(name: str, results: Path) -> bool:
    """Tell whether results are whole, or say how they ended."""
    if name == "build":
        files = list(results.glob("*/*.fmu"))
        return len(files) > 0 and all(zipfile.ZipFile(file).testzip() is None for file in files)
    if name == "reproduce":
        return "studies" in json.loads((results / "reproduction.json").read_text())
    status = json.loads((results / "run.json").read_text())["status"]
    return status in ("complete", "interrupted", "failed")


def check_users_files(place: Path) -> None:
    for name, text in MINE.items():
        assert (place / name).read_text() == text, f"{name} is another file"


def left(place: Path) -> set[str]:
    """What is neither an input, nor the user's, nor results or kept code."""
    known = {"slope.toml", "spt.toml", "tmp", "cache", "notes.txt", ".thesis.old", RESULTS}
    known |= {"thesis.running"}
    entries = {entry.name for entry in place.iterdir()} - known
    entries |= {f"tmp/{entry.name}" for entry in (place / "tmp").iterdir()}
    return entries | {f"in results: {entry.name}" for entry in (place / RESULTS).glob(".*")}


ENDINGS = ("SIGKILL", "SIGTERM", "SIGHUP", "full disk")


@pytest.mark.parametrize("moment", range(MOMENTS))
@pytest.mark.parametrize("ending", ENDINGS)
def test_a_command_that_is_ended_loses_nothing_and_the_next_one_works(
    command, ending, moment, request, tmp_path
):
    chosen, results, duration = command
    name = next(name for name, known in COMMANDS.items() if known is chosen)
    is_full = ending == "full disk"
    place = request.getfixturevalue("disk") if is_full else tmp_path / "work"
    shutil.copytree(results, place / RESULTS)
    laid_out(place)
    process = started(place, chosen.words, chosen.is_cold)
    time.sleep(duration * (moment + 0.5) / MOMENTS)
    filler = filled(place) if is_full else None
    if not is_full:
        process.send_signal(getattr(signal, ending))
    code = ended(process)
    told = said(place)
    assert "Traceback" not in told, told
    check_users_files(place)
    assert is_sound(name, place / RESULTS)
    if filler:
        filler.unlink()
        assert code in (0, 1, 2), told  # 2: before anything was computed
        assert code == 0 or "No space left" in " ".join(told.split()), told
    elif ending != "SIGKILL":
        # Python ends itself with SIGINT if Ctrl-C has hit code of exec(); a shell says 130 then
        assert code in (0, 130, -signal.SIGINT, -getattr(signal, ending)), told
        assert left(place) <= RESUMED.get(name, set()), told
    assert ended(started(place, chosen.again, chosen.is_cold)) == 0, said(place)
    check_users_files(place)
    assert is_sound(name, place / RESULTS)
    assert not left(place)
