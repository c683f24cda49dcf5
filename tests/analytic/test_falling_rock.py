"""Motion, momentum and energy of the falling rock against closed forms with the terms of the integration."""

import math

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from rockshed.components.catalogue import component

ROCK = component("FallingRock")

forces = st.floats(-1e5, 1e5)
speeds = st.floats(-50.0, 50.0)
steps = st.floats(1e-6, 1e-2)


def rock(**parameters):
    instance = ROCK.instance()
    for name, value in parameters.items():
        instance[name.replace("__", ".")] = value
    instance.initialise()
    return instance


def pushed(instance, force_x=0.0, force_y=0.0, torque=0.0):
    instance["force.x"], instance["force.y"], instance["torque"] = force_x, force_y, torque
    return instance


def test_free_fall():
    """Velocity is exact, the path is too long by g dt t/2."""
    instance = rock(
        gravity=9.81, position0__y=2.0, velocity0__y=-8.0, velocity0__x=3.0, internal_step=1e-4
    )
    instance.step(0.0, 0.3)
    assert instance["velocity.y"] == pytest.approx(-8.0 - 9.81 * 0.3, rel=1e-12)
    assert instance["position.y"] == pytest.approx(
        2.0 - 8.0 * 0.3 - 9.81 * 0.3**2 / 2 - 9.81 * 1e-4 * 0.3 / 2, rel=1e-12
    )
    assert instance["position.x"] == pytest.approx(0.9, rel=1e-12)
    assert instance["velocity.x"] == 3.0


def test_constant_force_and_torque():
    instance = pushed(
        rock(mass=5.0, shape="given", moment_of_inertia=0.2, gravity=0.0, velocity0__y=0.0),
        10.0,
        -20.0,
        0.4,
    )
    instance.step(0.0, 0.5)
    assert instance["velocity.x"] == pytest.approx(1.0, rel=1e-9)
    assert instance["velocity.y"] == pytest.approx(-2.0, rel=1e-9)
    assert instance["angular_velocity"] == pytest.approx(1.0, rel=1e-9)
    assert instance["angle"] == pytest.approx(0.25 * (1 + 1e-5 / 0.5), rel=1e-9)
    assert instance["energy.work.contact"] == pytest.approx(0.5 * 5 * (1 + 4) + 0.5 * 0.2, rel=1e-9)


@pytest.mark.parametrize(
    ("shape", "inertia"), [("sphere", 0.4 * 4 * 0.25), ("disc", 0.5 * 4 * 0.25), ("given", 0.7)]
)
def test_spin_up_follows_from_the_shape(shape, inertia):
    instance = pushed(
        rock(mass=4.0, radius=0.5, shape=shape, moment_of_inertia=0.7, gravity=0.0), torque=0.3
    )
    instance.step(0.0, 0.1)
    assert instance["angular_velocity"] == pytest.approx(0.03 / inertia, rel=1e-12)


def test_spin_without_torque_goes_on():
    instance = rock(angular_velocity0=7.0, angle0=0.5)
    instance.step(0.0, 0.2)
    assert instance["angular_velocity"] == 7.0
    assert instance["angle"] == pytest.approx(0.5 + 1.4, rel=1e-12)


@given(forces, forces, forces, speeds, speeds, steps, st.integers(1, 20))
def test_momentum(force_x, force_y, torque, vx, vy, step, count):
    instance = pushed(
        rock(velocity0__x=vx, velocity0__y=vy, internal_step=step / 3), force_x, force_y, torque
    )
    for number in range(count):
        instance.step(number * step, step)
    time, mass = step * count, instance["mass"]
    for axis, force, start in (("x", force_x, vx), ("y", force_y - mass * instance["gravity"], vy)):
        scale = abs(force) * time + mass * abs(start) + 1e-3
        assert mass * (instance[f"velocity.{axis}"] - start) == pytest.approx(
            force * time, abs=1e-12 * scale
        )
    spin = 0.4 * mass * instance["radius"] ** 2 * instance["angular_velocity"]
    assert spin == pytest.approx(torque * time, rel=1e-12, abs=1e-12)


