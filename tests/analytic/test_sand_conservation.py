"""What discs on their own keep: momentum, angular momentum, energy."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.sand_discs import (
    RADIUS,
    SMALL_BOX,
    RockOnSand,
    cushion,
    discs_at,
    masses,
    rows,
    run,
    sand_stiffness,
    stirred,
)


def cloud(count, seed, parameters):
    """Discs thrown at each other from all sides, some of them overlapping."""
    random = np.random.default_rng(seed)
    centres = random.uniform(0.0, 2.2 * RADIUS * math.sqrt(count), (count, 2))
    velocities = random.normal(0.0, 0.3, (count, 2)) - 10.0 * (centres - centres.mean(0))
    spins = random.normal(0.0, 50.0, count) if parameters["rotation"] == "free" else None
    return discs_at(centres, velocities, spins, parameters)


def momentum(instance):
    """Sum of m v, and of m |v| to measure it by."""
    velocity, mass = rows(instance)[:, 2:4], masses(instance)
    return mass @ velocity, mass @ np.hypot(*velocity.T)


def angular_momentum(instance):
    """Sum of x cross m v + I omega, and of its parts' sizes."""
    (x, y, vx, vy, surface, radius), mass = rows(instance)[:, :6].T, masses(instance)
    orbit, spin = mass * (x * vy - y * vx), 0.5 * mass * radius * surface
    return (orbit + spin).sum(), (abs(orbit) + abs(spin)).sum()


clouds = st.fixed_dictionaries(
    {
        "rotation": st.sampled_from(["free", "locked"]),
        "damping": st.sampled_from([0.0, 0.2, 0.7]),
        "friction_angle": st.floats(0.0, 1.2),
        "rolling_resistance": st.sampled_from([0.0, 0.3]),
        "tangential_ratio": st.floats(0.1, 1.0),
        "stiffness_factor": st.floats(0.2, 1.0),
    }
)


@settings(max_examples=40)
@given(count=st.integers(2, 40), seed=st.integers(0, 10**6), parameters=clouds)
def test_momentum_of_free_discs(count, seed, parameters):
    discs = cloud(count, seed, parameters)
    before, size = momentum(discs)
    run(discs, 2e-3)
    assert momentum(discs)[0] == pytest.approx(before, abs=1e-12 * size)


@settings(max_examples=20)
@given(
    count=st.integers(2, 40),
    seed=st.integers(0, 10**6),
    damping=st.sampled_from([0.0, 0.2]),
    rolling=st.sampled_from([0.0, 0.3]),
)
def test_angular_momentum_of_smooth_discs(count, seed, damping, rolling):
    """Central forces and opposite rolling moments keep it to rounding, semi-implicit Euler
    included."""
    discs = cloud(
        count,
        seed,
        {
            "rotation": "free",
            "friction_angle": 0.0,
            "damping": damping,
            "rolling_resistance": rolling,
        },
    )
    before, size = angular_momentum(discs)
    run(discs, 2e-3)
    assert angular_momentum(discs)[0] == pytest.approx(before, abs=1e-11 * size)


def test_angular_momentum_of_rough_discs_errs_by_friction_times_overlap():
    """Friction acts on each disc at its own radius, though the centres are nearer by the overlap: a
    known trait of the model.

    An elastic impact with speed v that slides throughout has the overlap v/w sin(wt), w^2 = 2k/m,
    and the friction mu k overlap: the angular momentum gained is the integral of their product, mu
    k v^2 pi / (2 w^3).
    """
    mu, speed = 0.01, 0.5
    discs = discs_at(
        [(0.0, 0.0), (2 * RADIUS, 0.0)],
        [(speed / 2, 0.0), (-speed / 2, 0.2)],
        parameters={"damping": 0.0, "friction_angle": math.atan(mu), "internal_step": 1e-7},
    )
    before, size = angular_momentum(discs)
    run(discs, 2e-3)
    k = sand_stiffness(discs)
    gain = mu * k * speed**2 * math.pi / (2.0 * math.sqrt(2.0 * k / masses(discs)[0]) ** 3)
    assert angular_momentum(discs)[0] - before == pytest.approx(gain, rel=0.02)
    assert gain < 0.001 * size


