"""Moment-curvature lines of roofs: steel sections and reinforced concrete strips, against hand calculations."""

from dataclasses import replace

import numpy as np
import pytest

from rockshed.components.catalogue import component
from rockshed.sites.shed.reinforced_concrete import (
    Bars,
    Concrete,
    Strip,
    StripError,
    strip_corners,
)
from rockshed.sites.shed.yielding import SteelSection, steel_corners

H400 = SteelSection(2.05e11, 666e-6, 3330e-6, 3670e-6, 235e6)
"""H-400x400x13x21 of SS400."""


def test_corners_of_a_girder_are_its_yield_and_plastic_moment():
    corners = steel_corners(H400)
    assert corners.moments == pytest.approx((782.55e3, 862.45e3), rel=1e-9)
    assert corners.curvatures == pytest.approx((5.7317e-3, 11.463e-3), rel=1e-4)
    values = corners.parameters(girders=1.6)
    assert values["section.corner1.moment"] == pytest.approx(1.6 * 782.55e3)
    assert values["section.corner3.moment"] == 0.0
    assert values["section.corner2.curvature"] == corners.curvatures[1]


def test_the_line_of_a_girder_encloses_the_area_of_its_fibres():
    """What the plastic moment is more than the moment, over the curvature: H-400 without its fillets."""
    half = (np.arange(4000) + 0.5) * 0.2 / 4000
    width = np.where(half > 0.179, 0.4, 0.013)
    curvatures = np.linspace(0.0, 60.0, 6001)  # in units of the yield curvature
    stress = np.minimum(1.0, curvatures[:, None] * half / 0.2)
    moments = 2.0 * (stress * width * half).sum(axis=1) * 0.2 / 4000
    plastic, elastic = moments[-1], moments[100]
    missing = (plastic - moments[100:]).sum() * 0.01
    assert 1.0 + missing / (0.5 * (plastic - elastic)) == pytest.approx(2.1, abs=0.15)


def test_a_section_without_a_reserve_has_one_corner():
    corners = steel_corners(replace(H400, plastic_modulus=3340e-6))
    assert len(corners.moments) == 1
    assert corners.parameters()["section.corner2.moment"] == 0.0


STRIP = Strip(width=1.0, height=0.5, steel_area=2000e-6, depth=0.44)
CONCRETE = Concrete(strength=24e6, tensile_strength=2.9e6, elastic_modulus=2.5e10)
BARS = Bars(345e6)


def test_a_strip_by_hand():
    """Ultimate: block 0.8095, axis 41.8 mm deep, arm 0.44 - 0.416 x; cracking f b h2/6.

    Yield: parabola, eps_s = 0.001725. With x = 0.0960 m: top 0.000481, 1/2 of it 0.2407 of the peak strain,
    block 0.2407 - 0.0193 = 0.2214 * 20.4 MPa * 0.096 m = 433 kN: too little; x = 0.1191 m balances 690 kN.
    """
    corners = strip_corners(STRIP, CONCRETE, BARS)
    assert corners.moments[0] == pytest.approx(2.9e6 * 1.0 * 0.5**2 / 6.0)
    assert corners.curvatures[0] == pytest.approx(corners.moments[0] / (2.5e10 * 0.5**3 / 12))
    axis = 690e3 / (0.8095 * 20.4e6)
    assert corners.curvatures[2] == pytest.approx(0.0035 / axis, rel=1e-3)
    assert corners.moments[2] == pytest.approx(690e3 * (0.44 - 0.416 * axis), rel=1e-3)
    axis = 0.44 - 0.001725 / corners.curvatures[1]
    ratio = corners.curvatures[1] * axis / 0.002
    assert (ratio - ratio**2 / 3) * 20.4e6 * axis == pytest.approx(690e3, rel=1e-9)
    centre = (2 * ratio / 3 - ratio**2 / 4) / (ratio - ratio**2 / 3) * axis
    assert corners.moments[1] == pytest.approx(690e3 * (0.44 - axis + centre), rel=1e-9)
    assert 0.105 < axis < 0.125


