"""The slave in the FMU: values, initialization mode, and what it does with calls that it must refuse."""

import math
import re

import pytest

from rockshed.components.catalogue import NAMES
from rockshed.fmus.parts import Runtime

from .host import DISCARD, ERROR, OK, WARNING, Host


@pytest.fixture(params=list(Runtime))
def fmus(request):
    return request.getfixturevalue(f"{request.param}_fmus")


@pytest.fixture
def tank(fmus):
    with Host(fmus["Probe"], "tank") as host:
        yield host


@pytest.mark.parametrize("name", [*NAMES, "Probe"])
def test_start_values_really_hold(fmus, name):
    with Host(fmus[name]) as host:
        started = {name: v for name, v in host.variables.items() if v.start is not None}
        kinds = {"Real": float, "Boolean": lambda text: text == "true"}
        assert {n: host[n] for n in started} == {
            n: kinds.get(v.type, int)(v.start) for n, v in started.items()
        }
        host.start()
        assert {n: host[n] for n in started} == {
            n: kinds.get(v.type, int)(v.start) for n, v in started.items()
        }
        assert not host.errors()


@pytest.mark.parametrize("name", [*NAMES, "Probe"])
def test_every_fmu_steps(fmus, name):
    with Host(fmus[name]) as host:
        step = float(host.description.defaultExperiment.stepSize)
        host.start().steps(3, step)
        assert all(math.isfinite(value) for value in host.outputs().values())
        assert host.messages == []


def test_blocks_and_single_references_read_and_write_the_same(tank):
    tank.start()
    references = [tank.variables[f"extra[{i}]"].valueReference for i in (1, 2, 3)]
    for values in ([1.0, 2.0, 3.0], [4.0, 5.0, 6.0]):
        for _ in range(2):  # the first time unknown, then known as a block
            tank.fmu.setReal(references, values)
            assert tank.fmu.getReal(references) == values
    scattered = [references[2], references[0]]
    for values in ([7.0, 8.0], [9.0, 10.0]):
        for _ in range(2):
            tank.fmu.setReal(scattered, values)
            assert tank.fmu.getReal(scattered) == values
    assert [tank[f"extra[{i}]"] for i in (1, 2, 3)] == [10.0, 5.0, 9.0]
    assert tank.fmu.getReal([]) == []
    tank.fmu.setReal([], [])
    assert tank.messages == []


def test_every_type_is_set_and_acts(tank):
    tank.start(leak=1, counting=False, first_count=7, **{"level0[2]": 4.0}, inflow=2.0, valve=0.5)
    assert (tank["leak"], tank["counting"], tank["first_count"], tank["tanks"]) == (1, False, 7, 3)
    tank.steps(10, 0.1)
    assert tank["level[2]"] == pytest.approx(
        4.0 + 1.0 * 1.0, rel=1e-14
    )  # no leak: level0 + valve * inflow * time
    assert tank["count"] == 7.0


def test_outputs_in_initialization_mode_follow_parameters_and_inputs(tank):
    tank.fmu.setupExperiment()
    tank.fmu.enterInitializationMode()
    assert (tank["level[1]"], tank["flow"], tank["initialisations"]) == (0.0, 0.0, 1.0)
    tank["level0[1]"] = 2.5
    assert (tank["level[1]"], tank["initialisations"]) == (2.5, 2.0)
    tank["inflow"] = 3.0
    assert (tank["flow"], tank["initialisations"]) == (3.0, 2.0)
    tank.fmu.exitInitializationMode()
    assert (tank["level[1]"], tank["flow"], tank["initialisations"]) == (2.5, 3.0, 2.0)
    tank["inflow"] = 1.0
    assert tank["flow"] == 3.0  # between steps outputs do not follow inputs
    assert tank.step(0.0, 0.1) == OK
    assert tank["flow"] == 1.0


def test_inputs_that_do_not_fit_yet_can_be_corrected_before_the_initialization_mode_ends(tank):
    tank.fmu.setupExperiment()
    tank.fmu.enterInitializationMode()
    tank["inflow"] = 20.0
    assert [tank["flow"], tank["flow"]] == [20.0, 20.0]
    assert [(status, category) for status, category, _ in tank.messages] == [
        (WARNING, "logStatusWarning")
    ]
    tank["inflow"] = 1.0
    tank.fmu.exitInitializationMode()
    assert tank["flow"] == 1.0
    assert tank.step(0.0, 0.1) == OK


