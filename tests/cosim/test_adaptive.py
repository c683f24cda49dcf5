"""Exchanges whose length follows the error of the coupling."""

import numpy as np
import pytest

from rockshed.core import continuing
from rockshed.core import run as core
from rockshed.core.errors import InputRefused, RunFailed
from rockshed.core.system.planning import make_plan
from rockshed.runs.job import Job
from rockshed.runs.simulation import simulate
from rockshed.runs.system import System, case
from tests.cosim.mocks import Mock, inp, mass, out, spring, wired

CONTROLS = ("doubling", "ledger")
BOND = {
    "giver": "spring",
    "force": ["end1.force"],
    "taker": "mass",
    "position": ["position"],
}
UNIT = 1 / 4096
"""Smallest step (s) here."""


def oscillator(control, tolerance, largest=1 / 64, **changes):
    """A mass of 1 kg on a spring of 4 N/m, let go at 1 m: cos(2 t)."""
    settings = {
        "exchange_step": UNIT,
        "stop_time": 2.0,
        "output_interval": 1 / 4,
        "bonds": {"pull": BOND},
        "adaptive": {"tolerance": tolerance, "largest_step": largest, "control": control},
    }
    return wired(
        {"spring": spring(4.0), "mass": mass(1.0, position=1.0)},
        ["spring.end1.force -> mass.force", "mass.position -> spring.end1.position"],
        **{**settings, **changes},
    )


def run(spec, sources):
    return simulate(System(Job("test", spec, sources, {})))


def value(found, name):
    return next(metric.value for metric in found.summary if metric.name == name)


@pytest.mark.parametrize(
    ("control", "tolerances"), [("doubling", (1e-1, 1e-2, 1e-3)), ("ledger", (1e-2, 1e-3, 1e-4))]
)
def test_the_error_falls_with_the_tolerance_and_the_number_of_exchanges_rises(control, tolerances):
    found = [run(*oscillator(control, tolerance)) for tolerance in tolerances]
    errors = [np.abs(r.series["mass.position"] - np.cos(2.0 * r.time)).max() for r in found]
    assert errors[0] > 1.5 * errors[1] > 1.5**2 * errors[2]
    made = [r.metrics["exchanges"].value for r in found]
    assert made[0] < made[1] < made[2]


def test_steps_that_cannot_grow_give_the_bits_of_the_fixed_step():
    """All pairs of the smallest step are tried in one and taken back: nothing of that is left."""
    changes = {"watch": ["mass.position"], "stop_time": 0.5}
    tried = run(*oscillator("doubling", 1e-15, 2 * UNIT, **changes))
    fixed = run(*oscillator("doubling", 1e-15, 2 * UNIT, **{**changes, "adaptive": None}))
    for name, values in fixed.series.items():
        assert values.tobytes() == tried.series[name].tobytes()
    same = [name for name in fixed.metrics if name.startswith(("mass_", "coupling_"))]
    assert same
    assert [fixed.metrics[n].value for n in same] == [tried.metrics[n].value for n in same]
    assert tried.metrics["exchanges"].value == 3 * 1024
    assert tried.metrics["exchanges_kept"].value == 2 * 1024


@pytest.mark.parametrize("control", CONTROLS)
def test_rows_stand_where_they_always_do_and_exchanges_are_counted(control):
    spec, sources = oscillator(control, 1e-2, output_interval=5 / 4096, stop_time=0.5 + 5 / 4096)
    spec = spec.model_copy(update={"stop_time": 1000 / 4096})
    found = run(spec, sources)
    assert found.time == pytest.approx(np.arange(201) * 5 / 4096, abs=0)
    steps = [call for call in sources["mass"].calls if call[0] == "step"]
    proof = 0 if control == "ledger" else 4  # steps by which it is proved that the FMU goes back
    assert found.metrics["exchanges"].value == len(steps) - proof
    kept = found.metrics["exchanges_kept"].value
    mean = found.series["coupling.step"][1:]
    assert (5 / 4096 / mean).sum() == pytest.approx(kept)


