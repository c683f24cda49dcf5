"""Kept code: only whole, unchanged and of this user; what does not fit is compiled anew."""

import os
import random
import subprocess
import sys
from pathlib import Path

import pytest

from rockshed.components.common import cache, kernels
from rockshed.components.common.kept import folder_problem, keep, kept, make_private

posix = pytest.mark.skipif(sys.platform == "win32", reason="modes of POSIX")

KERNEL = '''
"""A kernel of three lines."""
from rockshed.components.common.kernels import kernel

@kernel
def twice(x):
    return 2.0 * x + {constant}
'''


def flipped(content: bytes, number: random.Random) -> bytes:
    """The content with one bit changed, cut short, emptied, or longer."""
    kind = number.randrange(10)
    if kind == 0:
        return b""
    if kind == 1:
        return content[: number.randrange(len(content))]
    if kind == 2:
        return content + b"\0"
    damaged = bytearray(content)
    damaged[number.randrange(len(damaged))] ^= 1 << number.randrange(8)
    return bytes(damaged)


def test_of_200_damages_none_is_taken(tmp_path):
    file, number = tmp_path / "code", random.Random(1)
    keep(file, os.urandom(1000))
    whole = file.read_bytes()
    assert kept(file) is not None
    for _ in range(200):
        file.write_bytes(flipped(whole, number))
        assert kept(file) is None


@posix
def test_a_file_that_others_can_write_is_not_taken(tmp_path):
    file = tmp_path / "code"
    keep(file, b"code")
    assert file.stat().st_mode & 0o777 == 0o600
    file.chmod(0o666)
    assert kept(file) is None


@posix
def test_a_folder_that_others_can_write_is_refused_with_the_reason(tmp_path, monkeypatch):
    folder = tmp_path / "open"
    folder.mkdir()
    folder.chmod(0o777)
    assert folder_problem(folder) == f"{folder} can be written by others"
    assert "open can be written by others" in folder_problem(folder / "inside" / "deeper")
    monkeypatch.setenv(cache.CACHE_VARIABLE, str(folder / "cache"))
    assert cache.cache_directory() is None
    assert "can be written by others" in cache.cache_problem()
    assert "set ROCKSHED_CACHE_DIR to a folder" in cache.cache_problem()
    assert not (folder / "cache").exists()


@posix
@pytest.mark.skipif(os.name != "nt" and os.geteuid() != 0, reason="only root gives files away")
def test_a_folder_of_another_user_is_refused_with_the_reason(tmp_path):
    folder = tmp_path / "theirs"
    folder.mkdir()
    os.chown(folder, 4321, 4321)
    assert folder_problem(folder / "mine") == f"{folder} belongs to another user (number 4321)"
    file = tmp_path / "code"
    keep(file, b"code")
    os.chown(file, 4321, 4321)
    assert kept(file) is None


@posix
def test_folders_are_made_for_this_user_alone_whatever_the_umask(tmp_path):
    before = os.umask(0)
    try:
        make_private(tmp_path / "a" / "b")
    finally:
        os.umask(before)
    assert [path.stat().st_mode & 0o777 for path in (tmp_path / "a", tmp_path / "a/b")] == [
        0o700,
        0o700,
    ]


RUN = "import sys; sys.path.insert(0, sys.argv[1]); import mine; print(mine.twice(float(sys.argv[2])))"


