"""A beam whose supports stand on Mogami's plates, without rods: force in, settlement out."""

import pytest

from rockshed.components.catalogue import component
from rockshed.core.run import simulate
from rockshed.core.system.reading import system_from
from rockshed.fmus.in_process import InProcess

SIDES = ("left", "right")


def load(folder, force, **ground):
    """A force (N) on the middle discs of the laboratory beam from t = 0 on, for 30 ms."""
    plates = {
        f"plate_{side}": {
            "fmu": "in process",
            "parameters": {
                "resistance.start": 2e3,
                "resistance.end": 2e4,
                "resistance.time": 10e-3,
                **ground,
            },
        }
        for side in SIDES
    }
    connections, bonds = [], {}
    for number, plate in enumerate(plates, 1):
        connections += [
            f"beam.support.mean_force.y[{number}] -> {plate}.force.y",
            f"{plate}.position.y -> beam.support.position.y[{number}]",
            f"{plate}.velocity.y -> beam.support.velocity.y[{number}]",
        ]
        bonds[plate] = {
            "giver": "beam",
            "force": [f"support.mean_force.y[{number}]"],
            "taker": plate,
            "position": ["position.y"],
            "work": f"support.work[{number}]",
        }
    beam = {
        "fmu": "in process",
        "parameters": {"force.y[12]": -0.5 * force, "force.y[13]": -0.5 * force},
    }
    system = system_from(
        {
            "name": "plates",
            "stop_time": 0.03,
            "exchange_step": 2e-6,
            "output_interval": 1e-4,
            "master": "sequential",
            "components": {"beam": beam, **plates},
            "connections": connections,
            "bonds": bonds,
        },
        "plates",
    )
    sources = {"beam": InProcess(component("RBSMBeam"), {"elements": 24})} | {
        plate: InProcess(component("ImpulsiveGround"), {}) for plate in plates
    }
    return simulate(system, folder, sources=sources)


def test_the_supports_settle_alike_for_good_and_the_books_close(tmp_path):
    run = load(tmp_path / "run", 1e4)
    settled = [run.series[f"plate_{side}.settlement"] for side in SIDES]
    assert settled[0][-1] > 1e-5
    assert settled[0] == pytest.approx(settled[1], abs=1e-12)
    assert (settled[0][1:] >= settled[0][:-1]).all()
    given = run.series["plate_left.energy.work.contact"][-1]
    assert given > 0.1
    for side in SIDES:
        assert abs(run.series[f"coupling.plate_{side}.energy"]).max() < 0.02 * given
        assert abs(run.series[f"plate_{side}.energy.residual"]).max() < 1e-9 * given


def test_a_load_below_the_resistance_moves_nothing(tmp_path):
    run = load(tmp_path / "run", 1e3)
    assert all(abs(run.series[f"plate_{side}.settlement"]).max() == 0.0 for side in SIDES)
    assert abs(run.series["beam.support.force.y[1]"]).max() > 500.0
