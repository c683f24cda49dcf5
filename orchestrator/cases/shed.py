"""A shed of a project file as a case: its system, its derived values and its design.

The sand is the model ``one-law``; the roof yields with its section.
"""

from collections.abc import Mapping
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import Any

from rockshed.components.catalogue import component
from rockshed.components.common.ports import Causality
from rockshed.components.common.units import kN, ms, standard_gravity

from ..core.errors import Problem
from ..core.system.fields import Value
from ..core.system.parts import ComponentSpec, EnergyAlarm, SharedValue
from ..core.system.system import SystemSpec
from ..sites.shed.geometry import WALL_HEIGHT, WALL_THICKNESS, ShedLayout, end_stiffness
from ..sites.shed.materials import caution
from ..sites.shed.preparation import Cushioned, PreparedShed, SlopeRock, prepare
from ..sites.shed.site import ShedProject
from ..sites.shed.words import in_words
from ..sites.source import SiteLike, SiteSource
from .on_rods import SIDES, loads_at_rest, on_rods, rod_sizes
from .registry import Case, ComponentSizes, weight_on_beam, with_implicit
from .sand_models import SandLayer, Soil, changes, sand_model
from .sonoda1993 import impact_bonds, impact_connections

MODEL = "one-law"
"""Model of the sand of every project."""
_PARTNERS = ("rock", "beam")
CAMPAIGN = "campaign"
"""Folder of the campaign of a slope in that of a run."""

FOLLOWS: Mapping[str, str] = {
    "sand.thickness": "cushion.effective_width",
    "sand.disc.radius": "numerics.disc_radius",
    "sand.beam.radius": "roof.span and numerics.elements",
    "beam_radius": "roof.span and numerics.elements",
    "sand.base": "roof",
    "sand.base.y": "roof",
    "sand.seed": "numerics.seed",
    "beam.span": "roof.span",
    "beam.axis.x": "roof.span",
    "beam.axis.y": "roof.span and numerics.elements",
    "beam.section.area": "roof.section and cushion.effective_width",
    "beam.section.second_moment": "roof.section and cushion.effective_width",
    "beam.section.height": "roof.section",
    "beam.elastic_modulus": "roof.elastic_modulus",
    "beam.supports": "supports.kind",
    "beam.support.stiffness": "supports.stiffness and cushion.effective_width",
    "beam.deck.mass": "roof.slab",
    **dict.fromkeys(("box_left", "sand.box.left", "beam.box.left"), "cushion.width"),
    **dict.fromkeys(("box_width", "sand.box.width", "beam.box.width"), "cushion.width"),
}
"""Parameters that follow from fields of the project, and cannot be set apart from them."""
_FOLLOW_FALL: Mapping[str, str] = {
    "rock.radius": "rock.mass, rock.size and rock.density",
    "sand.rock.radius": "rock.mass, rock.size and rock.density",
    "rock_radius": "rock.mass, rock.size and rock.density",
    "rock_mass": "rock.mass",
    "sand.rock.mass": "rock.mass",
    "rock.position0.x": "rock.place",
    "rock.position0.y": "cushion.thickness and numerics.clearance",
    "rock.velocity0.x": "rock.velocity and rock.angle",
    "rock.velocity0.y": "rock.drop_height, or rock.velocity",
    "rock.angular_velocity0": "rock.spin",
}
"""Those of a rock that falls."""
_OF_SLOPE = ("rock_radius", "rock_mass", "sand.rock.radius", "sand.rock.mass")
_WALLS = ("sand.box.wall_height", "sand.box.wall_thickness")
_FREE = ("internal_step", "lead_time")
"""Parameters of a rock from a slope that may be set."""


def prepared(project: SiteLike, changes: Mapping[str, Any] | None = None) -> PreparedShed:
    """Read and check a project, and carry out the campaign of its slope where it has one.

    Parameters
    ----------
    project : path, mapping or ShedProject
        Project file (TOML), or its content.
    changes : mapping of str to Any, optional
        Fields that replace those of the project.

    Returns
    -------
    PreparedShed

    Raises
    ------
    InputRefused
        Everything that is wrong with the project or its slope.
    """
    return prepare(project, changes, _rock_of_slope)


def _rock_of_slope(
    project: ShedProject, source: SiteSource, cushioned: Cushioned, problems: list[Problem]
) -> SlopeRock | None:
    from .below_slope import rock_of_slope  # needs numba, which a rock that falls does not

    return rock_of_slope(project, source, cushioned, problems)


