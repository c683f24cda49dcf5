"""A rock shed on piles: an impact on girders as in Sonoda et al., whose supports stand on two driven rods with ground under them.

The paper's supports are rigid; piles and soil are assumed. Static weight: the girders start bent under their own weight and that of
the sand, at rest. Each rod carries half of it at its head from the start on (``head.preload``), the ground under it that and the
weight of the rod (``preload``): Smith's spring at the toe is compressed by it, the shaft carries nothing at rest. Rods and ground
count displacements, waves and stresses from there, so gravity is 0 in them.
"""

from collections.abc import Mapping
from dataclasses import dataclass

from ..core.system.system import ComponentSpec, Connection, PowerBond, System, Value
from . import full_scale
from .spt import toe_bond, toe_connections

NAME = "shed-on-piles"
GIRDERS = "girders-8"
SIDES = ("left", "right")
EXCHANGE = 5e-6
"""Exchange step (s), a fifth of the limit Z/k of a rod under the end of the girders. The sand takes it too, with the
impulse-conserving scheme: a longer step of its own would show its forces late, which costs 1.6 % of the impact energy at 0.2 ms."""


@dataclass(frozen=True)
class Pile:
    """A concrete pile of 50 cm: length (m), area (m2), wave speed (m/s), density (kg/m3); soil in N, m, s/m.

    segments: of the travel time of an exchange step each.
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
        """Number of segments."""
        return round(self.length / self.speed / EXCHANGE)

    @property
    def weight(self) -> float:
        """Of the rod (N)."""
        return self.length * self.area * self.density * full_scale.GRAVITY


PILE = Pile()


def shed_system(
    fmus: Mapping[str, str], discs: int, elements: int, segments: int = PILE.segments
) -> System:
    """The shed as a co-simulation of ``sand``, ``rock``, ``beam``, and ``rod_left``, ``ground_left``, ``rod_right``,
    ``ground_right``; the rods come last. Sizes are those that the FMUs were built with.
    """
    base = full_scale.full_scale_system(
        fmus, full_scale.impacts()[GIRDERS], "impulse", discs, elements
    )
    components = dict(base.components)
    connections, bonds = list(base.connections), dict(base.bonds)
    for number, side in enumerate(SIDES, 1):
        rod, ground = f"rod_{side}", f"ground_{side}"
        components[rod] = ComponentSpec(fmu=fmus[rod], parameters=_rod(segments))
        components[ground] = ComponentSpec(
            fmu=fmus[ground],
            parameters={
                "port": "wave",
                "law": "smith",
                "ultimate_resistance": PILE.toe,
                "quake": PILE.quake,
                "damping": PILE.toe_damping,
                "internal_step": EXCHANGE,
            },
        )
        connections += [*support_connections("beam", number, rod), *toe_connections(rod, ground)]
        bonds[f"beam_{rod}"] = PowerBond(
            giver="beam",
            force=[f"support.mean_force.y[{number}]"],
            taker=rod,
            position=["head.position"],
            work=f"support.work[{number}]",
        )
        bonds[f"{ground}_{rod}"] = toe_bond(rod, ground)
    order = [
        "sand",
        "rock",
        "beam",
        *(f"ground_{side}" for side in SIDES),
        *(f"rod_{side}" for side in SIDES),
    ]
    return base.model_copy(
        update={
            "name": NAME,
            "description": "1 tf from 10 m on 90 cm of crushed sand on girders of 8 m that stand on two piles",
            "components": components,
            "connections": connections,
            "bonds": bonds,
            "order": order,
            "exchange_step": EXCHANGE,
            "record": [
                "sand.*",
                "rock.*",
                "beam.*",
                *(f"ground_{side}.*" for side in SIDES),
                *(
                    f"rod_{side}.{what}.*"
                    for side in SIDES
                    for what in ("head", "toe", "energy", "stress")
                ),
            ],
            "watch": [
                *base.watch,
                *(f"rod_{side}.head.contact_force" for side in SIDES),
                *(f"ground_{side}.settlement" for side in SIDES),
            ],
        }
    )


def _rod(segments: int) -> dict[str, Value]:
    """Parameters of a rod. The last segment has no shaft resistance: the toe's port of waves needs one that reflects nothing."""
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
    """A support of a beam on the head of a rod that counts upwards."""
    return [
        Connection(source=f"{beam}.support.mean_force.y[{number}]", target=f"{rod}.head.force"),
        Connection(source=f"{rod}.head.position", target=f"{beam}.support.position.y[{number}]"),
        Connection(source=f"{rod}.head.velocity", target=f"{beam}.support.velocity.y[{number}]"),
    ]


def derived(system: System, discs: int, elements: int) -> dict[str, Value]:
    """The weights at rest, and the stiffness of the girders' end that the rods must know for their limit, 4 EI/R3."""
    beam = system.components["beam"].parameters
    cushion = float(beam.get("cushion.weight", full_scale.cushion_weight(system, discs)))
    span, density = float(beam["span"]), float(beam.get("density", 7850.0))
    mass = (
        density * float(beam["section.area"]) + float(beam.get("deck.mass", 0.0))
    ) * span + float(beam.get("box.mass", 0.0))
    at_head = 0.5 * (mass * float(beam["gravity"]) + cushion)
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


_STEEL = 2.1e6 * 9.80665e4
"""Young's modulus (Pa) that RBSMBeam has where none is given."""
