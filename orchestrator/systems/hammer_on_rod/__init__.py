"""A rigid hammer on an elastic rod, against St. Venant's closed form."""

from pathlib import Path

from rockshed.components.hammer import COMPONENT as HAMMER
from rockshed.components.pile_rod import COMPONENT as ROD

from ...core.system.reading import system_from
from ...core.system.system import SystemSpec
from ..system import ExchangeOrder, FmuPart, FmuPaths, ImpactSystem
from .truth import LENGTH, MASS, REFLECTION, SPEED, hammer_velocity

SEGMENTS = 200
"""Of 10 us each."""


def make(files: FmuPaths, step: float, scheme: ExchangeOrder) -> SystemSpec:
    """Return the blow; the rod is told whether its partner has made the step already."""
    rod = {
        "head.port": "waves",
        "exchange": "parallel" if scheme == "jacobi" else "sequential",
        "toe.condition": "reflection",
        "toe.reflection": REFLECTION,
        "section.length[1]": LENGTH,
    }
    return system_from(
        {
            "name": "hammer-on-rod",
            "components": {
                "hammer": {"fmu": files["hammer"], "parameters": {"mass": MASS, "weight": False}},
                "rod": {"fmu": files["rod"], "parameters": rod},
            },
            "order": ["hammer", "rod"],
            "connections": [
                "rod.head.wave -> hammer.head.wave",
                "rod.head.impedance -> hammer.head.impedance",
                "hammer.force -> rod.head.force",
            ],
            "bonds": {
                "head": {
                    "giver": "hammer",
                    "force": ["force"],
                    "taker": "rod",
                    "position": ["head.position"],
                    "work": "energy.work.head",
                }
            },
            "master": scheme,
            "exchange_step": step,
            "stop_time": SYSTEM.stop_time,
        }
    )


SYSTEM = ImpactSystem(
    name="hammer-on-rod",
    title="Hammer on a rod: St. Venant's impact",
    folder=Path(__file__).parent,
    parts={"hammer": FmuPart(HAMMER), "rod": FmuPart(ROD, {"segments": SEGMENTS})},
    make=make,
    quantity="hammer.velocity",
    unit="m/s",
    truth=hammer_velocity,
    stop_time=8e-3,
    steps=(3.2e-4, 1.6e-4, 8e-5, 2e-5),
    step=8e-5,
    tolerance=1e-4,
    energies=("rod.energy.work.head", "hammer.energy.work.head"),
    impact_energy=0.5 * MASS * SPEED**2,
    moments={"hammer.head.*": "begin"},
)