def shed_case(shed: PreparedShed) -> Case:
    """Return the case of a project.

    Parameters
    ----------
    shed : PreparedShed
        The project with all its numbers.

    Returns
    -------
    Case
        To be run as those of the catalogue.
    """
    found = shed.layout
    words = shed.project.description or in_words(found)
    if shed.slope is not None and not shed.project.description:
        origin = shed.slope.origin
        words += f"; the rock is trial {origin.trial} on the slope {origin.slope.name}"
    made = Case(
        shed.name,
        words,
        models={
            "sand": "SandCushion",
            "rock": "SlopeRockfall" if shed.slope else "FallingRock",
            "beam": "RBSMBeam",
            **dict.fromkeys(_of_supports(found, "rod"), "PileRod"),
            **dict.fromkeys(_of_supports(found, "ground"), "ImpulsiveGround"),
        },
        sizes={
            "sand": {"discs": found.discs, "elements": found.elements},
            "beam": {"elements": found.elements},
            **_cells(shed),
            **dict.fromkeys(_of_supports(found, "rod"), rod_sizes(found)),
        },
        couplings={
            "impulse": "sand first, kinematics extrapolated, mean forces, exchange every "
            f"{found.exchange_step / ms:g} ms"
        },
        coupling=shed.project.numerics.coupling,
        make=partial(_make, shed, words),
        one_size=("sand.elements", "beam.elements"),
        derived=partial(_derived, found),
        follows={name: f"the project's {fields}" for name, fields in _follows(shed).items()},
        facts={"project": _project(shed), "design": design(shed.project, found), **_told(shed)},
        warnings=shed.warnings,
        files=None if shed.slope is None else partial(_keep, shed.slope),
    )
    return with_implicit(made)


def _follows(shed: PreparedShed) -> Mapping[str, str]:
    """Return the parameters that follow from fields of a project, and these fields."""
    if shed.slope is None:
        return {**FOLLOWS, **_FOLLOW_FALL}
    every = component("SlopeRockfall").layout.variables
    names = [v.name for v in every if v.causality is Causality.PARAMETER and v.name not in _FREE]
    of_slope = [*(f"rock.{name}" for name in names), *_OF_SLOPE]
    return {
        **FOLLOWS,
        **dict.fromkeys(of_slope, "slope, and its file"),
        **dict.fromkeys(_WALLS, "cushion.thickness"),
    }


def _cells(shed: PreparedShed) -> dict[str, dict[str, int]]:
    """Return the size of the slope; nothing where there is none."""
    if shed.slope is None:
        return {}
    return {"rock": {"cells": len(shed.slope.origin.slope.nodes) - 1}}


def _told(shed: PreparedShed) -> dict[str, Any]:
    """Return campaign and choice of a slope for the provenance; nothing where there is none."""
    if shed.slope is None or shed.project.slope is None:
        return {}
    from .below_slope import told  # needs numba

    return {"slope": told(shed.slope.origin, shed.project.slope)}


def _keep(slope: SlopeRock, folder: Path) -> None:
    """Write the campaign of a slope into the folder of a run."""
    from ..campaigns.keeping import keep  # needs numba

    keep(slope.origin, folder / CAMPAIGN)


def _make(
    shed: PreparedShed,
    words: str,
    fmus: Mapping[str, str],
    sizes: ComponentSizes,
    coupling: str,
) -> SystemSpec:
    """Return the system; rock, sand and beam in one frame, whose origin is the left support."""
    watched = ("transmitted_force", "rock.force.y", "penetration", "clearance")
    found = shed.layout
    system = SystemSpec(
        name=shed.name,
        description=words,
        components={
            "sand": ComponentSpec(fmu=fmus["sand"], record_states=True, parameters=_sand(found)),
            "rock": ComponentSpec(fmu=fmus["rock"], parameters=_rock(shed)),
            "beam": ComponentSpec(fmu=fmus["beam"], parameters=_beam(found)),
        },
        shared=_shared(found),
        connections=impact_connections(_PARTNERS),
        bonds=impact_bonds(_PARTNERS),
        energy_alarm=EnergyAlarm(share=0.005, reference="rock.energy.kinetic"),
        master="sequential",
        order=["sand", *_PARTNERS],
        stop_time=found.stop_time,
        exchange_step=found.exchange_step,
        output_interval=found.output_interval,
        state_interval=found.state_interval,
        watch=[f"sand.{name}" for name in watched]
        + ["beam.midspan.deflection", "beam.energy.elastic", "beam.energy.strain_estimate"],
    )
    return system if found.rod is None else on_rods(system, found.rod, fmus, found.exchange_step)


