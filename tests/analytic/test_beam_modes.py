"""Frequencies, critical step and damping of the beam against closed forms with their discretisation terms."""

import math
from contextlib import nullcontext

import numpy as np
import pytest

from rockshed.components.catalogue import component
from rockshed.components.common.component import ComponentError

BEAM = component("RBSMBeam")
SPAN = 1.2
EI, EA = 2.1e6 * 9.80665e4 * 187e-8, 2.1e6 * 9.80665e4 * 11.85e-4
MASS_PER_LENGTH = 7850 * 11.85e-4


def beam(elements=24, **parameters):
    instance = BEAM.instance(elements=elements)
    for name, value in parameters.items():
        instance[name.replace("__", ".")] = value
    instance.initialise()
    return instance


def mode(instance, n):
    """Shape sin(n pi x/L) at the discs."""
    elements = instance.sizes["elements"]
    return np.sin(n * np.pi * (np.arange(elements) + 0.5) / elements)


def history(instance, array, shape, dt, every, count):
    """Amplitude of the shape, every so many steps, from the deflected shape released at rest."""
    state = instance.state(array)[1:-1]
    state[:] = 1e-6 * shape
    amplitudes = [1.0]
    instance["internal_step"] = dt
    for number in range(count):
        instance.step(number * every * dt, every * dt)
        amplitudes.append(shape @ state / (1e-6 * (shape @ shape)))
    assert state == pytest.approx(amplitudes[-1] * 1e-6 * shape, abs=1e-13)
    return np.array(amplitudes)


def frequency(instance, array, shape, dt, every):
    """omega (rad/s) without the error of the time integration: x[k+1] + x[k-1] = 2 cos(every phi) x[k], omega dt = 2 sin(phi/2)."""
    _, first, middle, last = history(instance, array, shape, dt, every, 3)
    return 2 / dt * math.sin(math.acos((last + first) / (2 * middle)) / every / 2)


@pytest.mark.parametrize("n", [1, 2, 3])
def test_first_frequencies(n):
    """Exact for the chain; to the continuous beam the term is (n pi/N)2/12."""
    errors = []
    for elements in (24, 48):
        instance, spacing = beam(elements), SPAN / elements
        omega = frequency(instance, "v", mode(instance, n), 1e-6, 1000 // n**2)
        chain = (
            4
            / spacing**2
            * math.sqrt(EI / MASS_PER_LENGTH)
            * math.sin(n * math.pi / (2 * elements)) ** 2
        )
        assert omega == pytest.approx(chain, rel=1e-9)
        errors.append(1 - omega / ((n * math.pi / SPAN) ** 2 * math.sqrt(EI / MASS_PER_LENGTH)))
    assert errors[0] == pytest.approx((n * math.pi / 24) ** 2 / 12, rel=0.02)
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.02)


