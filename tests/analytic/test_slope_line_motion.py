"""Rolling, sliding and coming to rest on a cell, against closed forms."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.slope_rocks import G, along, mode, plane

angles = st.floats(math.radians(1.0), math.radians(60.0))


def pressed(angle, roughness, shear_per_pressure):
    """P / (m g) when S = shear_per_pressure * P: the second of equations (1)."""
    phi = 0.5 * math.acos(1.0 - roughness)
    return math.cos(angle) / (math.cos(phi) - shear_per_pressure * math.sin(phi))


@pytest.mark.parametrize(("shape", "share"), [("sphere", 5 / 7), ("disc", 2 / 3)])
def test_a_smooth_rock_rolls_with_the_share_of_gravity_of_its_shape(shape, share):
    rock = plane(0.3, shape=shape, friction=0.9)
    rock.step(0.0, 2.0)
    assert mode(rock) == "rolling"
    assert along(rock, 0.3) == pytest.approx(share * G * math.sin(0.3) * 2.0, rel=1e-12)
    assert math.hypot(
        rock["position.x"], rock["position.y"] - 0.5 / math.cos(0.3)
    ) == pytest.approx(share * G * math.sin(0.3) * 2.0, rel=1e-12)
    assert rock["angular_velocity"] == pytest.approx(-along(rock, 0.3) / 0.5, rel=1e-12)


@given(
    angles, st.floats(0.0, 0.3), st.floats(0.0, 200.0), st.floats(0.05, 1.0), st.floats(0.0, 30.0)
)
def test_rolling_fulfils_the_equations_of_motion(angle, roughness, resistance, ratio, speed):
    """(1) with no slip, solved for the forces: normal equation, spin equation, and what is left along the cell."""
    mass, radius = 1000.0, 0.5
    inertia = ratio * mass * radius**2
    rock = plane(
        angle,
        speed,
        -speed,
        friction=0.99 * math.sqrt(2.0 / max(roughness, 1e-4) - 1.0),
        mass=mass,
        roughness=roughness,
        resistance=resistance,
        shape="given",
        moment_of_inertia=inertia,
    )
    phi, drag = 0.5 * math.acos(1.0 - roughness), math.pi * radius**2 * resistance
    rock.step(0.0, 1e-3)
    if mode(rock) != "rolling":
        return
    gained = (along(rock, angle) - speed) / 1e-3
    spun = (rock["angular_velocity"] + speed / radius) / 1e-3
    shear = -inertia * spun / radius
    pressure = (mass * G * math.cos(angle) + shear * math.sin(phi)) / math.cos(phi)
    left = (
        mass * G * math.sin(angle)
        - pressure * math.sin(phi)
        - shear * math.cos(phi)
        - drag
        - mass * gained
    )
    assert left == pytest.approx(0.0, abs=1e-8 * mass * G)
    assert spun == pytest.approx(-gained / radius, abs=1e-8 * G / radius)


@given(
    angles, st.floats(0.0, 0.3), st.floats(0.05, 0.9), st.floats(1.0, 20.0), st.floats(-1.0, 3.0)
)
def test_sliding_fulfils_the_equations_of_motion_whichever_way_it_slips(
    angle, roughness, friction, speed, spin
):
    """Topspin beyond rolling (spin < -speed) pushes the rock forward: the sign that the print has lost."""
    spin = -speed * spin
    if abs(speed + spin) < 0.3 * speed:
        spin = 0.0
    rock = plane(angle, speed, spin, friction=friction, roughness=roughness)
    rock.step(0.0, 1e-4)
    assert mode(rock) == "sliding"
    phi, across = 0.5 * math.acos(1.0 - roughness), math.copysign(friction, speed + spin)
    pressure = pressed(angle, roughness, across)
    assert (along(rock, angle) - speed) / 1e-4 == pytest.approx(
        G * (math.sin(angle) - pressure * (math.sin(phi) + across * math.cos(phi))), abs=1e-6
    )
    assert (rock["angular_velocity"] - spin / 0.5) / 1e-4 == pytest.approx(
        -across * pressure * G / (0.4 * 0.5), abs=1e-6
    )


def test_stopping_distance_on_the_flat():
    """Energy (1 + beta) m v2 / 2 against the roughness' share of the weight and the resistance."""
    speed, roughness, resistance, mass, radius = 8.0, 0.02, 300.0, 1400.0, 0.5
    rock = plane(
        0.0,
        speed,
        -speed,
        friction=0.6,
        roughness=roughness,
        resistance=resistance,
        mass=mass,
        radius=radius,
    )
    phi, drag = 0.5 * math.acos(1.0 - roughness), math.pi * radius**2 * resistance
    slowing = (G * math.tan(phi) + drag / mass) / (
        1.0 + 0.4 * (math.tan(phi) * math.sin(phi) + math.cos(phi))
    )
    rock.step(0.0, 60.0)
    assert mode(rock) == "rest"
    assert rock["position.x"] == pytest.approx(speed**2 / (2.0 * slowing), rel=1e-10)
    assert rock["next_event.time"] == 1e30
    assert (rock["velocity.x"], rock["angular_velocity"]) == (0.0, 0.0)


@pytest.mark.parametrize("friction", [0.1, 0.4])
def test_time_and_speed_when_slip_turns_to_rolling(friction):
    """Without spin at first, on the flat: u = 5/7 u0 after 2/7 u0 / (mu g)."""
    rock = plane(0.0, 7.0, 0.0, friction=friction)
    turn = 2.0 / (friction * G)
    assert rock["next_event.time"] == pytest.approx(turn, rel=1e-12)
    rock.step(0.0, turn + 1e-9)
    assert mode(rock) == "rolling"
    assert rock["velocity.x"] == pytest.approx(5.0, rel=1e-8)
    assert rock["angular_velocity"] == pytest.approx(-10.0, rel=1e-8)