def _of_supports(found: ShedLayout, part: str) -> list[str]:
    """Return the components under the two ends of the roof; none where nothing gives way."""
    return [f"{part}_{side}" for side in SIDES] if found.rod else []


def _derived(found: ShedLayout, system: SystemSpec, sizes: ComponentSizes) -> Mapping[str, Value]:
    """Return the weight of the sand, and what supports that give way carry at rest."""
    values = dict(weight_on_beam(system, sizes))
    if found.rod is None:
        return values
    roof = found.roof
    deck = found.cushion.effective_width * roof.deck_mass
    mass = roof.span * (found.girders * roof.density * roof.area + deck)
    gravity = float(system.shared["gravity"].value)
    at_head = 0.5 * (mass * gravity + float(values["beam.cushion.weight"]))
    stiffness = end_stiffness(roof, found.girders, found.element)
    return values | loads_at_rest(at_head, stiffness, found.rod)


def _sand(found: ShedLayout) -> dict[str, Value]:
    """Return the parameters of the sand: those of its model, its material and its place."""
    cushion = found.cushion
    soil = Soil(float(cushion.sand.cohesion or 0.0), float(cushion.sand.solid_fraction or 0.0))
    layer = SandLayer(
        cushion.width,
        cushion.thickness,
        found.disc_radius,
        found.rock.radius,
        found.rock.speed,
        soil,
        found.stop_time,
        dropped=False,
        on_beam=True,
    )
    of_model = changes(sand_model(MODEL), layer).values
    return {
        **{name.removeprefix("sand."): value for name, value in of_model.items()},
        "modulus": float(cushion.sand.modulus or 0.0),
        "density": float(cushion.sand.density or 0.0),
        "friction_angle": float(cushion.sand.friction_angle or 0.0),
        "thickness": cushion.effective_width,
        "disc.radius": found.disc_radius,
        "seed": found.seed,
        "surface": "levelled",
        "kinematics": "linear",
        "forces": "mean",
        "internal_step": found.sand_step,
        **_walls(found),
    }


def _walls(found: ShedLayout) -> dict[str, Value]:
    """Return the walls over which a rock from a slope comes in; others have no upper end."""
    if found.arrival is None:
        return {}
    return {
        "box.wall_height": WALL_HEIGHT * found.cushion.thickness,
        "box.wall_thickness": WALL_THICKNESS,
    }


def _rock(shed: PreparedShed) -> dict[str, Value]:
    """Return the parameters of the rock; mass, radius and gravity are shared values."""
    found = shed.layout
    if shed.slope is not None and shed.project.slope is not None:
        from .below_slope import slope_values  # needs numba

        values = slope_values(shed.slope.origin, shed.project.slope)
        return {**values, "internal_step": found.sand_step}
    return {
        "position0.x": found.start_x,
        "position0.y": found.start_y,
        "velocity0.x": found.rock.velocity_x,
        "velocity0.y": found.start_velocity_y,
        "angular_velocity0": found.rock.spin,
        "internal_step": found.sand_step,
    }


def _beam(found: ShedLayout) -> dict[str, Value]:
    """Return the parameters of all girders that take part, as one beam."""
    roof = found.roof
    line = roof.corners.parameters(found.girders) if roof.corners else {}
    return {
        **line,
        "span": roof.span,
        "axis.y": found.axis_y,
        "supports": roof.supports,
        "support.stiffness": found.girders * roof.support_stiffness,
        "elastic_modulus": roof.elastic_modulus,
        "section.area": found.girders * roof.area,
        "section.second_moment": found.girders * roof.second_moment,
        "section.height": roof.height,
        "density": roof.density,
        "deck.mass": roof.deck_mass * found.cushion.effective_width,
        "damping.stiffness": found.beam_damping,
        "internal_step": found.beam_step,
    }


