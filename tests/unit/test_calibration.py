"""The fit of E_bar to made-up static tests whose answer is known, and what happens around it when runs do not end well."""

import numpy as np
import pytest
from typer.testing import CliRunner

import rockshed.commands.calibrate_sand
from rockshed.analyses.calibration import search as calibration
from rockshed.analyses.calibration.fit import Push, Unreachable, fit
from rockshed.analyses.calibration.measurement import Measurement, of_stiffness
from rockshed.analyses.calibration.run import calibrate
from rockshed.analyses.calibration.search import Calibration, by_misfit
from rockshed.commands.app import app
from rockshed.components.common.units import cm, kgf
from rockshed.core.errors import InputRefused, RunFailed
from rockshed.metrics.load_curve import LoadCurve
from rockshed.runs import batch, first_compilation, kept
from rockshed.runs.batch import COMPLETE, FAILED, INTERRUPTED, Outcome
from rockshed.runs.kept import FINISHED

E_BAR = kgf / cm**2
PLACES = np.linspace(0.0, 0.05, 501)


def push(e_bar, seed, factor=1.0, exponent=1.0, power=1.0):
    """A sand whose load is 38 kN/m * x at E_bar = 30, times (x / 4 cm) ** (power - 1)."""
    load = 38e3 * 0.04 * (PLACES / 0.04) ** power * (e_bar / 30.0) ** exponent * factor
    return Push(e_bar * E_BAR, seed, LoadCurve(PLACES, load))


def pushes(**options):
    return [push(e_bar, seed, **options) for e_bar in (30.0, 40.0, 50.0) for seed in (1, 2, 3)]


def test_a_modulus_is_found_again_from_its_spring_constant():
    result = fit(of_stiffness(38e3 * 1.5, "k"), pushes())
    assert result.modulus / E_BAR == pytest.approx(45.0, rel=1e-4)
    assert result.exponent == pytest.approx(1.0, rel=1e-6)
    assert result.uncertainty / E_BAR < 1e-6
    assert float(result.load[0]) == pytest.approx(38e3 * 1.5 * 0.04, rel=1e-4)


def test_loads_that_do_not_go_with_the_modulus_itself():
    """(45/30)^0.8 times the load of E_bar = 30."""
    result = fit(of_stiffness(38e3 * 1.5**0.8, "k"), pushes(exponent=0.8))
    assert result.modulus / E_BAR == pytest.approx(45.0, rel=1e-4)
    assert result.exponent == pytest.approx(0.8, rel=1e-6)


def test_samples_that_scatter_make_the_result_uncertain():
    """Six percent up and down in the load, with exponent 1: about 6 percent in E_bar."""
    scattered = [
        push(e_bar, seed, factor)
        for e_bar in (30.0, 40.0, 50.0)
        for seed, factor in ((1, 0.94), (2, 1.0), (3, 1.06))
    ]
    result = fit(of_stiffness(38e3 * 1.5, "k"), scattered)
    assert result.modulus / E_BAR == pytest.approx(45.0, rel=0.01)
    assert 0.045 < result.uncertainty / result.modulus < 0.065


def test_a_curve_of_another_shape_has_an_error_that_counts():
    """What a parabola has that no straight line through the origin has: sqrt(1 - (sum x^3)^2 / (sum x^2 sum x^4))."""
    depth = np.linspace(0.002, 0.04, 20)
    measured = Measurement("bent", depth, 38e3 * 0.04 * (depth / 0.04) ** 2)
    result = fit(measured, pushes())
    cosine = float(depth @ depth**2) / np.sqrt(float(depth @ depth) * float(depth**2 @ depth**2))
    assert result.misfit == pytest.approx(np.sqrt(1.0 - cosine**2), rel=0.01)
    assert result.uncertainty == pytest.approx(result.modulus * result.misfit, rel=1e-3)


