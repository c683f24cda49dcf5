"""The doctor's look at kept code, leftovers and what is slow; nothing is taken from the working folder."""

import os
import subprocess
import sys
import tempfile

import pytest
from filelock import FileLock
from typer.testing import CliRunner

from rockshed.commands.app import app
from rockshed.commands.screen import Screen
from rockshed.components.catalogue import component
from rockshed.components.common import cache
from rockshed.components.common.kept import keep
from rockshed.core.results.own_files import mark
from rockshed.fmus.native import fmu as native_fmu
from rockshed.runs import health
from rockshed.temporary import ALIVE


@pytest.fixture
def folder(monkeypatch, tmp_path):
    """A folder of kept code with sound, damaged and older files, and one of the user's."""
    place = tmp_path / "cache"
    monkeypatch.setenv(cache.CACHE_VARIABLE, str(place))
    stamp = cache.source_stamp(component("FallingRock").folder)[:16]
    for name in (stamp, "0" * 16):
        (place / name).mkdir(parents=True)
        keep(place / name / "kernel.nbi", b"index")
    (place / stamp / "kernel.1.nbc").write_bytes(b"cut sh")
    (place / f"loop-{'0' * 24}.o").write_bytes(b"of older sources")
    (place / "notes.txt").write_text("mine")
    (place / "more").mkdir()
    return place


def test_the_doctor_counts_damaged_and_older_files(folder):
    rows = {row["kept code"]: row for row in health.cache_table()}
    assert rows["compiled kernels"]["files"] == "3"
    assert rows["compiled kernels"]["damaged"] == "1"
    assert rows["compiled kernels"]["of older sources"] == "1"
    assert rows["exchange loop"]["of older sources"] == "1"


def test_cleaning_removes_what_was_kept_and_nothing_else(folder):
    assert health.clean(health.kept_files()) > 0
    assert sorted(path.name for path in folder.iterdir()) == ["more", "notes.txt"]


@pytest.fixture
def left(tmp_path, monkeypatch):
    """Results and temporary folders, of killed runs and of the user."""
    results, temporary = tmp_path / "results", tmp_path / "tmp"
    for name in ("thesis.running-2", "thesis.running", ".thesis.old"):
        (results / name).mkdir(parents=True)
    mark(results / "thesis.running-2")
    (results / ".0123abcd.rockshed-old").mkdir()
    for name in ("rockshed_abc", "rockshed_mine", "rockshed-live"):
        (temporary / name).mkdir(parents=True)
    (temporary / "rockshed_abc" / ALIVE).touch()
    monkeypatch.setattr(tempfile, "gettempdir", lambda: str(temporary))
    return results, temporary


def test_leftovers_of_killed_runs_are_listed_and_no_folder_of_the_user(left):
    results, temporary = left
    with FileLock(temporary / "rockshed-live" / ALIVE):
        listed = [(row["number"], row["the first"]) for row in health.leftover_table(results)]
    assert listed == [
        ("2", str(results / ".0123abcd.rockshed-old")),
        ("1", str(temporary / "rockshed_abc")),
    ]


def test_cleaning_removes_temporary_folders_of_killed_runs_and_no_others(left, folder, monkeypatch):
    results, temporary = left
    monkeypatch.chdir(results.parent)
    with FileLock(temporary / "rockshed-live" / ALIVE):
        done = CliRunner().invoke(app, ["doctor", "--clean"])
    assert "1 temporary folder removed" in done.output
    assert sorted(path.name for path in temporary.iterdir()) == ["rockshed-live", "rockshed_mine"]
    assert len(list(results.iterdir())) == 4
    assert sorted(path.name for path in folder.iterdir()) == ["more", "notes.txt"]


@pytest.mark.skipif(os.name == "nt", reason="modes of POSIX")
def test_a_cache_that_cannot_be_used_is_told_with_what_to_set(tmp_path, monkeypatch):
    shared = tmp_path / "shared"
    shared.mkdir()
    shared.chmod(0o777)
    monkeypatch.setenv(cache.CACHE_VARIABLE, str(shared))
    told = "\n".join(health.slow_reasons())
    assert "kernels are compiled at every start" in told
    assert "can be written by others: set ROCKSHED_CACHE_DIR" in told


def test_a_command_says_once_that_no_kernels_are_kept(tmp_path, monkeypatch, capsys):
    monkeypatch.setenv(cache.CACHE_VARIABLE, str(tmp_path / "file" / "cache"))
    (tmp_path / "file").write_text("no folder")
    screen = Screen(quiet=True)
    for _ in range(2):
        with screen.busy("computing"), screen.progress("preparing"):
            pass
    told = capsys.readouterr().err
    assert told.count("kernels are compiled at every start") == 1
    assert "set ROCKSHED_CACHE_DIR to a folder" in " ".join(told.split())


PLANTED = "open({trap!r}, 'w').close()\n"


def test_nothing_is_imported_from_the_working_folder(tmp_path):
    trap = tmp_path / "executed"
    for name in ("json", "typer", "numba", "orchestrator"):
        (tmp_path / f"{name}.py").write_text(PLANTED.format(trap=str(trap)))
    command = [sys.executable, "-m", "rockshed", "list"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert not trap.exists()


def test_compilers_of_kernels_import_nothing_from_the_working_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(str(tmp_path))
    assert str(tmp_path) not in native_fmu._import_folders()
