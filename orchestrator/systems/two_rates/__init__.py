"""A slow and a stiff oscillator, whose steps are as 1:100."""

from pathlib import Path

from ...core.system.reading import system_from
from ...core.system.system import SystemSpec
from ..parts.light_mass import COMPONENT as LIGHT
from ..parts.mass import COMPONENT as MASS
from ..system import ExchangeOrder, FmuPart, FmuPaths, ImpactSystem
from .truth import (
    HEAVY,
    HEAVY_SPRING,
    JOINING,
    LIGHT_MASS,
    LIGHT_SPRING,
    START,
    slow_position,
    start_energy,
    start_of_light,
)

RATIO = 100
"""Steps of the light mass in one of the heavy mass."""


def make(files: FmuPaths, step: float, scheme: ExchangeOrder) -> SystemSpec:
    """Return the two masses; the light one is stepped a hundred times in each exchange."""
    slow = {"mass": HEAVY, "stiffness": HEAVY_SPRING, "position0.y": START}
    light = {
        "mass": LIGHT_MASS,
        "stiffness": LIGHT_SPRING,
        "partner.stiffness": JOINING,
        "position0.y": start_of_light(),
    }
    return system_from(
        {
            "name": "two-rates",
            "components": {
                "light": {"fmu": files["light"], "step": step / RATIO, "parameters": light},
                "slow": {"fmu": files["slow"], "parameters": slow},
            },
            "connections": [
                "slow.position.y -> light.partner.position.y",
                "slow.velocity.y -> light.partner.velocity.y",
                "light.partner.force.y -> slow.force.y",
            ],
            "bonds": {
                "joint": {
                    "giver": "light",
                    "force": ["partner.force.y"],
                    "taker": "slow",
                    "position": ["position.y"],
                }
            },
            "master": scheme,
            "exchange_step": step,
            "stop_time": SYSTEM.stop_time,
        }
    )


SYSTEM = ImpactSystem(
    name="two-rates",
    title="Two oscillators with steps 1:100",
    folder=Path(__file__).parent,
    parts={"light": FmuPart(LIGHT), "slow": FmuPart(MASS)},
    make=make,
    quantity="slow.position.y",
    unit="m",
    truth=slow_position,
    stop_time=0.2,
    steps=(4e-3, 1e-3, 5e-4, 2.5e-4),
    step=1e-3,
    tolerance=0.05,
    energies=(
        "slow.energy.kinetic",
        "slow.energy.elastic",
        "light.energy.kinetic",
        "light.energy.elastic",
    ),
    impact_energy=0.5 * HEAVY_SPRING * START**2,
    start_energy=start_energy(),
    finer={"light": RATIO},
    moments={"light.*": "middle", "slow.*": "middle"},
)
