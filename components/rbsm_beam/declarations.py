"""Variables of the beam. Equations, frame and signs: README.md beside this file."""

from ..common.component import Size
from ..common.plausible import Plausible
from ..common.ports import Layout, Sizes, State, choice, inp, out, param
from ..common.roles import Role
from ..common.stepping import internal_step, stable_step
from ..common.units import cm, cm2, cm4, kgf

SIMPLE, FIXED, SPRUNG = 1, 2, 3
ELASTIC, YIELDING = 1, 2
YIELD, CRACKING = 1, 2
SLIDERS = 3
"""Elements in parallel that slip, one for each corner of the moment-curvature line."""

SIZES = {
    "elements": Size(24, 2, 2000, "rigid discs of the chain"),
    "support_count": Size(
        2, 2, 100, "supports: 1 is the left, 2 the right one, all others stand between them"
    ),
}

_SONODA = "Sonoda et al. 1993, sec. 4: H-100x50x7, span 120 cm, discs of 5 cm"
_GEOMETRY = ("span", "axis.x")
_YIELDING = (
    "section.bending",
    "section.corner1.moment",
    "section.corner2.moment",
    "section.corner2.curvature",
    "section.corner3.moment",
    "section.corner3.curvature",
    "section.hardening_ratio",
    "section.corner1.kind",
    "section.corner1.hogging_moment",
    "section.corner2.hogging_moment",
    "section.corner3.hogging_moment",
    "section.corner_hogging_curvature",
)
_AT_REST = (
    *_YIELDING,
    "span",
    "axis.y",
    "supports",
    "support.stiffness",
    "support.element",
    "elastic_modulus",
    "section.area",
    "section.second_moment",
    "density",
    "deck.mass",
    "box.left",
    "box.width",
    "box.mass",
    "cushion.weight",
    "gravity",
    "support.position.y",
    "axis.x",
)


def _per_element(name: str, description: str, unit: str, *depends: str):
    return out(name, description, unit, size="elements", initial_dependencies=depends)


def _corner(name: str, description: str, unit: str = "N.m"):
    """Declare a value of a corner of the moment-curvature line of the whole section."""
    return param(name, f"{description}; of the whole section, if it yields", 0.0, unit, minimum=0.0)


def _padded(sizes: Sizes) -> int:
    """Return the length of an array over the discs with a place at each end for the support."""
    return sizes["elements"] + 2


def _slipped(sizes: Sizes) -> int:
    return SLIDERS * _padded(sizes)


def _supports(sizes: Sizes) -> int:
    return sizes["support_count"]


