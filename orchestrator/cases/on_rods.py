"""A roof whose supports stand on rods in the ground: the components under its two ends."""

from collections.abc import Mapping

from ..core.system.fields import Value
from ..core.system.parts import ComponentSpec
from ..core.system.system import SystemSpec
from ..sites.shed.foundation import SupportRod
from ..sites.shed.geometry import ShedLayout
from .shed_on_piles import SIDES as SIDES
from .shed_on_piles import support_bond, support_connections
from .spt import toe_bond, toe_connections


def rod_sizes(found: ShedLayout) -> dict[str, int]:
    """Return the sizes of a rod under the roof.

    Parameters
    ----------
    found : ShedLayout
        The shed.

    Returns
    -------
    dict of str to int
        By name; empty where nothing gives way.
    """
    if found.rod is None:
        return {}
    return {"segments": found.rod.segments, "sections": len(found.rod.length)}


def on_rods(
    base: SystemSpec, rod: SupportRod, fmus: Mapping[str, str], exchange: float
) -> SystemSpec:
    """Return a system of sand, rock and beam on two rods and the ground under each.

    Parameters
    ----------
    base : SystemSpec
        The system on rigid supports.
    rod : SupportRod
        Under each end.
    fmus : mapping of str to str
        Files of the FMUs by component.
    exchange : float
        Exchange step (s).

    Returns
    -------
    SystemSpec
        The rods come last.
    """
    components = dict(base.components)
    connections = list(base.connections)
    bonds = dict(base.bonds)
    rods = [f"rod_{side}" for side in SIDES]
    grounds = [f"ground_{side}" for side in SIDES]
    for number, (upper, lower) in enumerate(zip(rods, grounds), 1):
        components[upper] = ComponentSpec(fmu=fmus[upper], parameters=_rod(rod))
        components[lower] = ComponentSpec(fmu=fmus[lower], parameters=_ground(rod, exchange))
        connections += [*support_connections("beam", number, upper), *toe_connections(upper, lower)]
        bonds[f"beam_{upper}"] = support_bond("beam", number, upper)
        bonds[f"{lower}_{upper}"] = toe_bond(upper, lower)
    recorded = [f"{name}.{part}.*" for name in rods for part in ("head", "toe", "energy", "stress")]
    changes = {
        "components": components,
        "connections": connections,
        "bonds": bonds,
        "order": [*base.order, *grounds, *rods],
        "record": [f"{name}.*" for name in ("sand", "rock", "beam", *grounds)] + recorded,
        "watch": [
            *base.watch,
            *(f"{name}.head.contact_force" for name in rods),
            *(f"{name}.settlement" for name in grounds),
        ],
    }
    return base.model_copy(update=changes)


def _rod(rod: SupportRod) -> dict[str, Value]:
    """Return the parameters of a rod; its gravity is 0: it counts from the position at rest."""
    sections = {
        f"section.{name}[{number}]": value
        for name in ("length", "area", "modulus", "density")
        for number, value in enumerate(getattr(rod, name), 1)
    }
    shaft = {
        f"shaft.{name}[{number}]": value
        for name in ("resistance", "quake", "damping")
        for number, value in enumerate(getattr(rod, f"shaft_{name}"), 1)
    }
    return {
        **sections,
        **shaft,
        "head.port": "kinematics",
        "head.direction": "up",
        "toe.condition": "port",
        "toe.port": "waves",
        "exchange": "sequential",
    }


def _ground(rod: SupportRod, exchange: float) -> dict[str, Value]:
    """Return the parameters of the ground under a rod."""
    return {
        "port": "wave",
        "law": "smith",
        "ultimate_resistance": rod.toe_resistance,
        "quake": rod.toe_quake,
        "damping": rod.toe_damping,
        "internal_step": exchange,
    }


def loads_at_rest(at_head: float, end_stiffness: float, rod: SupportRod) -> dict[str, Value]:
    """Return the loads that rods and ground carry at rest, and the stiffness above the rods.

    Parameters
    ----------
    at_head : float
        Load of each end of the roof (N).
    end_stiffness : float
        Of the end of the roof (N/m).
    rod : SupportRod
        Under each end.

    Returns
    -------
    dict of str to Value
        By ``component.parameter``.
    """
    values: dict[str, Value] = {}
    for side in SIDES:
        values |= {
            f"rod_{side}.head.preload": at_head,
            f"rod_{side}.head.partner.stiffness": end_stiffness,
            f"ground_{side}.preload": at_head + rod.weight,
        }
    return values