def test_on_a_slope_too_steep_for_its_friction_a_rock_never_rolls():
    """tan(theta) > 7/2 mu for a sphere: S = 2/7 m g sin(theta) would exceed mu P."""
    for friction, expected in ((0.30, "rolling"), (0.28, "sliding")):
        rock = plane(math.atan(1.0), 1.0, -1.0, friction=friction)
        rock.step(0.0, 5.0)
        assert mode(rock) == expected


def test_a_rock_that_decelerates_rolls_on():
    """The printed condition of rolling calls it a sliding one."""
    rock = plane(math.radians(2.0), 5.0, -5.0, friction=0.5, roughness=0.1)
    rock.step(0.0, 0.5)
    assert along(rock, math.radians(2.0)) < 5.0
    assert mode(rock) == "rolling"


def test_resistance_and_roughness_never_start_a_motion():
    rock = plane(math.radians(10.0), friction=0.6, roughness=0.1, resistance=500.0)
    assert math.tan(0.5 * math.acos(0.9)) > math.tan(math.radians(10.0))
    assert mode(rock) == "rest"
    rock.step(0.0, 100.0)
    assert (rock["position.x"], rock["velocity.x"], rock["velocity.y"]) == (0.0, 0.0, 0.0)


def test_a_rock_thrown_up_the_slope_comes_back_slower_and_passes_its_start():
    angle = math.radians(20.0)
    rock = plane(angle, -6.0, 6.0, friction=0.8, roughness=0.01)
    lost_before = rock["energy.start"]
    highest = 0.0
    for number in range(100):
        rock.step(number * 0.1, 0.1)
        highest = max(highest, rock["position.y"])
    assert highest > 0.5 / math.cos(angle) + 0.5
    assert rock["position.x"] > 0.0
    assert rock["energy.kinetic"] + rock["energy.gravity"] < lost_before
    assert rock["energy.residual"] == pytest.approx(0.0, abs=1e-9 * rock["energy.kinetic"])


@given(
    angles,
    st.floats(-20.0, 20.0),
    st.floats(-20.0, 20.0),
    st.floats(0.0, 0.2),
    st.floats(0.05, 0.9),
    st.floats(0.0, 500.0),
)
def test_the_mirrored_slope_gives_the_mirrored_motion(
    angle, speed, spin, roughness, friction, resistance
):
    rocks = [
        plane(
            side * angle,
            side * speed,
            side * spin,
            friction=friction,
            roughness=roughness,
            resistance=resistance,
        )
        for side in (1, -1)
    ]
    for rock in rocks:
        rock.step(0.0, 3.0)
    right, left = rocks
    assert mode(right) == mode(left)
    scale = 1.0 + abs(right["position.x"])
    for name, sign in (
        ("position.x", -1),
        ("position.y", 1),
        ("velocity.x", -1),
        ("velocity.y", 1),
        ("angular_velocity", -1),
        ("energy.kinetic", 1),
    ):
        assert right[name] == pytest.approx(sign * left[name], rel=1e-9, abs=1e-9 * scale)


def test_a_spinning_rock_on_rough_ground_spins_on_the_spot_and_rests():
    """mu tan(phi) < 1, but the friction mu m g cannot lift the rock over its roughness."""
    rock = plane(0.0, 0.0, 2.0, friction=0.2, roughness=0.3, mass=1000.0)
    assert mode(rock) == "spinning"
    halt = 0.4 * 2.0 / (0.2 * G)
    assert rock["next_event.time"] == pytest.approx(halt, rel=1e-12)
    rock.step(0.0, 1.0)
    assert mode(rock) == "rest"
    assert rock["position.x"] == 0.0
    assert rock["energy.friction"] == pytest.approx(0.5 * 0.4 * 1000.0 * 2.0**2, rel=1e-12)


@given(
    angles,
    st.floats(-15.0, 15.0),
    st.floats(-15.0, 15.0),
    st.floats(0.0, 0.2),
    st.floats(0.05, 0.9),
    st.floats(0.0, 500.0),
    st.floats(0.01, 20.0),
)
def test_what_line_motion_loses_is_booked(
    angle, speed, spin, roughness, friction, resistance, time
):
    rock = plane(angle, speed, spin, friction=friction, roughness=roughness, resistance=resistance)
    rock.step(0.0, time)
    assert rock["energy.residual"] == pytest.approx(
        0.0, abs=1e-10 * (abs(rock["energy.start"]) + rock["energy.kinetic"] + 1.0)
    )
    for name in ("friction", "roughness", "resistance"):
        assert rock[f"energy.{name}"] >= -1e-9 * (rock["energy.kinetic"] + 1.0)
    assert rock["energy.impact"] == 0.0


def test_take_off_at_the_limit_speed():
    """Eq. (29): with V_lim and the angle arctan(R_o) from the cell, at the moment at which the speed is reached."""
    angle, roughness = math.radians(35.0), 0.1
    rock = plane(angle, friction=0.9, roughness=roughness, **{"limit_speed__mean": 15.0})
    take_off = rock["next_event.time"]
    rock.step(0.0, take_off + 1e-11)
    assert mode(rock) == "flight"
    assert math.hypot(rock["velocity.x"], rock["velocity.y"]) == pytest.approx(15.0, rel=1e-9)
    direction = math.atan2(rock["velocity.y"], rock["velocity.x"])
    assert direction + angle == pytest.approx(math.atan(roughness), rel=1e-9)
    rock.step(take_off + 1e-11, 0.1)
    assert rock["height"] > 0.05
