"""``rockshed reproduce`` as a user meets it: a study through the FMUs, in processes of their own."""

import json

import pytest
from typer.testing import CliRunner

from rockshed.commands.app import app
from rockshed.papers.sonoda1993.fig19 import COARSE, _single
from rockshed.runs.batch import COMPLETE, FAILED, Task, run_all
from rockshed.runs.job import Request


@pytest.fixture(scope="module")
def table_5(tmp_path_factory):
    folder = tmp_path_factory.mktemp("reproduction") / "out"
    arguments = [
        "reproduce",
        "sonoda1993",
        "--quick",
        "--only",
        "table5",
        "--workers",
        "2",
        "--output-dir",
        str(folder),
    ]
    result = CliRunner().invoke(app, arguments)
    assert result.exit_code == 0, result.output
    return folder, result


@pytest.mark.slow
def test_table_5_has_its_nine_rows_with_both_models(table_5):
    folder, result = table_5
    content = json.loads((folder / "reproduction.json").read_text())
    rows = content["studies"][0]["rows"]
    assert len(rows) == 3 * (9 * 2 + 2 + 3)
    assert len(content["runs"]) == 9 * 3
    assert all(run["status"] == "complete" for run in content["runs"])
    for row in rows:
        if row["model"] == "calibrated" and row["unit"] != "%":
            assert abs(row["deviation_from_paper"]) < 0.12
        assert row["model_options"]["rotation"] == (
            "free" if row["model"] == "literal" else "locked"
        )
        assert set(row["fmus"]) == {"sand", "rock", "beam"}
    assert "Table 5" in result.stdout
    assert "runs: 27 of 27" in result.stderr


@pytest.mark.slow
def test_the_page_holds_its_figures(table_5):
    folder, _ = table_5
    page = (folder / "reproduction.html").read_text()
    assert (folder / "figures" / "table5.png").is_file()
    assert 'src="data:image/png;base64,' in page
    assert "9.64" in page


def test_a_run_that_fails_is_an_outcome_beside_the_others():
    good = Task(Request("lab-impact", options={"stop_time": 0.001}))
    found = run_all([_single(COARSE), good], 1, print, lambda done, total: None)
    failed = found[_single(COARSE).key]
    assert failed.status == FAILED
    assert failed.failed_at < 1e-3
    assert "the beam diverged" in failed.error
    assert found[good.key].status == COMPLETE
