"""The cases with rods in the ground: by waves no step is too long for a stiff toe, and no energy is made."""

import numpy as np
import pytest

from rockshed.core.errors import InputRefused
from rockshed.core.run import simulate
from rockshed.metrics.energy import impact_energy, system_residual
from rockshed.runs.job import Request, prepare
from tests.cosim.mocks import mass, spring, wired

IMPEDANCE = 5.8e-4 * 7850.0 * 5120.0
RESISTANCE = 20e3
STIFF = RESISTANCE / (1e3 * IMPEDANCE / 1e-4)
"""Quake (m) of a toe that is 1000 times as stiff as the plain port bears at 1e-4 s."""


def run(folder, case, values=(), coupling=None, **options):
    job = prepare(Request(case, dict(values), coupling=coupling, options=options, in_process=True))
    return simulate(job.system, folder, sources=job.sources, facts=job.facts)


@pytest.mark.parametrize("quake", [2.5e-3, STIFF])
def test_spt_at_any_exchange_has_the_converged_set_and_makes_no_energy(tmp_path, quake):
    sets = {}
    for step in (1e-5, 1e-4):
        done = run(
            tmp_path / f"{step}",
            "spt",
            {"ground.quake": quake},
            exchange_step=step,
            output_interval=1e-3,
        )
        sets[step] = done.series["ground.permanent_set"][-1]
        energy = impact_energy(done)
        for bond in ("hammer_rod", "ground_rod"):
            assert -0.005 * energy < done.series[f"coupling.{bond}.energy"][-1] <= 1e-9 * energy
        assert abs(system_residual(done)).max() < 0.005 * energy
    assert sets[1e-4] == pytest.approx(sets[1e-5], rel=0.01)
    assert 5e-3 < sets[1e-4] < 15e-3


def test_the_plain_port_gives_the_same_set_below_its_limit(tmp_path):
    plain = run(tmp_path / "plain", "spt", coupling="plain", output_interval=1e-3)
    waves = run(tmp_path / "waves", "spt", output_interval=1e-3)
    assert plain.series["ground.permanent_set"][-1] == pytest.approx(
        waves.series["ground.permanent_set"][-1], rel=0.01
    )


def test_the_plain_port_refuses_a_step_above_its_limit(tmp_path):
    with pytest.raises(InputRefused) as refusal:
        run(tmp_path / "run", "spt", {"ground.quake": STIFF}, coupling="plain", exchange_step=1e-4)
    texts = [str(problem) for problem in refusal.value.problems]
    assert {text.split(":")[0] for text in texts} == {"ground", "rod"}
    assert all("exceeds step_limit = 1e-07 s" in text for text in texts)
    assert not (tmp_path / "run").exists()


def test_waves_refuse_a_step_longer_than_the_rod(tmp_path):
    with pytest.raises(InputRefused, match=r"step_limit = 0\.002 s"):
        run(tmp_path / "run", "spt", exchange_step=2.5e-3, output_interval=5e-3)


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"ground.quake": 0}, "ground.quake: 0: allowed is"),
        ({"ground.quake": np.nan}, "ground.quake: nan: must be a finite number"),
        ({"ground.ultimate_resistance": -1}, "ground.ultimate_resistance: -1: allowed is"),
        ({"rod.section.area[1]": 0}, "rod.section.area[1]: 0: allowed is"),
        ({"hammer.mass": -1}, "hammer.mass: -1: allowed is"),
    ],
)
def test_values_that_are_none_are_refused(tmp_path, values, words):
    with pytest.raises(InputRefused) as refusal:
        run(tmp_path / "run", "spt", values)
    assert any(words in str(problem) for problem in refusal.value.problems), refusal.value.problems


@pytest.fixture(scope="module")
def shed(tmp_path_factory):
    """Until the rods are loaded and the ground slides."""
    return run(
        tmp_path_factory.mktemp("shed") / "run",
        "shed-on-piles",
        stop_time=0.044,
        output_interval=4e-4,
    )


def test_the_shed_stands_still_until_the_impact_arrives(shed):
    early = shed.series["time"] < 0.005
    for side in ("left", "right"):
        assert np.abs(shed.series[f"ground_{side}.settlement"][early]).max() < 1e-6
        assert np.abs(shed.series[f"rod_{side}.head.contact_force"][early]).max() < 100.0
        assert shed.series[f"ground_{side}.resistance"][0] == pytest.approx(
            -shed.series["beam.support.force.y[1]"][0] + 0.196 * 10.0 * 2400.0 * 9.80665, rel=1e-9
        )


def test_the_shed_keeps_its_energy_and_settles(shed):
    energy = impact_energy(shed)
    for bond in (
        "sand_rock",
        "sand_beam",
        "beam_rod_left",
        "ground_left_rod_left",
        "beam_rod_right",
        "ground_right_rod_right",
    ):
        assert abs(shed.series[f"coupling.{bond}.energy"]).max() < 1e-3 * energy
    assert abs(system_residual(shed)).max() < 1e-3 * energy
    assert shed.series["ground_left.permanent_set"][-1] > 1e-3
    assert shed.series["ground_left.permanent_set"] == pytest.approx(
        shed.series["ground_right.permanent_set"], abs=1e-6
    )


@pytest.mark.slow
def test_the_shed_on_stiff_strong_ground_is_the_one_on_rigid_supports(tmp_path):
    """Thick piles on ground that hardly gives: forces and deflection as on the girders of 8 m."""
    stiff = {
        name: value
        for side in ("left", "right")
        for name, value in (
            (f"ground_{side}.quake", 1e-6),
            (f"ground_{side}.ultimate_resistance", 1e7),
            (f"rod_{side}.section.area[1]", 20.0),
            (f"rod_{side}.section.density[1]", 2400.0),
        )
    }
    piles = run(tmp_path / "piles", "shed-on-piles", stiff, stop_time=0.022, output_interval=1e-3)
    rigid = run(
        tmp_path / "rigid",
        "girders-8",
        coupling="impulse",
        stop_time=0.022,
        exchange_step=5e-6,
        output_interval=1e-3,
    )
    for name in ("sand.rock.force.y", "sand.transmitted_force", "beam.midspan.deflection"):
        largest = np.abs(rigid.series[name]).max()
        assert piles.series[name] == pytest.approx(rigid.series[name], abs=0.01 * largest)


@pytest.mark.parametrize("master", ["sequential", "jacobi"])
def test_a_bond_whose_force_and_position_are_opposed_counts_the_same(tmp_path, master):
    """A spring whose force is told with the other sign, to a mass that takes it so."""

    def oscillate(sign):
        ends = {"spring": spring(sign * 4.0), "mass": mass(sign * 1.0, position=1.0)}
        bond = {
            "giver": "spring",
            "force": ["end1.force"],
            "taker": "mass",
            "position": ["position"],
            "opposed": sign < 0.0,
        }
        system, sources = wired(
            ends,
            ["spring.end1.force -> mass.force", "mass.position -> spring.end1.position"],
            master=master,
            exchange_step=0.01,
            stop_time=2.0,
            bonds={"b": bond},
        )
        return simulate(system, tmp_path / f"{master}{sign}", sources=sources)

    plain, opposed = oscillate(1.0), oscillate(-1.0)
    assert plain.series["mass.position"] == pytest.approx(
        opposed.series["mass.position"], abs=1e-12
    )
    for account in ("energy", "work.taker", "work.giver"):
        assert opposed.series[f"coupling.b.{account}"] == pytest.approx(
            plain.series[f"coupling.b.{account}"], abs=1e-11
        )
    assert abs(plain.series["coupling.b.work.taker"]).max() > 1.0
