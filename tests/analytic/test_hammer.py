"""The ram and its cushion: against St. Venant's solution through the rod's ports, restitution, balance of energy."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rockshed.components.common.component import ComponentError
from rockshed.components.pile_rod.st_venant import StVenant

from ..rods import HAMMER, ROD, march, named, reflecting, rod

IMPEDANCE = 23311.36


def blow(
    step_segments,
    duration,
    exchange="sequential",
    segments=50,
    rod_parameters=None,
    **hammer_parameters,
):
    """Hammer and rod (10 m, alpha 0.5), coupled by hand as a sequential or a Jacobi master does.

    step_segments: the step in travel times of a segment.
    """
    struck = named(
        ROD.instance(segments=segments),
        {
            "head__port": "waves",
            "toe__condition": "reflection",
            "toe__reflection": 0.5,
            "exchange": exchange,
            **(rod_parameters or {}),
        },
    )
    hammer = named(HAMMER.instance(), {"weight": 0.0, **hammer_parameters})
    struck.initialise()
    hammer.initialise()
    step = step_segments * struck["time_step"]
    rows = []
    for n in range(round(duration / step)):
        if exchange == "parallel":
            struck["head.force"] = hammer["force"]
        for port in ("head.wave", "head.impedance", "head.position", "head.velocity"):
            hammer[port] = struck[port]
        hammer.step(n * step, step)
        if exchange == "sequential":
            struck["head.force"] = hammer["force"]
        struck.step(n * step, step)
        rows.append((hammer["force"], hammer["head.reached"], struck["head.position"]))
    return hammer, struck, np.array(rows).T


@pytest.mark.parametrize("exchange", ["sequential", "parallel"])
@pytest.mark.parametrize(("steps", "tolerance"), [(1, 2e-5), (5, 5e-4), (10, 2e-3)])
def test_through_the_wave_port_it_is_st_venants_mass(exchange, steps, tolerance):
    hammer, struck, (force, _, _) = blow(steps, 4.4e-3, exchange, internal_step=1e-6)
    exact = StVenant(63.5, hammer["impact_velocity"], IMPEDANCE, 10.0 / 5120.0, 0.5)
    step = steps * struck["time_step"]
    count = int(exact.separation() / step + 1e-9)
    mean = [
        63.5 * (exact.velocity(n * step) - exact.velocity((n + 1) * step * (1 - 1e-12))) / step
        for n in range(count)
    ]
    np.testing.assert_allclose(force[:count], mean, atol=tolerance * exact.first_force, rtol=0)
    assert hammer["separation"] == pytest.approx(exact.separation(), rel=1e-6)
    assert hammer["velocity"] == pytest.approx(exact.rebound(), abs=tolerance * exact.speed)


@pytest.mark.parametrize("alpha", [-1.0, -0.5])
@pytest.mark.parametrize(("segments", "steps"), [(67, 1), (200, 1), (100, 5), (143, 5), (200, 10)])
def test_the_time_of_separation_is_of_second_order_in_the_exchange(alpha, segments, steps):
    """Of the wave the hammer knows the mean over a step alone, and that has many inside."""
    parameters = {"toe__reflection": alpha}
    exact = StVenant(63.5, math.sqrt(2 * 9.80665 * 0.75), IMPEDANCE, 10.0 / 5120.0, alpha)
    end = exact.separation()
    duration = end + 2 * steps * exact.travel_time / segments
    hammer, _, _ = blow(steps, duration, segments=segments, rod_parameters=parameters)
    assert hammer["separation"] == pytest.approx(end, rel=0.1 * (steps / segments) ** 2)


@pytest.mark.parametrize("step", [1e-5, 4e-6])
@pytest.mark.parametrize("restitution", [1.0, 0.3])
def test_a_cushion_lets_the_ram_go_within_a_step(step, restitution):
    """Half a period of the way in, restitution times as long out: second order in the step."""
    hammer = named(
        HAMMER.instance(),
        {
            "port": "kinematics",
            "cushion__stiffness": 1e8,
            "cushion__restitution": restitution,
            "weight": 0.0,
            "internal_step": step,
        },
    )
    hammer.initialise()
    for n in range(500):
        hammer.step(n * 1e-5, 1e-5)
    exact = 0.5 * math.pi * math.sqrt(63.5 / 1e8) * (1.0 + restitution)
    assert hammer["separation"] == pytest.approx(exact, rel=5e5 * step**2)


def test_hammer_and_rod_agree_on_the_head_and_the_coupling_makes_no_energy():
    hammer, struck, (_, known, shown) = blow(10, 6e-3)
    np.testing.assert_allclose(known, shown, atol=1e-12)
    spent = -hammer["energy.work.head"]
    assert 0.99 * spent < struck["energy.work.head"] < spent
    assert abs(hammer["energy.residual"]) < 1e-9
    assert abs(struck["energy.residual"]) < 1e-9


def test_a_step_that_is_no_multiple_of_the_rods_own_keeps_the_impulse():
    """Until the wave comes to the toe: what the ram has lost is in the rod, or waits for the next whole internal step."""
    hammer, struck, (force, _, _) = blow(7.3, 1.8e-3)
    step = 7.3 * struck["time_step"]
    exact = StVenant(63.5, hammer["impact_velocity"], IMPEDANCE, 10.0 / 5120.0, 0.5)
    lost = 63.5 * (hammer["impact_velocity"] - hammer["velocity"])
    assert 0.0 < struck["delay"] < struck["time_step"]
    waits = force[-1] * struck["delay"]
    assert struck["velocity"].sum() * struck["time_step"] * IMPEDANCE + waits == pytest.approx(
        lost, rel=1e-9
    )
    assert hammer["velocity"] == pytest.approx(
        float(exact.velocity(len(force) * step)), abs=1e-6 * exact.speed
    )


def test_the_plain_port_comes_to_the_wave_port_as_the_step_shrinks():
    """A cushion of 1e8 N/m: Z/k = 0.23 ms. Errors of the rebound velocity against the finest wave port."""
    cushion = {"cushion__stiffness": 1e8}
    reference, _, _ = blow(1, 8e-3, segments=1000, **cushion)
    errors = []
    for segments in (25, 50, 100, 200):
        plain = {"head__port": "kinematics", "head__partner__stiffness": 1e8}
        hammer, _, _ = blow(
            1, 8e-3, segments=segments, rod_parameters=plain, port="kinematics", **cushion
        )
        errors.append(abs(hammer["velocity"] - reference["velocity"]))
    assert errors[3] < 1e-3 * reference["impact_velocity"]
    assert errors[0] > 1.7 * errors[1] > 1.7**2 * errors[2] > 1.7**3 * errors[3]


def test_the_plain_port_refuses_a_step_that_the_wave_port_bears():
    stiff = {"cushion__stiffness": 1e11}
    plain = {"head__port": "kinematics", "head__partner__stiffness": 1e11}
    with pytest.raises(
        ComponentError,
        match=r"step 0\.000390625 s exceeds the limit of the ports, step_limit = 2\.33114e-07 s",
    ):
        blow(10, 4e-3, rod_parameters=plain, port="kinematics", **stiff)
    hammer, struck, _ = blow(10, 8e-3, **stiff)
    fine, _, _ = blow(1, 8e-3, segments=500, **stiff)
    assert hammer["velocity"] == pytest.approx(fine["velocity"], abs=0.02 * fine["impact_velocity"])
    assert struck["energy.work.head"] <= -hammer["energy.work.head"]


@pytest.mark.parametrize("restitution", [1.0, 0.8, 0.3])
def test_the_cushion_gives_back_the_square_of_its_restitution(restitution):
    """Against a wall: half a period of loading, then restitution times as long, and the ram leaves with e times its speed."""
    hammer = named(
        HAMMER.instance(),
        {
            "port": "kinematics",
            "cushion__stiffness": 1e8,
            "cushion__restitution": restitution,
            "weight": 0.0,
            "internal_step": 1e-6,
        },
    )
    hammer.initialise()
    forces = []
    for n in range(500):
        hammer.step(n * 1e-5, 1e-5)
        forces.append(hammer["end_force"])
    speed = hammer["impact_velocity"]
    assert hammer["velocity"] == pytest.approx(-restitution * speed, rel=1e-4)
    assert max(forces) == pytest.approx(speed * math.sqrt(63.5 * 1e8), rel=1e-4)
    quarter = 0.5 * math.pi * math.sqrt(63.5 / 1e8)
    assert hammer["separation"] == pytest.approx(quarter * (1.0 + restitution), rel=2e-3)
    assert hammer["energy.cushion_loss"] == pytest.approx(
        (1.0 - restitution**2) * hammer["energy.start"], rel=1e-3, abs=1e-6
    )
    assert abs(hammer["energy.residual"]) < 1e-10 * hammer["energy.start"]


@settings(max_examples=20)
@given(st.floats(1e5, 1e12), st.floats(0.05, 1.0), st.floats(1e-7, 1e-3), st.floats(-5e4, 5e4))
def test_a_cushion_of_any_stiffness_takes_any_step(stiffness, restitution, step, wave):
    """No tension, no gain of energy, an exact balance."""
    hammer = named(
        HAMMER.instance(),
        {
            "cushion__stiffness": stiffness,
            "cushion__restitution": restitution,
            "internal_step": step,
        },
    )
    hammer["head.wave"] = wave
    hammer.initialise()
    losses = [0.0]
    for n in range(50):
        hammer.step(n * step, step)
        assert hammer["force"] >= 0.0
        losses.append(hammer["energy.cushion_loss"])
    scale = hammer["energy.start"] + abs(hammer["energy.work.head"]) + abs(hammer["energy.gravity"])
    assert abs(hammer["energy.residual"]) < 1e-9 * scale
    assert np.diff(losses).min() > -1e-9 * scale


def test_blows_follow_each_other():
    hammer, _, (force, _, _) = blow(10, 0.1, blow__interval=0.05)
    assert hammer["blows"] == 2
    half = len(force) // 2
    assert force[half:].max() > 0.9 * force[:half].max()
    assert hammer["energy.supplied"] > 0.9 * hammer["energy.start"]
    assert abs(hammer["energy.residual"]) < 1e-9 * hammer["energy.start"]


def test_efficiency_takes_from_the_energy_of_the_fall():
    hammer = named(HAMMER.instance(), {"efficiency": 0.6})
    hammer.initialise()
    assert hammer["energy.kinetic"] == pytest.approx(0.6 * 63.5 * 9.80665 * 0.75, rel=1e-12)


def test_a_ram_above_the_head_arrives_later():
    hammer, _, (force, _, _) = blow(1, 1e-3, gap=1e-3)
    arrival = 1e-3 / hammer["impact_velocity"]
    first = np.flatnonzero(force > 0.0)[0] * 10.0 / 5120.0 / 50
    assert first == pytest.approx(arrival, abs=10.0 / 5120.0 / 50)


def test_the_rods_own_ram_is_the_same_as_a_hammer_at_every_internal_step():
    hammer, struck, _ = blow(1, 3e-3, internal_step=1.0)
    own = rod(50, ram__velocity=hammer["impact_velocity"], **reflecting(0.5))
    march(own, round(3e-3 / own["time_step"]), "force")
    np.testing.assert_allclose(struck["force"], own["force"], rtol=1e-9, atol=1e-6)
