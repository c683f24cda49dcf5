"""Full scale in Sonoda et al. (1993), sec. 4 (3): a rock of 1 tf on 90 cm of sand.

On a rigid base (figs 20 to 22) and on two girders (figs 23 and 24, table 6). Whatever the paper
leaves open is chosen here and said where the numbers stand.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any

from rockshed.components.catalogue import component
from rockshed.components.common.units import cm, cm2, cm4, kgf, standard_gravity

from ..core.system.fields import Value
from ..core.system.parts import ComponentSpec, EnergyAlarm, SharedValue
from ..core.system.schedule import Scheme
from ..core.system.system import SystemSpec
from ..references import Known, Reference, References
from .sand_models import FULL_SCALE_SOIL, SandLayer
from .sonoda1993 import SAND, differs, impact_bonds, impact_connections, of_the_test, printed_rows

_COUPLINGS: Mapping[str, tuple[Scheme, str, str]] = {
    "paper": ("sequential", "held", "last"),
    "impulse": ("sequential", "linear", "mean"),
}
"""Master, kinematics and forces of the sand by scheme of exchange.

paper: sand first, inputs held, exchange with the sand's own step. impulse: sand first, kinematics
extrapolated, mean forces, a longer exchange step.
"""

ROCK_MASS = 1000.0
ROCK_RADIUS = 45.6 * cm
DROP = 10.0
ROCK_SPEED = 14.0
"""After the drop of 10 m, as the paper rounds it (m/s)."""
LAYER = 90 * cm
DISC_RADIUS = 5 * cm
_GAP = 5e-3
"""Distance (m) between rock and sand at the start."""
_RIGID_STEPS = {"paper": 5e-5, "impulse": 2e-4}
_GIRDER_STEPS = {"paper": 1.25e-5, "impulse": 1e-4}
"""Exchange steps (s) by scheme; that of the paper's scheme is the internal step of sand and rock.

Discs are ten times as large as in the laboratory; the stable step is longer than 4e-4 s for all
these sands. What counts is the energy that the held forces make: on girders, 0.09 to 0.15 % of the
impact energy in 1 s with either scheme.
"""


@dataclass(frozen=True)
class Impact:
    """An impact at full scale.

    Attributes
    ----------
    name, summary : str
        Name of the case, and its content in a line.
    modulus : float
        Fictitious modulus E_bar (Pa).
    width : float
        Of the box (m).
    thickness : float
        Effective thickness dL of the sand out of the plane (m).
    stop_time : float
        End of the run (s), after the rock has turned.
    span : float
        Of the girders (m), 0 on a rigid base.
    """

    name: str
    summary: str
    modulus: float
    width: float
    thickness: float
    stop_time: float
    span: float = 0.0

    @property
    def discs(self) -> int:
        """Number of sand discs of 10 cm in the box: 360 and 270, as in the paper."""
        return round(self.width / (2 * DISC_RADIUS)) * round(LAYER / (2 * DISC_RADIUS))

    @property
    def steps(self) -> Mapping[str, float]:
        """Exchange steps (s) by scheme of exchange."""
        return _GIRDER_STEPS if self.span else _RIGID_STEPS

    @property
    def elements(self) -> int:
        """Number of beam discs.

        On a rigid base 1, the least that the sand can be built with, which is never touched.
        """
        return round(self.span / ELEMENT) if self.span else 1


RIGID_THICKNESS = 2 * ROCK_RADIUS * 10.0 / 9.9
"""Effective thickness on the rigid base (m), which the paper does not give.

As in the laboratory, 10 cm for a ball of 9.9 cm.
"""
GIRDER_THICKNESS = 170 * cm
"""Distance of the girders, which the paper takes as the effective thickness."""

ELEMENT = 20 * cm
"""Length of a beam element (m): a disc twice a sand disc, with a stable step of 2e-5 s.

The paper does not give its discs.
"""
GIRDERS = 2
GIRDER_AREA, GIRDER_SECOND_MOMENT, GIRDER_HEIGHT = 136.0 * cm2, 38_700 * cm4, 39 * cm
"""Section area (m2), second moment (m4) and height (m) of one girder.

