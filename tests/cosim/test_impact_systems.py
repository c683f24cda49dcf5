"""The suite of impact systems: exported, run without this program, scored, measured."""

import json
import shutil
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from typer.testing import CliRunner

import rockshed
from rockshed.commands.app import app
from rockshed.core.errors import InputRefused
from rockshed.core.run import simulate
from rockshed.core.system.iteration import Iteration
from rockshed.systems import hammer_on_rod
from rockshed.systems.catalogue import NAMES, impact_system, impact_systems
from rockshed.systems.files import export_systems, page
from rockshed.systems.jobs import build_parts, planned
from rockshed.systems.masters.table import MASTERS
from rockshed.systems.measured import MasterRun, SuiteRuns, from_text
from rockshed.systems.results import budget, error_at, order, overview, verdict
from rockshed.systems.stamps import in_process
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
        MasterRun("terminals", MASTERS[0].name, "fmi2-native", 40 / n, n, "", error, 0.1, cost, 0.0)
        for n, error, cost in zip((10, 20, 40), errors, costs)
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
    noisy = measurements((0.16, 0.04, 0.01), (4.2, 2.0, 4.0))
    assert error_at(noisy, 8.0) == pytest.approx(0.01)  # of the shortest step, not the dearest run
    assert error_at(measurements((0.16, 0.04, 0.01), (3.0, 2.0, 6.0)), 3.0) == pytest.approx(0.04)
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


# ---------------------------------------------------------------------- in the implicit master


def solved(name, step, master, folder, **options):
    """Error of a system in this process, and energy made, as parts; iterations of the exchanges."""
    system, sources = impact_system(name), in_process(impact_system(name))
    plan = planned(system, dict.fromkeys(system.parts, ""), step, master, options, sources)
    run = simulate(plan.system, folder / f"{master}-{step}", sources=sources, allow_unstable=True)
    values = np.asarray(run.series[system.quantity])
    error = np.abs(values - system.truth(np.asarray(run.series["time"]))).max() / system.scale
    end = sum(float(run.series[each][-1]) for each in system.energies)
    made = (end - system.start_energy) / system.impact_energy
    return float(error), made, run.provenance.get("iteration", {}).get("iterations")


def test_the_hammer_on_a_rod_has_the_values_of_the_sequential_master_in_one_iteration(tmp_path):
    for step in (8e-5, 2e-5):
        expected = solved("hammer-on-rod", step, "sequential", tmp_path)[:2]
        *found, iterations = solved("hammer-on-rod", step, "implicit", tmp_path)
        assert found == pytest.approx(expected, rel=1e-9)
        assert iterations == {"1": round(8e-3 / step)}
    assert found[0] < 2e-6


def test_with_values_of_the_end_the_wave_of_the_rod_comes_a_step_too_early(tmp_path):
    """The page derives the error, 2 abs(alpha) r H, which no iteration takes away."""
    truth = hammer_on_rod.truth
    for step in (8e-5, 4e-5):
        tight = Iteration(tolerance=1e-12)
        error, _, _ = solved("hammer-on-rod", step, "implicit", tmp_path, iteration=tight)
        early = 2.0 * abs(truth.REFLECTION) * truth.IMPEDANCE / truth.MASS * step
        assert error == pytest.approx(early, rel=0.03)


@pytest.mark.parametrize(
    ("name", "steps", "least"),
    [
        ("stiff-contact", (2e-5, 1e-5), 1.9),
        ("terminals", (1e-3, 5e-4), 1.9),
        pytest.param("bouncing-ball", (4e-3, 1e-3), 1.5, marks=pytest.mark.slow),
        pytest.param("two-rates", (4e-3, 1e-3), 1.5, marks=pytest.mark.slow),
    ],
)
def test_inputs_of_the_moments_of_a_page_have_an_order_that_those_of_the_end_have_not(
    tmp_path, name, steps, least
):
    def order_of(folder, **options):
        errors = [solved(name, s, "implicit", folder, **options)[0] for s in steps]
        return np.log(errors[0] / errors[1]) / np.log(steps[0] / steps[1])

    assert order_of(tmp_path / "moments") > least
    assert order_of(tmp_path / "end", iteration=Iteration()) < 1.1


