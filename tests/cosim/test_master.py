"""The loop: what components see of each other, how the error of the coupling falls, and how a run fails."""

import math

import numpy as np
import pytest

from rockshed.core.errors import InputRefused, RunFailed
from rockshed.core.results.reading import read_run
from rockshed.core.run import simulate
from tests.cosim.mocks import Mock, MockSlave, inp, mass, out, par, spring, wired

PAIR = [
    "spring.end1.force -> a.force",
    "spring.end2.force -> b.force",
    "a.position -> spring.end1.position",
    "b.position -> spring.end2.position",
]


def run(folder, connections, mocks, **settings):
    system, sources = wired(mocks, connections, **settings)
    return simulate(system, folder / "run", sources=sources)


def pair(folder, step, master, stop=6.4, **settings):
    """Two masses, 1 kg and 3 kg, on a spring of 3 N/m: stretched by 1 m at the start, angular frequency 2 1/s."""
    mocks = {"spring": spring(3.0, ends=2), "a": mass(1.0, position=1.0), "b": mass(3.0)}
    return run(
        folder,
        PAIR,
        mocks,
        master=master,
        exchange_step=step,
        stop_time=stop,
        record=["*.position"],
        **settings,
    )


def error(result):
    """Largest error of the stretch against the closed form cos(2 t)."""
    stretch = result.series["a.position"] - result.series["b.position"]
    return np.abs(stretch - np.cos(2.0 * result.series["time"])).max()


@pytest.mark.parametrize("master", ["sequential", "jacobi"])
def test_an_oscillator_of_two_masses_converges_with_first_order(tmp_path, master):
    errors = [error(pair(tmp_path, step, master)) for step in (0.008, 0.004, 0.002)]
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    assert orders == pytest.approx([1.0, 1.0], abs=0.12)


def test_jacobi_makes_three_times_the_error_of_sequential(tmp_path):
    """The force lags by one and a half steps instead of half a step, on average."""
    ratio = error(pair(tmp_path, 0.002, "jacobi")) / error(pair(tmp_path, 0.002, "sequential"))
    assert ratio == pytest.approx(3.0, rel=0.05)


def test_momentum_is_kept_by_both_masters(tmp_path):
    for master in ("sequential", "jacobi"):
        result = pair(tmp_path, 0.01, master)
        centre = (result.series["a.position"] + 3.0 * result.series["b.position"]) / 4.0
        assert centre == pytest.approx(np.full(centre.size, 0.25), abs=1e-12)


def counter(step=None):
    """Shows the end of its last step and the input it was given for it."""

    def advance(v, t, h):
        v["time"], v["seen"] = t + h, v["input"]

    return Mock([inp("input"), out("time"), out("seen")], advance)


def test_what_components_of_three_rates_see(tmp_path):
    """
    time   0    1    2    3    4
    slow   |i.........o|i.........o|
    even   |i....o|i....o|i....o|i....o|
    quick  |i=|==o|i=|==o|i=|==o|i=|==o|
    """
    mocks = {"slow": counter(), "even": counter(), "quick": counter()}
    links = ["even.time -> slow.input", "slow.time -> even.input", "even.time -> quick.input"]
    result = run(
        tmp_path,
        links,
        mocks,
        exchange_step=1.0,
        stop_time=4.0,
        components={"slow": {"step": 2.0}, "quick": {"step": 0.5}},
    )
    series = {name: values.tolist() for name, values in result.series.items()}
    assert series["slow.time"] == [0, 0, 2, 2, 4]
    assert series["even.time"] == series["quick.time"] == [0, 1, 2, 3, 4]
    assert series["slow.seen"] == [0, 0, 0, 0, 2]  # taken at 0 and at 2, when its steps begin
    assert series["even.seen"] == [
        0,
        0,
        2,
        2,
        4,
    ]  # after the slow one in the order: what it has reached
    assert series["quick.seen"] == [0, 1, 2, 3, 4]
    steps = [call[2:] for call in mocks["quick"].calls if call[0] == "step"]
    assert steps == [(n / 2, 0.5) for n in range(8)]


def test_times_are_the_floats_that_were_written_and_do_not_drift(tmp_path):
    mocks = {"a": counter()}
    run(
        tmp_path,
        [],
        mocks,
        exchange_step=1e-5,
        stop_time=0.03,
        output_interval=1e-2,
        start_time=0.01,
    )
    begins = [call[2] for call in mocks["a"].calls if call[0] == "step"]
    assert begins == [round(0.01 + n * 1e-5, 5) for n in range(2000)]
    assert {call[3] for call in mocks["a"].calls if call[0] == "step"} == {1e-5}


