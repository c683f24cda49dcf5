"""The beam as a component: buffers, start, refusals, steps that are divided, states that are restored."""

import math

import numpy as np
import pytest

from rockshed.components.catalogue import component
from rockshed.components.common.component import ComponentError
from rockshed.components.rbsm_beam import kernel

BEAM = component("RBSMBeam")


def beam(**sizes):
    instance = BEAM.instance(**sizes)
    instance.initialise()
    return instance


def push(instance, seed=0):
    rng = np.random.default_rng(seed)
    for name in ("force.x", "force.y", "torque"):
        instance[name] = rng.uniform(-500, 500, instance.sizes["elements"])
    instance["support.velocity.y"] = rng.uniform(-0.1, 0.1, 2)
    return instance


def test_places_at_the_start():
    instance = beam(elements=24)
    assert instance["position.x[1]"] == pytest.approx(0.025)
    assert np.diff(instance["position.x"]) == pytest.approx(np.full(23, 0.05))
    assert instance["position.x[24]"] == pytest.approx(1.175)
    assert instance["radius"] == pytest.approx(0.025)
    assert instance["position.y"] + instance["radius"] == pytest.approx(np.zeros(24), abs=1e-15)
    assert not instance["velocity.y"].any()
    assert not instance["angle"].any()


def test_forces_at_the_start_do_not_move_the_beam():
    instance = BEAM.instance(elements=4)
    instance["force.y"] = [-1.0, -2.0, -3.0, -4.0]
    instance.initialise()
    assert np.array_equal(instance["position.y"], np.full(4, -0.025))
    assert instance["transmitted_force"] == 10.0


def test_start_again_after_an_input_was_set_is_a_start():
    instance, other = BEAM.instance(elements=5), BEAM.instance(elements=5)
    for one in (instance, other):
        one["gravity"] = 9.81
    instance.initialise()
    instance["support.position.y"] = other["support.position.y"] = [0.001, 0.002]
    instance.evaluate()
    other.initialise()
    assert np.array_equal(instance.w, other.w)


