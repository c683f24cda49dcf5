"""The standard penetration test of Uto et al., table 1: hammer, rod and ground as three FMUs.

A ram of 63.5 kg falls 75 cm on a rod. The length of the rod is not in the table: 10.24 m, in which
a wave travels for 2 ms. The ground under the sampler is Smith's, with a resistance of 20 kN, which
is assumed, and Smith's quake and damping.
"""

from collections.abc import Mapping

from rockshed.components.common.units import cm, cm2, mm

from ..core.system.fields import Value
from ..core.system.parts import ComponentSpec, Connection, EnergyAlarm, PowerBond
from ..core.system.system import SystemSpec

NAME = "spt"
COUPLINGS: Mapping[str, tuple[str, float]] = {
    "waves": ("waves", 1e-4),
    "plain": ("kinematics", 1e-5),
}
"""Kind of the toe's port and exchange step (s) by coupling.

The hammer, rigid and without cushion, needs waves in both.
"""

MASS, DROP = 63.5, 75 * cm
AREA, DENSITY, SPEED = 5.8 * cm2, 7850.0, 5120.0
LENGTH = 2e-3 * SPEED
SEGMENTS = 200
"""Segments of the rod, of 0.01 ms travel time each: a tenth of the exchange step."""
RESISTANCE, QUAKE, DAMPING = 20e3, 2.5 * mm, 0.5
STOP = 0.03


def spt_system(fmus: Mapping[str, str], coupling: str = "waves") -> SystemSpec:
    """Return the test as a co-simulation of ``hammer``, ``ground`` and ``rod``.

    The rod comes last, so that it makes a step with the forces that its partners had in it.
    Displacements, velocities and forces at head and toe count downwards and in compression.

    Parameters
    ----------
    fmus : mapping of str to str
        Files of the FMUs by component.
    coupling : str
        Key of :data:`COUPLINGS`.

    Returns
    -------
    SystemSpec
        The co-simulation.
    """
    port, exchange = COUPLINGS[coupling]
    return SystemSpec(
        name=NAME,
        description="standard penetration test, 63.5 kg from 75 cm on a rod of 10.24 m "
        "(Uto et al., table 1)",
        master="sequential",
        order=["hammer", "ground", "rod"],
        components={
            "hammer": ComponentSpec(fmu=fmus["hammer"], parameters=_hammer()),
            "rod": ComponentSpec(fmu=fmus["rod"], parameters=_rod(port)),
            "ground": ComponentSpec(fmu=fmus["ground"], parameters=_ground(port)),
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


def _hammer() -> dict[str, Value]:
    return {"mass": MASS, "drop_height": DROP, "port": "waves", "internal_step": 1e-6}


def _rod(port: str) -> dict[str, Value]:
    """Return the parameters of the rod; port: kind of its toe's port."""
    return {
        "section.length[1]": LENGTH,
        "section.area[1]": AREA,
        "section.modulus[1]": DENSITY * SPEED**2,
        "section.density[1]": DENSITY,
        "head.port": "waves",
        "toe.condition": "port",
        "toe.port": port,
        "exchange": "sequential",
    }


def _ground(port: str) -> dict[str, Value]:
    """Return the parameters of the ground; port: kind of the rod's toe's port."""
    return {
        "port": "wave" if port == "waves" else port,
        "law": "smith",
        "ultimate_resistance": RESISTANCE,
        "quake": QUAKE,
        "damping": DAMPING,
        "internal_step": 1e-5,
    }


def hammer_connections(hammer: str, rod: str) -> list[Connection]:
    """Return the connections of a hammer with the head of a rod, by waves.

    Parameters
    ----------
    hammer, rod : str
        Names of the components.

    Returns
    -------
    list of Connection
        Wave and impedance to the hammer, force to the rod.
    """
    return [
        *(
            Connection(source=f"{rod}.head.{name}", target=f"{hammer}.head.{name}")
            for name in ("wave", "impedance")
        ),
        Connection(source=f"{hammer}.force", target=f"{rod}.head.force"),
    ]


def toe_connections(rod: str, ground: str) -> list[Connection]:
    """Return the connections of the toe of a rod with the ground under it.

    Motion and waves are both connected: the ports take what they need.

    Parameters
    ----------
    rod, ground : str
        Names of the components.

    Returns
    -------
    list of Connection
        Wave, impedance and motion to the ground, mean force to the rod.
    """
    return [
        *(
            Connection(source=f"{rod}.toe.{name}", target=f"{ground}.toe.{name}")
            for name in ("wave", "impedance", "position", "velocity")
        ),
        Connection(source=f"{ground}.toe.mean_force", target=f"{rod}.toe.force"),
    ]


def hammer_bond(hammer: str, rod: str) -> PowerBond:
    """Return the interface at the head.

    Parameters
    ----------
    hammer, rod : str
        Names of the components.

    Returns
    -------
    PowerBond
        The hammer computes the force.
    """
    return PowerBond(
        giver=hammer,
        force=["force"],
        taker=rod,
        position=["head.position"],
        work="energy.work.head",
    )


def toe_bond(rod: str, ground: str) -> PowerBond:
    """Return the interface at the toe, whose force presses upwards.

    Parameters
    ----------
    rod, ground : str
        Names of the components.

    Returns
    -------
    PowerBond
        The ground computes the force.
    """
    return PowerBond(
        giver=ground,
        force=["toe.mean_force"],
        taker=rod,
        position=["toe.position"],
        work="energy.work.contact",
        opposed=True,
    )


def partner_stiffness(system: SystemSpec) -> dict[str, Value]:
    """Return the stiffness R_u/Q of the ground, which a rod with a plain toe has to know.

    Parameters
    ----------
    system : SystemSpec
        With the resistance (N) and the quake (m) of the ground.

    Returns
    -------
    dict of str to Value
        ``rod.toe.partner.stiffness`` (N/m).
    """
    ground = system.components["ground"].parameters
    return {
        "rod.toe.partner.stiffness": float(ground["ultimate_resistance"]) / float(ground["quake"])
    }