@given(forces, forces, forces, speeds, speeds, st.floats(0.1, 30.0), steps)
def test_energy_residual(force_x, force_y, torque, vx, vy, gravity, step):
    """m g dt (v - v0)/2, as the README says: gravity alone leaves a residual, held forces none."""
    instance = rock(velocity0__x=vx, velocity0__y=vy, gravity=gravity, internal_step=step / 4)
    pushed(instance, force_x, force_y, torque).step(0.0, step)
    expected = instance["mass"] * gravity * step / 4 * (instance["velocity.y"] - vy) / 2
    scale = (
        instance["energy.kinetic"]
        + abs(instance["energy.gravity"])
        + abs(instance["energy.work.contact"])
    )
    assert instance["energy.residual"] == pytest.approx(expected, abs=1e-11 * scale)


@given(forces, forces, forces, st.integers(-20, -8), st.integers(0, 4))
def test_split_of_a_communication_step_gives_the_same_internal_steps(
    force_x, force_y, torque, exponent, splits
):
    step = 2.0**exponent
    whole, parts = (
        pushed(rock(internal_step=step / 16), force_x, force_y, torque) for _ in range(2)
    )
    whole.step(0.0, step)
    for number in range(2**splits):
        parts.step(number * step / 2**splits, step / 2**splits)
    for name in (
        "position.x",
        "position.y",
        "angle",
        "velocity.x",
        "velocity.y",
        "angular_velocity",
    ):
        assert whole[name] == parts[name]


@given(speeds, speeds, st.floats(0.01, 1.0))
def test_thrown_rock_keeps_its_parabola(vx, vy, time):
    assume(abs(vx) > 0.1)
    instance = rock(velocity0__x=vx, velocity0__y=vy, position0__y=0.0, internal_step=1e-4)
    instance.step(0.0, time)
    x, y, dt = instance["position.x"], instance["position.y"], time / math.ceil(time / 1e-4 - 1e-9)
    assert y == pytest.approx(
        vy * x / vx - instance["gravity"] / 2 * (x / vx) * (x / vx + dt), rel=1e-9, abs=1e-9
    )


# ------------------------------------------------------------------ driven


@given(forces, forces, forces, speeds, speeds, speeds, steps)
def test_a_driven_rock_keeps_its_velocities_and_the_machine_does_what_is_missing(
    force_x, force_y, torque, vx, vy, omega, step
):
    """Power of the machine: (m g - force_y) vy - force_x vx - torque omega; nothing else feeds the rock, and the balance closes."""
    instance = rock(
        motion="driven",
        velocity0__x=vx,
        velocity0__y=vy,
        angular_velocity0=omega,
        internal_step=step / 3,
    )
    start = {name: instance[name] for name in ("position.x", "position.y", "angle")}
    pushed(instance, force_x, force_y, torque).step(0.0, step)
    assert (instance["velocity.x"], instance["velocity.y"], instance["angular_velocity"]) == (
        vx,
        vy,
        omega,
    )
    for name, speed in (("position.x", vx), ("position.y", vy), ("angle", omega)):
        assert instance[name] - start[name] == pytest.approx(speed * step, rel=1e-9, abs=1e-12)
    supplied = ((4.0 * 9.80665 - force_y) * vy - force_x * vx - torque * omega) * step
    scale = (
        (abs(force_x * vx) + abs(force_y * vy) + abs(torque * omega) + 40.0 * abs(vy)) * step
        + instance["energy.kinetic"]
        + 1.0
    )
    assert instance["energy.work.drive"] == pytest.approx(supplied, abs=1e-12 * scale)
    assert instance["energy.residual"] == pytest.approx(
        0.0, abs=1e-11 * (scale + abs(instance["energy.gravity"]))
    )


def test_a_machine_that_lifts_a_rock_does_the_work_of_its_weight():
    instance = rock(motion="driven", mass=5.0, gravity=10.0, velocity0__y=0.2)
    instance.step(0.0, 3.0)
    assert instance["energy.work.drive"] == pytest.approx(30.0, rel=1e-9)
    assert instance["energy.work.contact"] == 0.0


def test_no_machine_works_on_a_free_rock():
    instance = pushed(rock(), 1e3, 1e4, 2.0)
    instance.step(0.0, 0.1)
    assert instance["energy.work.drive"] == 0.0
