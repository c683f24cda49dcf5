"""Hammer and rod as two FMUs in one co-simulation, by a port of waves and by a plain one, against St. Venant's closed form."""

import numpy as np
import pytest

from rockshed.components.pile_rod.st_venant import StVenant
from rockshed.core.errors import InputRefused
from rockshed.core.run import simulate
from rockshed.core.system.reading import system_from
from rockshed.fmus.build import build_if_needed

SEGMENTS, LENGTH = 256, 10.24
"""Travel time 2 ms, of a segment 7.8125 us: a whole number of ticks."""
STEP = LENGTH / 5120.0 / SEGMENTS
IMPEDANCE = 5.8e-4 * 7850 * 5120
BOND = {
    "giver": "hammer",
    "force": ["force"],
    "taker": "rod",
    "position": ["head.position"],
    "work": "energy.work.head",
}
WAVES = [
    "rod.head.wave -> hammer.head.wave",
    "rod.head.impedance -> hammer.head.impedance",
    "hammer.force -> rod.head.force",
]
PLAIN = [
    "rod.head.position -> hammer.head.position",
    "rod.head.velocity -> hammer.head.velocity",
    "hammer.force -> rod.head.force",
]


def blow(folder, steps, master="sequential", port="waves", **hammer):
    """A blow on a rod with alpha = -0.5 for 9 ms; the exchange step in steps of the rod."""
    stiffness = hammer.get("cushion.stiffness", 0.0)
    rod = {
        "head.port": port,
        "exchange": {"sequential": "sequential", "jacobi": "parallel"}[master],
        "toe.condition": "reflection",
        "toe.reflection": -0.5,
        "section.length[1]": LENGTH,
        "head.partner.stiffness": stiffness,
    }
    system = system_from(
        {
            "name": "blow",
            "stop_time": 9e-3,
            "exchange_step": steps * STEP,
            "master": master,
            "order": ["hammer", "rod"],
            "connections": WAVES if port == "waves" else PLAIN,
            "bonds": {"head": BOND},
            "components": {
                "hammer": {
                    "fmu": str(build_if_needed("Hammer")),
                    "parameters": {"weight": False, "port": port, **hammer},
                },
                "rod": {
                    "fmu": str(build_if_needed("PileRod", {"segments": SEGMENTS})),
                    "parameters": rod,
                },
            },
        },
        "blow",
    )
    return simulate(system, folder / "run")


def closed_form(run):
    return StVenant(
        63.5, float(run.series["hammer.impact_velocity"][0]), IMPEDANCE, LENGTH / 5120.0, -0.5
    )


def first_apart(run):
    """Row in which hammer and rod have separated for the first time; later the head comes back."""
    return int(np.flatnonzero(run.series["hammer.separation"] > 0.0)[0])


@pytest.mark.parametrize(
    ("master", "steps", "tolerance"),
    [("sequential", 1, 1e-4), ("jacobi", 1, 1e-4), ("sequential", 16, 5e-3), ("jacobi", 16, 5e-3)],
)
def test_by_waves_it_is_st_venants_mass(tmp_path, master, steps, tolerance):
    run = blow(tmp_path, steps, master)
    exact = closed_form(run)
    end = exact.separation()
    times = run.series["time"]
    together = times < end
    np.testing.assert_allclose(
        run.series["hammer.velocity"][together],
        exact.velocity(times[together]),
        rtol=0,
        atol=tolerance * exact.speed,
    )
    apart = first_apart(run)
    assert run.series["hammer.separation"][apart] == pytest.approx(end, rel=tolerance)
    assert run.series["hammer.velocity"][apart] == pytest.approx(
        exact.rebound(), abs=tolerance * exact.speed
    )
    assert run.series["rod.energy.work.head"][-1] <= -run.series["hammer.energy.work.head"][-1] * (
        1 + 1e-12
    )
    assert np.abs(run.series["rod.energy.residual"]).max() < 1e-9


def test_the_ledger_of_a_wave_port_never_shows_energy_that_was_made(tmp_path):
    """The rod's work is displacement times mean force; the coupling loses the variance of the force, and less in shorter steps."""
    coarse, fine = blow(tmp_path / "coarse", 16), blow(tmp_path / "fine", 4)
    lost = []
    for run in (coarse, fine):
        np.testing.assert_allclose(
            run.series["coupling.head.work.taker"], run.series["rod.energy.work.head"], atol=1e-8
        )
        assert np.diff(run.series["coupling.head.energy"]).max() < 1e-9
        lost.append(
            -run.series["coupling.head.energy"][first_apart(run)]
            / run.series["hammer.energy.start"][0]
        )
    assert 0.0 < lost[1] < 0.1 * lost[0] < 1e-3


def test_by_the_plain_port_it_comes_to_the_same_with_a_cushion(tmp_path):
    """1e8 N/m: the limit is 0.23 ms, 29 steps of the rod."""
    cushion = {"cushion.stiffness": 1e8}
    waves = blow(tmp_path / "waves", 1, **cushion)
    plain = blow(tmp_path / "plain", 1, port="kinematics", **cushion)
    speed = waves.series["hammer.impact_velocity"][0]
    np.testing.assert_allclose(
        plain.series["hammer.velocity"], waves.series["hammer.velocity"], atol=0.01 * speed, rtol=0
    )
    assert plain.series["hammer.velocity"][-1] == pytest.approx(
        waves.series["hammer.velocity"][-1], abs=2e-3 * speed
    )


def test_the_plain_port_refuses_a_step_before_anything_runs(tmp_path):
    with pytest.raises(
        InputRefused, match=r"communication step of 0\.00025 s exceeds step_limit = 0\.000233114 s"
    ):
        blow(tmp_path, 32, port="kinematics", **{"cushion.stiffness": 1e8})
    assert not (tmp_path / "run" / "timeseries.parquet").exists()


def test_waves_refuse_a_step_beyond_the_travel_time(tmp_path):
    with pytest.raises(InputRefused, match=r"exceeds step_limit = 0\.002 s"):
        blow(tmp_path, 288)
    with pytest.raises(InputRefused, match=r"exceeds step_limit = 0\.001 s"):
        blow(tmp_path, 144, "jacobi")


def test_an_unstable_chain_is_refused_however_short_the_exchange(tmp_path):
    """Smith's spring five times as stiff as the rod's, in segments whose own step is longer than the exchange."""
    rod = {
        "scheme": "smith",
        "ram.mass": 63.5,
        "toe.condition": "reflection",
        "toe.reflection": -2.0 / 3.0,
        "section.length[1]": 50.0,
    }
    system = system_from(
        {
            "name": "rod",
            "stop_time": 1e-3,
            "exchange_step": 1e-5,
            "components": {
                "rod": {
                    "fmu": str(build_if_needed("PileRod", {"segments": SEGMENTS})),
                    "parameters": rod,
                }
            },
        },
        "rod",
    )
    with pytest.raises(
        InputRefused,
        match=r"rod\.internal_step: steps of 3\.81.*e-05 s .* exceed stable_step = 2\.88.*e-05 s",
    ):
        simulate(system, tmp_path / "run")
    assert simulate(system, tmp_path / "run", allow_unstable=True).status == "complete"
