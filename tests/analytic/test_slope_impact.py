"""Flight, impact and change of cell, against closed forms."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numba import njit
from scipy.special import lambertw

from rockshed.components.slope_rockfall.restitution import (
    collide,
    contact_tilt,
    rebound,
    restitution,
)
from tests.slope_rocks import G, along, mode, plane, slope

PRINTED, NONE, CONSISTENT = 1, 2, 3
ROCK = {"mass": 1361.0, "radius": 0.5}
SOIL = {"strength": 8e5, "stiffness": 8e6, "hardening": 0.4}
AREA = math.pi * 0.5**2 / 4


def restitution_of(speed, treatment, gravity=G, **ground):
    soil = {**SOIL, **ground}
    return restitution(
        speed,
        ROCK["mass"],
        ROCK["radius"],
        gravity,
        soil["strength"],
        soil["stiffness"],
        soil["hardening"],
        AREA,
        treatment,
    )


# --- flight ---


@given(st.floats(math.radians(-40), math.radians(60)), st.floats(-10.0, 10.0), st.floats(0.5, 12.0))
def test_height_and_length_of_a_jump(angle, u, v):
    """From the cell, with u along it and v off it: (17), (18), and the landing at twice the time of the highest point."""
    rock = plane(angle, radius=0.5, roughness=1e-6, hardening=0.5, start=False)
    rock["velocity0.x"] = u * math.cos(angle) + v * math.sin(angle)
    rock["velocity0.y"] = v * math.cos(angle) - u * math.sin(angle)
    rock.initialise()
    highest = v / (G * math.cos(angle))
    assert rock["next_event.time"] == pytest.approx(2.0 * highest, rel=1e-9)
    rock.step(0.0, highest)
    assert rock["height"] == pytest.approx(v * v / (2.0 * G * math.cos(angle)), rel=1e-9)
    rock.step(highest, highest - 1e-7)
    assert mode(rock) == "flight"
    assert rock["height"] == pytest.approx(0.0, abs=2e-7 * v)
    way = u * 2.0 * highest + G * math.sin(angle) * 2.0 * highest**2
    gone = rock["position.x"] * math.cos(angle) - (
        rock["position.y"] - 0.5 / math.cos(angle)
    ) * math.sin(angle)
    assert gone == pytest.approx(way, abs=1e-5 * (1.0 + abs(way)))


def test_a_jump_over_a_steeper_cell_begins_parallel_to_the_upper_one():
    """(30): from V sin(turn) / sqrt(2 g cos(theta2)) = sqrt(R_o r) on."""
    turn, roughness, radius = math.radians(25.0), 0.1, 0.5
    limit = math.sqrt(2.0 * G * math.cos(turn) * roughness * radius) / math.sin(turn)
    for speed, expected in ((0.999 * limit, "line"), (1.001 * limit, "flight")):
        joint = radius * math.tan(0.5 * turn)  # of the path: it lies on the bisector
        rock = slope(
            [(-50, 0), (0, 0), (50, -50 * math.tan(turn))],
            on_slope=1.0,
            position0__x=joint - 1e-6,
            velocity0__x=speed,
            angular_velocity0=-speed / radius,
            roughness=roughness,
            radius=radius,
            friction=0.9,
        )
        rock.step(0.0, 1e-3)
        assert ("flight" if mode(rock) == "flight" else "line") == expected
        if expected == "flight":
            assert rock["velocity.x"] == pytest.approx(speed, rel=1e-2)
            assert abs(rock["velocity.y"]) < 0.05


def test_a_less_steep_cell_is_an_impact():
    rock = slope(
        [(-50, 50), (0, 0), (50, 0)],
        on_slope=1.0,
        position0__x=-1.0,
        velocity0__x=3.0,
        velocity0__y=-3.0,
        friction=0.5,
        hardening=0.3,
        roughness=0.05,
    )
    before = rock["energy.start"]
    rock.step(0.0, 1.0)
    assert rock["impacts"] >= 1
    assert rock["position.x"] > 0.0
    assert rock["energy.impact"] > 0.0
    assert rock["energy.kinetic"] + rock["energy.gravity"] < before


# --- restitution ---


@pytest.mark.parametrize("speed", [1e-6, 1e-3, 0.01, 0.1, 1.0, 5.0, 12.0])
@pytest.mark.parametrize("strength", [8e5, 3e6])
def test_penetration_and_restitution_against_the_lambert_function(speed, strength):
    """(26): k delta / q_d = 1 + E + W(-exp(-1 - E)), E = m v1^2 k / (2 q_d^2 A); then (24) and (27) without gravity."""
    stiffness, hardening = 10.0 * strength, 0.6
    energy = ROCK["mass"] * speed**2 * stiffness / (2.0 * strength**2 * AREA)
    a = 1.0 + energy + lambertw(-np.exp(-1.0 - energy)).real
    e, delta = restitution_of(
        speed, NONE, strength=strength, stiffness=stiffness, hardening=hardening
    )
    if energy > 1e-5:  # below, the branch point of the Lambert function takes scipy's digits
        assert delta == pytest.approx(a * strength / stiffness, rel=1e-8)
        assert e == pytest.approx(
            math.sqrt(hardening / (ROCK["mass"] * stiffness * AREA))
            * strength
            * AREA
            * (1 - math.exp(-a))
            / speed,
            rel=1e-8,
        )
    else:
        assert delta == pytest.approx(
            speed * math.sqrt(ROCK["mass"] / (stiffness * AREA)), rel=math.sqrt(energy)
        )


@given(
    st.floats(-4.0, 1.6),
    st.floats(5.0, 7.5),
    st.floats(0.0, 1.0),
    st.sampled_from([PRINTED, NONE, CONSISTENT]),
)
def test_restitution_keeps_its_energy_balance(decade, strength, hardening, treatment):
    """Work of the ground on the way in = kinetic energy (+ gravity's work); what is given back is epsilon N^2 / (2 k A)."""
    speed, strength = 10.0**decade, 10.0**strength
    stiffness = 10.0 * strength
    e, delta = restitution_of(
        speed, treatment, strength=strength, stiffness=stiffness, hardening=hardening
    )
    assert 0.0 <= e <= 1.0
    assert 0.0 <= delta <= 2.0 * ROCK["radius"]
    if delta == 2.0 * ROCK["radius"]:
        assert e == 0.0
        return
    a = stiffness * delta / strength
    taken = strength**2 * AREA / stiffness * (a + math.expm1(-a))
    kinetic, gravity = 0.5 * ROCK["mass"] * speed**2, ROCK["mass"] * G * delta
    force = -strength * AREA * math.expm1(-a)
    assert taken == pytest.approx(kinetic + (gravity if treatment == CONSISTENT else 0.0), rel=1e-7)
    given_back = hardening * force**2 / (2.0 * stiffness * AREA) - (
        0.0 if treatment == NONE else gravity
    )
    assert e * e * kinetic == pytest.approx(
        max(0.0, given_back), rel=1e-6, abs=1e-9 * (kinetic + gravity)
    )


def test_limits_of_restitution():
    """Without gravity e(0+) = sqrt(eps); printed, e = 0 below a critical speed; it falls with the speed; eps = 1 loses nothing."""
    assert restitution_of(1e-4, NONE)[0] == pytest.approx(math.sqrt(0.4), rel=1e-3)
    assert restitution_of(1e-2, PRINTED)[0] == 0.0
    assert restitution_of(1e-2, CONSISTENT)[0] == 0.0
    assert restitution_of(1e-2, CONSISTENT, hardening=1.0, strength=1e12)[0] == pytest.approx(
        1.0, abs=1e-3
    )
    assert restitution_of(5.0, NONE, hardening=0.0)[0] == 0.0
    curve = [restitution_of(v, NONE)[0] for v in np.linspace(0.01, 12.0, 200)]
    assert np.all(np.diff(curve) < 0.0)
    assert restitution_of(0.0, NONE) == (0.0, 0.0)
    assert restitution_of(1.0, CONSISTENT, strength=1e4) == (0.0, 1.0)  # cannot carry the rock


# --- velocities after an impact ---

collisions = {
    "u": st.floats(0.0, 30.0),
    "v": st.floats(-30.0, -1e-3),
    "spin": st.floats(-60.0, 60.0),
    "e": st.floats(0.0, 1.0),
    "phi": st.floats(0.0, 1.2),
    "friction": st.floats(0.0, 2.0),
    "ratio": st.floats(0.05, 1.0),
}


@given(**collisions)
def test_impact_fulfils_the_equations_of_momentum(u, v, spin, e, phi, friction, ratio):
    """(19) solved for both impulses, for m = r = 1: the normal one consistent, and the cone of friction kept."""
    s, c = math.sin(phi), math.cos(phi)
    after_u, after_v, after_spin = rebound(u, v, spin, e, s, c, friction, 1.0, ratio)
    shear = -ratio * (after_spin - spin)
    pressure = -s * (after_u - u) + c * (after_v - v)
    scale = (1.0 + abs(u) + abs(v) + abs(spin)) / c
    assert after_v == -e * v
    assert -c * (after_u - u) - s * (after_v - v) == pytest.approx(shear, abs=1e-9 * scale)
    sticks = abs(after_u + after_spin) < 1e-9 * scale
    if sticks:
        assert abs(shear) <= friction * pressure + 1e-9 * scale or friction * math.tan(phi) >= 1.0
    else:
        assert abs(shear) == pytest.approx(friction * pressure, abs=1e-9 * scale)


def test_without_tilt_sticking_and_slipping_are_those_of_a_rigid_sphere():
    stuck = rebound(5.0, -4.0, 0.0, 0.5, 0.0, 1.0, 0.9, 1.0, 0.4)
    assert stuck == pytest.approx((5.0 / 1.4, 2.0, -5.0 / 1.4), rel=1e-12)
    slid = rebound(5.0, -4.0, 0.0, 0.5, 0.0, 1.0, 0.1, 1.0, 0.4)
    assert slid == pytest.approx((5.0 - 0.1 * 6.0, 2.0, -0.1 * 6.0 / 0.4), rel=1e-12)
    overspun = rebound(5.0, -4.0, -50.0, 0.5, 0.0, 1.0, 0.1, 1.0, 0.4)
    assert overspun == pytest.approx((5.0 + 0.1 * 6.0, 2.0, -50.0 + 0.1 * 6.0 / 0.4), rel=1e-12)


def test_a_contact_that_locks_itself_sticks():
    s, c = math.sin(1.2), math.cos(1.2)
    after_u, _, after_spin = rebound(20.0, -1.0, 10.0, 0.2, s, c, 0.6, 1.0, 0.4)
    assert 0.6 * math.tan(1.2) > 1.0
    assert after_u == pytest.approx(-after_spin, rel=1e-12)


@pytest.mark.parametrize(("delta", "degrees"), [(0.0, 0.0), (0.5, 45.0), (1.0, 90.0)])
def test_tilt_of_the_contact_follows_from_the_penetration(delta, degrees):
    s, c = contact_tilt(delta, 0.5, 1e9, -1.0, 0.0, False)
    assert math.degrees(math.atan2(s, c)) == pytest.approx(degrees, abs=1e-9)


def test_a_capped_tilt_does_not_throw_a_falling_rock_back():
    assert contact_tilt(0.3, 0.5, 0.0, -5.0, 0.4, True) == (0.0, 1.0)
    s, c = contact_tilt(0.3, 0.5, 1.0, -5.0, 0.4, True)
    assert s / c == pytest.approx(1.0 / (1.4 * 5.0), rel=1e-12)


@njit
def gains_of(numbers, capped, treatment):
    """Relative gain of energy in impacts at random: each row of ``numbers``, uniform in 0 ... 1, makes one."""
    gains = np.empty(len(numbers))
    for i in range(len(numbers)):
        n = numbers[i]
        radius, mass, ratio = (
            10.0 ** (2.0 * n[0] - 1.3),
            10.0 ** (1.0 + 4.0 * n[1]),
            0.05 + 0.95 * n[2],
        )
        u, v = 10.0 ** (4.7 * n[3] - 3.0), -(10.0 ** (4.7 * n[4] - 3.0))
        spin = 100.0 * n[5] - 50.0 if n[6] < 0.7 else -u
        e, delta = restitution(
            -v,
            mass,
            radius,
            9.81 * n[7],
            10.0 ** (4.0 + 4.0 * n[8]),
            10.0 ** (5.0 + 4.0 * n[9]),
            n[10],
            0.25 * np.pi * radius**2,
            treatment,
        )
        x, y, z = collide(u, v, spin / radius, e, delta, capped, 3.0 * n[11], radius, ratio)
        gains[i] = (x * x + y * y + ratio * (radius * z) ** 2) / (
            u * u + v * v + ratio * spin**2
        ) - 1.0
    return gains


def test_no_impact_gains_energy_in_a_million_and_many_do_as_printed():
    rng = np.random.default_rng(1)
    for _ in range(10):
        assert gains_of(rng.random((100_000, 12)), True, CONSISTENT).max() < 1e-12
    assert np.mean(gains_of(rng.random((100_000, 12)), False, PRINTED) > 1e-12) > 0.1


@given(
    st.floats(-1.0, 1.0),
    st.floats(-20.0, 20.0),
    st.floats(-20.0, -0.5),
    st.floats(-40.0, 40.0),
    st.floats(0.1, 0.9),
)
def test_the_mirrored_impact_is_the_mirrored_one(angle, vx, vy, omega, friction):
    rocks = []
    for side in (1, -1):
        reach = 100.0
        rock = slope(
            [(-reach, side * reach * math.tan(angle)), (reach, -side * reach * math.tan(angle))],
            position0__x=0.0,
            position0__y=3.0 + 0.5 / math.cos(angle),
            velocity0__x=side * vx,
            velocity0__y=vy,
            friction=friction,
            angular_velocity0=side * omega,
            roughness=0.02,
        )
        rock.step(0.0, rock["next_event.time"] + 1e-6)
        rocks.append(rock)
    assert rocks[0]["impacts"] == rocks[1]["impacts"] == 1
    for name, sign in (
        ("velocity.x", -1),
        ("velocity.y", 1),
        ("angular_velocity", -1),
        ("energy.impact", 1),
    ):
        assert rocks[0][name] == pytest.approx(sign * rocks[1][name], rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("meaning", ["relative", "absolute"])
def test_tilt_turns_the_cell_of_an_impact(meaning):
    """On a flat cell only the absolute tilt acts: a rock that falls straight down is thrown to the right."""
    rock = slope(
        [(-10, 0), (10, 0)],
        position0__x=0.0,
        position0__y=5.0,
        velocity0__x=0.0,
        tilt=0.1,
        friction=0.0,
        hardening=0.9,
        tilt__meaning=meaning,
        strength=1e8,
        stiffness=1e9,
    )
    rock.step(0.0, rock["next_event.time"] + 1e-9)
    turned = {"relative": 0.0, "absolute": 0.1}[meaning]
    speed = math.sqrt(2.0 * G * 4.5)
    if turned:
        e = -(rock["velocity.x"] * math.sin(turned) + rock["velocity.y"] * math.cos(turned)) / (
            -speed * math.cos(turned)
        )
        assert 0.0 < e < 1.0
        assert rock["velocity.x"] > 0.5
    else:
        assert rock["velocity.x"] == 0.0


def test_a_rebound_never_goes_into_the_true_cell():
    """A grazing rock on a cell tilted against it would be sent into the slope; it is turned along it."""
    rock = slope(
        [(-100, 0), (100, 0)],
        position0__x=0.0,
        position0__y=0.6,
        velocity0__x=30.0,
        tilt=0.2,
        tilt__meaning="absolute",
        hardening=0.0,
        friction=0.3,
    )
    rock.step(0.0, rock["next_event.time"] + 1e-6)
    assert rock["impacts"] == 1
    assert rock["velocity.y"] == 0.0
    assert along(rock, 0.0) > 20.0
