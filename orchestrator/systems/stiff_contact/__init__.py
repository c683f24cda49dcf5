"""Two bodies and a stiff contact."""

from pathlib import Path

from ...core.system.reading import system_from
from ...core.system.system import SystemSpec
from ..parts.mass import COMPONENT as MASS
from ..parts.spring import COMPONENT as SPRING
from ..system import ExchangeOrder, FmuPart, FmuPaths, ImpactSystem
from .truth import SPEED, STIFFNESS, STRIKER, STRUCK, struck_velocity

CONNECTIONS = [
    "striker.position.y -> contact.lower.position.y",
    "striker.velocity.y -> contact.lower.velocity.y",
    "struck.position.y -> contact.upper.position.y",
    "struck.velocity.y -> contact.upper.velocity.y",
    "contact.lower.force.y -> striker.force.y",
    "contact.upper.force.y -> struck.force.y",
]


def make(files: FmuPaths, step: float, scheme: ExchangeOrder) -> SystemSpec:
    """Return striker, struck body and the contact between them."""
    ends = {"striker": "lower", "struck": "upper"}
    return system_from(
        {
            "name": "stiff-contact",
            "components": {
                "contact": {"fmu": files["contact"], "parameters": {"stiffness": STIFFNESS}},
                "striker": {
                    "fmu": files["striker"],
                    "parameters": {"mass": STRIKER, "velocity0.y": SPEED},
                },
                "struck": {"fmu": files["struck"], "parameters": {"mass": STRUCK}},
            },
            "connections": CONNECTIONS,
            "bonds": {
                end: {
                    "giver": "contact",
                    "force": [f"{end}.force.y"],
                    "taker": body,
                    "position": ["position.y"],
                }
                for body, end in ends.items()
            },
            "master": scheme,
            "exchange_step": step,
            "stop_time": SYSTEM.stop_time,
        }
    )


SYSTEM = ImpactSystem(
    name="stiff-contact",
    title="Stiff contact of two bodies, also beyond the explicit limit",
    folder=Path(__file__).parent,
    parts={"contact": FmuPart(SPRING), "striker": FmuPart(MASS), "struck": FmuPart(MASS)},
    make=make,
    quantity="struck.velocity.y",
    unit="m/s",
    truth=struck_velocity,
    stop_time=4e-3,
    steps=(2e-3, 1e-3, 1e-4, 2e-5, 1e-5),
    step=1e-5,
    tolerance=0.04,
    energies=("striker.energy.kinetic", "struck.energy.kinetic", "contact.energy.elastic"),
    impact_energy=0.5 * STRIKER * SPEED**2,
    start_energy=0.5 * STRIKER * SPEED**2,
    moments={"contact.*": "middle"},
)