def test_a_wrong_start_is_refused_with_all_its_reasons_when_the_initialization_mode_ends(tank):
    tank.start(limit=1000.0, valve=-1.0, inflow=math.nan, leak=3, first_count=-1)
    (text,) = tank.errors()
    for part in (
        "tank (Probe)",
        "limit = 1000 m: allowed is 0.1 to 100 m",
        "valve = -1",
        "inflow = nan",
        "leak = 3",
        "first_count = -1",
    ):
        assert part in text
    assert tank.step(0.0, 0.1) == tank.refusal


def test_a_fault_of_the_component_at_the_start_and_later_is_told(tank):
    tank.start(inflow=20.0)
    assert "inflow 20 m/s at the start exceeds the limit 10 m: reduce inflow" in tank.errors()[0]
    tank.fmu.reset()
    tank.messages.clear()
    tank.start(inflow=9.0, leak=1)
    tank.steps(2, 0.5)
    assert tank.step(1.0, 0.5) == DISCARD
    assert "at t = 1 s a tank overflows above the level 10 m" in tank.errors()[0]
    assert tank.step(1.0, 0.01) == tank.refusal
    assert "restore an earlier state" in tank.errors()[1]


def test_an_internal_step_above_the_stable_one_gives_a_warning_in_a_step_that_is_long_enough(tank):
    tank.start(internal_step=0.75)
    assert tank.step(0.0, 0.1) == OK
    assert tank.messages == []  # internal steps are never longer than the communication step
    assert tank.step(0.1, 0.6) == OK
    assert tank.step(0.7, 0.6) == OK
    ((status, category, text),) = tank.messages  # once
    assert (status, category) == (WARNING, "logStatusWarning")
    assert "internal_step = 0.75 s exceeds stable_step = 0.5 s" in text


def set_extra(host, *values):
    """Set an array that has been set before, so that it is known as a block."""
    references = [host.variables[f"extra[{i}]"].valueReference for i in (1, 2, 3)]
    host.fmu.setReal(references, [0.0, 0.0, 0.0])
    host.fmu.setReal(references, values)


MISUSE = {
    "NaN input": (
        lambda h: h.__setitem__("inflow", math.nan),
        "at t = 0 s: inflow = nan: must be a finite number",
    ),
    "infinite input": (
        lambda h: set_extra(h, math.inf, 0.0, 1.0),
        "extra[1] = inf: must be a finite number",
    ),
    "infinities that cancel": (
        lambda h: set_extra(h, 0.0, math.inf, -math.inf),
        "extra[2] = inf: must be a finite number",
    ),
    "input out of range": (lambda h: h.__setitem__("valve", 1.5), "valve = 1.5: allowed is 0 to 1"),
    "parameter set late": (
        lambda h: h.__setitem__("limit", 20.0),
        "limit = 20 is refused: a parameter is fixed",
    ),
    "enumeration set late": (
        lambda h: h.__setitem__("leak", 1),
        "leak = 1 is refused: a parameter is fixed",
    ),
    "boolean set late": (
        lambda h: h.__setitem__("counting", False),
        "counting = 0 is refused: a parameter is fixed",
    ),
    "output set": (
        lambda h: h.__setitem__("level[2]", 1.0),
        "level[2] = 1 is refused: it is an output",
    ),
    "unknown reference read": (
        lambda h: h.fmu.getReal([999]),
        "value reference 999 is unknown: allowed is 0 to ",
    ),
    "huge reference read": (lambda h: h.fmu.getReal([2**32 - 1]), "is unknown: allowed is 0 to "),
    "unknown reference set": (
        lambda h: h.fmu.setReal([999], [1.0]),
        "value reference 999 is unknown",
    ),
    "unknown integer": (lambda h: h.fmu.getInteger([999]), "value reference 999 is unknown"),
    "unknown boolean": (lambda h: h.fmu.getBoolean([999]), "value reference 999 is unknown"),
    "wrong type read": (lambda h: h.fmu.getReal([1]), "leak is of type Enumeration, not Real"),
    "wrong type set": (lambda h: h.fmu.setInteger([0], [1]), "limit is of type Real, not Integer"),
    "constant set": (lambda h: h.__setitem__("tanks", 4), "is unknown"),
    "string read": (lambda h: h.fmu.getString([0]), "this FMU has no string"),
    "string set": (lambda h: h.fmu.setString([0], ["x"]), "this FMU has no string"),
    "initialised twice": (
        lambda h: h.fmu.enterInitializationMode(),
        "cannot enter the initialization mode: the slave is",
    ),
    "set up twice": (
        lambda h: h.fmu.setupExperiment(),
        "cannot set up the experiment: the slave is initialised already",
    ),
}