@pytest.mark.parametrize("options", [{"exponent": 0.05}, {"factor": 0.0}])
def test_a_load_that_does_not_rise_with_the_modulus_says_nothing_about_it(options):
    with pytest.raises(
        Unreachable, match=r"57 kgf/cm|58\.1 kgf/cm.*out of reach.*E_bar from 30 to 50 kgf/cm2"
    ):
        fit(of_stiffness(57e3, "k"), pushes(**options))


def test_the_model_with_the_smaller_error_is_chosen_and_the_other_kept():
    depth = np.linspace(0.002, 0.04, 20)
    measured = Measurement("curve", depth, 38e3 * depth)
    bent, straight = (
        Calibration(name, {}, [fit(measured, pushes(power=power))], ())
        for name, power in (("bent", 1.3), ("straight", 1.0))
    )
    made, lost = by_misfit({"bent": lambda: bent, "straight": lambda: straight})
    assert [c.rotation for c in made] == ["straight", "bent"]
    assert lost == {}


def test_a_model_that_cannot_have_the_load_leaves_it_to_the_other():
    measured = of_stiffness(57e3, "k")

    def never():
        fit(measured, pushes(factor=0.0))

    fine = Calibration("fine", {}, [fit(measured, pushes())], ())
    made, lost = by_misfit({"never": never, "fine": lambda: fine})
    assert ([c.rotation for c in made], list(lost)) == (["fine"], ["never"])
    with pytest.raises(Unreachable):
        by_misfit({"never": never, "nor this": never})


# ------------------------------------------------------------------ around the fit, with made-up runs


@pytest.fixture
def sand(monkeypatch):
    """Runs are replaced by a sand of 38 kN/m at E_bar = 30 (times ``factor``); ``status`` of those of the fit."""

    def use(factor=1.0, exponent=1.0, status=COMPLETE, failed_at=None):
        def run(task, status=COMPLETE):
            made = push(float(task.request.values["sand.modulus"]) / E_BAR, 1, factor, exponent)
            series = {
                "sand.penetration": made.curve.depth,
                "sand.rock.force.y": made.curve.load,
                "sand.surface_height": np.array([0.1]),
                "sand.surface_level": np.array([0.1]),
                "sand.stable_step": np.array([1e-4]),
            }
            return Outcome(
                task.key,
                status,
                "broken" if status == FAILED else "",
                failed_at,
                series=series,
                options={"packing": "square"},
            )

        monkeypatch.setattr(calibration, "run_here", lambda task, *rest: run(task))
        monkeypatch.setattr(
            calibration,
            "run_all",
            lambda tasks, *rest: {task.key: run(task, status) for task in tasks},
        )

    return use


@pytest.mark.parametrize("stiffness", [2e3, 38e3, 150e3])
def test_the_search_comes_to_the_modulus_from_far_away(sand, stiffness):
    sand(factor=0.2, exponent=1.2)
    found = calibrate(stiffness, seeds=2).best
    assert found.modulus / E_BAR == pytest.approx(
        30.0 * (stiffness / 38e3 / 0.2) ** (1 / 1.2), rel=1e-3
    )


def test_several_measurements_share_their_tests(sand):
    sand()
    result = calibrate([of_stiffness(k, str(k)) for k in (90e3, 30e3, 45e3)], seeds=2)
    (made,) = result.calibrations
    assert [f.modulus / E_BAR for f in made.fits] == pytest.approx(
        [90 / 38 * 30, 30 / 38 * 30, 45 / 38 * 30], rel=1e-3
    )
    assert len(made.pushes) <= 12


def test_a_spring_constant_out_of_reach_is_told_with_what_is_reached(sand):
    sand(factor=0.01)
    with pytest.raises(
        Unreachable,
        match=r"39\.1 kgf/cm at 4 cm is out of reach: .* to 6\.46 kgf/cm for .* to 500 kgf/cm2",
    ):
        calibrate([of_stiffness(39.1 * kgf / cm, "k")])