@pytest.mark.parametrize("n", [1, 2])
def test_axial_frequencies(n):
    instance = beam()
    shape = np.sin((2 * n - 1) * np.pi / 2 * (np.arange(24) + 0.5) / 24)
    omega = frequency(instance, "u", shape, 1e-7, 2000 // n)
    assert omega == pytest.approx(
        2 * 24 / SPAN * math.sqrt(EA / MASS_PER_LENGTH) * math.sin((2 * n - 1) * math.pi / 96),
        rel=1e-9,
    )


def stiffness_over_mass(instance, array):
    """What a unit displacement of each disc does to the velocities in one short step, per second."""
    displacement, rate = instance.state(array), instance.state(array + "_rate")
    columns, dt = [], instance["internal_step"]
    for number in range(1, instance.sizes["elements"] + 1):
        displacement[:], rate[:] = 0.0, 0.0
        displacement[number] = 1e-3
        BEAM.step(0.0, dt, instance.w, instance.x, instance.k)
        columns.append(-rate[1:-1] / (1e-3 * dt))
    return np.array(columns).T


def test_frequencies_on_fixed_supports():
    """Clamped beam: (beta L)2 with cos cosh = 1; the chain's term falls with 1/N2."""
    roots = np.array([4.730040744862704, 7.853204624095838, 10.995607838001671])
    expected = (roots / SPAN) ** 2 * math.sqrt(EI / MASS_PER_LENGTH)
    errors = []
    for elements in (24, 72):
        instance = beam(elements, supports="fixed", internal_step=1e-8)
        errors.append(
            np.sqrt(np.sort(np.linalg.eigvals(stiffness_over_mass(instance, "v")).real)[:3])
            / expected
            - 1
        )
    assert np.abs(errors[0]).max() < 0.04
    assert errors[0] / errors[1] == pytest.approx(9, rel=0.08)


@pytest.mark.parametrize("supports", ["simple", "fixed"])
@pytest.mark.parametrize("elements", [2, 3, 4, 9, 24])
@pytest.mark.parametrize("second_moment", [187e-8, 187e-6], ids=["axial", "bending"])
def test_stable_step_is_that_of_the_highest_frequency(elements, supports, second_moment):
    """Few discs of the laboratory's section are limited axially; a stiffer section always in bending."""
    instance = beam(
        elements, supports=supports, internal_step=1e-10, section__second_moment=second_moment
    )
    omega2 = 0.0
    for array in ("u", "v"):
        matrix = stiffness_over_mass(instance, array)
        assert matrix == pytest.approx(matrix.T, rel=1e-9, abs=1e-9 * abs(matrix).max())
        omega2 = max(omega2, np.linalg.eigvalsh(matrix)[-1])
    assert instance["stable_step"] == pytest.approx(2 / math.sqrt(omega2), rel=1e-8)


def test_critical_steps_of_the_laboratory_beam():
    assert beam()["stable_step"] == pytest.approx(6.143e-6, rel=1e-4)
    assert beam()["stable_step"] == pytest.approx(
        0.05**2 / 2 * math.sqrt(MASS_PER_LENGTH / EI), rel=1e-12
    )
    axial = 0.05 * math.sqrt(7850 / (2.1e6 * 9.80665e4)) / math.cos(math.pi / 96)
    assert beam(section__second_moment=1e-9)["stable_step"] == pytest.approx(axial, rel=1e-12)


@pytest.mark.parametrize(
    "parameters",
    [
        {},
        {"supports": "fixed"},
        {"section__second_moment": 1e-7},
        {"section__second_moment": 1e-7, "supports": "fixed"},
        {"damping__stiffness": 3e-6},
        {"damping__mass": 2e5},
        {"damping__mass": 5e4, "damping__stiffness": 1e-6, "supports": "fixed"},
    ],
)
def test_bounded_just_below_the_stable_step_and_not_just_above(parameters):
    rng = np.random.default_rng(1)
    kick = 1e-6 * rng.standard_normal((2, 24))
    below, above = beam(**parameters), beam(**parameters)
    for instance, factor in ((below, 0.99), (above, 1.01)):
        instance["internal_step"] = factor * instance["stable_step"]
        instance.state("u")[1:-1], instance.state("v")[1:-1] = kick
    below.step(0.0, 20000 * below["internal_step"])
    assert np.abs(below["position.y"] + 0.025).max() < 2e-5
    with pytest.raises(
        ComponentError, match=r"RBSMBeam: at t = 0 s the beam diverged.*internal_step is .* stable"
    ):
        above.step(0.0, 20000 * above["internal_step"])


@pytest.mark.parametrize("damping", [{"damping__mass": 300.0}, {"damping__stiffness": 1e-5}])
def test_decay_of_the_first_mode(damping):
    """x[k+1] = p x[k] - q x[k-1], q the square of the decay between samples; a step takes 1 - a dt from it."""
    instance = beam(**damping)
    omega = 4 / 0.05**2 * math.sqrt(EI / MASS_PER_LENGTH) * math.sin(math.pi / 48) ** 2
    rate = instance["damping.mass"] + instance["damping.stiffness"] * omega**2
    x0, x1, x2, x3 = history(instance, "v", mode(instance, 1), 1e-6, 1000, 3)
    _, q = np.linalg.solve([[x1, -x0], [x2, -x1]], [x2, x3])
    assert math.log(q) / 1000 == pytest.approx(math.log(1 - rate * 1e-6), rel=1e-6)


def test_mass_that_is_even_over_the_span_slows_all_modes_alike():
    """The same mass as deck, as box, or as steel: exact for the chain."""
    plain, deck = beam(), beam(deck__mass=3 * MASS_PER_LENGTH)
    box = beam(box__left=0.0, box__width=SPAN, box__mass=3 * MASS_PER_LENGTH * SPAN)
    for heavy in (deck, box):
        assert heavy["stable_step"] == pytest.approx(2 * plain["stable_step"], rel=1e-9)
        assert frequency(heavy, "v", mode(heavy, 1), 1e-6, 1000) == pytest.approx(
            frequency(beam(), "v", mode(plain, 1), 1e-6, 1000) / 2, rel=1e-9
        )


@pytest.mark.parametrize("supports", ["simple", "fixed"])
def test_stable_step_with_a_box_is_on_the_safe_side(supports):
    """Nothing grows at it, and at 1.1 times it something does: the discs without the box decide."""
    for factor, grows in ((0.999, False), (1.1, True)):
        instance = beam(supports=supports, deck__mass=10.0, box__mass=20.0)
        instance["internal_step"] = factor * instance["stable_step"]
        instance.state("v")[1:-1] = 1e-9 * np.random.default_rng(1).uniform(-1, 1, 24)
        with pytest.raises(ComponentError, match="diverged") if grows else nullcontext():
            instance.step(0.0, 3000 * instance["internal_step"])
        if not grows:
            assert np.abs(instance["position.y"] + 0.025).max() < 1e-7
