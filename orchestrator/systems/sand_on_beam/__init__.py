"""The laboratory impact: a ball on a cushion of sand on a beam, against one program."""

from pathlib import Path

from rockshed.components.falling_rock import COMPONENT as ROCK
from rockshed.components.rbsm_beam import COMPONENT as BEAM
from rockshed.components.sand_cushion import COMPONENT as SAND

from ...cases.sonoda1993 import lab_system, tests
from ...core.system.system import SystemSpec
from ..system import ExchangeOrder, FmuPart, FmuPaths, ImpactSystem
from .truth import STOP, TEST, rock_velocity

_COUPLINGS = {"sequential": "paper", "jacobi": "jacobi"}


def make(files: FmuPaths, step: float, scheme: ExchangeOrder) -> SystemSpec:
    """Return test 4 of the laboratory with held inputs, without recorded states."""
    system = lab_system(files, tests()[TEST], _COUPLINGS.get(scheme, "jacobi"))
    components = {
        name: spec.model_copy(update={"record_states": False})
        for name, spec in system.components.items()
    }
    changes = {
        "name": "sand-on-beam",
        "components": components,
        "master": scheme,
        "exchange_step": step,
        "output_interval": None,
        "state_interval": None,
        "stop_time": STOP,
        "record": ["rock.*", "beam.energy.*", "sand.rock.*", "sand.energy.*"],
        "watch": [],
    }
    return system.model_copy(update=changes)


SYSTEM = ImpactSystem(
    name="sand-on-beam",
    title="Sand on a beam: a distinct element model, against one program",
    folder=Path(__file__).parent,
    parts={"sand": FmuPart(SAND), "rock": FmuPart(ROCK), "beam": FmuPart(BEAM)},
    make=make,
    quantity="rock.velocity.y",
    unit="m/s",
    truth=rock_velocity,
    stop_time=STOP,
    steps=(1.6e-4, 8e-5, 4e-5, 2e-5),
    step=4e-5,
    tolerance=0.02,
    energies=(
        "rock.energy.work.contact",
        "sand.energy.work.rock",
        "beam.energy.work.contact",
        "sand.energy.work.beam",
    ),
    impact_energy=0.5 * 4.0 * 8.0**2,
)
