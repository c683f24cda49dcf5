"""Records the results for which no closed form is known anew: ``python -m tests.fmu.record``."""

import csv

from rockshed.components.catalogue import component
from rockshed.fmus.experiments.found import experiments_of
from rockshed.fmus.experiments.recorded import DATA
from tests.fmu.kernels import course

RECORDED = {"driven-rock": "SandCushion"}


def record(name, owner):
    made = component(owner)
    sizes = made.with_sizes()
    (one,) = (each for each in experiments_of(made, sizes) if each.name == name)
    table = course(made, sizes, one)
    with (DATA / f"{name}.csv").open("w", encoding="utf-8", newline="") as file:
        lines = csv.writer(file, lineterminator="\n")
        lines.writerow(table)
        lines.writerows([f"{value:.12g}" for value in row] for row in zip(*table.values()))


if __name__ == "__main__":
    for experiment, its_owner in RECORDED.items():
        record(experiment, its_owner)