def test_fibres_of_the_strip_give_the_same_moments():
    """At the curvatures of yield and ultimate, by 20,000 layers and a bisection for the axis."""
    strip = replace(STRIP, upper_area=600e-6, upper_depth=0.05)
    corners = strip_corners(strip, CONCRETE, BARS)
    depth = (np.arange(20000) + 0.5) * strip.height / 20000

    def forces(axis, curvature):
        strain = np.clip(curvature * (axis - depth), 0.0, 0.002) / 0.002
        layers = 20.4e6 * (2 * strain - strain**2) * strip.height / 20000
        steel = [
            (area * BARS.stress(curvature * (place - axis)), place)
            for area, place in ((2000e-6, 0.44), (600e-6, 0.05))
        ]
        total = layers.sum() - sum(force for force, _ in steel)
        moment = sum(force * place for force, place in steel) - (layers * depth).sum()
        return total, moment

    for moment, curvature in zip(corners.moments[1:], corners.curvatures[1:]):
        low, high = 1e-3, 0.4
        for _ in range(60):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if forces(middle, curvature)[0] < 0 else (low, middle)
        assert forces(low, curvature)[1] == pytest.approx(moment, rel=1e-4)


def test_a_strip_without_bars_above_hogs_up_to_cracking_only():
    corners = strip_corners(STRIP, CONCRETE, BARS)
    assert corners.hogging_moments == (corners.moments[0],) * 3
    assert corners.hogging_curvature == corners.curvatures[0]
    assert corners.cracks


def test_hogging_is_sagging_of_the_strip_upside_down():
    alike = replace(STRIP, upper_area=2000e-6, upper_depth=0.06)
    corners = strip_corners(alike, CONCRETE, BARS)
    assert corners.hogging_moments == pytest.approx(corners.moments)
    assert corners.hogging_curvature == pytest.approx(corners.curvatures[-1])
    fewer = strip_corners(replace(alike, upper_area=1000e-6), CONCRETE, BARS)
    assert 345e3 * 0.42 < fewer.hogging_moments[-1] < 345e3 * 0.48  # steel and its arm
    few = strip_corners(replace(alike, upper_area=500e-6), CONCRETE, BARS)
    assert few.hogging_moments == (few.moments[0],) * 3  # less than what cracks it
    with pytest.raises(StripError, match="in hogging, the concrete crushes"):
        strip_corners(replace(STRIP, upper_area=30000e-6, upper_depth=0.06), CONCRETE, BARS)


def test_a_strip_that_breaks_without_a_warning_is_refused():
    with pytest.raises(StripError, match="crushes before the steel yields"):
        strip_corners(replace(STRIP, steel_area=20000e-6), CONCRETE, BARS)
    with pytest.raises(StripError, match="crushes before the steel yields"):
        strip_corners(replace(STRIP, steel_area=90000e-6), CONCRETE, BARS)
    with pytest.raises(StripError, match="breaks when it cracks; give more steel"):
        strip_corners(replace(STRIP, steel_area=500e-6), CONCRETE, BARS)


@pytest.mark.parametrize(
    ("modulus", "second_moment", "corners"),
    [
        (2.05e11, 666e-6, steel_corners(H400)),
        (2.5e10, STRIP.second_moment, strip_corners(STRIP, CONCRETE, BARS)),
    ],
)
def test_the_beam_takes_the_corners(modulus, second_moment, corners):
    made = component("RBSMBeam").instance(elements=9)
    made["span"], made["elastic_modulus"] = 9.0, modulus
    made["section.second_moment"] = second_moment
    for name, value in corners.parameters().items():
        made[name] = value
    made.initialise()
    stiffness = modulus * second_moment
    assert corners.curvatures[0] == pytest.approx(corners.moments[0] / stiffness)
