"""A rock shed on piles: an impact on girders whose supports stand on two driven rods in the ground.

The impact is that of Sonoda et al., whose supports are rigid; piles and soil are assumed. Static
weight: the girders start bent under their own weight and that of the sand, at rest. Each rod
carries half of it at its head from the start on (``head.preload``), the ground under it that and
the weight of the rod (``preload``): Smith's spring at the toe is compressed by it, the shaft
carries nothing at rest. Rods and ground count displacements, waves and stresses from there, so
gravity is 0 in them.
"""

from collections.abc import Mapping
from dataclasses import dataclass

from rockshed.components.common.units import cm2, kgf, standard_gravity

from ..core.system.fields import Value
from ..core.system.parts import ComponentSpec, Connection, PowerBond
from ..core.system.system import SystemSpec
from . import full_scale
from .iterated import IteratedTimes
from .spt import toe_bond, toe_connections

NAME = "shed-on-piles"
GIRDERS = "girders-8"
SIDES = ("left", "right")
COUPLING = (
    "sand first, rods last, kinematics extrapolated, mean forces, waves at the toes, exchange "
    "every 0.005 ms"
)
"""Scheme of exchange in words."""
EXCHANGE = 5e-6
"""Exchange step (s), a fifth of the limit Z/k of a rod under the end of the girders.

The sand takes it too, with the impulse-conserving scheme: a longer step of its own would show its
forces late, which costs 1.6 % of the impact energy at 0.2 ms.
"""
WINDOW = IteratedTimes(exchange_step=1e-5, length=4e-4)
"""Times of the scheme ``implicit`` (s): the longest exchange step at which an explicit master is
stable, and a window of 40 of these, which 6 to 8 iterations make fit together."""


@dataclass(frozen=True)
class Pile:
    """A concrete pile of 50 cm in its soil.

    Attributes
    ----------
    length, area : float
        Of the rod (m, m2).
    speed, density : float
        Wave speed and density of the rod (m/s, kg/m3).
    shaft, toe : float
        Resistances of the soil (N).
    quake : float
        Of shaft and toe (m).
    shaft_damping, toe_damping : float
        Smith's damping (s/m).
    """

    length: float = 10.0
    area: float = 0.196
    speed: float = 4000.0
    density: float = 2400.0
    shaft: float = 200e3
    toe: float = 250e3
    quake: float = 2.5e-3
    shaft_damping: float = 0.16
    toe_damping: float = 0.5

    @property
    def segments(self) -> int:
        """Number of segments, of the travel time of an exchange step each."""
        return round(self.length / self.speed / EXCHANGE)

    @property
    def weight(self) -> float:
        """Weight of the rod (N), without the soil."""
        return self.length * self.area * self.density * standard_gravity


PILE = Pile()


def shed_system(
    fmus: Mapping[str, str], discs: int, elements: int, segments: int = PILE.segments
) -> SystemSpec:
    """Return the shed as a co-simulation of impact, two rods and the ground under each.

    The components are ``sand``, ``rock``, ``beam``, ``rod_left``, ``ground_left``, ``rod_right``
    and ``ground_right``; the rods come last.

    Parameters
    ----------
    fmus : mapping of str to str
        Files of the FMUs by component.
    discs, elements, segments : int
        Sizes that sand, beam and rods were built with.

    Returns
    -------
    SystemSpec
        The co-simulation.
    """
    base = full_scale.full_scale_system(
        fmus, full_scale.impacts()[GIRDERS], "impulse", discs, elements
    )
    girders = base.components["beam"]
    undamped = {**girders.parameters, "damping.stiffness": 0.0}
    components = {**base.components, "beam": girders.model_copy(update={"parameters": undamped})}
    connections = list(base.connections)
    bonds = dict(base.bonds)
    for number, side in enumerate(SIDES, 1):
        rod = f"rod_{side}"
        ground = f"ground_{side}"
        components[rod] = ComponentSpec(fmu=fmus[rod], parameters=_rod(segments))
        components[ground] = ComponentSpec(fmu=fmus[ground], parameters=_ground())
        connections += [*support_connections("beam", number, rod), *toe_connections(rod, ground)]
        bonds[f"beam_{rod}"] = support_bond("beam", number, rod)
        bonds[f"{ground}_{rod}"] = toe_bond(rod, ground)
    grounds = [f"ground_{side}" for side in SIDES]
    rods = [f"rod_{side}" for side in SIDES]
    recorded = [f"{rod}.{part}.*" for rod in rods for part in ("head", "toe", "energy", "stress")]
    return base.model_copy(
        update={
            "name": NAME,
            "description": "1 tf from 10 m on 90 cm of crushed sand on girders of 8 m that stand "
            "on two piles",
            "components": components,
            "connections": connections,
            "bonds": bonds,
            "order": ["sand", "rock", "beam", *grounds, *rods],
            "exchange_step": EXCHANGE,
            "record": [f"{name}.*" for name in ("sand", "rock", "beam", *grounds)] + recorded,
            "watch": [
                *base.watch,
                *(f"{rod}.head.contact_force" for rod in rods),
                *(f"{ground}.settlement" for ground in grounds),
            ],
        }
    )


