"""The energy that a coupling makes: against closed forms and against the energy of the components themselves."""

import math

import numpy as np
import pytest

from rockshed.core.errors import RunFailed
from rockshed.core.loop.ledger import _sums
from rockshed.core.loop.recording import _runs
from rockshed.core.results.reading import read_run
from rockshed.core.run import simulate
from rockshed.core.system.timing import Timing
from tests.cosim.mocks import Mock, inp, mass, out, par, spring, wired

BOND = {"giver": "spring", "force": ["end1.force"], "taker": "mass", "position": ["position"]}
LINKS = ["spring.end1.force -> mass.force", "mass.position -> spring.end1.position"]


def oscillate(folder, step, master, mocks=None, **settings):
    """1 kg on a spring of 4 N/m (2 rad/s) for five periods, or another time, 2 J at the start."""
    exchanges = round(settings.pop("time", 5.0 * math.pi) / step)
    system, sources = wired(
        mocks or {"spring": spring(4.0), "mass": mass(1.0, position=1.0)},
        LINKS,
        master=master,
        exchange_step=step,
        stop_time=exchanges * step,
        **{"bonds": {"b": BOND}, **settings},
    )
    return simulate(system, folder / "run", sources=sources)


def made(result):
    return result.series["coupling.b.energy"][-1]


@pytest.mark.parametrize("master", ["sequential", "jacobi"])
def test_the_ledger_is_the_growth_of_the_components_energy(tmp_path, master):
    """All energy is in mass and spring, so what they gain is what the coupling made. The spring knows its end as it was shown."""
    result = oscillate(tmp_path, 0.01, master)
    kinetic = 0.5 * result.series["mass.velocity"] ** 2
    stored = result.series["spring.end1.force"] ** 2 / (2.0 * 4.0)
    assert result.series["coupling.b.energy"] == pytest.approx(kinetic + stored - 2.0, abs=1e-11)
    assert result.series["coupling.b.work.taker"] == pytest.approx(kinetic, abs=1e-11)


@pytest.mark.parametrize(("master", "lag"), [("sequential", 0.5), ("jacobi", 1.5)])
def test_held_values_make_energy_at_the_rate_of_their_lag(tmp_path, master, lag):
    """A force that lags by ``lag`` exchange steps H makes the energy E grow as dE/dt = lag omega^2 H E, omega = 2."""
    for step in (0.004, 0.002, 0.001):
        time = round(5.0 * math.pi / step) * step
        expected = math.exp(lag * 4.0 * step * time) - 1.0
        assert made(oscillate(tmp_path, step, master)) / 2.0 == pytest.approx(
            expected, rel=2.5 * step
        )


def test_the_energy_made_is_of_first_order_in_the_exchange_step(tmp_path):
    energies = [made(oscillate(tmp_path, step, "jacobi")) for step in (2e-3, 1e-3, 5e-4)]
    assert np.log2(np.divide(energies[:-1], energies[1:])) == pytest.approx([1.0, 1.0], abs=0.1)


def counting_spring(stiffness):
    """A spring that counts the work done on it itself, by its own stored energy."""
    plain = spring(stiffness)

    def step(v, t=0.0, h=0.0):
        plain.step(v, t, h)
        v["work"] = 7.0 + 0.5 * v["stiffness"] * v["end1.position"] ** 2

    return Mock([*plain.ports, out("work", "J")], step, step)


def test_the_givers_own_account_is_taken_where_it_has_one(tmp_path):
    """It need not begin at zero, and gives the same energy as the force times the displacement that the giver was shown."""
    own = oscillate(
        tmp_path,
        0.01,
        "jacobi",
        {"spring": counting_spring(4.0), "mass": mass(1.0, position=1.0)},
        bonds={"b": {**BOND, "work": "work"}},
    )
    shown = oscillate(tmp_path, 0.01, "jacobi")
    assert own.series["coupling.b.energy"] == pytest.approx(
        shown.series["coupling.b.energy"], abs=1e-11
    )


def test_a_slow_taker_is_charged_with_the_force_it_held(tmp_path):
    """The mass steps every third exchange; its kinetic energy is still the work that the ledger says it got."""
    result = oscillate(tmp_path, 0.01, "sequential", components={"mass": {"step": 0.03}}, time=3.0)
    assert result.series["coupling.b.work.taker"] == pytest.approx(
        0.5 * result.series["mass.velocity"] ** 2, abs=1e-11
    )