def pusher(at=0.5, holds=False):
    """Pushes with nothing, then from a time on with 1 N; says so by a truth or by nothing."""

    def step(v, t, h):
        v["on"] = float(t + h > at)
        v["force"] = v["on"]

    ports = [inp("position", "m"), out("force", "N")]
    return Mock(ports + ([out("on", kind="Boolean")] if holds else []), step)


def pushed(control, holds, tolerance=1e-3):
    return wired(
        {"pusher": pusher(holds=holds), "mass": mass(1.0)},
        ["pusher.force -> mass.force", "mass.position -> pusher.position"],
        exchange_step=UNIT,
        stop_time=1.0,
        output_interval=1 / 8,
        watch=["pusher.on"] if holds else [],
        bonds={
            "push": {
                "giver": "pusher",
                "force": ["force"],
                "taker": "mass",
                "position": ["position"],
            }
        },
        energy_alarm={"reference": 1.0},
        adaptive={"tolerance": tolerance, "largest_step": 1 / 8, "control": control},
    )


def test_a_jump_is_found_with_the_smallest_step_by_doubling():
    spec, sources = pushed("doubling", holds=True)
    found = run(spec, sources)
    assert found.metrics["largest_exchange_step"].value == 1 / 16
    assert found.metrics["smallest_exchange_step"].value == UNIT
    assert found.metrics["steps_rejected"].value > 0
    exact = 0.5 * (1.0 - 0.5) ** 2
    assert found.series["mass.position"][-1] == pytest.approx(exact, abs=2 * UNIT)


def test_the_ledger_begins_again_with_the_smallest_step_after_an_event():
    def steps(holds):
        spec, sources = pushed("ledger", holds, tolerance=0.5)
        run(spec, sources)
        made = [(c[2], c[3]) for c in sources["mass"].calls if c[0] == "step"]
        return [h for t, h in made if t >= 0.5][:3]

    assert steps(True)[:2] != steps(False)[:2]
    assert UNIT in steps(True)


def test_a_value_of_the_scenario_begins_again_with_the_smallest_step():
    spec, sources = wired(
        {"mass": mass(1.0), "spring": spring(1.0)},
        ["spring.end1.force -> mass.force", "mass.position -> spring.end1.position"],
        exchange_step=UNIT,
        stop_time=1.0,
        output_interval=1 / 2,
        adaptive={"tolerance": 1e-2, "largest_step": 1 / 8},
        scenario={"fault": [{"port": "mass.force", "kind": "cut", "from": 0.5}]},
    )
    run(spec, sources)
    steps = {t: h for kind, _, t, h in (c for c in sources["mass"].calls if c[0] == "step")}
    assert max(h for t, h in steps.items() if t < 0.5) > UNIT
    assert steps[0.5] == UNIT


@pytest.mark.parametrize("control", CONTROLS)
@pytest.mark.parametrize("order", [0, 1])
def test_a_run_that_goes_on_takes_the_steps_of_one_in_one_go(tmp_path, control, order):
    own = {"extrapolation": order, "components": {"mass": {"step": UNIT}}}
    whole, sources = oscillator(control, 1e-3, **own)
    core.simulate(whole, tmp_path / "whole", sources=sources)
    broken, sources = oscillator(control, 1e-3, **own)
    step = sources["mass"].step
    sources["mass"].step = lambda v, t, h: (3, "broken") if t >= 1.3 else step(v, t, h)
    with pytest.raises(RunFailed, match="broken"):
        core.simulate(broken, tmp_path / "ended", sources=sources, checkpoint_every=0.5)
    resumed = oscillator(control, 1e-3, **own)[1]
    continuing.resume(continuing.find_stopped(tmp_path / "ended"), resumed)
    for name in ("timeseries.parquet", "columns.csv"):
        assert (tmp_path / "whole" / name).read_bytes() == (tmp_path / "ended" / name).read_bytes()