def support_bond(beam: str, number: int, rod: str) -> PowerBond:
    """Return the interface of a support of a beam with the head of a rod.

    Parameters
    ----------
    beam, rod : str
        Names of the components.
    number : int
        Of the support, from 1.

    Returns
    -------
    PowerBond
        The beam computes the force.
    """
    return PowerBond(
        giver=beam,
        force=[f"support.mean_force.y[{number}]"],
        taker=rod,
        position=["head.position"],
        work=f"support.work[{number}]",
    )


def _ground() -> dict[str, Value]:
    """Return the parameters of the ground under a rod."""
    return {
        "port": "wave",
        "law": "smith",
        "ultimate_resistance": PILE.toe,
        "quake": PILE.quake,
        "damping": PILE.toe_damping,
        "internal_step": EXCHANGE,
    }


def _rod(segments: int) -> dict[str, Value]:
    """Return the parameters of a rod.

    The last segment has no shaft resistance: the toe's port of waves needs one that reflects
    nothing.
    """
    return {
        "section.length[1]": PILE.length,
        "section.area[1]": PILE.area,
        "section.modulus[1]": PILE.density * PILE.speed**2,
        "section.density[1]": PILE.density,
        "head.port": "kinematics",
        "head.direction": "up",
        "toe.condition": "port",
        "toe.port": "waves",
        "exchange": "sequential",
        "shaft.quake[*]": PILE.quake,
        "shaft.damping[*]": PILE.shaft_damping,
        **{f"shaft.resistance[{i}]": PILE.shaft / (segments - 1) for i in range(1, segments)},
    }


def support_connections(beam: str, number: int, rod: str) -> list[Connection]:
    """Return the connections of a support of a beam with the head of a rod that counts upwards.

    Parameters
    ----------
    beam, rod : str
        Names of the components.
    number : int
        Of the support, from 1.

    Returns
    -------
    list of Connection
        Mean force to the rod, motion to the beam.
    """
    return [
        Connection(source=f"{beam}.support.mean_force.y[{number}]", target=f"{rod}.head.force"),
        Connection(source=f"{rod}.head.position", target=f"{beam}.support.position.y[{number}]"),
        Connection(source=f"{rod}.head.velocity", target=f"{beam}.support.velocity.y[{number}]"),
    ]


def derived(system: SystemSpec, discs: int, elements: int) -> dict[str, Value]:
    """Return the weights at rest, and the stiffness of the girders' end, 4 EI/R3.

    The rods must know that stiffness for their limit.

    Parameters
    ----------
    system : SystemSpec
        The shed.
    discs, elements : int
        Sizes of sand and beam.

    Returns
    -------
    dict of str to Value
        By ``component.parameter``.
    """
    beam = system.components["beam"].parameters
    cushion = float(beam.get("cushion.weight", full_scale.cushion_weight(system, discs)))
    span, density = float(beam["span"]), float(beam.get("density", 7850.0))
    mass = (
        density * float(beam["section.area"]) + float(beam.get("deck.mass", 0.0))
    ) * span + float(beam.get("box.mass", 0.0))
    at_head = 0.5 * (mass * float(system.shared["gravity"].value) + cushion)
    stiffness = (
        4.0
        * float(beam.get("elastic_modulus", _STEEL))
        * float(beam["section.second_moment"])
        / (span / elements) ** 3
    )
    values: dict[str, Value] = {"beam.cushion.weight": cushion}
    for side in SIDES:
        values |= {
            f"rod_{side}.head.preload": at_head,
            f"rod_{side}.head.partner.stiffness": stiffness,
            f"ground_{side}.preload": at_head + PILE.weight,
        }
    return values


_STEEL = 2.1e6 * kgf / cm2
"""Young's modulus (Pa) that RBSMBeam has where none is given."""
