"""The benchmark of a macro step: all tools really exchange the values, and one that is missing or fails says so."""

import fmpy
import pytest

from rockshed.bench import exchange, table
from rockshed.bench import exchange_price as price
from rockshed.bench.exchange import BARE, OURS, PEERS, Pair
from rockshed.bench.interleave import Times
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


@pytest.fixture
def short(monkeypatch):
    """Measurements of a thousand exchanges, and the columns of each row that is taken."""
    widths = []
    monkeypatch.setattr(price, "EXCHANGES", 1000)
    monkeypatch.setattr(
        price._Nowhere,
        "rows",
        lambda self, times, values: widths.extend([values.shape[1]] * len(times)),
    )
    return widths


def test_an_exchange_is_priced_with_and_without_ledger_and_rows(short):
    columns = {}
    with price.accounts_of_relays(2) as contestants:
        for name, work in contestants.items():
            short.clear()
            assert work() > 0.0
            columns[name] = list(short)
    values, works = 4 * price.CHANNELS, 2 * 3
    assert columns == {price.BARE: [], price.LEDGER: [], price.KEPT: [values + works] * 1000}


def test_288_values_are_exchanged_by_both_versions_of_fmi(short, monkeypatch):
    seen = []
    pair = price._pair

    def looked(file, *more):
        fmu = fmpy.read_model_description(str(file))
        outputs = [one for one in fmu.modelVariables if one.causality == "output"]
        seen.append((fmu.fmiVersion[0], len(outputs)))
        return pair(file, *more)

    monkeypatch.setattr(price, "_pair", looked)
    with price.versions_of_fmi(2) as contestants:
        assert all(work() > 0.0 for work in contestants.values())
    assert seen == [("3", 1), ("2", price.VALUES // 2)]


def test_the_impact_is_priced_with_the_rows_and_bonds_that_it_has(monkeypatch):
    system = price.lab("paper", Runtime.NATIVE)
    priced = []
    monkeypatch.setattr(price, "_whole", priced.append)
    assert set(price.accounts_of_impact()) == {price.KEPT, price.BARE}
    kept, bare = priced
    assert kept == system
    assert kept.bonds
    assert (bare.bonds, bare.record) == ({}, [])


def test_the_least_times_are_compared():
    times = Times({"a": [3.0, 2.0, 9.0], "b": [4.0, 8.0, 5.0]})
    assert times.ratio_of_least("a", "b") == 0.5


@pytest.mark.parametrize(("value", "missed"), [(0.3, False), (0.5, True), (None, False)])
def test_a_goal_is_missed_by_what_was_measured_only(value, missed):
    assert table.BenchmarkRow("step", value, "ratio", "ctypes", 0.4).is_missed is missed
