"""The doctor's look at kept code, leftovers and what is slow."""

import os

import pytest

from rockshed.components.catalogue import component
from rockshed.components.common import cache
from rockshed.components.common.kept import keep
from rockshed.runs import health


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


def test_leftovers_of_killed_runs_are_listed(tmp_path, monkeypatch):
    results, temporary = tmp_path / "results", tmp_path / "tmp"
    (results / "thesis.running").mkdir(parents=True)
    (temporary / "rockshed_abc").mkdir(parents=True)
    monkeypatch.setattr(health.tempfile, "gettempdir", lambda: str(temporary))
    listed = [(row["number"], row["the first"]) for row in health.leftover_table(results)]
    assert listed == [("1", "thesis.running"), ("1", "rockshed_abc")]


@pytest.mark.skipif(os.name == "nt", reason="modes of POSIX")
def test_a_cache_that_cannot_be_used_is_told_with_what_to_set(tmp_path, monkeypatch):
    shared = tmp_path / "shared"
    shared.mkdir()
    shared.chmod(0o777)
    monkeypatch.setenv(cache.CACHE_VARIABLE, str(shared))
    told = "\n".join(health.slow_reasons())
    assert "kernels are compiled at every start" in told
    assert "can be written by others: set ROCKSHED_CACHE_DIR" in told
