"""A beam that yields: collapse loads, loops, residual deflections after an impulse, starts under weights.

Against closed forms of plastic theory; and what holds for all inputs: energy closes, plastic work never falls.
"""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rockshed.components.catalogue import component
from rockshed.components.common.component import ComponentError
from rockshed.components.rbsm_beam import chain, yielding

BEAM = component("RBSMBeam")
SPAN, SECOND_MOMENT = 1.2, 187e-8
MODULUS = 2.1e6 * 9.80665e4
EI = MODULUS * SECOND_MOMENT
MASS_PER_LENGTH = 7850 * 11.85e-4
CAPACITY = 8000.0
"""Plastic moment (N m)."""


def beam(elements=25, step=0.4, inner=(), **parameters):
    """An elastic-perfectly plastic beam, if no other corners are given, at ``step`` of its stable step."""
    made = BEAM.instance(elements=elements, support_count=2 + len(inner))
    made["section.bending"], made["section.corner1.moment"] = "yielding", CAPACITY
    made["support.element"] = [0, 0, *inner]
    for name, value in parameters.items():
        made[name.replace("__", ".")] = value
    made["internal_step"] = 1e9
    made.initialise()
    made["internal_step"] = step * made["stable_step"]
    return made


TRILINEAR = {
    "section__corner1__moment": 0.5 * CAPACITY,
    "section__corner2__moment": 0.9 * CAPACITY,
    "section__corner2__curvature": 1.5 * CAPACITY / EI,
    "section__corner3__moment": CAPACITY,
    "section__corner3__curvature": 4.0 * CAPACITY / EI,
    "section__hardening_ratio": 0.01,
}


def on_the_line(curvature):
    """Moment (N m) of the three corners at a curvature on first loading."""
    curvatures = np.array([0.0, 0.5, 1.5, 4.0, 104.0]) * CAPACITY / EI
    moments = np.array([0.0, 0.5, 0.9, 1.0, 2.0]) * CAPACITY
    return np.sign(curvature) * np.interp(abs(curvature), curvatures, moments)


# ------------------------------------------------------------------ static collapse


def under(load, made, ramp=0.1, hold=0.1):
    """Raise a load (N, downwards, by disc) slowly and hold it; the speed in the end (m/s)."""
    for n in range(50):
        made["force.y"] = -load * (n + 1) / 50
        made.step(n * ramp / 50, ramp / 50)
    made.step(ramp, hold)
    return np.abs(made["velocity.y"]).max()


