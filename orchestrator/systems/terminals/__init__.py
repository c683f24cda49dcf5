"""Two bodies on springs and a spring between them, connected by their terminals."""

from pathlib import Path

from ...core.system.reading import system_from
from ...core.system.system import SystemSpec
from ..parts.mass import COMPONENT as MASS
from ..parts.spring import COMPONENT as SPRING
from ..system import ExchangeOrder, FmuPart, FmuPaths, ImpactSystem
from .truth import JOINING, MASSES, SPEED, SPRINGS, upper_position


def make(files: FmuPaths, step: float, scheme: ExchangeOrder) -> SystemSpec:
    """Return the bodies and the spring between; each connection joins two terminals."""
    lower = {"mass": MASSES[0], "stiffness": SPRINGS[0], "velocity0.y": SPEED}
    upper = {"mass": MASSES[1], "stiffness": SPRINGS[1]}
    joint = {"stiffness": JOINING, "tension_ratio": 1.0}
    return system_from(
        {
            "name": "terminals",
            "components": {
                "joint": {"fmu": files["joint"], "parameters": joint},
                "lower": {"fmu": files["lower"], "parameters": lower},
                "upper": {"fmu": files["upper"], "parameters": upper},
            },
            "connections": ["joint.lower <-> lower.body", "joint.upper <-> upper.body"],
            "bonds": {
                end: {
                    "giver": "joint",
                    "force": [f"{end}.force.y"],
                    "taker": end,
                    "position": ["position.y"],
                }
                for end in ("lower", "upper")
            },
            "master": scheme,
            "exchange_step": step,
            "stop_time": SYSTEM.stop_time,
        }
    )


SYSTEM = ImpactSystem(
    name="terminals",
    title="Two bodies and a spring, connected by terminals",
    folder=Path(__file__).parent,
    parts={"joint": FmuPart(SPRING), "lower": FmuPart(MASS), "upper": FmuPart(MASS)},
    make=make,
    quantity="upper.position.y",
    unit="m",
    truth=upper_position,
    stop_time=0.16,
    steps=(2e-3, 1e-3, 5e-4, 1.25e-4),
    step=1.25e-4,
    tolerance=0.06,
    energies=(
        "lower.energy.kinetic",
        "lower.energy.elastic",
        "upper.energy.kinetic",
        "upper.energy.elastic",
        "joint.energy.elastic",
    ),
    impact_energy=0.5 * MASSES[0] * SPEED**2,
    start_energy=0.5 * MASSES[0] * SPEED**2,
    moments={"joint.*": "middle"},
)