def test_a_constant_force_makes_no_energy(tmp_path):
    """Giver and taker agree on all of the way but its last part, which the giver has not been shown yet."""
    weight = Mock(
        [par("weight", 3.0), inp("end1.position", "m"), out("end1.force", "N")],
        start=lambda v: v.update({"end1.force": -v["weight"]}),
    )
    result = oscillate(tmp_path, 0.1, "sequential", {"spring": weight, "mass": mass(1.0)})
    last_way = np.diff(result.series["mass.position"])[-1]
    assert made(result) == pytest.approx(-3.0 * last_way, rel=1e-9)


def test_an_array_of_forces_is_one_bond(tmp_path):
    """Two masses on two springs behind one bond: twice the energy of one."""

    def both(v, t=0.0, h=0.0):
        for i in (1, 2):
            v[f"force[{i}]"] = -4.0 * v[f"position[{i}]"]

    springs = Mock(
        [*(inp(f"position[{i}]", "m") for i in (1, 2)), *(out(f"force[{i}]", "N") for i in (1, 2))],
        both,
        both,
    )

    def move(v, t, h):
        for i in (1, 2):
            v[f"position[{i}]"] += h * (v[f"velocity[{i}]"] + 0.5 * v[f"force[{i}]"] * h)
            v[f"velocity[{i}]"] += v[f"force[{i}]"] * h

    names = ("force", "position", "velocity")
    masses = Mock(
        [
            (inp if name == "force" else out)(
                f"{name}[{i}]", {"force": "N", "position": "m", "velocity": "m/s"}[name]
            )
            for name in names
            for i in (1, 2)
        ],
        move,
        lambda v: v.update({"position[1]": 1.0, "position[2]": -1.0}),
    )
    system, sources = wired(
        {"spring": springs, "mass": masses},
        ["spring.force[*] -> mass.force[*]", "mass.position[*] -> spring.position[1..2]"],
        exchange_step=0.01,
        stop_time=1.0,
        master="jacobi",
        bonds={
            "b": {
                "giver": "spring",
                "force": ["force[*]"],
                "taker": "mass",
                "position": ["position[*]"],
            }
        },
    )
    double = simulate(system, tmp_path / "two", sources=sources).series["coupling.b.energy"]
    single = oscillate(tmp_path, 0.01, "jacobi", time=1.0).series["coupling.b.energy"]
    assert double == pytest.approx(2.0 * single, rel=1e-12, abs=1e-13)


@pytest.mark.parametrize(
    ("reference", "alarms"), [(2.0, True), (1e3, False), ("spring.work", True)]
)
def test_the_alarm_compares_with_a_reference(tmp_path, reference, alarms):
    """0.02 of 2 J are made soon; the spring's own account stands at 9 J at the start."""
    result = oscillate(
        tmp_path,
        0.01,
        "jacobi",
        {"spring": counting_spring(4.0), "mass": mass(1.0, position=1.0)},
        energy_alarm={"share": 0.02, "reference": reference},
    )
    warnings = [text for text in result.provenance["warnings"] if "coupling energy" in text]
    assert len(warnings) == alarms
    if alarms:
        level = 2.0 if reference == 2.0 else 9.0
        energy = result.series["coupling.b.energy"]
        most = np.abs(energy).argmax()
        percent = 100.0 * energy[most] / level
        assert f"{percent:+.3g} % of E0 = {level:g} J, and 2 % are tolerated" in warnings[0]
        assert f"at t = {result.series['time'][most]:.9g} s" in warnings[0]


def test_an_alarm_is_on_by_default_and_finds_its_reference(tmp_path):
    """E0 is the largest work of an interface where no kinetic energy is declared: 2 J of the spring.

    What a Jacobi exchange makes in five periods is more than 1 % of it, and less in a fine one.
    """
    coarse, fine = (
        oscillate(tmp_path / str(step), step, "jacobi").provenance["warnings"]
        for step in (1e-2, 1e-4)
    )
    assert [text.startswith("bond b: the coupling energy reaches ") for text in coarse] == [True]
    assert "reduce the exchange step" in coarse[0]
    assert fine == []