The paper says H-300x400 only: read as the rolled section of the series 400 x 300, H-390x300x10x16
of JIS G 3192 as it stood in 1993, bent about the strong axis.
"""
GIRDERS_MODEL = "one-law"
"""Model of the sand that comes near the energies measured on the girders (table 6).

The ``calibrated`` one was fitted to the laboratory, and has several times as much.
"""
YIELD_STRESS = 235e6
"""Yield stress of the girders (Pa), which the paper does not give: that of SS41, SS400 today.

JIS G 3101: flanges of 16 to 40 mm, the lower value also for those of 16 mm here.
"""
_BEAM_STEP = 1e-5
BEAM_DAMPING = 5e-6
"""Rayleigh damping of the girders' stiffness (s), which the paper does not give.

Less than 0.01 % of critical for their first mode, tens of percent for the fastest ones, which would
grow without any, for the contact forces on the beam are held over an exchange.
"""

DECK_MASS, BOX_MASS = 0.0, 0.0
"""Mass of a deck by length (kg/m), and of the box (kg), on the girders.

The paper gives none: none is assumed.
"""

_SANDS = (
    ("pit", "pit sand", 20.0, 0.24),
    ("river", "river sand", 75.0, 0.16),
    ("crushed", "crushed sand", 100.0, 0.16),
)
"""Name, E_bar (kgf/cm2) and end of the run (s); the paper has 70 to 80 for river sand."""
_GIRDER_SAND, _GIRDER_STOP = 100.0, 0.2


@cache
def impacts() -> dict[str, Impact]:
    """Return the impacts at full scale by the name of their case."""
    rigid = [
        Impact(
            f"rigid-base-{name}",
            f"1 tf from 10 m on 90 cm of {words} on a rigid base, E_bar {modulus:g} kgf/cm²",
            modulus * kgf / cm2,
            4.0,
            RIGID_THICKNESS,
            stop,
        )
        for name, words, modulus, stop in _SANDS
    ]
    spans = [float(row["span_m"]) for row in printed_rows("table6")]
    girders = [
        Impact(
            f"girders-{span:g}",
            f"1 tf from 10 m on 90 cm of crushed sand on two H-300x400 girders of {span:g} m",
            _GIRDER_SAND * kgf / cm2,
            3.0,
            GIRDER_THICKNESS,
            _GIRDER_STOP,
            span,
        )
        for span in spans
    ]
    return {impact.name: impact for impact in rigid + girders}


def full_scale_system(
    fmus: Mapping[str, str],
    impact: Impact,
    coupling: str = "paper",
    discs: int | None = None,
    elements: int | None = None,
) -> SystemSpec:
    """Return an impact at full scale as a co-simulation of rock, sand and, on girders, beam.

    The origin is the left support on the girders, the left wall on the rigid base.

    Parameters
    ----------
    fmus : mapping of str to str
        Files of the FMUs by component.
    impact : Impact
        The impact.
    coupling : str
        ``paper`` or ``impulse``.
    discs, elements : int, optional
        Sizes that ``sand`` and ``beam`` were built with, by default those of the impact; the rock
        starts above the layer that so many discs make.

    Returns
    -------
    SystemSpec
        The co-simulation.
    """
    master, kinematics, forces = _COUPLINGS[coupling]
    partners = ("rock", "beam") if impact.span else ("rock",)
    components = {
        "sand": _sand(fmus["sand"], impact, kinematics, forces),
        "rock": _rock(fmus["rock"], impact, discs or impact.discs),
    }
    watched = ("transmitted_force", "rock.force.y", "penetration", "clearance")
    watch = [f"sand.{name}" for name in watched]
    spacing = 0.0
    if impact.span:
        spacing = impact.span / (elements or impact.elements)
        components["beam"] = _girders(fmus["beam"], impact, spacing)
        watch += ["beam.midspan.deflection", "beam.energy.elastic", "beam.energy.strain_estimate"]
    return SystemSpec(
        name=impact.name,
        description=f"Sonoda et al. 1993, full scale: {impact.summary}",
        components=components,
        shared=_shared(impact, spacing),
        connections=impact_connections(partners),
        bonds=impact_bonds(partners),
        energy_alarm=EnergyAlarm(share=0.005, reference="rock.energy.kinetic"),
        master=master,
        order=["sand", *partners],
        stop_time=impact.stop_time,
        exchange_step=impact.steps[coupling],
        output_interval=4e-4,
        state_interval=4e-3,
        watch=watch,
    )


def _sand(fmu: str, impact: Impact, kinematics: str, forces: str) -> ComponentSpec:
    parameters: dict[str, Value] = {
        "modulus": impact.modulus,
        "thickness": impact.thickness,
        "disc.radius": DISC_RADIUS,
        "base": "beam_surface" if impact.span else "floor",
        "kinematics": kinematics,
        "forces": forces,
        "internal_step": impact.steps["paper"],
    }
    return ComponentSpec(fmu=fmu, record_states=True, parameters=parameters)


def _rock(fmu: str, impact: Impact, discs: int) -> ComponentSpec:
    """Return the rock above the layer that so many discs make on a square lattice."""
    rows = math.ceil(discs / round(impact.width / (2 * DISC_RADIUS)))
    parameters: dict[str, Value] = {
        "position0.x": _middle(impact),
        "position0.y": rows * 2 * DISC_RADIUS + ROCK_RADIUS + _GAP,
        "velocity0.y": -ROCK_SPEED,
        "internal_step": impact.steps["paper"],
    }
    return ComponentSpec(fmu=fmu, parameters=parameters)


def _girders(fmu: str, impact: Impact, spacing: float) -> ComponentSpec:
    """Return the girders as one beam; spacing: length of an element (m)."""
    parameters: dict[str, Value] = {
        "span": impact.span,
        "axis.y": -0.5 * spacing,
        "section.area": GIRDERS * GIRDER_AREA,
        "section.second_moment": GIRDERS * GIRDER_SECOND_MOMENT,
        "section.height": GIRDER_HEIGHT,
        "deck.mass": DECK_MASS,
        "box.mass": BOX_MASS,
        "damping.stiffness": BEAM_DAMPING,
        "internal_step": _BEAM_STEP,
    }
    return ComponentSpec(fmu=fmu, parameters=parameters)


def _shared(impact: Impact, spacing: float) -> dict[str, SharedValue]:
    """Return the values that several components take; spacing: length of an element (m), or 0."""
    boxed = ["sand", "beam"] if impact.span else ["sand"]
    falling = ["rock", *boxed]
    left = _middle(impact) - 0.5 * impact.width
    shared = {
        "box_left": SharedValue(value=left, targets=[f"{name}.box.left" for name in boxed]),
        "box_width": SharedValue(
            value=impact.width, targets=[f"{name}.box.width" for name in boxed]
        ),
        "gravity": SharedValue(
            value=standard_gravity, targets=[f"{name}.gravity" for name in falling]
        ),
        "rock_radius": SharedValue(value=ROCK_RADIUS, targets=["rock.radius", "sand.rock.radius"]),
        "rock_mass": SharedValue(value=ROCK_MASS, targets=["rock.mass", "sand.rock.mass"]),
    }
    if spacing:
        shared["beam_radius"] = SharedValue(value=0.5 * spacing, targets=["sand.beam.radius"])
    return shared


def _middle(impact: Impact) -> float:
    """Return the middle of girders or box, from the origin (m)."""
    return 0.5 * (impact.span or impact.width)


def design(impact: Impact) -> dict[str, Any]:
    """Return what results on girders are compared with: one girder's section and its yield stress.

    Parameters
    ----------
    impact : Impact
        The impact.

    Returns
    -------
    dict
        ``roof`` and ``criteria`` for the provenance of a run, in SI units; empty on a rigid base.
    """
    if not impact.span:
        return {}
    return {
        "roof": {
            "kind": "girders",
            "section": "H-390x300x10x16",
            "area": GIRDER_AREA,
            "second_moment": GIRDER_SECOND_MOMENT,
            "section_modulus": GIRDER_SECOND_MOMENT / (0.5 * GIRDER_HEIGHT),
            "height": GIRDER_HEIGHT,
            "yield_stress": YIELD_STRESS,
            "girders": GIRDERS,
            "spacing": GIRDER_THICKNESS,
            "span": impact.span,
        },
        "criteria": [
            {
                "name": "stress",
                "limit": YIELD_STRESS,
                "unit": "Pa",
                "source": "assumed: SS41, the paper does not say",
            }
        ],
    }


def cushion_weight(system: SystemSpec, discs: int) -> float:
    """Return the weight of the sand on girders, under which they start bent, at rest.

    Radii that differ are uniform within radius (1 - spread, 1 + spread): on average discs are
    heavier by spread^2 / 3.

    Parameters
    ----------
    system : SystemSpec
        With the parameters of the sand.
    discs : int
        Number of discs.

    Returns
    -------
    float
        Weight (N).
    """
    given = {
        v.name: v.start_at(0, {})
        for v in component("SandCushion").layout.variables
        if v.size is None
    }
    shared = {
        name.removeprefix("sand."): entry.value
        for entry in system.shared.values()
        for name in entry.targets
        if name.startswith("sand.")
    }
    sand = {**given, **system.components["sand"].parameters, **shared}
    density = float(sand["density"]) / (
        float(sand["solid_fraction"]) if sand.get("density_of") == "layer" else 1.0
    )
    spread = float(sand["disc.spread"]) if sand["packing"] in ("random", "prepared") else 0.0
    area = math.pi * float(sand["disc.radius"]) ** 2 * (1.0 + spread**2 / 3.0)
    return discs * density * area * float(sand["thickness"]) * float(sand["gravity"])


def layer(impact: Impact, dropped: bool = True) -> SandLayer:
    """Return the sand of an impact, for the models of it.

    Parameters
    ----------
    impact : Impact
        The impact.
    dropped : bool
        Whether the rock starts above the sand.

    Returns
    -------
    SandLayer
        The layer.
    """
    return SandLayer(
        impact.width,
        LAYER,
        DISC_RADIUS,
        ROCK_RADIUS,
        ROCK_SPEED,
        FULL_SCALE_SOIL,
        impact.stop_time,
        on_beam=bool(impact.span),
        dropped=dropped,
    )


ASSUMED = ("beam.deck.mass", "beam.box.mass", "beam.cushion.weight")
"""Values of the girders' load that the paper does not give."""


