"""Deflections, moments and reactions of the beam at rest, against closed forms with their discretisation terms.

The beam is brought to rest by damping, so what is tested is the chain as it moves.
"""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rockshed.components.catalogue import component
from rockshed.components.common.component import ComponentError

BEAM = component("RBSMBeam")
EI = 2.1e6 * 9.80665e4 * 187e-8
SPAN, LOAD = 1.2, 1000.0


def beam(elements=25, **parameters):
    instance = BEAM.instance(elements=elements)
    for name, value in parameters.items():
        instance[name.replace("__", ".")] = value
    return instance


def come_to_rest(instance):
    """Start, and run with nearly critical damping of the first mode until nothing moves."""
    instance["damping.mass"] = 2500.0 if instance["supports"] == 1.0 else 6000.0
    instance["internal_step"] = 1e9
    instance.initialise()
    instance["internal_step"] = 0.4 * instance["stable_step"]
    instance.step(0.0, 0.03)
    assert np.abs(instance["velocity.y"]).max() < 1e-12
    return instance


def put_midspan_load(instance, load=LOAD):
    n = instance.sizes["elements"]
    for number in ((n + 1) // 2, n // 2 + 1):
        instance[f"force.y[{number}]"] -= 0.5 * load


@pytest.mark.parametrize(
    ("elements", "term"), [(5, 2 / 25), (25, 2 / 625), (6, -1 / 36), (24, -1 / 576)]
)
def test_midspan_load_on_simple_supports(elements, term):
    instance = beam(elements)
    put_midspan_load(instance)
    come_to_rest(instance)
    assert instance["midspan.deflection"] == pytest.approx(
        LOAD * SPAN**3 / (48 * EI) * (1 + term), rel=1e-8
    )
    arm = SPAN if elements % 2 else SPAN * (1 - 1 / elements)
    assert instance["midspan.moment"] == pytest.approx(LOAD * arm / 4, rel=1e-8)
    assert instance["midspan.strain"] == pytest.approx(LOAD * arm / 4 * 0.05 / EI, rel=1e-8)
    assert instance["transmitted_force"] == LOAD
    assert instance["support.force.y"] == pytest.approx([-LOAD / 2, -LOAD / 2], rel=1e-8)


@pytest.mark.parametrize(
    ("elements", "deflection_term", "moment_term"),
    [
        (5, 2 / 25 + 9 / 5 / 625, 1 / 25),
        (25, 2 / 625 + 9 / 5 / 25**4, 1 / 625),
        (6, 4 / 5 / 36, 0.0),
        (24, 4 / 5 / 576, 0.0),
    ],
)
def test_uniform_load_on_simple_supports(elements, deflection_term, moment_term):
    instance = beam(elements)
    instance["force.y"] = -LOAD / elements
    come_to_rest(instance)
    assert instance["midspan.deflection"] == pytest.approx(
        5 * LOAD * SPAN**3 / (384 * EI) * (1 + deflection_term), rel=1e-8
    )
    assert instance["midspan.moment"] == pytest.approx(
        LOAD * SPAN / 8 * (1 + moment_term), rel=1e-8
    )


@pytest.mark.parametrize("n", [5, 25])
def test_midspan_load_on_fixed_supports(n):
    # the chain integrates M2 by the trapezoidal rule, exact for the moments and off by sum(h3) f''/12 for the deflection
    instance = beam(n, supports="fixed")
    put_midspan_load(instance)
    come_to_rest(instance)
    assert instance["midspan.moment"] == pytest.approx(LOAD * SPAN / 8, rel=1e-8)
    assert instance["midspan.deflection"] == pytest.approx(
        LOAD * SPAN**3 / (192 * EI) * (1 + 8 / n**2 - 6 / n**3), rel=1e-8
    )
    assert instance["support.force.y"] == pytest.approx([-LOAD / 2, -LOAD / 2], rel=1e-8)


def test_uniform_load_on_fixed_supports_converges_with_the_square_of_the_spacing():
    errors = []
    for n in (21, 63):
        instance = beam(n, supports="fixed")
        instance["force.y"] = -LOAD / n
        come_to_rest(instance)
        assert instance["midspan.moment"] == pytest.approx(
            LOAD * SPAN / 24 * (1 + 2 / n**2), rel=1e-7
        )
        errors.append(instance["midspan.deflection"] / (LOAD * SPAN**3 / (384 * EI)) - 1)
    assert errors[0] / errors[1] == pytest.approx(9, rel=0.05)


@pytest.mark.parametrize("number", [1, 2, 7, 24])
def test_lever_rule_of_a_load_and_a_torque(number):
    place = (number - 0.5) / 24
    loaded, turned = beam(24), beam(24)
    loaded[f"force.y[{number}]"] = -LOAD
    turned[f"torque[{number}]"] = LOAD
    assert come_to_rest(loaded)["support.force.y"] == pytest.approx(
        [-LOAD * (1 - place), -LOAD * place], rel=1e-7
    )
    assert come_to_rest(turned)["support.force.y"] == pytest.approx(
        [-LOAD / SPAN, LOAD / SPAN], rel=1e-7
    )


@settings(max_examples=8)
@given(st.integers(1, 12), st.integers(1, 12), st.sampled_from(["simple", "fixed"]))
def test_angle_by_a_force_is_deflection_by_a_torque(turned_disc, loaded_disc, supports):
    """Maxwell's theorem: so the couple is the one that does the torque's work."""
    by_force, by_torque = beam(12, supports=supports), beam(12, supports=supports)
    by_force[f"force.y[{loaded_disc}]"] = LOAD
    by_torque[f"torque[{turned_disc}]"] = LOAD
    angle = come_to_rest(by_force)[f"angle[{turned_disc}]"]
    deflection = come_to_rest(by_torque)[f"position.y[{loaded_disc}]"] + 0.025
    assert deflection == pytest.approx(angle, rel=1e-7, abs=1e-10)


def test_axial_load():
    n, pull = 24, 1e4
    free, fixed = beam(n), beam(n, supports="fixed")
    for instance in (free, fixed):
        instance[f"force.x[{n}]"] = pull
        instance["damping.stiffness"] = 2e-5
        come_to_rest(instance)
        instance.step(0.03, 0.03)
    flexibility = SPAN / (2.1e6 * 9.80665e4 * 11.85e-4)
    reach = (n - 0.5) / n
    assert free[f"position.x[{n}]"] - reach * SPAN == pytest.approx(
        pull * flexibility * reach, rel=1e-8
    )
    assert fixed[f"position.x[{n}]"] - reach * SPAN == pytest.approx(
        pull * flexibility * reach * (1 - reach), rel=1e-8
    )


@pytest.mark.parametrize("n", [5, 25])
def test_energy_of_a_midspan_load_and_its_estimate_from_the_strain(n):
    instance = beam(n)
    put_midspan_load(instance)
    come_to_rest(instance)
    static = 0.5 * LOAD**2 * SPAN**3 / (48 * EI)
    assert instance["energy.strain_estimate"] == pytest.approx(static, rel=1e-8)
    assert instance["energy.bending"] == pytest.approx(static * (1 + 2 / n**2), rel=1e-8)
    assert instance["energy.axial"] == 0.0


@pytest.mark.parametrize("supports", ["simple", "fixed"])
@pytest.mark.parametrize("elements", [2, 3, 24])
def test_nothing_moves_under_the_weight(supports, elements):
    instance = beam(elements, supports=supports, gravity=9.81, deck__mass=20.0)
    instance["support.position.y[1]"], instance["support.position.y[2]"] = -1e-3, 2e-3
    instance.initialise()
    at_start = instance["position.y"].copy()
    assert np.ptp(at_start) > 1e-4
    for count in range(100):
        instance.step(count * 1e-5, 1e-5)
    assert instance["position.y"] == pytest.approx(at_start, abs=1e-15)
    assert np.abs(instance["velocity.y"]).max() < 1e-10
    weight = (7850 * 11.85e-4 + 20) * SPAN * 9.81
    assert instance["support.force.y"].sum() == pytest.approx(-weight, rel=1e-6)
    assert instance["energy.damping"] == 0.0


SHED = {
    "gravity": 9.81,
    "deck__mass": 30.0,
    "box__left": 0.13,
    "box__width": 0.37,
    "box__mass": 12.0,
    "cushion__weight": 900.0,
}


@pytest.mark.parametrize("supports", ["simple", "fixed"])
@pytest.mark.parametrize("elements", [2, 5, 24])
def test_nothing_moves_under_a_cushion_whose_weight_the_inputs_go_on_with(elements, supports):
    """A box that stands on one side, from within a disc to within another."""
    instance = beam(elements, supports=supports, **SHED)
    instance["support.position.y[1]"], instance["support.position.y[2]"] = -1e-3, 2e-3
    edges = np.clip(np.arange(elements + 1) * SPAN / elements, 0.13, 0.5)
    instance["force.y"] = -900.0 * np.diff(edges) / 0.37
    instance.initialise()
    at_start = instance["position.y"].copy()
    assert np.ptp(at_start) > 1e-4
    for count in range(100):
        instance.step(count * 1e-5, 1e-5)
    assert instance["position.y"] == pytest.approx(at_start, abs=1e-14)
    assert np.abs(instance["velocity.y"]).max() < 1e-9
    whole = (7850 * 11.85e-4 + 30) * SPAN * 9.81 + 12 * 9.81 + 900
    assert instance["support.force.y"].sum() == pytest.approx(-whole, rel=1e-6)
    assert instance["energy.strain_estimate"] < 1e-12


def test_without_the_inputs_the_beam_springs_up_from_under_the_cushion():
    """At the start it stores the work of the weight, of which nothing gets lost; the strain of the start counts as none."""
    instance = beam(24, box__left=0.0, box__width=SPAN, cushion__weight=LOAD)
    instance.initialise()
    assert instance["midspan.deflection"] == pytest.approx(
        5 * LOAD * SPAN**3 / (384 * EI) * (1 + 4 / 5 / 576), rel=1e-9
    )
    assert instance["midspan.start_strain"] == pytest.approx(LOAD * SPAN / 8 * 0.05 / EI, rel=1e-9)
    assert instance["energy.strain_estimate"] == 0.0
    stored, strain, lowest = instance["energy.start"], instance["midspan.start_strain"], 0.0
    assert stored == pytest.approx(LOAD**2 * SPAN**3 / (240 * EI), rel=1e-2)
    for count in range(500):
        instance.step(count * 1e-5, 1e-5)
        assert instance["energy.kinetic"] + instance["energy.elastic"] == pytest.approx(
            stored, rel=1e-2
        )
        lowest = min(lowest, instance["midspan.strain"])
        deflection = SPAN**2 * (instance["midspan.strain"] - strain) / (6 * 0.1)
        assert instance["energy.strain_estimate"] == pytest.approx(
            24 * EI / SPAN**3 * deflection**2, rel=1e-9, abs=1e-12
        )
    assert lowest == pytest.approx(-strain, rel=0.05)


def test_a_box_on_one_half_by_the_lever_rule():
    instance = beam(
        24,
        gravity=10.0,
        density=1e-3,
        box__left=0.0,
        box__width=SPAN / 2,
        box__mass=40.0,
        cushion__weight=400.0,
    )
    instance.initialise()
    assert instance["support.force.y"] == pytest.approx([-600.0, -200.0], rel=1e-6)
    assert instance["midspan.moment"] == pytest.approx(200.0 * SPAN / 2, rel=1e-3)


@pytest.mark.parametrize(("left", "width"), [(-0.01, 0.3), (1.0, 0.3), (0.0, 1.3)])
def test_a_box_beside_the_beam_is_refused(left, width):
    for loaded in ({"box__mass": 1.0}, {"cushion__weight": 1.0}):
        with pytest.raises(ComponentError, match=r"box\.left.*span.*1\.2 m"):
            beam(box__left=left, box__width=width, **loaded).initialise()
    beam(box__left=left, box__width=width).initialise()


def test_deflection_under_the_weight():
    instance = beam(25, gravity=9.81)
    instance.initialise()
    weight = 7850 * 11.85e-4 * SPAN * 9.81
    expected = 5 * weight * SPAN**3 / (384 * EI) * (1 + 2 / 25**2 + 9 / 5 / 25**4)
    assert instance["midspan.deflection"] == pytest.approx(expected, rel=1e-10)
    assert instance["energy.gravity"] == pytest.approx(-2 * instance["energy.bending"], rel=1e-9)


def test_fixed_beam_with_one_support_raised():
    """12 EI/L3 and 6 EI/L2, the forces of a settled support, with the hinges' discretisation of 1/N2."""
    errors = []
    for n in (12, 36):
        instance = beam(n, supports="fixed")
        instance["support.position.y[2]"] = 1e-3
        instance.initialise()
        assert instance["support.force.y[1]"] == pytest.approx(
            -instance["support.force.y[2]"], rel=1e-7
        )
        errors.append(instance["support.force.y[1]"] / (12 * EI * 1e-3 / SPAN**3) - 1)
    assert abs(errors[1]) < 1e-2
    assert errors[0] / errors[1] == pytest.approx(9, rel=0.1)


def test_the_moment_at_the_wall_of_a_uniform_load_is_hogging_and_converges_to_a_twelfth():
    """-q L2/12 by the books; the chain is off by the order of 1/N2, and simple supports have none."""
    errors = []
    for n in (21, 63):
        instance = beam(n, supports="fixed")
        instance["force.y"] = -LOAD / n
        come_to_rest(instance)
        left, right = instance["support.moment"]
        assert left == pytest.approx(right, rel=1e-7)
        errors.append(left / (-LOAD * SPAN / 12) - 1)
    assert abs(errors[1]) < 1e-2
    assert errors[0] / errors[1] == pytest.approx(9, rel=0.1)
    free = beam(24)
    free["force.y"] = -LOAD / 24
    assert list(come_to_rest(free)["support.moment"]) == [0.0, 0.0]
