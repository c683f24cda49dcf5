"""Back-analysis: parameters that made the end points lie within what is inferred from them."""

import shutil
import tomllib

import numpy as np
import pyarrow.parquet
import pytest
from typer.testing import CliRunner

import rockshed
from rockshed.analyses.back_analysis.likelihood import held_out
from rockshed.analyses.back_analysis.parameters import Parameter
from rockshed.analyses.saved import saved_result
from rockshed.commands.app import app
from rockshed.components.slope_rockfall.records import OUTCOME
from rockshed.core.errors import InputRefused

POINTS = [[0, 40, "soil"], [30, 12, "soil"], [45, 8, "soil"], [120, 3]]
TRUTH = {"soil.roughness.mean": 0.25, "soil.undulation": 0.1}
RANGES = {"soil.roughness.mean": (0.05, 0.6), "soil.undulation": (0.0, 0.4)}


def site(**values):
    return {
        "name": "slope",
        "rock": {"radius": 0.4, "density": 2600.0},
        "start": {"x": 1.0},
        "limit_speed": {"mean": 12.0, "deviation": 2.0},
        "profile": {"points": POINTS},
        "material": {"soil": {"like": "soil", **values}},
        "line": [{"name": "road", "x": 35.0}],
    }


@pytest.fixture(scope="module")
def measured(tmp_path_factory):
    """End points, and speeds at a line, of 50 rocks on a slope whose ground is known."""
    truth = site(roughness={"mean": 0.25, "deviation": 0.04}, undulation=0.1)
    made = rockshed.rockfall(truth, trials=50, seed=77).to_arrow()
    file = tmp_path_factory.mktemp("data") / "ends.csv"
    rows = zip(made["x"].to_pylist(), made["road.speed"].to_pylist(), strict=True)
    lines = [f"{x:.2f};{speed:.2f}" for x, speed in rows]
    file.write_text("\n".join(["x (m);road.speed (m/s)", *lines]))
    return file


@pytest.fixture(scope="module")
def found(measured, tmp_path_factory):
    return rockshed.calibrate_rockfall(
        site(),
        measured,
        fit=RANGES,
        steps=60,
        trials=200,
        forecast=site(),
        workers=2,
        folder=tmp_path_factory.mktemp("out") / "found",
    )


def test_the_parameters_that_made_the_end_points_lie_within_their_intervals(found):
    for name, (middle, low, high) in found.parameters.items():
        assert low <= TRUTH[name] <= high
        assert low < middle < high
        ends = RANGES[name]
        assert high - low < 0.8 * (ends[1] - ends[0])  # the data have told something


def test_the_fit_has_the_percentiles_of_the_data(found):
    ends = found.inferred.end_points
    for share in (0.1, 0.5, 0.9):
        value, low, high = found.fitted.percentile(share)
        assert low <= value <= high
        assert value == pytest.approx(np.percentile(ends, 100 * share), abs=8.0)
    assert 0.6 < found.covered <= 1.0


def test_the_forecast_of_the_same_slope_is_the_fit(found):
    np.testing.assert_array_equal(found.forecast.ends, found.fitted.ends)


def test_speeds_at_a_line_count_as_measured_too(found):
    names = [entry.name for entry in found.inferred.observed]
    assert names == ["x", "road.speed"]
    assert found.inferred.posterior.pointwise.shape[1] == sum(
        len(entry.values) for entry in found.inferred.observed
    )


def test_samples_and_materials_are_saved_and_the_materials_can_be_used(found):
    table = pyarrow.parquet.read_table(found.folder / "posterior.parquet")
    assert set(RANGES) < set(table.column_names)
    materials = tomllib.loads((found.folder / "calibrated.toml").read_text())["material"]
    assert materials["soil"]["undulation"] == pytest.approx(found.inferred.best[1])
    made = rockshed.rockfall({**site(), "material": materials}, trials=50)
    assert made.records.outcomes.shape == (50, len(OUTCOME))


def test_a_back_analysis_is_drawn_and_reported_again_from_its_folder(found, tmp_path):
    folder = tmp_path / "moved"
    shutil.copytree(found.folder, folder)
    stored = saved_result(folder)
    assert [table.rows for table in stored.tables()] == [table.rows for table in found.tables()]
    assert stored.notes == found.notes
    for name, entry in found.metrics.items():
        assert stored.metrics[name].value == pytest.approx(entry.value, rel=1e-9)
    done = CliRunner().invoke(app, ["plot", str(folder)])
    assert done.exit_code == 0, done.output
    assert {"ends.png", "parameters.png"} <= {file.name for file in folder.rglob("*.png")}
    (page,) = rockshed.report(folder)
    assert "cross-validation" in page.read_text().lower()
    (folder / "ends.parquet").write_bytes(b"PAR1")
    with pytest.raises(InputRefused, match="cannot be read"):
        saved_result(folder)