def _shared(found: ShedLayout) -> dict[str, SharedValue]:
    """Return the values that several components take: one rock, one gravity, one box."""
    boxed = ("sand", "beam")
    return {
        "gravity": SharedValue(
            value=standard_gravity, targets=[f"{name}.gravity" for name in ("sand", *_PARTNERS)]
        ),
        "rock_mass": SharedValue(value=found.rock.mass, targets=["rock.mass", "sand.rock.mass"]),
        "rock_radius": SharedValue(
            value=found.rock.radius, targets=["rock.radius", "sand.rock.radius"]
        ),
        "box_left": SharedValue(
            value=found.box_left, targets=[f"{name}.box.left" for name in boxed]
        ),
        "box_width": SharedValue(
            value=found.cushion.width, targets=[f"{name}.box.width" for name in boxed]
        ),
        "beam_radius": SharedValue(value=0.5 * found.element, targets=["sand.beam.radius"]),
    }


def _project(shed: PreparedShed) -> dict[str, Any]:
    """Return the project as the provenance of a run keeps it."""
    derived = asdict(shed.layout)
    sand = shed.layout.cushion.sand.model_dump(exclude={"like"})
    return {
        "file": str(shed.source.file) if shed.source.file else "",
        "content": dict(shed.source.content),
        "derived": {**derived, "cushion": {**derived["cushion"], "sand": sand}},
    }


def design(project: ShedProject, found: ShedLayout) -> dict[str, Any]:
    """Return what the results of a shed are compared with.

    Parameters
    ----------
    project : ShedProject
        With the criteria.
    found : ShedLayout
        The numbers.

    Returns
    -------
    dict
        ``rock``, ``cushion``, ``roof`` of one girder, and ``criteria``, in SI units; ``notes``,
        what a reader has to know.
    """
    rock, cushion, roof = found.rock, found.cushion, found.roof
    text = caution(project.material, cushion.material)
    return {
        "rock": {
            "mass": rock.mass,
            "radius": rock.radius,
            "density": rock.density,
            "speed": rock.speed,
            "drop_height": rock.drop_height,
        },
        "cushion": {
            "thickness": cushion.thickness,
            "width": cushion.width,
            "effective_width": cushion.effective_width,
            "rule": cushion.rule,
            "materials": {cushion.material: cushion.sand.model_dump(exclude={"like"})},
        },
        "roof": {
            "kind": roof.kind,
            "section": roof.section,
            "area": roof.area,
            "second_moment": roof.second_moment,
            "section_modulus": roof.section_modulus,
            "plastic_modulus": roof.plastic_modulus,
            "height": roof.height,
            "yield_stress": roof.yield_stress,
            "girders": found.girders,
            "spacing": roof.spacing,
            "span": roof.span,
        },
        "criteria": [
            {"name": name, "limit": limit, "unit": unit}
            for name, limit, unit in _criteria(project, found)
            if limit is not None
        ],
        "notes": [*_remarks(found), *([text] if text else [])],
    }


def _remarks(found: ShedLayout) -> list[str]:
    """Return what a reader of the results has to know of the section."""
    roof = found.roof
    if roof.kind != "concrete":
        return []
    bears = f"{roof.hogging_capacity * found.girders / kN:.4g} kN m"
    if roof.hogging_capacity > roof.cracking_moment:
        return [
            f"bars above as given: in hogging the strip bears {bears}; between cracking and yield "
            "its stiffness is taken as in sagging"
        ]
    return [
        "no bars above, or too few (roof.concrete.top_bar_diameter): in hogging the strip bears "
        f"{bears}, which cracks it, and breaks past that (criterion curvature)"
    ]


def _criteria(project: ShedProject, found: ShedLayout) -> list[tuple[str, float | None, str]]:
    """Return name, limit and unit of the criteria; None where there is no limit.

    The curvature of concrete counts in that at which it crushes.
    """
    given = project.criteria
    roof = found.roof
    stress = given.stress
    moment = given.plastic_moment
    concrete = roof.kind == "concrete"
    crushing = 1.0 if concrete and roof.corners else None
    hogging = roof.hogging_capacity * found.girders if concrete else None
    if roof.yield_stress is not None:
        stress = stress or (roof.yield_stress if roof.kind == "girders" else None)
        moment = moment or roof.yield_stress * roof.plastic_modulus * found.girders
    return [
        ("stress", stress, "Pa"),
        ("sagging moment" if concrete else "plastic moment", moment, "N.m"),
        ("hogging moment", hogging, "N.m"),
        ("curvature", crushing, "1"),
        ("deflection", given.deflection_of(roof.span), "m"),
        ("pile set", given.pile_set, "m"),
        ("penetration", given.penetration or found.cushion.thickness, "m"),
    ]