def test_outputs_are_passed_on_at_the_start_through_a_chain(tmp_path):
    """A chain of components that pass their input through: the last one starts with the first one's value."""

    def through(v):
        v["y"] = v["x"] + 1.0

    links = ["a.y -> b.x", "b.y -> c.x", "c.y -> d.x"]
    mocks = {name: Mock([inp("x", start=10.0), out("y")], start=through) for name in "dcba"}
    result = run(tmp_path, links, mocks, record=["*.y"])
    assert [result.series[f"{name}.y"][0] for name in "abcd"] == [11.0, 12.0, 13.0, 14.0]
    assert result.provenance["warnings"] == []


def test_a_loop_that_does_not_settle_is_told(tmp_path):
    def more(v):
        v["y"] = v["x"] + 1.0

    result = run(
        tmp_path,
        ["a.y -> b.x", "b.y -> a.x"],
        {"a": Mock([inp("x"), out("y")], start=more), "b": Mock([inp("x"), out("y")], start=more)},
    )
    assert (
        "outputs at the start still change after 20 rounds of exchange, a.y among them"
        in result.provenance["warnings"][0]
    )


def test_an_input_without_connection_keeps_its_value(tmp_path):
    result = run(
        tmp_path,
        [],
        {"a": mass(2.0)},
        components={"a": {"parameters": {"force": 4.0}}},
        stop_time=3.0,
    )
    assert result.series["a.velocity"][-1] == pytest.approx(6.0, rel=1e-12)


# ---------------------------------------------------------------------- refusals at the start


def test_what_components_refuse_is_collected_from_all_and_leaves_nothing(tmp_path):
    bad = {name: Mock([out("x")], start=lambda v: (3, "this cannot be")) for name in "ab"}
    with pytest.raises(InputRefused) as refusal:
        run(tmp_path, [], {**bad, "c": Mock([out("x")])})
    assert [str(problem) for problem in refusal.value.problems] == [
        "a: this cannot be",
        "b: this cannot be",
    ]
    assert list(tmp_path.iterdir()) == []


def stepper(internal, stable):
    return Mock(
        [par("internal_step", internal, "s"), out("stable_step", "s"), inp("x"), out("y")],
        start=lambda v: v.update(stable_step=stable),
    )


@pytest.mark.parametrize(
    ("internal", "communication", "stable", "refused"),
    [
        (2e-5, 1e-5, 6e-6, True),
        (2e-5, 1e-5, 1e-5, False),
        (1e-6, 1e-5, 6e-6, False),
        (8e-6, 1e-5, 6e-6, True),
    ],
)
def test_a_step_above_the_stable_one(tmp_path, internal, communication, stable, refused):
    settings = {"exchange_step": communication, "stop_time": 1e-4}
    if not refused:
        assert (
            run(tmp_path, [], {"beam": stepper(internal, stable)}, **settings).status == "complete"
        )
        return
    with pytest.raises(InputRefused) as refusal:
        run(tmp_path, [], {"beam": stepper(internal, stable)}, **settings)
    text = str(refusal.value)
    assert f"steps of {min(internal, communication):g} s" in text
    assert "exceed stable_step = 6e-06 s" in text
    system, sources = wired({"beam": stepper(internal, stable)}, [], **settings)
    allowed = simulate(system, tmp_path / "run", sources=sources, allow_unstable=True)
    assert "exceed stable_step" in allowed.provenance["warnings"][0]


def test_an_output_that_is_no_number_after_the_initialisation(tmp_path):
    lost = Mock([out("x")], start=lambda v: v.update(x=math.nan))
    with pytest.raises(InputRefused, match=r"a\.x: is no finite number after the initialisation"):
        run(tmp_path, ["a.x -> b.x"], {"a": lost, "b": Mock([inp("x")])})


# ---------------------------------------------------------------------- failures in the loop


def failing(at, answer):
    return Mock(
        [inp("x"), out("y")], lambda v, t, h: answer if t >= at - 1e-9 else v.update(y=t + h)
    )


@pytest.mark.parametrize(("status", "name"), [(2, "Discard"), (3, "Error"), (4, "Fatal")])
def test_a_step_that_fails_ends_the_run_and_keeps_what_was_computed(tmp_path, status, name):
    with pytest.raises(RunFailed) as failure:
        run(tmp_path, [], {"good": counter(), "bad": failing(0.5, (status, "the rope is torn"))})
    assert (
        str(failure.value)
        == f"bad at t = 0.5 s: the step by 0.1 s failed ({name}): the rope is torn"
    )
    assert (failure.value.component, failure.value.time) == ("bad", 0.5)
    kept = read_run(tmp_path / "run")
    assert kept.status == "failed"
    assert kept.provenance["error"] == str(failure.value)
    assert kept.series["bad.y"] == pytest.approx([0.0, 0.1, 0.2, 0.3, 0.4, 0.5])
    assert kept.metrics["exchanges"].value == 5


