"""The benchmark of a macro step: all tools really exchange the values, and one that is missing or fails says so."""

import pytest

from rockshed.bench import exchange, table
from rockshed.bench.exchange import BARE, OURS, PEERS, Pair
from rockshed.fmus.build import Runtime


@pytest.mark.slow
def test_every_tool_there_is_connects_the_pair():
    """A contestant refuses to be timed if an output does not show what the other one was given."""
    with Pair(Runtime.PYTHON, 4) as pair:
        assert {OURS, BARE, "fmpy"} <= set(pair.contestants)
        assert set(pair.contestants) | set(pair.missing) == {OURS, *PEERS}
        assert all(reason == "not installed" for reason in pair.missing.values())
        assert all(work() > 0.0 for work in pair.contestants.values())


def test_tools_that_are_missing_or_fail_say_so(monkeypatch):
    monkeypatch.setattr(exchange, "PEERS", {"absent": "no-such-package", "broken": "fmpy"})
    with Pair(Runtime.PYTHON, 2) as pair:
        assert pair.missing["absent"] == "not installed"
        assert pair.missing["broken"] == "failed: KeyError: 'broken'"


@pytest.mark.parametrize(("value", "missed"), [(0.3, False), (0.5, True), (None, False)])
def test_a_goal_is_missed_by_what_was_measured_only(value, missed):
    assert table.BenchmarkRow("step", value, "ratio", "ctypes", 0.4).is_missed is missed