def test_the_same_samples_come_from_any_number_of_threads(measured):
    effort = {"fit": RANGES, "steps": 20, "trials": 50}
    one, two = (rockshed.calibrate_rockfall(site(), measured, workers=n, **effort) for n in (1, 2))
    np.testing.assert_array_equal(one.inferred.values, two.inferred.values)


def test_weights_leave_out_the_fold_that_made_a_sample_likely():
    """Two samples, of which the second fits the first value only."""
    pointwise = np.array([[-1.0, -1.0], [0.0, -2.0]])
    fold, weights = held_out(pointwise, 2, 1)
    without_first, without_second = weights[fold[0]], weights[fold[1]]
    assert without_first[0] > without_first[1]
    assert without_second[0] < without_second[1]


def test_a_wide_range_is_uniform_in_the_logarithm():
    assert Parameter("a", 1.0, 100.0).value(0.5) == pytest.approx(10.0)
    assert Parameter("a", 0.0, 100.0).value(0.5) == pytest.approx(50.0)


@pytest.mark.parametrize(
    ("text", "options", "words"),
    [
        (
            "x (m)\n40\n41\n42\n43\n500\n",
            [],
            "ends.csv, line 6: x = 500 m is off the profile, which has 0 to 120 m",
        ),
        ("x (m)\n40\n41\n", [], "has 2 end points, from which nothing can be inferred"),
        ("y (m)\n40\n41\n", [], "has no column x"),
        (
            "x (m),gate.speed (m/s)\n40,3\n41,4\n42,\n43,\n44,\n",
            [],
            "column 7: 'gate.speed (m/s)': the site has no line 'gate'",
        ),
        ("x (m),fence.speed\n40,3\n41,\n42,\n43,\n44,\n", [], "has one value of fence.speed"),
        ("x,fence.height\n40,0\n41,0\n42,\n43,\n44,\n", [], "has no fence.height above 0"),
        ("x,fence.energy\n40,9\n41,-2\n42,\n43,\n44,\n", [], "line 3: fence.energy = -2 is neg"),
        (
            "x\n40\n41\n42\n43\n44\n",
            ["--fit", "soil.friction=0.2..inf", "--fit", "a"],
            "--fit: 'a' is no range",
        ),
        (
            "x (m)\n40\n41\n42\n43\n44\n",
            ["--fit", "soil.strenth=1..2"],
            "--fit soil.strenth: there is no such quantity here",
        ),
        ("x (m)\n40\n41\n42\n43\n44\n", ["--fit", "soil.hardening=0..2"], "allowed is 0 to 1"),
        (
            "x (m)\n40\n41\n42\n43\n44\n",
            ["--fit", "soil.friction=0.5..0.2"],
            "0.5 is not below 0.2",
        ),
        ("x (m)\n40\n41\n42\n43\n44\n", ["--fit", "soil.friction"], "is no range of a quantity"),
        ("x (m)\n40\n41\n42\n43\n44\n", ["--trials", "3"], "--trials: 3 are too few"),
        ("x (m)\n40\n41\n42\n43\n44\n", ["--scatter", "0"], "--scatter: 0 m is not positive"),
    ],
)
def test_bad_input_is_refused_before_anything_is_computed(
    tmp_path, monkeypatch, text, options, words
):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "ends.csv").write_text(text)
    (tmp_path / "slope.toml").write_text(
        "[rock]\nradius = 0.4\ndensity = 2600\n[start]\nx = 1.0\n[limit_speed]\nmean = 12\ndeviation = 2\n"
        '[profile]\npoints = [[0, 40, "soil"], [30, 12, "soil"], [120, 3]]\n'
        '[[line]]\nname = "fence"\nx = 30.0\n'
    )
    done = CliRunner().invoke(app, ["calibrate", "rockfall", "slope.toml", "ends.csv", *options])
    assert done.exit_code == 2
    assert words in " ".join(done.output.split())
    assert not (tmp_path / "results").exists()


def test_a_forecast_needs_materials_of_the_same_names(measured):
    other = {**site(), "profile": {"points": [[0, 40, "rock"], [60, 3]]}}
    with pytest.raises(InputRefused, match="rock is no material of slope"):
        rockshed.calibrate_rockfall(site(), measured, forecast=other)
