"""Beams whose ends stand on springs: rest, static loads, swings, lift-off and energy against closed forms."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rockshed.components.catalogue import component
from rockshed.components.common.component import ComponentError

BEAM = component("RBSMBeam")
N, SPAN, GRAVITY = 25, 1.2, 9.80665
EI = 2.1e6 * 9.80665e4 * 187e-8
MASS = 7850 * 11.85e-4 * SPAN
WEIGHT = MASS * GRAVITY
HINGED = 48 * EI / SPAN**3
"""Stiffness of the beam on hinges against a load at midspan (N/m)."""


def beam(stiffness, elements=N, supports="elastic", **parameters):
    made = BEAM.instance(elements=elements)
    made["supports"] = ("simple", "fixed", "elastic").index(supports) + 1
    made["support.stiffness"] = stiffness
    for name, value in parameters.items():
        made[name.replace("__", ".")] = value
    made["internal_step"] = 1e9
    made.initialise()
    made["internal_step"] = 0.4 * made["stable_step"]
    return made


def run(made, until, exchange=1e-4):
    found = []
    for i in range(round(until / exchange)):
        made.step(i * exchange, exchange)
        found.append((made["midspan.deflection"], *made["support.force.y"]))
    return np.array(found).T


@pytest.mark.parametrize("stiffness", [1e4, 1e7, 1e11])
def test_at_rest_each_spring_bears_half_of_the_weight_and_gives_by_it(stiffness):
    made = beam(stiffness, gravity=GRAVITY)
    rigid = beam(0.0, supports="simple", gravity=GRAVITY)
    sunk = WEIGHT / 2 / stiffness
    assert made["support.force.y"] == pytest.approx([-WEIGHT / 2] * 2, rel=1e-9)
    assert made["support.settlement"] == pytest.approx([sunk] * 2, rel=1e-9)
    assert made["midspan.deflection"] == pytest.approx(rigid["midspan.deflection"] + sunk, rel=1e-9)
    assert made["moment"] == pytest.approx(rigid["moment"], rel=1e-6)
    assert made["energy.support"] == pytest.approx(WEIGHT**2 / 4 / stiffness, rel=1e-9)
    before = made["midspan.deflection"]
    deflections, *_ = run(made, 0.01)
    assert np.abs(deflections - before).max() < 1e-9 * before


def test_on_uneven_weights_each_end_gives_by_what_it_bears():
    made = beam(1e6, cushion__weight=1e3, box__left=0.0, box__width=0.288)
    assert made["support.force.y"] == pytest.approx([-880.0, -120.0], rel=1e-9)
    assert made["support.settlement"] == pytest.approx([880e-6, 120e-6], rel=1e-9)


@pytest.mark.parametrize("share", [0.1, 1.0, 10.0])
def test_a_load_at_midspan_deflects_it_by_that_of_the_hinged_beam_and_of_the_springs(share):
    """P / (48 EI/L3) (1 + 2/N2) + P / 2 k, where the swing has died out."""
    stiffness, load = share * HINGED, 1e3
    slowest = math.sqrt(1 / (1 / HINGED + 1 / (2 * stiffness)) / MASS)
    made = beam(stiffness, damping__mass=2 * slowest)
    made["force.y"][N // 2] = -load
    deflections, left, right = run(made, 20 / slowest)
    expected = load / HINGED * (1 + 2 / N**2) + load / (2 * stiffness)
    assert deflections[-1] == pytest.approx(expected, rel=1e-4)
    assert (left[-1], right[-1]) == pytest.approx((-load / 2, -load / 2), rel=1e-4)
    assert made["support.settlement"] == pytest.approx([load / 2 / stiffness] * 2, rel=1e-4)


def test_on_soft_springs_the_beam_bounces_as_a_body_of_its_mass():
    """2 pi sqrt(m / 2 k), m with the two ends, each half a disc's mass."""
    stiffness = HINGED / 1e4
    period = 2 * math.pi * math.sqrt(MASS * (1 + 1 / N) / (2 * stiffness))
    made = beam(stiffness)
    made["force.y"] = np.full(N, -100.0 / N)
    exchange = period / 400
    deflections, *_ = run(made, 0.75 * period, exchange)
    assert np.argmax(deflections) * exchange == pytest.approx(period / 2, rel=0.01)
    assert deflections.max() == pytest.approx(100.0 / stiffness, rel=1e-3)


@pytest.mark.parametrize(("stiffness", "nearness"), [(1e2, 0.05), (1e4, 2e-3)])
def test_on_stiffer_springs_a_blow_bends_it_ever_more_as_on_hinges(stiffness, nearness):
    """Pressed down by its load: unloaded ends leave their springs, as the blow first lifts them."""
    sand, found = 5e4, []
    loaded = {"cushion__weight": sand, "box__left": 0.0, "box__width": SPAN}
    for made in (beam(stiffness * HINGED, **loaded), beam(0.0, supports="simple", **loaded)):
        rest = made["midspan.deflection"]
        made["force.y"] = np.full(N, -sand / N)
        made["force.y"][N // 2] -= 1e4
        found.append(run(made, 0.01)[0] - rest)
    assert found[0] == pytest.approx(found[1], abs=nearness * found[1].max())


@settings(max_examples=40)
@given(
    st.floats(1e-3, 1e3),
    st.lists(
        st.lists(st.floats(-1e4, 1e4), min_size=2 * N, max_size=2 * N), min_size=1, max_size=3
    ),
    st.lists(st.floats(-0.5, 0.5), min_size=2, max_size=2),
    st.booleans(),
    st.sampled_from([0.0, 5e-6]),
)
def test_springs_only_push_and_no_energy_is_made(share, loads, speeds, yields, viscosity):
    """Moving supports, torques, yielding and lift-off included; momentum to rounding."""
    line = {"section__bending": 2, "section__corner1__moment": 2e3} if yields else {}
    made = beam(share * HINGED, gravity=GRAVITY, damping__stiffness=viscosity, **line)
    made["internal_step"] = 0.02 * made["stable_step"]
    made["support.velocity.y"] = speeds
    exchange, stored = 2e-4, [made["energy.elastic"]]
    for i, load in enumerate(loads):
        made["force.y"] = load[:N]
        made["torque"] = 0.01 * np.array(load[N:])
        made.step(i * exchange, exchange)
        made["support.position.y"] += exchange * made["support.velocity.y"]
        stored.append(made["energy.kinetic"] + made["energy.elastic"] + made["energy.support"])
        assert (made["support.force.y"] <= 0.0).all()
        assert (made["support.mean_force.y"] <= 0.0).all()
        assert (made["support.settlement"] >= 0.0).all()
    assert abs(made["energy.residual"]) < 5e-3 * (max(stored) + 1.0)


def test_a_beam_that_is_pulled_up_leaves_its_springs_and_falls_back():
    made = beam(1e6, gravity=GRAVITY)
    made["force.y"] = np.full(N, 3 * WEIGHT / N)
    _, left, _ = run(made, 0.01)
    assert left[-1] == 0.0
    assert made["position.y"][0] > -0.024
    made["force.y"] = np.zeros(N)
    _, left, _ = run(made, 0.2)
    assert left.min() < -WEIGHT
    assert abs(made["energy.residual"]) < 5e-3 * made["energy.work.contact"]


@pytest.mark.parametrize(("supports", "stiffness"), [("elastic", 0.0), ("simple", 1e6)])
def test_a_stiffness_without_elastic_supports_is_refused_and_so_is_the_reverse(supports, stiffness):
    with pytest.raises(ComponentError, match="belong together"):
        beam(stiffness, supports=supports)
