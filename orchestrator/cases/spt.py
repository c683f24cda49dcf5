"""The standard penetration test of Uto et al., table 1: hammer, rod and ground as three FMUs.

A ram of 63.5 kg falls 75 cm on a rod. The length of the rod is not in the table: 10.24 m, in which a wave travels for 2 ms. The
ground under the sampler is Smith's, with a resistance of 20 kN, which is assumed, and Smith's quake and damping.
"""

from collections.abc import Mapping
from typing import Literal

from rockshed.components.common.units import cm, cm2, mm

from ..core.system.system import ComponentSpec, Connection, EnergyAlarm, PowerBond, System, Value

NAME = "spt"
Coupling = Literal["waves", "plain"]
COUPLINGS: Mapping[str, tuple[str, float]] = {
    "waves": ("waves", 1e-4),
    "plain": ("kinematics", 1e-5),
}
"""Kind of the toe's port and exchange step (s). The hammer, rigid and without cushion, needs waves in both."""

MASS, DROP = 63.5, 75 * cm
AREA, DENSITY, SPEED = 5.8 * cm2, 7850.0, 5120.0
LENGTH = 2e-3 * SPEED
SEGMENTS = 200
"""Of 0.01 ms travel time, a tenth of the exchange step."""
RESISTANCE, QUAKE, DAMPING = 20e3, 2.5 * mm, 0.5
STOP = 0.03


def spt_system(
    fmus: Mapping[str, str], coupling: str = "waves", segments: int = SEGMENTS
) -> System:
    """The test as a co-simulation of ``hammer``, ``ground`` and ``rod``, in this order: the rod comes last, so that it makes a step
    with the forces that its partners had in it.

    Displacements, velocities and forces at head and toe count downwards and in compression. segments: those that ``rod`` was built
    with.
    """
    port, exchange = COUPLINGS[coupling]
    sections = ("length", "area", "modulus", "density")
    values = (LENGTH, AREA, DENSITY * SPEED**2, DENSITY)
    return System(
        name=NAME,
        description="standard penetration test, 63.5 kg from 75 cm on a rod of 10.24 m (Uto et al., table 1)",
        master="sequential",
        order=["hammer", "ground", "rod"],
        components={
            "hammer": ComponentSpec(
                fmu=fmus["hammer"],
                parameters={
                    "mass": MASS,
                    "drop_height": DROP,
                    "port": "waves",
                    "internal_step": 1e-6,
                },
            ),
            "rod": ComponentSpec(
                fmu=fmus["rod"],
                parameters={
                    **{
                        f"section.{name}[1]": value
                        for name, value in zip(sections, values, strict=True)
                    },
                    "head.port": "waves",
                    "toe.condition": "port",
                    "toe.port": port,
                    "exchange": "sequential",
                },
            ),
            "ground": ComponentSpec(
                fmu=fmus["ground"],
                parameters={
                    "port": "wave" if port == "waves" else port,
                    "law": "smith",
                    "ultimate_resistance": RESISTANCE,
                    "quake": QUAKE,
                    "damping": DAMPING,
                    "internal_step": 1e-5,
                },
            ),
        },
        connections=[*hammer_connections("hammer", "rod"), *toe_connections("rod", "ground")],
        bonds={"hammer_rod": hammer_bond("hammer", "rod"), "ground_rod": toe_bond("rod", "ground")},
        energy_alarm=EnergyAlarm(share=0.01, reference="hammer.energy.kinetic"),
        stop_time=STOP,
        exchange_step=exchange,
        output_interval=1e-4,
        record=["hammer.*", "ground.*", "rod.head.*", "rod.toe.*", "rod.energy.*", "rod.stress.*"],
        watch=["rod.head.contact_force", "rod.toe.contact_force", "ground.settlement"],
    )


def hammer_connections(hammer: str, rod: str) -> list[Connection]:
    """A hammer on the head of a rod, by waves."""
    return [
        *(
            Connection(source=f"{rod}.head.{name}", target=f"{hammer}.head.{name}")
            for name in ("wave", "impedance")
        ),
        Connection(source=f"{hammer}.force", target=f"{rod}.head.force"),
    ]


def toe_connections(rod: str, ground: str) -> list[Connection]:
    """The ground under the toe of a rod. Motion and waves are both connected: the ports take what they need."""
    return [
        *(
            Connection(source=f"{rod}.toe.{name}", target=f"{ground}.toe.{name}")
            for name in ("wave", "impedance", "position", "velocity")
        ),
        Connection(source=f"{ground}.toe.mean_force", target=f"{rod}.toe.force"),
    ]


def hammer_bond(hammer: str, rod: str) -> PowerBond:
    """The interface at the head."""
    return PowerBond(
        giver=hammer,
        force=["force"],
        taker=rod,
        position=["head.position"],
        work="energy.work.head",
    )


def toe_bond(rod: str, ground: str) -> PowerBond:
    """The interface at the toe, whose force presses upwards."""
    return PowerBond(
        giver=ground,
        force=["toe.mean_force"],
        taker=rod,
        position=["toe.position"],
        work="energy.work.contact",
        opposed=True,
    )


def partner_stiffness(system: System) -> dict[str, Value]:
    """The stiffness R_u/Q of the ground, which a rod with a plain toe has to know for its limit."""
    ground = system.components["ground"].parameters
    return {
        "rod.toe.partner.stiffness": float(ground["ultimate_resistance"]) / float(ground["quake"])
    }