def jostle(step, duration=4e-3, **changes):
    """A heap of discs stirred to 0.1 m/s under gravity; largest energy error met on the way, in
    kinetic energies at the start."""
    parameters = {
        **SMALL_BOX,
        "packing": "hexagonal",
        "rotation": "free",
        "internal_step": step,
        **changes,
    }
    discs = stirred(cushion({**parameters}), 0.1)
    energy, worst = discs["energy.kinetic"], 0.0
    for _ in range(100):
        run(discs, duration / 100)
        worst = max(worst, abs(discs["energy.residual"]) / energy)
    return worst


def test_elastic_smooth_discs_keep_their_energy_to_second_order():
    errors = [
        jostle(step, damping=0.0, friction_angle=0.0, **{"wall.friction_angle": 0.0})
        for step in (4e-5, 1e-5, 2.5e-6)
    ]
    assert errors[-1] < 1e-4
    assert all(coarse > 8.0 * fine for coarse, fine in pairwise(errors))


@pytest.mark.parametrize(
    "changes", [{}, {"rotation": "locked"}, {"rolling_resistance": 0.3}, {"damping": 0.0}], ids=str
)
def test_energy_balance_with_all_losses_closes_to_first_order(changes):
    errors = [jostle(step, **changes) for step in (2e-5, 1e-5, 5e-6)]
    assert errors[-1] < 0.015
    assert all(1.6 < coarse / fine < 2.5 for coarse, fine in pairwise(errors))


@pytest.mark.parametrize(("rise", "turn"), [(0.2, 0.0), (0.0, 20.0)], ids=["lifted", "turned"])
@pytest.mark.parametrize("base", ["beam_discs", "beam_surface"])
def test_work_of_a_beam_that_lifts_or_rubs_the_sand(base, rise, turn):
    """The beam starts to move at once, and does work by its force or its torque."""
    residuals = []
    for step in (2e-5, 1e-5, 5e-6):
        sand = cushion({**SMALL_BOX, "base": base, "packing": "hexagonal", "internal_step": step})
        sand["beam.velocity.y"], sand["beam.angular_velocity"] = rise, turn
        for i in range(round(4e-3 / step)):
            sand["beam.position.y"], sand["beam.angle"] = -0.025 + rise * i * step, turn * i * step
            sand.step(i * step, step)
        assert sand["energy.work.beam"] > 1e-3
        residuals.append(abs(sand["energy.residual"]) / sand["energy.work.beam"])
    assert residuals[1] < 0.05
    assert residuals[0] / residuals[2] == pytest.approx(4.0, rel=0.5)


@pytest.mark.parametrize("rotation", ["free", "locked"])
def test_energy_balance_of_an_impact_halves_with_the_step(rotation):
    """The rock strikes a small cushion: the sand's balance, and the work that either side counts at
    their interface."""
    residuals, gaps = [], []
    for step in (2e-5, 1e-5, 5e-6):
        sand = cushion(
            {
                **SMALL_BOX,
                "base": "beam_discs",
                "packing": "hexagonal",
                "rotation": rotation,
                "rock.radius": 0.02,
                "rock.mass": 0.5,
                "internal_step": step,
            }
        )
        pair = RockOnSand(sand, (0.051, sand["surface_height"] + 0.0201), (0.0, -4.0), step)
        pair.advance(6e-3)
        impact = 0.5 * 0.5 * 4.0**2
        assert sand["energy.work.rock"] > 0.5 * impact
        residuals.append(abs(sand["energy.residual"]) / impact)
        gaps.append(abs(sand["energy.work.rock"] + pair.rock["energy.work.contact"]) / impact)
    assert residuals[1] < 0.01
    assert gaps[1] < 0.005
    assert residuals[0] / residuals[2] == pytest.approx(4.0, rel=0.5)