def test_runs_without_a_result_end_the_calibration(sand):
    sand(status=INTERRUPTED)
    with pytest.raises(KeyboardInterrupt):
        calibrate([of_stiffness(38e3, "k")])
    sand(status=FAILED, failed_at=0.5)
    with pytest.raises(RunFailed, match="broken"):
        calibrate([of_stiffness(38e3, "k")])


def test_what_the_calibration_chooses_cannot_be_set():
    with pytest.raises(InputRefused) as refusal:
        calibrate(
            [of_stiffness(38e3, "k")],
            values={"sand.modulus": 3e6, "sand.damping": 0.1, "sand.seed": 4},
        )
    assert [problem.where for problem in refusal.value.problems] == [
        "sand.modulus",
        "sand.seed",
    ]


def test_the_first_compilation_of_kernels_is_told(sand, monkeypatch, caplog):
    monkeypatch.setattr(first_compilation, "has_kernels", lambda folder: False)
    monkeypatch.setattr(first_compilation, "_told", set())
    sand()
    calibrate(38e3, seeds=2)
    assert "compiling kernels of FallingRock, SandCushion, once on this machine" in caplog.text


# ------------------------------------------------------------------ the command


@pytest.fixture
def command(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "400")
    return lambda *arguments: CliRunner().invoke(app, ["calibrate", *arguments])


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ([], "takes either a file or --stiffness"),
        (["curve.csv", "--stiffness", "1 N/m"], "not both"),
        (["none.csv"], "none.csv: cannot be read"),
        (["--stiffness", "39.1"], "has no unit"),
        (["--stiffness", "39.1 kgf/cm", "--rotation", "fit"], "needs a curve"),
        (["--stiffness", "39.1 kgf/cm", "--rotation", "loose"], "'loose' is unknown"),
        (["--stiffness", "39.1 kgf/cm", "--set", "sand.modulus=1"], "is chosen by the calibration"),
        (
            ["curve.csv", "--rotation", "fit", "--set", "sand.rotation=free"],
            "is what the rotation fit chooses",
        ),
    ],
)
def test_bad_input_is_refused(command, arguments, words):
    result = command(*arguments)
    assert result.exit_code == 2
    assert words in " ".join(result.stderr.split())


def test_the_command_says_that_kernels_are_compiled(command, sand, monkeypatch):
    monkeypatch.setattr(rockshed.commands.calibrate_sand, "is_cold", lambda names: True)
    sand()
    assert "compiling kernels, first run only" in command("--stiffness", "38 kN/m").stderr


def test_exit_codes_of_what_goes_wrong_later(command, sand):
    sand(status=INTERRUPTED)
    assert command("--stiffness", "38 kN/m").exit_code == 130
    sand(status=FAILED, failed_at=0.5)
    assert command("--stiffness", "38 kN/m").exit_code == 1
    sand(factor=0.01)
    refused = command("--stiffness", "38 kN/m", "--json")
    assert refused.exit_code == 2
    assert '"status": "refused"' in refused.stdout


def test_table_4_stands_beside_what_was_printed(command, sand, tmp_path):
    sand(factor=1.29 * 30.0 * kgf / cm / 38e3)  # the paper's line
    result = command("sonoda1993", "--output-dir", "here", "--seeds", "2")
    assert result.exit_code == 0, result.output
    rows = {
        line.split()[1]: line.split()
        for line in result.stdout.splitlines()
        if line.startswith("test ")
    }
    assert list(rows) == ["2", "4", "6", "8", "10", "12"]
    for number, row in rows.items():
        assert float(row[4]) == pytest.approx(float(row[3]) / 1.29, abs=0.06)
        assert abs(float(row[-2])) <= (9 if number == "8" else 3)
    assert {file.name for file in (tmp_path / "here").iterdir()} == {
        "calibration.json",
        "calibration.csv",
        "calibration.png",
    }