@pytest.mark.parametrize("calls", [1, 2, 5, 10])
def test_internal_steps_are_the_same_however_they_are_called(calls):
    whole, parts = push(beam()), push(beam())
    whole["support.velocity.y"] = parts["support.velocity.y"] = [0.0, 0.0]
    for count in range(100):
        whole.step(count * 1e-5, 1e-5)
        for _ in range(calls):
            kernel.advance(10 // calls, 1e-6, parts.w, parts.x, parts.k)
        kernel.publish(parts.w, parts.x, parts.k)
    for name in (
        "position.x",
        "position.y",
        "angle",
        "velocity.x",
        "velocity.y",
        "angular_velocity",
        "support.force.y",
    ):
        assert np.array_equal(whole[name], parts[name])
    assert parts["energy.work.contact"] == pytest.approx(whole["energy.work.contact"], rel=1e-9)


def test_step_that_is_no_multiple_is_divided_into_equal_parts():
    coarse, fine = push(beam()), push(beam())
    coarse["internal_step"], fine["internal_step"] = 1e-6, 2.5e-6 / 3
    coarse.step(0.0, 2.5e-6)
    fine.step(0.0, 2.5e-6)
    assert np.array_equal(coarse.x, fine.x)


def test_state_goes_to_another_instance_bit_for_bit():
    original, copy = push(beam()), BEAM.instance()
    original.step(0.0, 1e-4)
    copy.from_bytes(original.to_bytes())
    for instance in (original, copy):
        push(instance, seed=2).step(1e-4, 1e-4)
    assert original.to_bytes() == copy.to_bytes()


def test_bad_parameters_are_all_named():
    instance = BEAM.instance(elements=3)
    instance["span"], instance["density"], instance["gravity"], instance["supports"] = (
        -1.0,
        math.nan,
        -9.8,
        4.0,
    )
    with pytest.raises(ComponentError) as error:
        instance.initialise()
    for name in ("span", "density", "gravity", "supports"):
        assert any(problem.startswith(f"{name} = ") for problem in error.value.problems)


@pytest.mark.parametrize(
    "sizes", [{"elements": 1}, {"elements": 2001}, {"support_count": 1}, {"discs": 4}]
)
def test_sizes_out_of_range(sizes):
    with pytest.raises(ComponentError, match="RBSMBeam"):
        BEAM.instance(**sizes)


@pytest.mark.parametrize("force", [math.nan, math.inf, -1e12])
def test_loads_beyond_sense_stop_the_beam(force):
    instance = beam()
    instance["force.y[3]"] = force
    with pytest.raises(
        ComponentError,
        match=r"at t = 0\.25 s the beam diverged.*1\.2 m.*internal_step is 1e-06 s.*6\.14346e-06 s",
    ):
        instance.step(0.25, 1e-3)


def test_every_output_is_published():
    """No output keeps the zero of an empty buffer once beam, supports and damping are at work."""
    instance = BEAM.instance()
    instance["gravity"], instance["damping.mass"] = 9.81, 10.0
    instance.initialise()
    push(instance)["support.position.y"] = [1e-4, -2e-4]
    instance.step(0.0, 1e-4)
    silent = [name for name, index in instance.references.items() if instance.w[index] == 0.0]
    ends = ["support.element[1]", "support.element[2]"]
    free_ends = ["support.moment[1]", "support.moment[2]"]  # on simple supports
    unset = ["axis.x", "deck.mass", "box.mass", "cushion.weight", "damping.stiffness"]
    unset += [name for name in silent if name.startswith(("section.corner", "section.hardening"))]
    yielding = ["energy.plastic", "midspan.residual_deflection", "curvature_ratio"]
    yielding += [name for name in silent if "plastic_" in name]
    springs = ["support.stiffness", "energy.support"]
    springs += [f"support.settlement[{i}]" for i in (1, 2)]
    assert sorted(silent) == sorted(
        unset + ends + free_ends + yielding + springs + ["box.inertia_force"]  # no box
    )


YIELDING = {
    "section.bending": "yielding",
    "section.corner1.moment": 100.0,
    "section.corner2.moment": 150.0,
    "section.corner2.curvature": 1e-3,
    "section.hardening_ratio": 0.05,
    "supports": "fixed",
    "damping.stiffness": 1e-7,
}


def yielding(**values):
    instance = BEAM.instance()
    for name, value in {**YIELDING, **values}.items():
        instance[name] = value
    instance.initialise()
    return instance


def test_a_yielding_beam_publishes_what_is_plastic():
    instance = push(yielding())
    instance["force.y"] = -3e4
    instance.step(0.0, 1e-3)
    for name in ("energy.plastic", "midspan.residual_deflection", "curvature_ratio"):
        assert instance[name] > 0.0
    assert instance["plastic_curvature"].max() > 0.0
    assert instance["support.plastic_rotation"].max() < 0.0
    elastic = instance["midspan.moment"] * 0.05 / (2.1e6 * 9.80665e4 * 187e-8)
    assert instance["midspan.strain"] > 1.01 * elastic


@pytest.mark.parametrize("calls", [1, 2, 10])
def test_internal_steps_of_a_yielding_beam_are_the_same_however_they_are_called(calls):
    whole, parts = push(yielding()), push(yielding())
    whole["support.velocity.y"] = parts["support.velocity.y"] = [0.0, 0.0]
    for count in range(100):
        whole.step(count * 1e-5, 1e-5)
        for _ in range(calls):
            kernel.advance(10 // calls, 1e-6, parts.w, parts.x, parts.k)
            kernel.publish(parts.w, parts.x, parts.k)
    assert whole["energy.plastic"] > 0.0
    for name in ("position.y", "velocity.y", "moment", "plastic_curvature", "support.force.y"):
        assert np.array_equal(whole[name], parts[name])
    assert parts["energy.plastic"] == pytest.approx(whole["energy.plastic"], rel=1e-12)


def test_a_yielding_beam_goes_on_from_its_state_to_the_bit():
    one = push(yielding())
    one.step(0.0, 5e-4)
    other = yielding()
    other.from_bytes(one.to_bytes())
    for instance in (one, other):
        instance["force.y"] = 2e4
        instance.step(5e-4, 5e-4)
    assert one["energy.plastic"] > 0.0
    assert one.to_bytes() == other.to_bytes()


@pytest.mark.parametrize(
    "corners",
    [
        {"section.corner1.moment": 0.0},
        {"section.corner2.moment": 90.0},
        {"section.corner2.moment": 0.0},
        {"section.corner2.curvature": 0.0},
        {"section.corner2.curvature": 1e-5},
        {"section.corner3.moment": 400.0, "section.corner3.curvature": 1.1e-3},
        {"section.corner3.moment": 160.0},
        {"section.hardening_ratio": 0.9},
        {"section.corner1.hogging_moment": 80.0},
        {"section.corner1.hogging_moment": 80.0, "section.corner2.hogging_moment": 70.0},
    ],
)
def test_corners_that_make_no_moment_curvature_line_are_refused(corners):
    with pytest.raises(ComponentError, match=r"moment-curvature line.*section\.corner1\.moment"):
        yielding(**corners)


def test_a_section_with_an_elastic_slope_past_its_corners_is_elastic():
    stiff = {"section.corner2.moment": 0.0, "section.corner2.curvature": 0.0}
    one = push(yielding(**stiff, **{"section.hardening_ratio": 1.0}))
    other = push(yielding(**{"section.bending": "elastic"}))
    for instance in (one, other):
        instance.step(0.0, 1e-3)
    assert one["energy.plastic"] == 0.0
    for name in ("position.y", "velocity.y", "moment", "support.force.y", "energy.damping"):
        assert one[name] == pytest.approx(other[name], rel=1e-12)
