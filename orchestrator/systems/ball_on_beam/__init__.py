"""A ball that is dropped on the middle of a beam."""

from pathlib import Path

from rockshed.components.falling_rock import COMPONENT as ROCK
from rockshed.components.rbsm_beam import COMPONENT as BEAM

from ...core.system.reading import system_from
from ...core.system.system import SystemSpec
from ..parts.beam_contact import COMPONENT as CONTACT
from ..system import ExchangeOrder, FmuPart, FmuPaths, ImpactSystem
from .truth import AREA, DENSITY, MASS, MODULUS, SECOND_MOMENT, SPAN, SPEED, STIFFNESS, deflection

ELEMENTS = 49
"""Discs of the beam; an odd number has one in the middle."""


def make(files: FmuPaths, step: float, scheme: ExchangeOrder) -> SystemSpec:
    """Return ball, contact and beam, without gravity."""
    ball = {"mass": MASS, "position0.y": 0.0, "velocity0.y": -SPEED, "gravity": 0.0}
    beam = {
        "span": SPAN,
        "axis.y": 0.0,
        "gravity": 0.0,
        "elastic_modulus": MODULUS,
        "section.area": AREA,
        "section.second_moment": SECOND_MOMENT,
        "density": DENSITY,
    }
    return system_from(
        {
            "name": "ball-on-beam",
            "components": {
                "contact": {"fmu": files["contact"], "parameters": {"stiffness": STIFFNESS}},
                "ball": {"fmu": files["ball"], "parameters": {**ball, "internal_step": 1e-6}},
                "beam": {"fmu": files["beam"], "parameters": beam},
            },
            "connections": [
                "ball.position.y -> contact.ball.position.y",
                "beam.position.y[*] -> contact.beam.position.y[*]",
                "contact.ball.force.y -> ball.force.y",
                "contact.beam.force.y[*] -> beam.force.y[*]",
            ],
            "bonds": {
                "ball": {
                    "giver": "contact",
                    "force": ["ball.force.y"],
                    "taker": "ball",
                    "position": ["position.y"],
                }
            },
            "master": scheme,
            "exchange_step": step,
            "stop_time": SYSTEM.stop_time,
            "record": ["contact.*", "ball.*", "beam.energy.*", "beam.midspan.*"],
        }
    )


SYSTEM = ImpactSystem(
    name="ball-on-beam",
    title="Ball on a beam, against the beam's modes",
    folder=Path(__file__).parent,
    parts={
        "contact": FmuPart(CONTACT, {"elements": ELEMENTS}),
        "ball": FmuPart(ROCK),
        "beam": FmuPart(BEAM, {"elements": ELEMENTS}),
    },
    make=make,
    quantity="beam.midspan.deflection",
    unit="m",
    truth=deflection,
    stop_time=4e-3,
    steps=(8e-5, 4e-5, 2e-5, 1e-5),
    step=1e-5,
    tolerance=0.03,
    energies=(
        "ball.energy.kinetic",
        "contact.energy.elastic",
        "beam.energy.kinetic",
        "beam.energy.elastic",
    ),
    impact_energy=0.5 * MASS * SPEED**2,
    start_energy=0.5 * MASS * SPEED**2,
    moments={"contact.*": "middle"},
)
