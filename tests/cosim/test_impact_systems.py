"""The suite of impact systems: exported, run without this program, scored, measured."""

import json
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from typer.testing import CliRunner

from rockshed.commands.app import app
from rockshed.core.errors import InputRefused
from rockshed.core.run import simulate
from rockshed.systems.catalogue import NAMES, impact_system, impact_systems
from rockshed.systems.files import export_systems, page
from rockshed.systems.jobs import build_parts
from rockshed.systems.masters.table import MASTERS
from rockshed.systems.measuring import MasterRun, SuiteRuns, from_text
from rockshed.systems.results import budget, error_at, order, overview, verdict
from tests.fmu.test_peers import needs

WITHOUT_US = (
    "import runpy, sys; sys.modules['rockshed'] = None; sys.argv = sys.argv[1:]; "
    "runpy.run_path(sys.argv[0], run_name='__main__')"
)
SMALL = ("algebraic-loop", "terminals")


def alone(folder, *words):
    """Run a script of the exported suite in a process that cannot import this program."""
    return subprocess.run(
        [sys.executable, "-c", WITHOUT_US, *words],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
        timeout=100,
    )


@pytest.fixture(scope="module")
def suite(tmp_path_factory):
    folder = tmp_path_factory.mktemp("suite") / "systems"
    export_systems(impact_systems(SMALL), folder)
    return folder


@pytest.mark.parametrize("kind", ["fmi2-native", "fmi3-native", "fmi2-python"])
def test_the_exported_suite_runs_and_is_scored_with_fmpy_and_numpy_alone(suite, kind):
    for name in SMALL:
        ran = alone(suite, "run.py", "fmpy", f"{name}/{kind}/job.json", f"{name}-{kind}.json")
        assert ran.returncode == 0, ran.stderr
        scored = alone(suite, "score.py", name, f"{name}-{kind}.json")
        assert scored.returncode == 0, scored.stdout + scored.stderr
        assert "within the tolerance" in scored.stdout


def test_the_exported_ssp_and_system_file_run_here_with_the_values_of_fmpys_slaves(suite):
    folder = suite / "terminals" / "fmi2-native"
    alone(suite, "run.py", "fmpy", str(folder / "job.json"), "values.json")
    theirs = json.loads((suite / "values.json").read_text())["values"]["upper.position.y"]
    for file in ("system.toml", "terminals.ssp"):
        result = suite / f"run of {file}"
        words = ["run", str(folder / file), "--output-dir", str(result), "--no-figures", "--quiet"]
        assert CliRunner().invoke(app, words).exit_code == 0
        import rockshed

        np.testing.assert_array_equal(rockshed.read_run(result)["upper.position.y"], theirs)


def test_its_system_file_connects_terminals(suite):
    text = (suite / "terminals" / "fmi2-native" / "system.toml").read_text()
    assert '"joint.lower <-> lower.body"' in text


@pytest.mark.parametrize(
    ("content", "code", "words"),
    [
        ("time,soft.displacement\n0,0\n0.64,1.0\n", 3, "beyond the tolerance"),
        ("time,soft.displacement\n0,0\n0.002,nan\n0.64,0\n", 2, "no finite numbers"),
        ("time,soft.displacement\n0,0\n0.32,0\n", 2, "ends at 0.32 s, too early"),
        ("time,other\n0,0\n", 2, "has no column soft.displacement"),
        ("time,soft.displacement\n0,zero\n", 2, "could not convert"),
        ("", 2, "is no table"),
        ("time,soft.displacement\n0.0001,0\n", 2, "has no time of the truth"),
    ],
)
def test_the_scorer_tells_what_is_wrong_with_a_result(suite, content, code, words):
    (suite / "result.csv").write_text(content)
    scored = alone(suite, "score.py", "algebraic-loop", "result.csv")
    assert scored.returncode == code
    assert words in scored.stdout + scored.stderr
    assert "Traceback" not in scored.stderr


def test_the_true_values_are_scored_as_exact(suite):
    scored = alone(suite, "score.py", "terminals", "terminals/truth.csv")
    assert scored.stdout == "terminals/truth.csv: 0, within the tolerance 0.06\n"


def test_a_suite_is_written_into_an_empty_folder_only(suite):
    with pytest.raises(InputRefused, match="is not empty"):
        export_systems([], suite)
    refused = CliRunner().invoke(app, ["export", "systems", str(suite), "--runtime", "native"])
    assert refused.exit_code == 2
    assert "no options" in refused.output


@pytest.mark.parametrize("name", NAMES)
def test_every_page_tells_quantity_tolerance_frame_and_what_goes_wrong(name):
    text = page(impact_system(name))
    for word in ("**Quantity**", "**Tolerance**", "**Frame**", "**What goes wrong.**"):
        assert word in text