def test_checkpoints_between_rows_would_change_the_steps_and_are_refused(tmp_path):
    spec, sources = oscillator("ledger", 1e-3)
    with pytest.raises(InputRefused, match=r"multiple of output_interval = 0\.25 s"):
        core.simulate(spec, tmp_path / "run", sources=sources, checkpoint_every=1 / 8)


def test_what_cannot_be_adaptive_is_refused_all_at_once():
    spec, sources = oscillator(
        "ledger",
        1e-3,
        largest=3 * UNIT,
        output_interval=None,
        bonds={},
        components={"spring": {"step": 2 * UNIT}},
        stop_time=1.0,
        scenario={"set": [{"port": "mass.mass", "value": 2.0, "when": "mass.position < 0"}]},
    )
    sources["mass"].varies = False
    with pytest.raises(InputRefused) as refusal:
        make_plan(spec, sources)
    places = {problem.where for problem in refusal.value.problems}
    assert {
        "adaptive.largest_step",
        "output_interval",
        "adaptive.control",
        "spring.step",
        "mass.step",
    } <= places


def test_a_scenario_that_needs_every_exchange_is_refused():
    noise = {"port": "mass.force", "kind": "noise", "from": 0.5, "deviation": 1.0}
    spec, sources = oscillator("ledger", 1e-3, scenario={"fault": [noise]})
    with pytest.raises(InputRefused, match="noise, which needs every exchange"):
        make_plan(spec, sources)


def test_an_fmu_that_does_not_come_back_is_refused_by_name(tmp_path):
    spec, sources = oscillator("doubling", 1e-3)
    count = [0]
    step = sources["mass"].step

    def forgetful(v, t, h):
        count[0] += 1
        step(v, t, h)
        v["position"] += 1e-9 * count[0]

    sources["mass"].step = forgetful
    with pytest.raises(InputRefused, match="mass: does not come back"):
        core.simulate(spec, tmp_path / "run", sources=sources)
    assert not (tmp_path / "run").exists()


def test_a_component_with_a_step_of_its_own_keeps_it():
    spec, sources = oscillator("ledger", 1e-1, components={"mass": {"step": UNIT / 2}})
    run(spec, sources)
    lengths = {call[3] for call in sources["mass"].calls if call[0] == "step"}
    assert lengths == {UNIT / 2}
    assert max(call[3] for call in sources["spring"].calls if call[0] == "step") > UNIT


def test_a_step_that_is_discarded_is_made_in_halves():
    """A component that refuses long steps is asked for shorter ones."""
    spec, sources = oscillator("doubling", 0.5)
    step = sources["mass"].step
    sources["mass"].step = lambda v, t, h: (2, "too long") if h > 4 * UNIT else step(v, t, h)
    found = run(spec, sources)
    assert found.metrics["largest_exchange_step"].value <= 4 * UNIT


@pytest.mark.slow
def test_an_impact_takes_a_fifth_of_the_exchanges_of_a_fixed_step_with_held_inputs():
    """With inputs that follow lines, and against the coupling `paper`."""

    def metrics(coupling, step, values=None, **options):
        times = {"stop_time": 0.0384, "output_interval": 1.28e-3, "state_interval": 1.28e-2}
        system = case(
            "lab-impact", coupling=coupling, values=values, exchange_step=step, **times, **options
        )
        return simulate(system).metrics

    def error(found):
        names = ("peak_transmitted_force", "penetration")
        return max(abs(found[name].value / finest[name].value - 1.0) for name in names)

    finest = metrics("paper", 1e-6)
    fixed = metrics("paper", 2e-5)
    made = {"tolerance": 1e-2, "largest_step": 2.56e-4, "control": "ledger"}
    linear = {"sand.kinematics": "linear"}
    found = metrics("jacobi", 1e-6, linear, extrapolation=1, adaptive=made)
    assert error(found) < error(fixed)
    assert 5 * found["exchanges"].value <= fixed["exchanges"].value