def leaking_spring(share):
    """A spring that declares the error of its own balance: it loses a share of 2 J by the end."""
    plain = spring(4.0)

    def step(v, t=0.0, h=0.0):
        plain.step(v, t, h)
        v["residual"] = 5.0 - share * 2.0 * (t + h) / (5.0 * math.pi)

    ports = [*plain.ports, out("residual", "J", role="energy.residual")]
    return Mock(ports, step, step)


@pytest.mark.parametrize(("share", "alarms"), [(0.03, True), (0.005, False)])
def test_a_component_whose_own_balance_is_off_is_named_in_a_warning(tmp_path, share, alarms):
    """Its error counts from the start; the interface shows nothing, and no column is recorded."""
    result = oscillate(
        tmp_path,
        1e-4,
        "sequential",
        {"spring": leaking_spring(share), "mass": mass(1.0, position=1.0)},
        energy_alarm={"reference": 2.0, "share": 0.02},
        record=["mass.position"],
    )
    warnings = result.provenance["warnings"]
    assert len(warnings) == alarms
    if alarms:
        assert warnings[0].startswith(
            "spring: the error of its balance of energy (spring.residual) reaches -0.06"
        )
        assert "-3 % of E0 = 2 J" in warnings[0]
        assert "reduce the internal step of spring" in warnings[0]


def test_a_body_in_motion_is_a_reference_from_the_start(tmp_path):
    """Kinetic energies that are declared count as E0 where they are more than any work."""
    moving = mass(1.0, position=1.0)
    ports = [*moving.ports, out("kinetic", "J", role="energy.kinetic")]

    def start(v):
        moving.start(v)
        v["kinetic"] = 1e6

    heavy = Mock(ports, moving.step, start)
    found = oscillate(tmp_path, 1e-2, "jacobi", {"spring": spring(4.0), "mass": heavy})
    assert made(found) > 0.02 * 2.0
    assert found.provenance["warnings"] == []


def test_a_runaway_ends_the_run_and_keeps_its_rows(tmp_path):
    """E grows by exp(0.6 t) with a lag of 1.5 steps of 0.1 s: 11 times at ln 11 / 0.6 s."""
    alarm = {"reference": 2.0}
    with pytest.raises(RunFailed, match=r"bond b .*unstable.*E0 = 2 J.*reduce") as end:
        oscillate(tmp_path, 0.1, "jacobi", energy_alarm=alarm)
    assert end.value.time == pytest.approx(math.log(11.0) / 0.6, rel=0.3)
    run = read_run(tmp_path / "run")
    assert run.status == "failed"
    assert abs(run.series["coupling.b.energy"][run.time < end.value.time]).max() <= 20.0
    assert run.time[-1] >= end.value.time


def test_a_runaway_needs_an_energy_that_the_system_names(tmp_path):
    assert oscillate(tmp_path, 0.1, "jacobi").status == "complete"


def test_the_summary_has_the_final_accounts(tmp_path):
    result = oscillate(tmp_path, 0.01, "jacobi")
    for name in ("coupling.b.energy", "coupling.b.work.taker", "coupling.b.work.giver"):
        metric = result.metrics[name.replace(".", "_")]
        assert metric.value == result.series[name][-1]
        assert metric.unit == "J"


def test_sums_are_added_from_left_to_right_to_the_bit():
    rows = np.random.default_rng(5).normal(size=(7, 31)) * 10.0 ** np.arange(-15, 16)
    expected = [0.0] * len(rows)
    for i, row in enumerate(rows):
        for value in row:
            expected[i] += value
    np.testing.assert_array_equal(_sums(rows), expected)
    np.testing.assert_array_equal(_sums(rows[:1]), expected[:1])


def test_moments_have_the_bits_of_single_times():
    timing = Timing(3 * 10**17, 7, 10**6, 1, 1, {}, 10**12)
    found = timing.moments(range(0, 10**6, 997))
    assert found.tolist() == [timing.seconds(n) for n in range(0, 10**6, 997)]


def test_places_that_follow_one_another_are_copied_together():
    assert list(_runs([4, 5, 6, 2, 9, 10])) == [(0, 4, 3), (3, 2, 1), (4, 9, 2)]
    assert list(_runs([])) == []