def result(folder: Path, cache_folder: Path) -> str:
    done = subprocess.run(
        [sys.executable, "-P", "-c", RUN, folder, "4"],
        env=os.environ | {cache.CACHE_VARIABLE: str(cache_folder)},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_damaged_indices_and_codes_of_numba_are_compiled_anew(tmp_path):
    (tmp_path / "mine.py").write_text(KERNEL.format(constant=1.0))
    folder = tmp_path / "cache"
    assert result(tmp_path, folder) == "9.0\n"
    index, code = (next(folder.rglob(f"*.{ending}")) for ending in ("nbi", "nbc"))
    number = random.Random(2)
    for file in (index, code):
        for damage in (b"", None):
            whole = file.read_bytes()
            file.write_bytes(flipped(whole, number) if damage is None else damage)
            assert result(tmp_path, folder) == "9.0\n"
            assert kept(file) is not None, "the damaged file was not replaced"


@pytest.mark.parametrize("ending", ["nbi", "nbc"])
def test_code_that_names_a_module_which_is_gone_is_compiled_anew(tmp_path, ending):
    """As that of an FMU whose folder was unpacked once; the file is whole and of this user."""
    (tmp_path / "mine.py").write_text(KERNEL.format(constant=1.0))
    folder = tmp_path / "cache"
    assert result(tmp_path, folder) == "9.0\n"
    file = next(folder.rglob(f"*.{ending}"))
    keep(file, b"crockshed_0123_lib.kernels\nmoved\n.")
    assert result(tmp_path, folder) == "9.0\n"
    assert kept(file) != b"crockshed_0123_lib.kernels\nmoved\n."


EDITED = """
import importlib, pathlib, sys
sys.path.insert(0, sys.argv[1])
sys.dont_write_bytecode = True
import mine
file = pathlib.Path(mine.__file__)
file.write_text(file.read_text().replace("+ 1.0", "+ 2000.0"))
importlib.reload(mine)
print(mine.twice(4.0))
"""


def test_code_of_edited_sources_is_not_kept_under_the_stamp_of_the_old_ones(tmp_path):
    """As in a notebook that imports a module anew; who goes back would be given the new code."""
    source, folder = tmp_path / "mine.py", tmp_path / "cache"
    source.write_text(KERNEL.format(constant=1.0))
    done = subprocess.run(
        [sys.executable, "-P", "-c", EDITED, tmp_path],
        env=os.environ | {cache.CACHE_VARIABLE: str(folder)},
        capture_output=True,
        text=True,
    )
    assert done.stdout == "2008.0\n", done.stderr
    assert not list(folder.rglob("*.nbc"))
    source.write_text(KERNEL.format(constant=1.0))
    assert result(tmp_path, folder) == "9.0\n"


@pytest.fixture
def files(tmp_path):
    """Kept code of a function for two processors."""
    made = kernels._KeptFiles(str(tmp_path), "function", "stamp")
    made.save("wide", ("code for wide vectors", 1))
    made.save("narrow", ("code for narrow ones", 2))
    return made


def test_of_200_damages_of_each_file_of_numba_none_gives_another_code(files, tmp_path):
    number = random.Random(6)
    kinds = sorted(tmp_path.iterdir())
    assert [file.suffix for file in kinds] == [".nbc", ".nbc", ".nbi"]
    for file in kinds:
        whole = file.read_bytes()
        for _ in range(200):
            file.write_bytes(flipped(whole, number))
            assert files.load("wide") in (None, ("code for wide vectors", 1))
            assert files.load("narrow") in (None, ("code for narrow ones", 2))
        file.write_bytes(whole)
    assert files.load("wide") == ("code for wide vectors", 1)


def test_processes_that_compile_for_two_processors_never_take_each_others_code(
    tmp_path, monkeypatch
):
    """The other one has looked at the index before, and ends before this one writes its code."""
    files, other = (kernels._KeptFiles(str(tmp_path), "function", "stamp") for _ in range(2))
    monkeypatch.setattr(other, "_load_index", dict)
    write = files._save_data

    def write_later(name, data):
        other.save("narrow", "code for narrow ones")
        write(name, data)

    monkeypatch.setattr(files, "_save_data", write_later)
    files.save("wide", "code for wide vectors")
    assert files.load("wide") in (None, "code for wide vectors")
    assert files.load("narrow") in (None, "code for narrow ones")


def test_code_is_not_named_before_it_is_there(tmp_path, monkeypatch):
    """A kill in between must not leave the name of other code that lies there."""
    files = kernels._KeptFiles(str(tmp_path), "function", "stamp")
    files.save("wide", "code for wide vectors")
    next(tmp_path.glob("*.nbi")).write_bytes(b"cut sh")
    monkeypatch.setattr(files, "_save_data", lambda name, data: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        files.save("narrow", "code for narrow ones")
    assert files.load("narrow") is None


PLANT = """
import os, pickle, sys
class Evil:
    def __reduce__(self):
        return os.mkdir, (sys.argv[2],)
open(sys.argv[1], "wb").write(pickle.dumps("0.68.1") + pickle.dumps(Evil()))
"""


def test_an_index_that_somebody_planted_is_not_executed(tmp_path):
    (tmp_path / "mine.py").write_text(KERNEL.format(constant=2.0))
    folder, trap = tmp_path / "cache", tmp_path / "executed"
    assert result(tmp_path, folder) == "10.0\n"
    index = next(folder.rglob("*.nbi"))
    subprocess.run([sys.executable, "-c", PLANT, index, trap], check=True)
    assert result(tmp_path, folder) == "10.0\n"
    assert not trap.exists()


LOOP = """
import sys
from rockshed.core.loop import machine_code
machine_code.advance()
print(machine_code.kept_file())
"""


def loop_file(cache_folder: Path) -> Path:
    done = subprocess.run(
        [sys.executable, "-c", LOOP],
        env=os.environ | {cache.CACHE_VARIABLE: str(cache_folder)},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    return Path(done.stdout.strip())


@pytest.mark.slow
def test_a_damaged_exchange_loop_is_compiled_anew(tmp_path):
    file = loop_file(tmp_path / "cache")
    whole, number = file.read_bytes(), random.Random(3)
    for damaged in (whole[:1000], flipped(whole, number)):
        file.write_bytes(damaged)
        loop_file(tmp_path / "cache")
        assert file.read_bytes() == whole
