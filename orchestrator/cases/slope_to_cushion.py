"""A rock from its slope onto the cushion of a rock shed.

The slope is ``examples/shed.toml``, above the girders of Sonoda et al. (1993). The rock is a trial
of the campaign over that slope: of the rocks that land on the cushion the one at the 95th
percentile of the kinetic energy. It comes in obliquely, over the side wall, is handed over above
the sand, and may bounce and go on along the slope.
"""

import tomllib
from collections.abc import Mapping
from functools import cache
from pathlib import Path

from rockshed.components.common.component import Instance
from rockshed.components.common.units import cm, cm2, kgf

from ..core.system.fields import Value
from ..core.system.parts import ComponentSpec, SharedValue
from ..core.system.system import SystemSpec
from .full_scale import GIRDER_THICKNESS, Impact, full_scale_system, layer
from .sand_models import SandLayer
from .slope_parameters import site_parameters

SITE = Path(__file__).parents[1] / "examples" / "shed.toml"
LINE = "cushion"
"""Search line that the rocks pass as they land on the cushion."""
SHARE = 0.95
"""Percentile of the kinetic energy of the rocks there."""
TRIAL = 7649
"""The trial at this percentile in the site's 10,000; a test finds it again."""

IMPACT = Impact(
    "slope-to-cushion",
    "95th-percentile rock of a 35 m slope on 90 cm of crushed sand on H-300x400 girders of 10 m",
    100.0 * kgf / cm2,
    10.0,
    GIRDER_THICKNESS,
    0.6,
    10.0,
)
"""The girders of the case ``girders-10`` with sand on their whole length, as on a roof.

The rock is that of the site.
"""
WALL_HEIGHT, WALL_THICKNESS = 89 * cm, 50 * cm
"""Height and thickness (m) of the walls of the roof.

A little lower than the ground on the uphill side, which does not touch the wall; as wide as rocks
need that are on their way off.
"""
LEAD_TIME = 5e-3
"""Time (s) from the start to the hand-over."""
_MARGIN = 5 * cm


@cache
def cells() -> int:
    """Return the number of cells of the site's slope.

    Each begins at a node that names its material.
    """
    with SITE.open("rb") as file:
        return len(tomllib.load(file)["profile"]["points"]) - 1


@cache
def _site() -> Instance:
    """Return the site as an initialised component, as its campaign has it."""
    from ..sites.rockfall.preparation import prepare  # imports numba, which other cases need not

    return prepare(SITE).instance


def receiver(radius: float) -> dict[str, Value]:
    """Return the box in which the rock is handed over.

    It reaches between the outer faces of the walls, and on the downhill side until the rock has
    fallen clear of them; its upper side is the search line.

    Parameters
    ----------
    radius : float
        Of the rock (m).

    Returns
    -------
    dict of str to Value
        By the name of the parameter of the slope.
    """
    with SITE.open("rb") as file:
        line = next(entry for entry in tomllib.load(file)["line"] if entry["name"] == LINE)
    return {
        "receiver.present": True,
        "receiver.left": -WALL_THICKNESS + _MARGIN,
        "receiver.bottom": -1.0,
        "receiver.right": IMPACT.width + WALL_THICKNESS + radius + _MARGIN,
        "receiver.top": line["points"][0][1],
    }


def slope_system(
    fmus: Mapping[str, str],
    coupling: str = "paper",
    discs: int | None = None,
    elements: int | None = None,
) -> SystemSpec:
    """Return slope, sand and girders as a co-simulation.

    The origin is the left support, below the surface of the beam.

    Parameters
    ----------
    fmus : mapping of str to str
        Files of the FMUs by component.
    coupling : str
        ``paper`` or ``impulse``.
    discs, elements : int, optional
        Sizes that ``sand`` and ``beam`` were built with, by default those of the impact.

    Returns
    -------
    SystemSpec
        The co-simulation.
    """
    system = full_scale_system(fmus, IMPACT, coupling, discs, elements)
    site = _site()
    sand = system.components["sand"]
    step = system.components["rock"].parameters["internal_step"]
    rock = {**_rock_parameters(site), "internal_step": step}
    roof = {
        "box.wall_height": WALL_HEIGHT,
        "box.wall_thickness": WALL_THICKNESS,
    }
    return system.model_copy(
        update={
            "description": IMPACT.summary,
            "shared": _shared(system, site),
            "components": {
                **system.components,
                "rock": ComponentSpec(fmu=fmus["rock"], parameters=rock),
                "sand": sand.model_copy(update={"parameters": {**sand.parameters, **roof}}),
            },
        }
    )


def _shared(system: SystemSpec, site: Instance) -> dict[str, SharedValue]:
    """Return the shared values of the impact, those of the rock as the site has them."""
    return {
        name: value.model_copy(update={"value": site[name.removeprefix("rock_")]})
        if name.startswith("rock_")
        else value
        for name, value in system.shared.items()
    }


def _rock_parameters(site: Instance) -> dict[str, Value]:
    """Return the parameters of the rock on its slope; mass and radius are shared values."""
    own = site_parameters(site)
    slope = {name: own[name] for name in own if name not in ("mass", "radius")}
    return {**slope, "trial": TRIAL, "lead_time": LEAD_TIME, **receiver(site["radius"])}


def sand_layer() -> SandLayer:
    """Return the sand of the roof, for the models of it."""
    return layer(IMPACT, dropped=False)