# ---------------------------------------------------------------------- in our master


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=[] if n in SMALL else [pytest.mark.slow]) for n in NAMES]
)
@pytest.mark.parametrize("scheme", ["sequential", "jacobi"])
def test_both_masters_keep_the_tolerance_at_the_stated_step(name, scheme, tmp_path):
    system = impact_system(name)
    files = build_parts(system, tmp_path / "fmus")
    made = system.make(files, system.step, scheme)
    made = made.model_copy(update={"record": [system.quantity, *system.energies]})
    run = simulate(made, tmp_path / "run", allow_unstable=True)
    values = np.asarray(run.series[system.quantity])
    error = np.abs(values - system.truth(np.asarray(run.series["time"]))).max() / system.scale
    assert 0.0 < error < system.tolerance
    start = sum(float(run.series[each][0]) for each in system.energies)
    assert start == pytest.approx(system.start_energy, rel=1e-12)


def test_the_error_of_the_algebraic_loop_is_of_first_order_and_halved_in_turn(tmp_path):
    system = impact_system("algebraic-loop")
    files = build_parts(system, tmp_path / "fmus")
    errors = {}
    for scheme in ("sequential", "jacobi"):
        for step in (4e-3, 2e-3):
            run = simulate(system.make(files, step, scheme), tmp_path / "run")
            true = system.truth(np.asarray(run.series["time"]))
            errors[scheme, step] = np.abs(run.series[system.quantity] - true).max()
    for scheme in ("sequential", "jacobi"):
        assert errors[scheme, 4e-3] / errors[scheme, 2e-3] == pytest.approx(2.0, rel=0.01)
    assert errors["jacobi", 2e-3] / errors["sequential", 2e-3] == pytest.approx(2.0, rel=0.01)


# ---------------------------------------------------------------------- measurements


def measurements(errors, costs=(1.0, 2.0, 4.0)):
    return [
        MasterRun("terminals", MASTERS[0].name, "fmi2-native", step, 10, "", error, 0.1, cost, 0.0)
        for step, error, cost in zip((4.0, 2.0, 1.0), errors, costs)
    ]


def test_an_order_is_the_slope_of_the_error_and_lost_ways_do_not_count():
    assert order(measurements((0.16, 0.04, 0.01))) == pytest.approx(2.0)
    assert order(measurements((7.0, 0.04, 0.02))) == pytest.approx(1.0)
    assert order(measurements((7.0, 0.5, 0.02))) is None
    assert order(measurements((None, None, None))) is None


def test_errors_at_equal_cost_lie_between_runs_and_beyond_them_where_that_is_on_the_safe_side():
    rows = measurements((0.16, 0.04, 0.01))
    assert error_at(rows, 2.0) == pytest.approx(0.04)
    assert error_at(rows, 2.0**1.5) == pytest.approx(0.02)
    assert error_at(rows, 8.0) == pytest.approx(0.01)  # more time would make it smaller
    assert error_at(rows, 0.5) is None
    assert error_at(rows, None) is None
    assert budget(rows, "terminals") is None  # none of these steps is the stated one


def test_verdicts_tell_equal_bits_only_of_equal_bits():
    row = measurements((0.1, 0.1, 0.1))[0]
    assert verdict(row) == "equal bits"
    assert verdict(replace(row, deviation=3e-16)) == "equal to 3e-16"
    assert verdict(replace(row, deviation=0.02)) == "runs, error 0.1"
    assert verdict(replace(row, error=2.0)) == "runs, and is wrong: 2"
    assert verdict(replace(row, reason="not installed")) == "not installed"


def test_measurements_are_read_as_they_were_written():
    measured = SuiteRuns(measurements((0.1, None, 1e-300)), {"fmpy": None}, "here", True)
    assert from_text(measured.as_text()) == measured
    assert len(overview(measured)) == 0


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["systems", "start"], "is measured alone"),
        (["start", "--quick"], "belong to the part systems"),
        (["system"], "is no part of the benchmark"),
    ],
)
def test_the_command_refuses_what_does_not_go_together(words, said):
    refused = CliRunner().invoke(app, ["bench", *words])
    assert refused.exit_code == 2
    assert said in " ".join(refused.output.split())


@pytest.mark.slow
@needs("libcosimpy", "ecospy", "tbb")
def test_a_quick_measurement_has_a_row_for_every_master_and_a_figure(tmp_path):
    words = ["bench", "systems", "--quick", "--rounds", "3", "--output-dir", str(tmp_path / "out")]
    ran = CliRunner().invoke(app, words)
    assert ran.exit_code == 0, ran.output
    measured = from_text((tmp_path / "out" / "systems.json").read_text())
    assert (tmp_path / "out" / "systems.png").stat().st_size > 20_000
    rows = {(row.system, row.master, row.step): row for row in measured.rows}
    assert {master for _, master, _ in rows} == {master.name for master in MASTERS}
    system = impact_system("terminals")
    for master in ("libcosim", "ecos", "ecos, SSP", "fmpy, slaves", "fmpy, simulate_ssp"):
        row = rows["terminals", master, system.step]
        assert row.error < system.tolerance
        assert row.deviation < 1e-12
        assert row.cost > 0.0
