"""Momentum and energy of the beam: forces, torques, moving supports, damping, weight. Laws that hold for all inputs."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rockshed.components.catalogue import component

BEAM = component("RBSMBeam")
N, SPAN = 12, 1.2
MASS = 7850 * 11.85e-4 * SPAN / N
PLACES = (np.arange(N) + 0.5) * SPAN / N
EXCHANGE = 1e-5

loads = st.lists(st.floats(-1e4, 1e4), min_size=3 * N, max_size=3 * N)
speeds = st.lists(st.floats(-1, 1), min_size=2, max_size=2)
parameters = st.fixed_dictionaries(
    {
        "supports": st.sampled_from(["simple", "fixed"]),
        "gravity": st.sampled_from([0.0, 9.81]),
        "damping.mass": st.sampled_from([0.0, 200.0]),
        "damping.stiffness": st.sampled_from([0.0, 1e-6]),
    }
)


def beam(elements=N, **chosen):
    instance = BEAM.instance(elements=elements)
    for name, value in chosen.items():
        instance[name] = value
    instance.initialise()
    return instance


def put(instance, load):
    instance["force.x"], instance["force.y"], torque = np.split(np.array(load), 3)
    instance["torque"] = 0.01 * torque


def run(instance, load_at, until, support_at=None, exchange=EXCHANGE):
    """Run with the load (3N values) and the motion (height, speed) of both supports as functions of time."""
    for count in range(round(until / exchange)):
        put(instance, load_at(count * exchange))
        if support_at:
            instance["support.position.y"], instance["support.velocity.y"] = support_at(
                count * exchange
            )
        instance.step(count * exchange, exchange)
    return instance


@settings(max_examples=50)
@given(parameters, st.lists(loads, min_size=2, max_size=4), speeds)
def test_momentum(chosen, sequence, speed):
    """Mass-proportional damping is left out: it pulls at the discs from outside."""
    instance = beam(**{**chosen, "damping.mass": 0.0})
    instance["support.velocity.y"] = speed
    for load in sequence:
        before = instance["velocity.y"].copy()
        put(instance, load)
        instance.step(0.0, EXCHANGE)
        instance["support.position.y"] += instance["support.velocity.y"] * EXCHANGE
        gained = MASS * (instance["velocity.y"] - before)
        force = instance["force.y"] - MASS * instance["gravity"]
        left, right = instance["support.mean_force.y"]
        impulse = EXCHANGE * (force.sum() - left - right)
        passed_on = (
            np.abs(force).sum()
            + np.abs(instance["torque"]).sum() * N / SPAN
            + abs(left)
            + abs(right)
        )
        scale = (
            EXCHANGE * passed_on + MASS * (np.abs(before) + np.abs(instance["velocity.y"])).sum()
        )
        assert gained.sum() == pytest.approx(impulse, abs=1e-12 * scale)
        if chosen["supports"] == "simple":
            moment_impulse = EXCHANGE * (force @ PLACES + instance["torque"].sum() - right * SPAN)
            assert gained @ PLACES == pytest.approx(moment_impulse, abs=1e-12 * scale)


@settings(max_examples=30)
@given(parameters, st.lists(loads, min_size=2, max_size=4), speeds)
def test_energy_residual_is_small_and_halves_with_the_step(chosen, sequence, speed):
    """The residual is of first order in the step for any held loads and any motion of the supports, jumps included."""
    residuals, scale = [], 0.0
    for dt in (4e-8, 2e-8):
        instance = beam(**chosen)
        instance["internal_step"] = dt
        for count, load in enumerate(sequence):
            put(instance, load)
            instance["support.velocity.y"] = speed
            instance["support.position.y"] = instance["support.velocity.y"] * EXCHANGE * count * 0.9
            instance.step(0.0, EXCHANGE)
            scale = max(
                scale,
                abs(instance["energy.work.contact"]),
                abs(instance["energy.work.support"]),
                instance["energy.kinetic"],
                instance["energy.elastic"],
                1e-9,
            )
        residuals.append(instance["energy.residual"])
    assert abs(residuals[0]) < 0.02 * scale
    assert abs(residuals[0] - 2 * residuals[1]) < 0.05 * abs(residuals[0]) + 1e-4 * scale


def half_sine(time):
    """A push of 4 ms on one disc, with a torque on the next."""
    load = np.zeros(3 * N)
    if time < 4e-3:
        load[N + 4], load[2 * N + 5] = -3000 * math.sin(math.pi * time / 4e-3), 2000
    return load


@pytest.mark.parametrize(
    "chosen",
    [
        {},
        {"supports": "fixed", "damping.mass": 100.0, "damping.stiffness": 1e-6, "gravity": 9.81},
        {
            "gravity": 9.81,
            "deck.mass": 9.0,
            "box.mass": 5.0,
            "box.left": 0.25,
            "box.width": 0.48,
            "damping.mass": 100.0,
        },
    ],
)
def test_residual_of_an_impact(chosen):
    residuals = []
    for dt in (2e-6, 1e-6, 5e-7):
        instance = run(beam(**chosen, internal_step=dt), half_sine, 6e-3)
        residuals.append(instance["energy.residual"])
    assert abs(residuals[1]) < 1e-2 * instance["energy.work.contact"]
    assert residuals[0] / residuals[1] == pytest.approx(2, rel=0.02)
    assert residuals[1] / residuals[2] == pytest.approx(2, rel=0.02)


def test_damping_takes_all_that_the_impact_gave():
    instance = run(
        beam(**{"damping.mass": 400.0, "damping.stiffness": 1e-6}), half_sine, 0.15, exchange=1e-4
    )
    assert instance["energy.kinetic"] + instance["energy.elastic"] < 1e-9
    assert instance["energy.work.contact"] > 0.5
    assert instance["energy.damping"] == pytest.approx(instance["energy.work.contact"], rel=1e-3)


def test_supports_that_move_like_a_wave_of_the_ground():
    """Both supports shaken apart: their work is what kinetic and elastic energy gain, to first order in the step."""

    def shaken(time):
        angle = 2 * math.pi * 100 * time
        height, speed = 1e-3 * math.sin(angle), 0.2 * math.pi * math.cos(angle)
        return [height, -height], [speed, -speed]

    residuals = []
    for dt in (1e-6, 5e-7):
        instance = run(
            beam(supports="fixed", internal_step=dt), lambda time: np.zeros(3 * N), 5.5e-3, shaken
        )
        residuals.append(instance["energy.residual"])
    assert instance["energy.work.support"] > 0.1
    assert abs(residuals[0]) < 2e-2 * instance["energy.work.support"]
    assert residuals[0] / residuals[1] == pytest.approx(2, rel=0.1)


def test_supports_and_beam_carried_along_together_feel_nothing():
    for ends in ([0.7, 0.7], [0.7, -0.3]):
        instance = beam()
        speed = ends[0] + (ends[1] - ends[0]) * PLACES / SPAN
        instance.state("v_rate")[1:-1] = speed
        run(
            instance,
            lambda time: np.zeros(3 * N),
            1e-3,
            lambda time, ends=ends: (np.array(ends) * time, ends),
        )
        assert instance["position.y"] + 0.025 == pytest.approx(speed * 1e-3, rel=1e-9)
        assert instance["angular_velocity"] == pytest.approx(
            np.full(N, (ends[1] - ends[0]) / SPAN), abs=1e-8
        )
        assert instance["energy.elastic"] < 1e-16
        assert np.abs(instance["support.force.y"]).max() < 1e-3
        assert abs(instance["energy.work.support"]) < 1e-6


@pytest.mark.parametrize("supports", ["simple", "fixed"])
def test_work_of_a_support_that_jumps(supports):
    instance = beam(supports=supports)
    instance["support.position.y"] = [1e-3, -2e-3]
    instance.step(0.0, 1e-12)
    assert instance["energy.elastic"] > 1
    assert instance["energy.work.support"] == pytest.approx(instance["energy.elastic"], rel=1e-9)


@pytest.mark.parametrize("supports", ["simple", "fixed"])
@pytest.mark.parametrize("elements", [9, 24])
def test_symmetric_load_gives_symmetric_response_to_the_bit(elements, supports):
    instance = beam(elements, supports=supports)
    pull = np.random.default_rng(3).uniform(-1e4, 1e4, elements)
    instance["force.y"] = pull + pull[::-1]
    instance["torque"] = (pull - pull[::-1]) / 100
    instance.step(0.0, 1e-3)
    assert np.ptp(instance["position.y"]) > 1e-4
    assert np.array_equal(instance["position.y"], instance["position.y"][::-1])
    assert np.array_equal(instance["velocity.y"], instance["velocity.y"][::-1])
    assert np.array_equal(instance["angle"], -instance["angle"][::-1])
    left, right = instance["support.force.y"]
    assert left == right


def test_the_weight_adds_its_own_deflection_and_nothing_else():
    with_weight, without = (run(beam(gravity=gravity), half_sine, 3e-3) for gravity in (9.81, 0.0))
    alone = beam(gravity=9.81)
    assert with_weight["position.y"] - alone["position.y"] == pytest.approx(
        without["position.y"] + 0.025, abs=1e-13
    )
    assert with_weight["midspan.moment"] - alone["midspan.moment"] == pytest.approx(
        without["midspan.moment"], rel=1e-8
    )


def test_the_couple_of_a_torque_does_the_torques_work():
    """Held torques alone: work = torque * change of angle, whatever the supports do meanwhile."""
    instance = beam(supports="fixed")
    instance["torque"] = np.random.default_rng(5).uniform(-100, 100, N)
    instance["support.velocity.y"] = [0.5, -0.8]
    before = instance["angle"].copy()
    instance.step(0.0, 2e-3)
    expected = instance["torque"] @ (instance["angle"] - before)
    assert instance["energy.work.contact"] == pytest.approx(expected, rel=1e-10)


@pytest.mark.parametrize("gravity", [0.0, 9.81])
def test_load_cells_under_the_box_carry_what_moves_and_holds_the_bare_beam(gravity):
    """Momentum of the beam without its box: from the cells, its weight and the supports."""
    box, sand = 15.0, 80.0
    chosen = {"box.mass": box, "gravity": gravity, "cushion.weight": sand}
    made = beam(**chosen)
    generator, impulse, seen = np.random.default_rng(3), 0.0, 0.0
    for n in range(400):
        made["force.y"] = -sand / N - 500.0 * generator.random(N)
        made.step(n * EXCHANGE, EXCHANGE)
        cells = made["transmitted_force"] - made["box.inertia_force"]
        held = cells + (box + N * MASS) * gravity + made["support.mean_force.y"].sum()
        impulse -= EXCHANGE * held
        seen = max(seen, abs(made["box.inertia_force"]))
    momentum = MASS * made["velocity.y"].sum()
    assert seen > 100.0
    assert momentum == pytest.approx(impulse, abs=1e-9)


def test_the_inertia_of_the_box_is_its_mass_times_acceleration():
    """Supports that rise with 1 - cos at 2 Hz, slowly against the 60 Hz of beam and box.

    The start is a jump of the acceleration: the beam swings, which leaves 4 % of it in the means.
    """
    made = beam(**{"box.mass": 15.0})
    height, omega = 0.05, 2.0 * math.pi * 2.0
    readings, exchange = [], 1e-4
    for n in range(2500):
        time = n * exchange
        made["support.position.y"] = height * (1.0 - math.cos(omega * time))
        made["support.velocity.y"] = height * omega * math.sin(omega * (time + 0.5 * exchange))
        made.step(time, exchange)
        readings.append(made["box.inertia_force"])
    largest = 15.0 * height * omega**2
    for first, last in ((0, 600), (600, 1900), (1250, 2500)):
        speeds = [height * omega * math.sin(omega * row * exchange) for row in (first, last)]
        mean = -15.0 * (speeds[1] - speeds[0]) / ((last - first) * exchange)
        assert np.mean(readings[first:last]) == pytest.approx(mean, abs=0.04 * largest)


def test_without_a_box_nothing_is_taken_from_the_cells():
    made = beam()
    made["force.y"] = -500.0
    made.step(0.0, EXCHANGE)
    assert made["box.inertia_force"] == 0.0
