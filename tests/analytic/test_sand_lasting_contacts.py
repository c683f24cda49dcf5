"""Contacts that do not spring back all the way, capillary bridges, and rolling on a boundary,
against closed forms."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rockshed.components.common.units import cm, kgf
from tests.sand_discs import RADIUS, cushion, discs_at, masses, rows, run, sand_stiffness, stirred

COHESION = 0.05 * kgf / cm**2
HEAD_ON = [(0.0, 0.0), (2 * RADIUS, 0.0)], [(1.0, 0.0), (-1.0, 0.0)]


def collision(parameters, step=1e-6, duration=6e-3):
    pair = discs_at(*HEAD_ON, parameters={"damping": 0.0, "internal_step": step, **parameters})
    before = pair["energy.kinetic"]
    run(pair, duration)
    return pair, before


@pytest.mark.parametrize("ratio", [1.0, 2.0, 5.0, 20.0])
def test_restitution_of_contacts_that_yield_is_the_root_of_the_stiffness_ratio(ratio):
    """Walton and Braun (1986): e = sqrt(k_loading / k_unloading), at any speed."""
    pair, before = collision({"unloading_ratio": ratio})
    rebound = (rows(pair)[1, 2] - rows(pair)[0, 2]) / 2.0
    assert rebound == pytest.approx(1.0 / math.sqrt(ratio), rel=2e-3)
    assert pair["energy.plastic"] == pytest.approx(
        (1.0 - 1.0 / ratio) * before, rel=3e-3, abs=1e-9 * before
    )
    assert pair["energy.elastic"] == 0.0


def test_reloading_goes_up_the_unloading_line_without_loss():
    """Pressed together, let go half of the way and pressed again to the same depth: the second
    round costs nothing."""
    pair = discs_at(
        [(0.0, 0.0), (2 * RADIUS, 0.0)],
        parameters={"damping": 0.0, "unloading_ratio": 4.0, "internal_step": 1e-7},
    )

    def at(overlap):
        rows(pair)[:, :4] = (0.0, 0.0, 0.0, 0.0), (2 * RADIUS - overlap, 0.0, 0.0, 0.0)
        run(pair, 1e-7)
        return pair["energy.elastic"], pair["energy.plastic"]

    deepest, k = 1e-3, sand_stiffness(pair)
    first = at(deepest)
    assert first == pytest.approx(
        (0.5 * k * deepest**2 / 4.0, 0.5 * k * deepest**2 * 0.75), rel=1e-9
    )
    assert at(0.875 * deepest) == pytest.approx(
        (0.5 * 4.0 * k * (0.125 * deepest) ** 2, first[1]), rel=1e-9
    )
    assert at(deepest) == pytest.approx(first, rel=1e-9)
    assert at(0.5 * deepest) == pytest.approx((0.0, first[1]), rel=1e-9)


def test_a_contact_that_was_open_begins_anew():
    pair, before = collision({"unloading_ratio": 4.0})
    rows(pair)[:, :2], rows(pair)[:, 2:4] = HEAD_ON
    pair.evaluate()
    run(pair, 6e-3)
    assert pair["energy.plastic"] == pytest.approx(0.75 * before, rel=3e-3)


def pull(sand):
    """Largest attraction between two discs (N): Rumpf with four contacts a disc."""
    area = math.pi * 2 * RADIUS * sand["thickness"]
    return (
        sand["cohesion"] * area / (4.0 * sand["solid_fraction"] * math.tan(sand["friction_angle"]))
    )


def test_a_bridge_draws_two_discs_together_and_holds_them():
    """At rest the spring bears the pull."""
    pair = discs_at([(0.0, 0.0), (2 * RADIUS * 1.04, 0.0)], parameters={"cohesion": COHESION})
    run(pair, 0.2)
    overlap = 2 * RADIUS - (rows(pair)[1, 0] - rows(pair)[0, 0])
    assert overlap == pytest.approx(pull(pair) / sand_stiffness(pair), rel=1e-6)


def test_no_pull_beyond_the_longest_bridge():
    pair = discs_at([(0.0, 0.0), (2 * RADIUS * 1.0501, 0.0)], parameters={"cohesion": COHESION})
    run(pair, 0.01)
    assert rows(pair)[1, 0] - rows(pair)[0, 0] == 2 * RADIUS * 1.0501
    assert pair["energy.capillary"] == 0.0


@pytest.mark.parametrize(("share", "parts"), [(0.99, False), (1.01, True)])
def test_work_of_separation(share, parts):
    """Two discs at rest part when they have more than the energy of bridge and spring: F s / 2 +
    F^2 / (2 k)."""
    pair = discs_at(
        [(0.0, 0.0), (2 * RADIUS, 0.0)],
        parameters={"cohesion": COHESION, "damping": 0.0, "internal_step": 1e-7},
    )
    force, stiffness = pull(pair), sand_stiffness(pair)
    rows(pair)[1, 0] -= force / stiffness
    work = 0.5 * force * 0.05 * 2 * RADIUS + 0.5 * force**2 / stiffness
    speed = math.sqrt(share * work / masses(pair)[0])
    rows(pair)[:, 2] = -speed, speed
    pair.evaluate()
    run(pair, 5e-3, 1e-4)
    assert bool(rows(pair)[1, 0] - rows(pair)[0, 0] > 2 * RADIUS * 1.051) is parts


@settings(max_examples=15)
@given(
    ratio=st.sampled_from([1.0, 3.0, 20.0]),
    cohesion=st.sampled_from([0.0, COHESION]),
    rolling=st.sampled_from([0.0, 0.3]),
    seed=st.integers(0, 1000),
)
def test_energy_is_accounted_for(ratio, cohesion, rolling, seed):
    """A stirred heap in a box: the residual falls with the step."""

    def residual(step):
        sand = stirred(
            cushion(
                {
                    "base": "floor",
                    "box.left": 0.0,
                    "box.width": 0.1,
                    "packing": "random",
                    "disc.spread": 0.25,
                    "seed": seed,
                    "rotation": "free",
                    "stiffness_factor": 1.0,
                    "settling.time": 0.3,
                    "unloading_ratio": ratio,
                    "cohesion": cohesion,
                    "rolling_resistance": rolling,
                    "rock.position.y": 2.0,
                    "internal_step": step,
                }
            ),
            0.5,
            seed,
        )
        energy = sand["energy.kinetic"]
        run(sand, 0.02)
        return abs(sand["energy.residual"]) / energy

    assert residual(1e-6) < max(2e-3, 0.6 * residual(4e-6))


def test_a_disc_rolls_to_rest_on_the_floor():
    """Rolling resistance on a plane: a moment mu_r m g r slows the disc down by mu_r g / 1.5."""
    disc = discs_at(
        [(0.0, RADIUS)],
        [(0.5, 0.0)],
        [-0.5 / RADIUS],
        parameters={
            "gravity": 9.80665,
            "base.y": 0.0,
            "rolling_resistance": 0.1,
            "internal_step": 2e-6,
        },
    )
    rows(disc)[0, 1] -= masses(disc)[0] * 9.80665 / sand_stiffness(disc)
    disc.evaluate()
    run(disc, 0.2)
    assert rows(disc)[0, 2] == pytest.approx(0.5 - 0.2 * 0.1 * 9.80665 / 1.5, rel=5e-3)
    run(disc, 1.0)
    assert abs(rows(disc)[0, 2]) < 2e-3