def point(elements):
    load = np.zeros(elements)
    load[elements // 2] = 1.0
    return load


def spread(elements):
    return np.full(elements, 1.0 / elements)


@pytest.mark.parametrize(
    ("ends", "shape", "elements", "load"),
    [
        ("simple", point, 25, 4.0),  # Mp/L
        ("simple", spread, 24, 8.0),
        ("fixed", point, 25, 8.0),
        ("fixed", spread, 24, 16.0),
    ],
)
def test_a_beam_rests_below_its_static_collapse_load_and_runs_away_above_it(
    ends, shape, elements, load
):
    collapse = load * CAPACITY / SPAN * shape(elements)
    speeds = [
        under(factor * collapse, beam(elements, supports=ends, damping__mass=3000.0))
        for factor in (0.997, 1.003)
    ]
    assert speeds[0] < 1e-4
    assert speeds[1] > 1e-3


def test_what_slips_does_not_damp():
    """A hinge past its corner: no dashpot while it bends on, the elastic one when it turns back."""
    made = beam(**{"damping__stiffness": 1e-6})
    c = chain.chain(made.w, made.k)
    places = (np.arange(-1, 26) + 0.5) / 25
    made.state("v")[:] = -np.sin(math.pi * places) * 3.0 * CAPACITY / EI * SPAN**2 / math.pi**2
    moments = []
    for speed in (-5.0, 5.0):
        made.state("v_rate")[:] = speed * np.sin(math.pi * places)
        chain.follow(c, made.w, made.x, made.k)
        power = chain.dissipation(c, made.w, made.x, made.k)
        assert power >= 0.0
        chain.deform(c, 1.0, 1e-6, made.w, made.x, made.k)
        moments.append(made.state("hinge_moment")[13])
    assert moments[0] == pytest.approx(CAPACITY, rel=1e-12)
    rate = EI * 5.0 * math.pi**2 / SPAN**2
    assert moments[1] == pytest.approx(CAPACITY - 1e-6 * rate, rel=1e-3)
    assert 1e-6 * rate > 0.001 * CAPACITY


# ------------------------------------------------------------------ one section


def section(**corners):
    """A beam of which the middle hinge is bent by hand, and that hinge's length over EI (1/(N))."""
    made = beam(5, **corners)
    length = SPAN / 5
    return made, length


def bend(made, curvature):
    """Bend the middle hinge; its moment (N m)."""
    elastic = made.state("elastic_moment")
    elastic[:] = 0.0
    elastic[3] = EI * curvature
    yielding.slip(chain.chain(made.w, made.k), made.w, made.x, made.k)
    return elastic[3] - made.state("offset")[3]


def test_a_section_follows_its_corners_on_first_loading():
    for sign in (1.0, -1.0):
        made, _ = section(**TRILINEAR)
        for curvature in sign * np.linspace(0.0, 6.0, 61) * CAPACITY / EI:
            assert bend(made, curvature) == pytest.approx(on_the_line(curvature), abs=1e-9)


def test_a_loop_is_the_doubled_line_and_its_area_is_the_plastic_work():
    """Masing's rule; each slider turns a parallelogram of 4 times its moment and its way."""
    made, length = section(**TRILINEAR)
    largest = 5.0 * CAPACITY / EI
    bend(made, largest)
    bend(made, -largest)
    bend(made, largest)
    before = made["energy.plastic"]
    top, area, last = on_the_line(largest), 0.0, (largest, on_the_line(largest))
    for share in np.linspace(1.0, -1.0, 2001):
        moment = bend(made, share * largest)
        turned = top - 2.0 * on_the_line(0.5 * (1.0 - share) * largest)
        assert moment == pytest.approx(turned, abs=1e-9)
        area += 0.5 * (moment + last[1]) * (share * largest - last[0])
        last = (share * largest, moment)
    bend(made, largest)
    loop = made["energy.plastic"] - before
    limits = np.array([0.5, 1.5, 4.0]) * CAPACITY
    shares = np.array([1.0 - 0.4, 0.4 - 0.04, 0.04 - 0.01])
    closed = 4.0 * (shares * limits * (EI * largest - limits)).sum() / EI * length
    assert loop == pytest.approx(closed, rel=1e-12)
    assert 2.0 * area * length == pytest.approx(loop, rel=1e-5)


@settings(max_examples=20)
@given(st.lists(st.floats(-8.0, 8.0), min_size=1, max_size=8), st.booleans())
def test_of_the_work_on_a_section_nothing_is_lost_and_plastic_work_never_falls(turns, several):
    made, length = section(**(TRILINEAR if several else {}))
    c = chain.chain(made.w, made.k)
    work, moment, place = 0.0, 0.0, 0.0
    for turn in turns:
        for curvature in np.linspace(place, turn, 80) * CAPACITY / EI:
            plastic, before = made["energy.plastic"], place
            now = bend(made, curvature)
            work += 0.5 * (moment + now) * (curvature - before * CAPACITY / EI) * length
            moment, place = now, curvature * EI / CAPACITY
            assert made["energy.plastic"] >= plastic
    stored = yielding.locked_and_elastic_energy(c, made.x, made.k)
    scale = CAPACITY**2 / EI * length * (1.0 + np.abs(np.diff([0.0, *turns])).sum())
    assert stored + made["energy.plastic"] == pytest.approx(work, abs=2e-3 * scale)


CRACKING = {
    **TRILINEAR,
    "section__corner1__kind": "cracking",
    "section__corner1__hogging_moment": 0.5 * CAPACITY,
    "section__corner2__hogging_moment": 0.62 * CAPACITY,
    "section__corner3__hogging_moment": 0.64 * CAPACITY,
}
"""A strip that cracks at half of its capacity, with fewer bars above than below."""


def test_cracked_concrete_unloads_to_the_origin_until_its_bars_yield():
    made, _ = section(**CRACKING)
    for largest in (0.9, 1.4):  # bars yield at 1.5
        top = bend(made, largest * CAPACITY / EI)
        assert top == pytest.approx(on_the_line(largest * CAPACITY / EI))
        made["energy.plastic"] = 0.0
        for share in (0.7, 0.3, 0.0, 0.9):
            now = bend(made, share * largest * CAPACITY / EI)
            assert now == pytest.approx(share * top, abs=1e-9)
        assert made["energy.plastic"] == 0.0
        assert yielding.permanent(chain.chain(made.w, made.k), 3, made.x, made.k) == 0.0


def test_hogging_has_moments_of_its_own_and_cracks_apart_from_sagging():
    made, _ = section(**CRACKING)
    bend(made, 1.4 * CAPACITY / EI)  # cracked below
    assert bend(made, -0.4 * CAPACITY / EI) == pytest.approx(-0.4 * CAPACITY)
    for curvature, moment in ((0.8, 0.62), (1.3, 0.64)):  # slopes 0.4 and 0.04, as below
        assert bend(made, -curvature * CAPACITY / EI) == pytest.approx(-moment * CAPACITY)
    made, _ = section(**CRACKING)
    bend(made, 3.0 * CAPACITY / EI)
    stays = yielding.permanent(chain.chain(made.w, made.k), 3, made.x, made.k)
    assert 0.0 < stays < 1.5 * CAPACITY
    assert bend(made, stays / EI) == pytest.approx(0.0, abs=1e-9)


@settings(max_examples=20)
@given(st.lists(st.floats(-8.0, 8.0), min_size=1, max_size=8))
def test_of_the_work_on_a_cracking_section_nothing_is_lost(turns):
    made, length = section(**CRACKING)
    c = chain.chain(made.w, made.k)
    work, moment, place = 0.0, 0.0, 0.0
    for turn in turns:
        for curvature in np.linspace(place, turn, 80):
            lost = made["energy.plastic"]
            now = bend(made, curvature * CAPACITY / EI)
            work += 0.5 * (moment + now) * (curvature - place) * CAPACITY / EI * length
            moment, place = now, curvature
            assert made["energy.plastic"] >= lost
    stored = yielding.locked_and_elastic_energy(c, made.x, made.k)
    scale = CAPACITY**2 / EI * length * (1.0 + np.abs(np.diff([0.0, *turns])).sum())
    assert stored + made["energy.plastic"] == pytest.approx(work, abs=2e-3 * scale)


def test_a_strip_that_only_cracked_comes_back_to_where_it_was():
    made = beam(25, damping__mass=2500.0, **CRACKING)
    under(8.0 * CAPACITY / SPAN * 0.8 * spread(25), made)
    cracked = made["midspan.deflection"]
    assert made["energy.plastic"] > 0.0
    under(0.0 * spread(25), made)
    assert made["midspan.residual_deflection"] == 0.0
    assert abs(made["midspan.deflection"]) < 1e-3 * cracked


def test_fixed_ends_without_bars_above_bear_what_cracks_them_and_no_more():
    weak = {f"section__corner{n}__hogging_moment": 0.2 * CAPACITY for n in (1, 2, 3)}
    weak["section__corner_hogging_curvature"] = 0.2 * CAPACITY / EI
    weak["section__hardening_ratio"] = 0.0
    made = beam(25, supports="fixed", damping__mass=3000.0, **{**CRACKING, **weak})
    load = 8.0 * CAPACITY / SPAN * 0.8
    under(load * spread(25), made, ramp=0.2, hold=0.2)
    assert made["support.moment"] == pytest.approx([-0.2 * CAPACITY] * 2, rel=0.1)
    assert made["midspan.moment"] == pytest.approx((0.8 - 0.2) * CAPACITY, rel=0.05)
    assert made["curvature_ratio"] > 1.0


# ------------------------------------------------------------------ impulses


def struck(ratio, elements, shape, step=0.1, stiffer=1.0, **parameters):
    """Give the discs speeds of a shape whose energy is ``ratio`` times the largest elastic one.

    Returns the beam after it has come to swing elastically, and its energy at the start (J).
    """
    made = beam(elements, step, elastic_modulus=stiffer * MODULUS, **parameters)
    energy = ratio * CAPACITY**2 * SPAN / (2.0 * EI * stiffer)
    disc = MASS_PER_LENGTH * SPAN / elements
    speed = math.sqrt(2.0 * energy / (disc * (shape**2).sum()))
    made.state("v_rate")[1:-1] = -speed * shape
    ends = MASS_PER_LENGTH * speed * SPAN**2 / (8.0 * CAPACITY)
    period = 2.0 * SPAN**2 / math.pi * math.sqrt(MASS_PER_LENGTH / (EI * stiffer))
    for n in range(20):
        made.step(n * (ends + period) / 20, (ends + period) / 20)
        # the energy at the start was 0 to the beam: the speeds came afterwards
        assert made["energy.residual"] == pytest.approx(energy, rel=1e-3)
    return made, energy


def triangle(elements):
    places = (np.arange(elements) + 0.5) / elements
    return 1.0 - np.abs(2.0 * places - 1.0)


@pytest.mark.parametrize(
    ("ratio", "elements", "stiffer"), [(10, 25, 1), (30, 25, 1), (30, 51, 1), (100, 25, 1)]
)
def test_after_an_impulse_in_the_shape_of_the_collapse_the_rigid_plastic_deflection_stays(
    ratio, elements, stiffer
):
    """Martin's bound, energy over collapse load, is the rigid-plastic solution; what swings is missing: up to 2/ratio."""
    made, energy = struck(ratio, elements, triangle(elements), stiffer=stiffer)
    closed = energy * SPAN / (4.0 * CAPACITY)
    residual = made["midspan.residual_deflection"]
    assert (1.0 - 2.0 / ratio) * closed < residual < closed
    assert made["energy.plastic"] > (1.0 - 1.0 / ratio) * energy


@pytest.mark.parametrize(("ratio", "stiffer"), [(10, 1.0), (100, 1.0), (1000, 10.0)])
def test_after_an_even_impulse_the_deflection_comes_near_that_of_travelling_hinges(ratio, stiffer):
    """m v2 L2 / 12 Mp (Symonds), which is 2/3 of Martin's bound; the elastic beam adds up to 1.5/sqrt(ratio)."""
    made, energy = struck(ratio, 25, np.ones(25), stiffer=stiffer)
    closed = energy * SPAN / (6.0 * CAPACITY)
    residual = made["midspan.residual_deflection"]
    assert closed < residual < (1.0 + 1.5 / math.sqrt(ratio)) * closed
    assert residual < 1.5 * closed


def test_the_deflection_after_an_impulse_converges_with_the_elements():
    found = [
        struck(30, elements, np.ones(elements))[0]["midspan.residual_deflection"]
        for elements in (13, 25, 51)
    ]
    assert abs(found[1] - found[2]) < 0.5 * abs(found[0] - found[2])
    assert found[1] == pytest.approx(found[2], rel=0.01)


@pytest.mark.parametrize("ends", ["simple", "fixed"])
def test_plastic_work_bounds_the_residual_deflection(ends):
    """It is no more than plastic work over collapse load, exactly: the elastic moments of that load are allowed."""
    made, _ = struck(30, 25, np.linspace(0.2, 1.0, 25), supports=ends)
    collapse = (4.0 if ends == "simple" else 8.0) * CAPACITY / SPAN
    assert 0.0 < made["midspan.residual_deflection"] <= made["energy.plastic"] / collapse


def test_stiffness_damping_takes_little_from_the_plastic_work():
    """2 % of critical in the first mode: dashpots on all springs of the discs would take most of it."""
    damping = 0.04 / (math.pi**2 / SPAN**2 * math.sqrt(EI / MASS_PER_LENGTH))
    free, energy = struck(30, 25, triangle(25))
    damped, _ = struck(30, 25, triangle(25), damping__stiffness=damping)
    assert damped["energy.damping"] < 0.05 * energy
    assert damped["midspan.residual_deflection"] == pytest.approx(
        free["midspan.residual_deflection"], rel=0.05
    )


# ------------------------------------------------------------------ residual deflection, rest


@pytest.mark.parametrize(
    ("ends", "inner"), [("simple", ()), ("fixed", ()), ("simple", (9,)), ("fixed", (18,))]
)
def test_the_residual_deflection_is_what_stays_when_the_loads_are_taken_away(ends, inner):
    made = beam(25, inner=inner, supports=ends, damping__mass=2500.0, **TRILINEAR)
    weakest = 24.0 if inner else {"simple": 8.0, "fixed": 12.0}[ends]
    under(weakest * CAPACITY / SPAN * 0.9 * spread(25), made, hold=0.0101)
    under(0.0 * spread(25), made)
    assert made["curvature_ratio"] > 0.2
    assert abs(made["midspan.residual_deflection"]) > 1e-5
    assert made["midspan.deflection"] == pytest.approx(
        made["midspan.residual_deflection"], rel=1e-6
    )


def test_a_cracked_beam_starts_at_rest_on_its_moment_curvature_line():
    weight = 0.85 * 8.0 * CAPACITY / SPAN
    made = beam(
        24, box__left=0.0, box__width=SPAN, cushion__weight=weight, gravity=9.81, **TRILINEAR
    )
    elastic = made.state("elastic_moment")[1:-1]
    assert made["moment"] == pytest.approx(on_the_line(elastic / EI), rel=1e-9)
    assert made["plastic_curvature"] == pytest.approx((elastic - made["moment"]) / EI, rel=1e-9)
    assert made["moment"].max() > 0.8 * CAPACITY
    made["force.y"] = -weight / 24
    made.step(0.0, 1e-3)
    assert np.abs(made["velocity.y"]).max() < 1e-8
    assert made["energy.plastic"] < 1e-6 * made["energy.elastic"]


@pytest.mark.parametrize("inner", [(), (9,)])
def test_a_cracked_redundant_beam_starts_at_rest(inner):
    weight = (30.0 if inner else 12.0) * CAPACITY / SPAN
    made = beam(
        25,
        inner=inner,
        supports="fixed",
        box__left=0.0,
        box__width=SPAN,
        cushion__weight=weight,
        **TRILINEAR,
    )
    assert np.abs(made["plastic_curvature"]).max() > 0.0
    assert inner or made["support.plastic_rotation"][0] < 0.0
    made["force.y"] = -weight / 25
    made.step(0.0, 1e-3)
    assert np.abs(made["velocity.y"]).max() < 1e-8


def test_a_beam_that_cannot_bear_its_weights_is_refused():
    weight = 1.01 * 8.0 * CAPACITY / SPAN
    with pytest.raises(ComponentError, match=r"does not come to rest.*8000 N\.m"):
        beam(24, box__left=0.0, box__width=SPAN, cushion__weight=weight)


# ------------------------------------------------------------------ shear


@pytest.mark.parametrize("ends", ["simple", "fixed"])
def test_shears_are_in_balance_with_loads_torques_and_reactions(ends):
    made = beam(25, supports=ends, damping__mass=3000.0)
    generator = np.random.default_rng(4)
    made["torque"] = generator.uniform(-20.0, 20.0, 25)
    load = generator.uniform(0.0, 100.0, 25)
    assert under(load, made, hold=0.2) < 1e-9
    left, right = made["support.force.y"]
    steps = np.append(made["shear"], made["support.shear[2]"])
    assert steps[[0, -1]] == pytest.approx([-left, right])
    assert np.diff(steps) == pytest.approx(-load, rel=1e-6)