# ------------------------------------------------------------------ from Python


def test_a_result_has_metrics_tables_and_a_figure(sand, tmp_path):
    sand()
    result = calibrate([of_stiffness(k, f"{k:g}") for k in (38e3, 57e3)], seeds=2)
    assert result.metrics["38000_e_bar"].value / E_BAR == pytest.approx(30.0, rel=1e-3)
    assert result.metrics["57000_e_bar"].unit == "Pa"
    (table,) = result.tables()
    assert [row["E_bar (kgf/cm²)"] for row in table] == ["30.0", "45.0"]
    assert set(result.figures()) == {"calibration"}
    assert result.to_arrow().column("e_bar").to_pylist() == pytest.approx(
        [30.0 * E_BAR, 45.0 * E_BAR], rel=1e-3
    )
    assert repr(result).startswith("<CalibrationResult 38000, 57000: E_bar 30.0 ± 0.0 kgf/cm²")


def test_files_join_those_that_are_in_the_folder(sand, tmp_path):
    sand()
    (tmp_path / "letter").write_text("dear")
    result = calibrate(38e3, seeds=2, folder=tmp_path)
    assert {file.name for file in tmp_path.iterdir()} == {
        "letter",
        "calibration.json",
        "calibration.csv",
    }
    assert result.metrics["e_bar"].value / E_BAR == pytest.approx(30.0, rel=1e-3)
    result.save(tmp_path)
    assert (tmp_path / "calibration.png").is_file()


def test_a_calibration_that_fails_leaves_nothing(sand, tmp_path):
    sand(status=FAILED, failed_at=0.5)
    with pytest.raises(RunFailed):
        calibrate(38e3, folder=tmp_path / "a" / "b")
    assert not list(tmp_path.iterdir())


def test_everything_wrong_with_the_arguments_is_told_at_once(tmp_path):
    with pytest.raises(InputRefused) as refusal:
        calibrate(tmp_path / "none.csv", rotation="loose", seeds=1)
    where = [problem.where for problem in refusal.value.problems]
    assert where == ["rotation", "seeds", str(tmp_path / "none.csv")]
    with pytest.raises(InputRefused, match="not above zero"):
        calibrate(-1.0)


def test_a_calibration_that_was_interrupted_goes_on_where_it_was(monkeypatch, tmp_path):
    """The FMUs are there; the runs are made up, and the fourth one is not carried out."""
    carried_out = []

    def run_one(order):
        carried_out.append(order.key)
        if len(carried_out) == 4:
            raise KeyboardInterrupt
        modulus = order.system.components["sand"].parameters["modulus"]
        curve = push(float(modulus) / E_BAR, 1, 0.2, 1.0).curve
        series = {
            "sand.penetration": curve.depth,
            "sand.rock.force.y": curve.load,
            "sand.surface_height": np.full_like(curve.depth, 0.1),
            "sand.surface_level": np.full_like(curve.depth, 0.1),
            "sand.stable_step": np.full_like(curve.depth, 1e-4),
        }
        fmus = kept._present(order.system)
        return Outcome(order.key, COMPLETE, series=series, options={"packing": "square"}, fmus=fmus)

    monkeypatch.setattr(batch, "run_one", run_one)
    monkeypatch.setattr(batch, "_carry_out", lambda orders, *_: map(run_one, orders))
    with pytest.raises(KeyboardInterrupt):
        calibrate(38e3, seeds=2, folder=tmp_path / "out")
    first = carried_out.copy()
    assert len(list((tmp_path / "out" / FINISHED).glob("run-*"))) == 3
    result = calibrate(38e3, seeds=2, folder=tmp_path / "out")
    assert result.best.modulus > 0.0
    assert len(carried_out) == len(set(carried_out)) + 1  # the fourth one twice
    assert carried_out[4] == first[3]
    assert not (tmp_path / "out" / FINISHED).exists()
