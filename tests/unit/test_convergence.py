"""Convergence of a shed: which meshes are computed, and what is said of their figures."""

import json
import math

import numpy as np
import pytest

from rockshed.analyses.convergence import run as study
from rockshed.analyses.convergence.figures import QUANTITIES, common_cut_off, measured
from rockshed.analyses.convergence.meshes import DISCS, ELEMENTS, meshes, tasks
from rockshed.core.errors import InputRefused
from rockshed.metrics import names
from rockshed.runs.outcome import Outcome

PROJECT = {
    "name": "trial",
    "rock": {"mass": "2.5 t", "drop_height": "25 m"},
    "cushion": {"thickness": "1.2 m"},
    "roof": {"section": "H-400x400x13x21", "span": "9 m", "spacing": "1.5 m"},
}


def made_up(error_of_discs=0.0, scatter=0.0, failing=()):
    """Runs whose figures err by a share that goes with the size of the discs."""

    def run_all(wanted, *rest):
        finest = min(task.request.values["numerics.disc_radius"] for task in wanted)
        outcomes = {}
        for number, task in enumerate(wanted):
            if number in failing:
                outcomes[task.key] = Outcome(task.key, "failed", "the sand is gone")
                continue
            coarse = task.request.values["numerics.disc_radius"] / finest - 1.0
            noise = scatter * math.sin(5.0 * number)
            value = 1e5 * (1.0 + error_of_discs * coarse + noise)
            metrics = {quantity.name: value for quantity in QUANTITIES}
            outcomes[task.key] = Outcome(task.key, "complete", metrics=metrics)
        return outcomes

    return run_all


def studied(monkeypatch, folder=None, **made):
    monkeypatch.setattr(study, "run_all", made_up(**made))
    return study.converge(PROJECT, packings=3, folder=folder, pictures=folder is not None)


def test_discs_get_finer_by_the_root_of_two_and_elements_by_two():
    found = meshes(PROJECT, {}, 2.0)
    discs = [mesh for mesh in found if mesh.refined == DISCS]
    elements = [mesh for mesh in found if mesh.refined == ELEMENTS]
    own = discs[1]
    assert [mesh.disc_radius / own.disc_radius for mesh in discs] == pytest.approx(
        [math.sqrt(2.0), 1.0, math.sqrt(0.5), 0.5], rel=1e-3
    )
    assert discs[-1].discs == pytest.approx(4 * own.discs, rel=0.01)
    assert {mesh.elements for mesh in discs} == {own.elements}
    assert [mesh.elements / own.elements for mesh in elements] == pytest.approx(
        [0.5, 1.0, 2.0, 4.0], rel=0.05
    )
    assert all(mesh.elements % 2 for mesh in elements)  # one has its middle at midspan


def test_each_packing_of_a_mesh_is_a_run_and_the_project_s_own_mesh_is_run_once():
    found = meshes(PROJECT, {}, 2.0)
    runs = [task for mesh in found for task in tasks(PROJECT, {}, mesh, 7, 3)]
    assert [task.request.values["numerics.seed"] for task in runs[:3]] == [7, 8, 9]
    assert len({task.key for task in runs}) == 3 * (len(found) - 1)


@pytest.mark.parametrize(
    ("error", "scatter", "verdict"),
    [
        (0.01, 0.0, "converged to 3 %"),
        (0.10, 0.0, "not converged"),
        (0.03, 0.2, "no difference beyond the scatter of the packings"),
    ],
)
def test_a_figure_is_converged_only_where_its_departure_and_its_error_are_small(
    monkeypatch, error, scatter, verdict
):
    result = studied(monkeypatch, error_of_discs=error, scatter=scatter)
    of_discs = [entry for entry in result.departures if entry.refined == DISCS]
    assert len(of_discs) == len(QUANTITIES)
    assert {entry.verdict for entry in of_discs} == {verdict}
    if not scatter:
        assert of_discs[0].share == pytest.approx(error, abs=1e-4)
        assert all(entry.share == 0.0 for entry in result.departures if entry.refined == ELEMENTS)


def test_settled_forces_of_all_meshes_are_filtered_alike():
    """A force with a fast part: the finer mesh's own, higher cut-off would let it pass."""
    time = np.linspace(0.0, 1.0, 2001)
    force = 1e5 * np.sin(np.pi * time) ** 2 * (1.0 + np.sin(2.0 * np.pi * 60.0 * time))
    series = {"time": time, "sand.rock.force.y": force, "sand.transmitted_force": force}
    coarse, fine = (
        Outcome(
            "run",
            "complete",
            metrics={names.SETTLED_CUT_OFF: cut_off, names.SETTLED_ROCK: own},
            series=series,
        )
        for cut_off, own in ((20.0, 1.0e5), (200.0, 2.0e5))
    )
    mesh = meshes(PROJECT, {}, 2.0)[1]
    alone = measured(mesh, [fine]).estimates[names.SETTLED_ROCK]
    together = measured(mesh, [fine], common_cut_off([coarse])).estimates[names.SETTLED_ROCK]
    assert alone.mean == 2.0e5
    assert together.mean == pytest.approx(1.0e5, rel=0.01)


def test_a_study_is_saved_with_its_table_and_figure(monkeypatch, tmp_path):
    result = studied(monkeypatch, tmp_path / "study", error_of_discs=0.05, failing=(0,))
    assert sorted(file.name for file in (tmp_path / "study").iterdir()) == [
        "convergence.csv",
        "convergence.json",
        "convergence.png",
    ]
    content = json.loads((tmp_path / "study" / "convergence.json").read_text(encoding="utf-8"))
    assert len(content["meshes"]) == len(result.measured)
    assert content["departures"][0]["verdict"] == "not converged"
    assert content["meshes"][0]["runs"] == 2
    assert "the sand is gone" in result.warnings[0]
    assert [len(table) for table in result.tables()] == [4, 4, 2 * len(QUANTITIES)]


def test_arguments_that_make_no_study_are_refused_together():
    with pytest.raises(InputRefused) as refusal:
        study.converge(PROJECT, packings=1, finest=1.0, values={"numerics.elements": 30})
    assert [problem.where for problem in refusal.value.problems] == [
        "numerics.elements",
        "packings",
        "finest",
    ]