LAYOUT = Layout(
    (
        param(
            "span",
            "distance of the outer supports",
            120 * cm,
            "m",
            minimum=1e-3,
            source=_SONODA,
            plausible=Plausible(0.1, 200.0, ("cm", "mm")),
        ),
        param("axis.x", "x of the left support", 0.0, "m"),
        param(
            "axis.y",
            "y of the unloaded axis of the beam; the default puts the top of 24 discs at y = 0",
            -2.5 * cm,
            "m",
        ),
        choice(
            "supports",
            "simple: both ends turn freely, the right one slides along the axis; fixed: neither "
            "turns nor slides; elastic: as simple, on springs that only push",
            ("simple", "fixed", "elastic"),
            "simple",
            source=_SONODA,
        ),
        param(
            "support.stiffness",
            "stiffness of the spring under either end, if supports are elastic",
            0.0,
            "N/m",
            minimum=0.0,
            plausible=Plausible(1e4, 1e12, ("kN/m", "kN/mm")),
        ),
        param(
            "support.element",
            "disc under which an inner support stands, counted from the left; 0 for supports 1 and "
            "2, which are the ends",
            0.0,
            size="support_count",
            minimum=0.0,
            maximum=2000.0,
        ),
        param(
            "elastic_modulus",
            "Young's modulus; the default is structural steel",
            2.1e6 * kgf / cm2,
            "Pa",
            minimum=1.0,
            plausible=Plausible(1e8, 1e12, ("GPa", "MPa", "kgf/cm2")),
        ),
        param(
            "section.area",
            "area of the section",
            11.85 * cm2,
            "m2",
            minimum=1e-12,
            source=_SONODA,
            plausible=Plausible(1e-5, 20.0, ("cm2", "mm2")),
        ),
        param(
            "section.second_moment",
            "second moment of area of the section",
            187 * cm4,
            "m4",
            minimum=1e-18,
            source=_SONODA,
            plausible=Plausible(1e-11, 100.0, ("cm4", "mm4")),
            role=Role.SECOND_MOMENT,
        ),
        param(
            "section.height",
            "height of the section, axis at half of it; for the strain only",
            10 * cm,
            "m",
            minimum=1e-6,
            source=_SONODA,
            plausible=Plausible(5e-3, 10.0, ("cm", "mm")),
            role=Role.SECTION_HEIGHT,
        ),
        choice(
            "section.bending",
            "elastic, or yielding along the corners of a moment-curvature line with kinematic "
            "hardening, alike in both directions unless corners have hogging moments",
            ("elastic", "yielding"),
            "elastic",
        ),
        _corner("section.corner1.moment", "bending moment up to which the section is elastic"),
        _corner("section.corner2.moment", "bending moment at the second corner, 0 without one"),
        _corner("section.corner2.curvature", "curvature at the second corner", "1/m"),
        _corner("section.corner3.moment", "bending moment at the third corner, 0 without one"),
        _corner("section.corner3.curvature", "curvature at the third corner", "1/m"),
        choice(
            "section.corner1.kind",
            "what the first corner is: yield, unloading with the elastic slope, or cracking, "
            "unloading towards the origin",
            ("yield", "cracking"),
            "yield",
        ),
        *(
            _corner(
                f"section.corner{number}.hogging_moment",
                f"bending moment with tension above at the {place} corner, between slopes as "
                "below; 0 at all corners: as below",
            )
            for number, place in enumerate(("first", "second", "third"), 1)
        ),
        _corner(
            "section.corner_hogging_curvature",
            "curvature with tension above that counts as that of the last corner in "
            "curvature_ratio; 0: where the slopes lead",
            "1/m",
        ),
        param(
            "section.hardening_ratio",
            "slope of the moment-curvature line past its last corner, as a part of the elastic one",
            0.0,
            minimum=0.0,
            maximum=1.0,
        ),
        param(
            "density",
            "density of the material; the default is structural steel",
            7850.0,
            "kg/m3",
            minimum=1e-3,
            plausible=Plausible(200.0, 25000.0, ("t/m3", "kN/m3")),
        ),
        param(
            "deck.mass",
            "mass per length that moves with the beam over its whole span besides its own",
            0.0,
            "kg/m",
            minimum=0.0,
            plausible=Plausible(1.0, 1e5, ("t/m",)),
        ),
        param(
            "box.left",
            "x of the left end of the box of sand that stands on the beam",
            41.5 * cm,
            "m",
        ),
        param(
            "box.width",
            "width of the box",
            37 * cm,
            "m",
            minimum=1e-6,
            source="Sonoda et al. 1993, fig. 2",
        ),
        param(
            "box.mass",
            "mass of the empty box, even over its width; moves with the beam",
            0.0,
            "kg",
            minimum=0.0,
        ),
        param(
            "cushion.weight",
            "weight of the sand in the box, even over its width, under which the beam is bent and "
            "at rest at the start; from then on the inputs act, and this no longer",
            0.0,
            "N",
            minimum=0.0,
            role=Role.CUSHION_WEIGHT,
        ),
        param(
            "gravity",
            "acceleration of gravity, downwards; 0 leaves the weight of beam, deck and box out, "
            "deflections then count from the position under it",
            0.0,
            "m/s2",
            minimum=0.0,
            role=Role.GRAVITY,
        ),
        param(
            "damping.mass", "Rayleigh damping, factor of the mass matrix", 0.0, "1/s", minimum=0.0
        ),
        param(
            "damping.stiffness",
            "Rayleigh damping, factor of the stiffness matrix",
            0.0,
            "s",
            minimum=0.0,
        ),
        internal_step(1e-6),
        inp("force.x", "force on the disc without its weight, to the right", "N", size="elements"),
        inp("force.y", "force on the disc without its weight, upwards", "N", size="elements"),
        inp(
            "torque",
            "torque on the disc about its centre, counter-clockwise",
            "N.m",
            size="elements",
        ),
        inp(
            "support.position.y",
            "height of the support above its place in the drawing",
            "m",
            size="support_count",
        ),
        inp("support.velocity.y", "velocity of the support, upwards", "m/s", size="support_count"),
        out(
            "position.x",
            "position of the disc's centre, to the right",
            "m",
            size="elements",
            initial_dependencies=_GEOMETRY,
            role=Role.ALONG,
        ),
        out(
            "position.y",
            "position of the disc's centre, upwards",
            "m",
            size="elements",
            initial_dependencies=_AT_REST,
            role=Role.STRUCTURE,
        ),
        _per_element(
            "angle",
            "angle of the disc, counter-clockwise: mean of the two bars beside it",
            "rad",
            *_AT_REST,
        ),
        _per_element("velocity.x", "velocity of the disc's centre, to the right", "m/s"),
        _per_element("velocity.y", "velocity of the disc's centre, upwards", "m/s"),
        _per_element(
            "angular_velocity",
            "angular velocity of the disc, counter-clockwise",
            "rad/s",
            "support.velocity.y",
            "span",
        ),
        out(
            "moment",
            "bending moment of the whole section at the disc's centre, positive with tension below",
            "N.m",
            size="elements",
            initial_dependencies=_AT_REST,
            role=Role.BENDING_MOMENT,
        ),
        out(
            "support.moment",
            "bending moment of the whole section at the support, positive with tension below; 0 "
            "at the ends of a beam on simple supports",
            "N.m",
            size="support_count",
            initial_dependencies=_AT_REST,
            role=Role.BENDING_MOMENT,
        ),
        out(
            "shear",
            "shear force of the whole section in the joint at the left edge of the disc, the rate "
            "of the moment along the beam: positive where the left part pushes the right one up",
            "N",
            size="elements",
            role=Role.SHEAR,
        ),
        out(
            "support.shear",
            "shear force beside the support: [1] right of the left end, [2] left of the right one; "
            "of an inner support that of the two beside it which is farther from zero",
            "N",
            size="support_count",
            role=Role.SHEAR,
        ),
        out(
            "plastic_curvature",
            "curvature at the disc's centre that would stay without a moment, positive with "
            "tension below",
            "1/m",
            size="elements",
            initial_dependencies=_AT_REST,
            role=Role.PLASTIC_CURVATURE,
        ),
        out(
            "support.plastic_rotation",
            "plastic rotation of the hinge at a fixed support, positive with tension below",
            "rad",
            size="support_count",
            initial_dependencies=_AT_REST,
        ),
        out(
            "curvature_ratio",
            "largest curvature so far, at discs and walls, as a multiple of that of the last "
            "corner; 0 while the section is elastic",
            "1",
            initial_dependencies=_AT_REST,
            role=Role.CURVATURE_RATIO,
        ),
        out(
            "support.force.y",
            "force of the beam on the support at the end of the step, upwards (negative under a "
            "load)",
            "N",
            size="support_count",
            role=Role.SUPPORT_FORCE,
        ),
        out(
            "support.mean_force.y",
            "mean of support.force.y over the step: its impulse divided by the step",
            "N",
            size="support_count",
        ),
        out(
            "support.settlement",
            "way by which the spring under the support is pressed together; of elastic supports",
            "m",
            size="support_count",
            initial_dependencies=_AT_REST,
        ),
        out(
            "support.work",
            "work that the moving support has done on the beam",
            "J",
            size="support_count",
            initial_dependencies=(),
        ),
        out(
            "radius",
            "radius of the discs, half their distance",
            "m",
            initial_dependencies=("span",),
        ),
        stable_step(),
        out(
            "transmitted_force",
            "sum of the vertical forces on the discs, positive downwards",
            "N",
            initial_dependencies=("force.y",),
            source="Sonoda et al. 1993, eq. (4)",
        ),
        out(
            "box.inertia_force",
            "force that accelerates the empty box, mean over the step, positive downwards: load "
            "cells between box and beam show transmitted_force less this (their zero is the "
            "weight at rest)",
            "N",
            initial_dependencies=(),
            role=Role.BOX_INERTIA,
        ),
        out(
            "midspan.deflection",
            "deflection of the midspan from the unloaded axis, positive downwards",
            "m",
            role=Role.DEFLECTION,
        ),
        out(
            "midspan.residual_deflection",
            "deflection of the midspan that would stay if all loads were taken from the beam, "
            "elastically, positive downwards",
            "m",
            initial_dependencies=_AT_REST,
            role=Role.RESIDUAL_DEFLECTION,
        ),
        out("midspan.moment", "bending moment at midspan, positive with tension below", "N.m"),
        out("midspan.strain", "strain at the lower flange at midspan, positive in tension", "1"),
        out(
            "energy.kinetic",
            "kinetic energy",
            "J",
            role=Role.KINETIC,
            label="beam, kinetic and elastic",
        ),
        out(
            "energy.elastic",
            "elastic energy, axial + bending",
            "J",
            source="Sonoda et al. 1993, eq. (5)",
            role=Role.ELASTIC,
            label="beam, kinetic and elastic",
        ),
        out(
            "energy.support",
            "elastic energy of the springs under elastic supports",
            "J",
            role=Role.ELASTIC,
            label="elastic supports",
        ),
        out(
            "energy.axial",
            "elastic energy of the axial springs",
            "J",
            source="Sonoda et al. 1993, eq. (6)",
        ),
        out(
            "energy.bending",
            "elastic energy of the bending springs, those of inner supports included; where the "
            "section yields, with what its hardening locks in",
            "J",
            source="Sonoda et al. 1993, eq. (6)",
        ),
        out(
            "midspan.start_strain",
            "midspan.strain at the start, at which gauges are set to zero",
            "1",
        ),
        out(
            "energy.strain_estimate",
            "elastic energy as estimated from what the strain at midspan has gained since the "
            "start",
            "J",
            source="Sonoda et al. 1993, eq. (7)",
            role=Role.ESTIMATED,
        ),
        out(
            "energy.gravity",
            "potential energy in gravity, zero for the unloaded axis",
            "J",
            role=Role.GRAVITY_ENERGY,
            label="gravity, above its least",
        ),
        out(
            "energy.damping",
            "energy that the damping has dissipated",
            "J",
            role=Role.DISSIPATED,
            label="lost in the beam",
        ),
        out(
            "energy.plastic",
            "energy that the section has dissipated by yielding and cracking",
            "J",
            initial_dependencies=(),
            role=Role.PLASTIC,
            label="yielding and cracking of the beam",
        ),
        out(
            "energy.work.contact",
            "work that the inputs force and torque have done on the beam",
            "J",
            role=Role.WORK_INSIDE,
        ),
        out(
            "energy.work.support",
            "work that the moving supports have done on the beam",
            "J",
            role=Role.WORK_INSIDE,
        ),
        out(
            "energy.residual",
            "energies + damping + plastic - works, minus their sum at the start: error of the "
            "integration",
            "J",
            role=Role.RESIDUAL,
        ),
        out("energy.start", "kinetic + elastic + supports + gravity at the start", "J"),
    ),
    (
        State("u", _padded),
        State("v", _padded),
        State("u_rate", _padded),
        State("v_rate", _padded),
        State("u_shape", _padded),
        State("v_shape", _padded),
        State("hinge_moment", _padded),
        State("mass", lambda sizes: sizes["elements"]),
        State("kick", lambda sizes: sizes["elements"]),
        State("load.x", lambda sizes: sizes["elements"]),
        State("load.y", lambda sizes: sizes["elements"]),
        State("support.height", _supports),
        State("reaction", _supports),
        State("end.height", lambda sizes: 2),
        State("end.rate", lambda sizes: 2),
        State("end.force", lambda sizes: 2),
        State("jump", _supports),
        State("influence", lambda sizes: _supports(sizes) ** 2),
        State("rest.load", lambda sizes: sizes["elements"]),
        State("unit.load", lambda sizes: sizes["elements"]),
        State("slider.share", lambda sizes: SLIDERS),
        State("slider.limit", lambda sizes: SLIDERS),
        State("slider.hogging_limit", lambda sizes: SLIDERS),
        State("last_corner", lambda sizes: 2),
        State("slipped", _slipped),
        State("cracked.below", _padded),
        State("cracked.above", _padded),
        State("hinge.length", _padded),
        State("elastic_moment", _padded),
        State("moment_rate", _padded),
        State("offset", _padded),
        State("above", _padded),
        State("below", _padded),
        State("relief", _padded),
        State("midspan.influence", _padded),
    ),
)