def test_a_warning_lets_the_run_go_on(tmp_path):
    assert run(tmp_path, [], {"a": failing(0.5, (1, "hot"))}).status == "complete"


def test_an_exchanged_value_that_is_no_number_is_named_with_its_time(tmp_path):
    lost = Mock(
        [inp("x"), out("y"), out("z")], lambda v, t, h: v.update(z=math.inf if t > 0.35 else 0.0)
    )
    with pytest.raises(
        RunFailed, match=r"a at t = 0\.5 s: a\.z is no finite number: the computation diverges"
    ):
        run(tmp_path, ["a.z -> b.x"], {"a": lost, "b": Mock([inp("x")])}, record=["a.y"])
    assert read_run(tmp_path / "run").status == "failed"


def test_a_recorded_value_that_is_no_number_is_named(tmp_path):
    lost = Mock([out("y")], lambda v, t, h: v.update(y=math.nan if t > 0.35 else 0.0))
    with pytest.raises(RunFailed, match=r"a at t = 0\.5 s: a\.y = nan is no finite number"):
        run(tmp_path, [], {"a": lost})


def test_progress_is_told(tmp_path):
    told = []
    system, sources = wired({"a": counter()}, [], stop_time=2.0)
    simulate(
        system, tmp_path / "run", sources=sources, progress=lambda now, end: told.append((now, end))
    )
    assert told == sorted(told)
    assert told[-1] == (2.0, 2.0)


def test_extremes_of_watched_outputs_count_every_exchange(tmp_path):
    wave = Mock([out("y", "m")], lambda v, t, h: v.update(y=math.sin(2.0 * math.pi * (t + h))))
    result = run(tmp_path, [], {"a": wave}, exchange_step=0.01, output_interval=1.0, watch=["a.y"])
    assert (
        result.metrics["a_y_maximum"].value,
        result.metrics["a_y_maximum_at"].value,
    ) == pytest.approx((1.0, 0.25))
    assert (
        result.metrics["a_y_minimum"].value,
        result.metrics["a_y_minimum_at"].value,
    ) == pytest.approx((-1.0, 0.75))
    assert result.metrics["a_y_maximum"].unit == "m"


def test_integrals_of_watched_outputs_count_every_exchange(tmp_path):
    """A ramp to 2 and a jump back to 0, in 1 s; two rows, which miss it."""
    ramp = Mock(
        [out("y", "N")], lambda v, t, h: v.update(y=2.0 * (t + h) if t + h < 0.995 else 0.0)
    )
    result = run(tmp_path, [], {"a": ramp}, exchange_step=0.01, output_interval=1.0, watch=["a.y"])
    assert result.series["a.y"].tolist() == [0.0, 0.0]
    assert result.metrics["a_y_integral"].value == pytest.approx(0.99**2 + 0.5 * 0.01 * 1.98)
    assert result.metrics["a_y_integral"].unit == "N.s"


# ---------------------------------------------------------------------- slaves in Python


def broken(error):
    def step(v, t, h):
        v["y"] = t
        if t > 0.45:
            raise error

    return {"a": Mock([out("y")], step), "b": Mock([inp("x")])}


def test_an_exception_in_a_slave_is_its_failure_with_the_exception_as_cause(tmp_path):
    message = r"a at t = 0\.5 s: the step by 0\.1 s failed \(Error\): ValueError: torn apart"
    with pytest.raises(RunFailed, match=message) as failure:
        run(tmp_path, ["a.y -> b.x"], broken(ValueError("torn apart")))
    assert isinstance(failure.value.__cause__, ValueError)
    kept = read_run(tmp_path / "run")
    assert kept.status == "failed"
    assert kept.metrics["exchanges"].value == 5


@pytest.mark.parametrize("error", [KeyboardInterrupt, SystemExit])
def test_what_ends_the_program_is_no_failure_of_a_slave(tmp_path, error):
    with pytest.raises(error):
        run(tmp_path, ["a.y -> b.x"], broken(error()))
    assert read_run(tmp_path / "run").status == "running"


@pytest.mark.parametrize("call", ["set", "get"])
def test_an_exception_while_values_are_moved_is_not_lost(tmp_path, call, monkeypatch):
    def fail(slave, *_rest):
        if any(made[0] == "step" for made in slave.mock.calls):
            raise ZeroDivisionError("no number")
        return original(slave, *_rest)

    original = getattr(MockSlave, call)
    monkeypatch.setattr(MockSlave, call, fail)
    mocks = {"a": Mock([inp("x"), out("z")]), "b": Mock([out("y")])}
    with pytest.raises(RunFailed, match=r"a at t = 0.*\(Error\): ZeroDivisionError") as failure:
        run(tmp_path, ["b.y -> a.x"], mocks, watch=["a.z"])
    assert isinstance(failure.value.__cause__, ZeroDivisionError)
