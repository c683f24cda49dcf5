"""Two springs that share a load, without any mass: an algebraic loop."""

from pathlib import Path

from ...core.system.reading import system_from
from ...core.system.system import SystemSpec
from ..parts.loaded_spring import COMPONENT as LOADED
from ..parts.soft_spring import COMPONENT as SOFT
from ..system import ExchangeOrder, FmuPart, FmuPaths, ImpactSystem
from .truth import AMPLITUDE, FIRST, RATE, SECOND, displacement


def make(files: FmuPaths, step: float, scheme: ExchangeOrder) -> SystemSpec:
    """Return both springs, each of which feeds the other."""
    loaded = {"stiffness": SECOND, "amplitude": AMPLITUDE, "angular_frequency": RATE}
    return system_from(
        {
            "name": "algebraic-loop",
            "components": {
                "loaded": {"fmu": files["loaded"], "parameters": loaded},
                "soft": {"fmu": files["soft"], "parameters": {"stiffness": FIRST}},
            },
            "connections": [
                "soft.displacement -> loaded.displacement",
                "loaded.force -> soft.force",
            ],
            "master": scheme,
            "exchange_step": step,
            "stop_time": SYSTEM.stop_time,
        }
    )


SYSTEM = ImpactSystem(
    name="algebraic-loop",
    title="Algebraic loop: two springs under one load",
    folder=Path(__file__).parent,
    parts={"loaded": FmuPart(LOADED), "soft": FmuPart(SOFT)},
    make=make,
    quantity="soft.displacement",
    unit="m",
    truth=displacement,
    stop_time=0.64,
    steps=(1.6e-2, 8e-3, 4e-3, 2e-3),
    step=2e-3,
    tolerance=0.03,
)
