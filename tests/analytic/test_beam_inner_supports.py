"""Beams over more than two spans: reactions, moments, frequencies and energy against closed forms."""

import math

import numpy as np
import pytest

from rockshed.components.catalogue import component
from rockshed.components.common.component import ComponentError

BEAM = component("RBSMBeam")
SPAN, GRAVITY = 1.2, 9.81
EI = 2.1e6 * 9.80665e4 * 187e-8
MASS_PER_LENGTH = 7850 * 11.85e-4
WEIGHT = MASS_PER_LENGTH * GRAVITY * SPAN


def beam(elements, *inner, **parameters):
    """A beam with inner supports under these discs, counted from 1."""
    made = BEAM.instance(elements=elements, support_count=2 + len(inner))
    made["support.element"] = [0, 0, *inner]
    for name, value in parameters.items():
        made[name.replace("__", ".")] = value
    made["internal_step"] = 1e9
    made.initialise()
    made["internal_step"] = 0.4 * made["stable_step"]
    return made


@pytest.mark.parametrize(("elements", "share", "bent"), [(25, 5e-4, 8e-3), (101, 1e-5, 5e-4)])
def test_three_supports_share_the_weight_as_those_of_a_beam_of_two_spans(elements, share, bent):
    """3/16, 10/16 and 3/16 of it, errors of the order 1/N3; w l2/8 above the middle one, 1/N2."""
    made = beam(elements, (elements + 1) // 2, gravity=GRAVITY)
    shares = -WEIGHT * np.array([3, 3, 10]) / 16
    assert made["support.force.y"] == pytest.approx(shares, rel=share)
    middle = made["moment"][elements // 2]
    assert middle == pytest.approx(-WEIGHT * SPAN / 32, rel=bent)
    assert made["support.moment"] == pytest.approx([0.0, 0.0, middle], rel=1e-12)
    assert made["support.force.y"].sum() == pytest.approx(-WEIGHT, rel=1e-9)


def test_a_support_that_sinks_below_two_unequal_spans_gives_the_moment_of_clapeyron():
    """Spans a, b: -w (a3 + b3)/8(a + b), and 3 EI d/ab more when it sinks by d."""
    elements, inner, sunk = 201, 71, 0.5e-3
    a = (inner - 0.5) * SPAN / elements
    b, load = SPAN - a, MASS_PER_LENGTH * GRAVITY
    made = BEAM.instance(elements=elements, support_count=3)
    made["support.element"], made["gravity"] = [0, 0, inner], GRAVITY
    made["support.position.y"] = [1e-3, 1e-3, 1e-3 - sunk]
    made.initialise()
    moment = 3 * EI * sunk / (a * b) - load * (a**3 + b**3) / (8 * SPAN)
    assert made["moment"][inner - 1] == pytest.approx(moment, rel=1e-3)
    assert made["support.force.y"][0] == pytest.approx(-moment / a - load * a / 2, rel=1e-3)
    assert made["support.force.y"][1] == pytest.approx(-moment / b - load * b / 2, rel=1e-3)


@pytest.mark.parametrize("ends", ["simple", "fixed"])
def test_on_five_supports_nothing_moves_from_the_start(ends):
    made = beam(24, 18, 5, 12, gravity=GRAVITY, supports=ends)
    before = made["moment"].copy(), made["support.force.y"].copy()
    assert before[1].sum() == pytest.approx(-WEIGHT, rel=1e-9)
    made.step(0.0, 2e-3)
    assert np.abs(made["velocity.y"]).max() < 1e-11
    assert made["moment"] == pytest.approx(before[0], rel=1e-7)
    assert made["support.mean_force.y"] == pytest.approx(before[1], rel=1e-7)


def test_two_equal_spans_vibrate_as_one_span_between_hinges_and_one_that_is_clamped():
    """pi2 and 3.9266022 squared (tan x = tanh x), of sqrt(EI/m l4)."""
    elements = 101
    made = beam(elements, (elements + 1) // 2)
    places = (np.arange(elements) + 0.5) / elements * 2.0
    for root, shape in ((math.pi, odd), (3.9266022, even)):
        omega = released(made, shape(places, root))
        exact = root**2 * math.sqrt(EI / MASS_PER_LENGTH) / (0.5 * SPAN) ** 2
        assert omega == pytest.approx(exact, rel=2e-3)


def odd(x, root):
    """Mode of two spans of length 1 whose halves mirror each other with the other sign."""
    return np.sin(root * x)


def even(x, root):
    """The same with the same sign: hinged at 0 and 2, level at 1."""
    y = np.minimum(x, 2.0 - x)
    return np.sin(root * y) - math.sin(root) / math.sinh(root) * np.sinh(root * y)


def released(made, shape):
    """Frequency (rad/s) of a beam released from a shape, from its kinetic energy's first maximum.

    It has the mode's whole energy a quarter of a period later, and half of it after an eighth.
    """
    made["support.velocity.y"] = 0.0
    for name in ("v", "v_rate", "u", "u_rate"):
        made.state(name)[:] = 0.0
    made.state("v")[1:-1] = 1e-5 * shape
    step, kinetic = 40 * made["internal_step"], []
    for n in range(300):
        made.step(n * step, step)
        kinetic.append(made["energy.kinetic"])
    whole = max(kinetic)
    after = next(n for n, value in enumerate(kinetic) if value >= 0.5 * whole)
    part = (0.5 * whole - kinetic[after - 1]) / (kinetic[after] - kinetic[after - 1])
    return 0.25 * math.pi / ((after + part) * step)


@pytest.mark.parametrize("damping", [0.0, 1e-6])
def test_momentum_and_energy_are_kept_while_an_inner_support_moves(damping):
    """Loads, a torque, weight, and three supports that move apart."""
    made = beam(24, 9, gravity=GRAVITY, damping__stiffness=damping)
    made["force.y[4]"], made["force.y[17]"], made["torque[9]"] = -900.0, -400.0, 20.0
    made["support.velocity.y"] = [0.01, -0.02, -0.05]
    mass = MASS_PER_LENGTH * SPAN / 24
    exchange, residuals = 1e-5, []
    for n in range(2000):
        before = made["velocity.y"].sum()
        made.step(n * exchange, exchange)
        gained = mass * (made["velocity.y"].sum() - before)
        forces = made["force.y"].sum() - WEIGHT - made["support.mean_force.y"].sum()
        assert gained == pytest.approx(exchange * forces, abs=1e-9)
        residuals.append(made["energy.residual"])
        made["support.position.y"] += made["support.velocity.y"] * exchange
    assert made["support.work"].sum() == pytest.approx(made["energy.work.support"], rel=1e-9)
    assert abs(made["support.work"][2]) > 0.5
    assert np.abs(residuals).max() < 2e-3 * np.abs(made["energy.work.support"])


def test_the_stable_step_bears_an_inner_support_and_a_longer_one_does_not():
    made = beam(24, 12)
    for part, bears in ((0.999, True), (1.25, False)):
        made = beam(24, 12)
        made["force.y[5]"], made["internal_step"] = -1.0, part * made["stable_step"]
        try:
            made.step(0.0, 0.02)
            stays = np.abs(made["position.y"] + 0.025).max() < 1e-4
        except ComponentError:
            stays = False
        assert stays == bears


@pytest.mark.parametrize("places", [[0, 0, 0], [0, 0, 25], [0, 0, 3.5], [1, 0, 5], [0, 0, 5, 5]])
def test_a_support_without_a_disc_of_its_own_is_refused(places):
    made = BEAM.instance(elements=24, support_count=len(places))
    made["support.element"] = places
    with pytest.raises(ComponentError, match=r"support\.element.*disc of its own"):
        made.initialise()
