"""Records results for which no closed form is known, and states, anew: ``python -m tests.fmu.record``."""

import csv
import lzma

from rockshed.components.catalogue import component
from rockshed.fmus.experiments.found import experiments_of
from rockshed.fmus.experiments.recorded import DATA, STATE_PLATFORM, STATE_SUFFIX
from rockshed.fmus.experiments.sand_cushion import _SETTLED
from rockshed.fmus.in_process import slave_class
from rockshed.platforms import this_machine
from tests.fmu.kernels import course

RECORDED = {"driven-rock": "SandCushion", "rock-into-settled-sand": "SandCushion"}
STATES = {"settled-sand": ("SandCushion", _SETTLED)}


def record(name, owner):
    made = component(owner)
    sizes = made.with_sizes()
    (one,) = (each for each in experiments_of(made, sizes) if each.name == name)
    table = course(made, sizes, one)
    with (DATA / f"{name}.csv").open("w", encoding="utf-8", newline="") as file:
        lines = csv.writer(file, lineterminator="\n")
        lines.writerow(table)
        lines.writerows([f"{value:.12g}" for value in row] for row in zip(*table.values()))


def state(owner, parameters):
    """Serialized state of a slave that is initialised with parameters."""
    made = component(owner)
    sizes = made.with_sizes()
    slave = slave_class(made, sizes)(instance_name=owner)
    for name, value in parameters.items():
        slave._instance[name] = value
    slave.setup_experiment(0.0, None, None)
    slave.enter_initialization_mode()
    slave.exit_initialization_mode()
    return slave._get_fmu_state()


def main():
    if this_machine() != STATE_PLATFORM:
        raise SystemExit(f"states are recorded on {STATE_PLATFORM.in_fmi3}")
    for name, (owner, parameters) in STATES.items():
        (DATA / f"{name}{STATE_SUFFIX}").write_bytes(lzma.compress(state(owner, parameters)))
    for name, owner in RECORDED.items():
        record(name, owner)


if __name__ == "__main__":
    main()