def test_the_exported_file_for_the_implicit_master_has_the_moments_of_the_page(suite):
    text = (suite / "terminals" / "fmi2-native" / "implicit.toml").read_text()
    assert 'master = "implicit"' in text
    assert 'target = "joint.*"' in text
    folder = suite / "implicit run"
    words = ["run", str(suite / "terminals" / "fmi2-native" / "implicit.toml"), "--quiet"]
    words += ["--no-figures", "--output-dir", str(folder)]
    assert CliRunner().invoke(app, words).exit_code == 0
    run = rockshed.read_run(folder)
    truth = impact_system("terminals").truth(np.asarray(run["time"]))
    assert np.abs(np.asarray(run["upper.position.y"]) - truth).max() < 1e-4


# ---------------------------------------------------------------------- misuse of the folder


@pytest.mark.parametrize(
    ("words", "code", "said"),
    [
        ([], 2, "run.py TOOL"),
        (["nothing", "a.json", "b.json"], 2, "invalid choice: 'nothing'"),
        (["fmpy", "a.json"], 2, "each JOB.json needs an ANSWER.json"),
        (["fmpy", "nowhere/job.json", "b.json"], 1, "No such file"),
        (["fmpy", "algebraic-loop/fmi2-native/job.json", "no/where.json"], 2, "No such file"),
        (["fmpy", "step=3e-3", "JOB", "b.json"], 1, "is no part of the 0.64 s"),
        (["fmpy", "step=-1", "JOB", "b.json"], 1, "is no part of the 0.64 s"),
        (["libcosim", "step=4e-3", "JOB", "b.json"], 1, "reads its exchange step from"),
        (["fmpy", "step=no", "JOB", "b.json"], 2, "step=no: is no number"),
    ],
)
def test_the_script_of_the_folder_says_what_is_wrong_with_its_words(suite, words, code, said):
    job = "algebraic-loop/fmi2-native/job.json"
    ran = alone(suite, "run.py", *[job if word == "JOB" else word for word in words])
    assert ran.returncode == code, ran.stderr
    assert said in ran.stderr
    assert "Traceback" not in ran.stderr


def test_a_job_runs_with_another_exchange_step_and_its_error_is_of_first_order(suite):
    job = "algebraic-loop/fmi2-native/job.json"
    errors = []
    for step in ("4e-3", "8e-3"):
        ran = alone(suite, "run.py", "fmpy", f"step={step}", job, "other.json")
        assert ran.returncode == 0, ran.stderr
        scored = alone(suite, "score.py", "algebraic-loop", "other.json")
        errors.append(float(scored.stdout.split()[1].rstrip(",")))
    assert errors[1] / errors[0] == pytest.approx(2.0, rel=0.01)


def test_an_fmu_that_is_missing_is_named(suite, tmp_path):
    copy = tmp_path / "copy"
    shutil.copytree(suite / "terminals" / "fmi2-native", copy)
    next(copy.glob("*.fmu")).unlink()
    ran = alone(suite, "run.py", "fmpy", str(copy / "job.json"), str(tmp_path / "answer.json"))
    assert ran.returncode == 1
    assert "there is no " in ran.stderr
    assert ".fmu" in ran.stderr


def test_truths_tell_their_units(suite):
    with (suite / "terminals" / "truth.csv").open() as opened:
        assert opened.readline() == "time [s],upper.position.y [m]\n"


def test_an_export_that_fails_leaves_nothing_behind(tmp_path, monkeypatch):
    def fails(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr("rockshed.systems.files._write_variant", fails)
    with pytest.raises(KeyboardInterrupt):
        export_systems(impact_systems(("terminals",)), tmp_path / "made" / "suite")
    assert [path.name for path in (tmp_path / "made").iterdir()] == []