def references(impact: Impact, changed: Mapping[str, Value]) -> References:
    """Return what is known of an impact with other values or sizes.

    Steps, choices of the sand's model and what the paper does not give of deck and box leave it
    that impact; with anything else nothing is known.

    Parameters
    ----------
    impact : Impact
        The impact.
    changed : mapping of str to Value
        Values and sizes that differ, by ``component.name``.

    Returns
    -------
    references : References
        What is known, and why something is not compared.
    """
    if others := [
        name for name in changed if name not in ASSUMED and (name in SAND or of_the_test(name))
    ]:
        return References(remarks=[f"not compared: {differs(others)}"])
    return References(known_of(impact))


_SETTLED_RATIO = "settled transmitted force / settled force on the rock"


def known_of(impact: Impact) -> dict[str, Known]:
    """Return what the paper gives to compare with an impact.

    The energy of table 6 was measured by the strain at midspan, gauges at zero before the test: eq.
    (7). The paper's analysis sums up the springs: eqs (5), (6).

    Parameters
    ----------
    impact : Impact
        The impact.

    Returns
    -------
    dict of str to Known
        By the name of the metric.
    """
    if not impact.span:
        return {_SETTLED_RATIO: Known(Reference(2.0, "sec. 4 (3): about twice"))}
    row = next(row for row in printed_rows("table6") if float(row["span_m"]) == impact.span)
    measured, computed = (
        Reference(0.01 * float(row[f"{who}_percent"])) for who in ("experiment", "paper_analysis")
    )
    return {
        "peak beam energy / impact energy": Known(computed),
        "peak beam energy from the midspan strain / impact energy": Known(experiment=measured),
        _SETTLED_RATIO: Known(
            Reference(1.4, "figs 23 and 24: the difference of the maxima is 30 to 50 %")
        ),
    }
