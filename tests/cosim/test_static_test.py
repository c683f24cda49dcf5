"""The static test as a user runs it: through the FMUs, by the command line."""

import json

import pytest
from typer.testing import CliRunner

from rockshed.commands.app import app
from rockshed.components.common.units import cm, kgf
from rockshed.core.results.reading import read_run
from rockshed.metrics import names

FAST = ["--set", "sand.internal_step=1e-4"]


@pytest.fixture(scope="module")
def pushed(tmp_path_factory):
    folder = tmp_path_factory.mktemp("static") / "run"
    result = CliRunner().invoke(
        app, ["run", "static-test", "--json", *FAST, "--output-dir", str(folder)]
    )
    assert result.exit_code == 0, result.output
    return json.loads(result.stdout), folder


def test_load_and_spring_constant_stand_beside_the_papers(pushed):
    content, _ = pushed
    metrics = {metric["name"]: metric for metric in content["metrics"]}
    load, stiffness = metrics[names.STATIC_LOAD], metrics[names.STATIC_STIFFNESS]
    assert load["value"] == pytest.approx(stiffness["value"] * 0.04)
    assert stiffness["references"]["paper"]["value"] == pytest.approx(1.29 * 30.4 * kgf / cm)
    assert stiffness["value"] == pytest.approx(1.29 * 30.4 * kgf / cm, rel=0.1)
    assert metrics[names.STATIC_DEPARTURE]["value"] < 0.15
    assert names.IMPACT_ENERGY not in metrics
    assert content["warnings"] == []


def test_the_machine_does_all_the_work(pushed):
    """On a sand that keeps most of it as elastic energy; the balance closes."""
    content, folder = pushed
    run = read_run(folder)
    metrics = {metric["name"]: metric["value"] for metric in content["metrics"]}
    assert metrics[names.MACHINE_WORK] == pytest.approx(
        run.series["sand.energy.work.rock"][-1], rel=0.06
    )  # less the rock's weight
    assert abs(metrics[names.RESIDUAL_WORK_SHARE]) < 5e-3
    assert set(run.series["rock.velocity.y"]) == {-0.01}


def test_pictures_are_those_of_a_static_test(pushed):
    content, folder = pushed
    assert {path.name for path in (folder / "figures").iterdir()} == {
        "load.png",
        "sand.png",
        "energy.png",
    }
    assert len(content["pictures"]) == 3


def test_a_run_that_does_not_reach_4_cm_has_no_spring_constant(tmp_path):
    result = CliRunner().invoke(
        app,
        [
            "run",
            "static-test",
            *FAST,
            "--stop-time",
            "0.5",
            "--no-figures",
            "--output-dir",
            str(tmp_path / "short"),
        ],
    )
    assert result.exit_code == 0
    assert "is not driven 4 cm deep" in result.stdout
    assert "kgf/cm " not in result.stdout