@pytest.mark.parametrize("what", MISUSE)
def test_misuse_after_the_initialisation_is_logged_and_stops_the_slave(tank, what):
    misuse, expected = MISUSE[what]
    tank.start()
    before = tank.outputs()
    misuse(tank)
    (text,) = tank.errors()
    assert "tank (Probe): " in text
    assert expected in text
    assert tank.step(0.0, 0.1) == tank.refusal
    assert tank.outputs() == before  # nothing wrong was taken over
    tank.fmu.reset()
    tank.start().steps(2, 0.1)


BAD_STEPS = {
    "negative": (0.5, -0.1, "its length must be a positive number"),
    "zero": (0.5, 0.0, "its length must be a positive number"),
    "not a number": (0.5, math.nan, "its length must be a positive number"),
    "infinite": (0.5, math.inf, "its length must be a positive number"),
    "after a gap": (0.6, 0.1, "the slave is at t = 0.5 s"),
    "into the past": (0.4, 0.1, "the slave is at t = 0.5 s"),
    "at no time": (math.nan, 0.1, "the slave is at t = 0.5 s"),
    "past the end": (0.5, 0.6, "passes the stop time 1 s"),
}


@pytest.mark.parametrize("what", BAD_STEPS)
def test_a_bad_step_is_refused_and_changes_nothing(tank, what):
    time, step, expected = BAD_STEPS[what]
    tank.start(stop=1.0, inflow=1.0).steps(5, 0.1)
    before = tank.outputs()
    assert tank.step(time, step) == tank.refusal
    assert expected in tank.errors()[0]
    assert tank.outputs() == before
    tank.steps(5, 0.1, first=5)  # the right steps go on


def test_steps_before_the_initialisation_and_after_the_end_are_refused(tank):
    assert tank.step(0.0, 0.1) == tank.refusal
    assert "the slave is not initialised: set up the experiment" in tank.errors()[0]
    tank.fmu.setupExperiment()
    tank.fmu.enterInitializationMode()
    assert tank.step(0.0, 0.1) == tank.refusal
    assert "the initialization mode is not finished" in tank.errors()[1]
    tank.fmu.exitInitializationMode()
    tank.steps(2, 0.1)
    tank.fmu.terminate()
    count = tank["count"]
    assert tank.step(0.2, 0.1) == tank.refusal
    assert "the slave is terminated" in tank.errors()[2]
    assert tank["count"] == count


def test_initialization_mode_needs_the_start_time_first(tank):
    tank.fmu.enterInitializationMode()
    assert "the start time is unknown" in tank.errors()[0]
    assert tank.step(0.0, 0.1) == tank.refusal


def test_an_experiment_that_ends_before_it_starts_is_refused(tank):
    tank.fmu.setupExperiment(startTime=1.0, stopTime=0.5)
    assert re.search(r"start time = 1(\.0)? s, stop time = 0\.5 s", tank.errors()[0])


def test_messages_have_declared_categories_and_no_percent_sign(tank):
    tank["limit"] = math.nan  # its description has one
    tank.start()
    ((status, category, text),) = tank.messages
    assert status == ERROR
    assert category in {c.name for c in tank.description.logCategories}
    assert "100 percent full" in text
    assert "%" not in text


def test_without_logging_misuse_is_refused_in_silence(fmus):
    with Host(fmus["Probe"], logging=False) as host:
        host.start()
        host["inflow"] = math.nan
        assert host.step(0.0, 0.1) == host.refusal
        assert host.messages == []
