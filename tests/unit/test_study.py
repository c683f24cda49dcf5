"""Studies: what varies, the points of designs, statistics of runs, and results that are read again."""

import errno
import math
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats
from typer.testing import CliRunner

import rockshed
from rockshed.analyses.saved import saved_result
from rockshed.analyses.study import run as study_run
from rockshed.analyses.study.designs import DesignPoint, design_problems, points
from rockshed.analyses.study.factors import Factor, Interval, Levels, RandomValue, in_si
from rockshed.analyses.study.records import MetricName, StudyRecords, StudyRun, by_size
from rockshed.analyses.study.result import StudyResult
from rockshed.analyses.study.statistics import (
    exceedance,
    mean_of,
    percentiles,
    ranks,
    sobol_table,
    spreads,
)
from rockshed.commands.app import app
from rockshed.commands.vary import varied_of
from rockshed.core.errors import InputRefused
from rockshed.metrics.percentiles import needed
from rockshed.runs import kept
from rockshed.runs.batch import check_one
from rockshed.runs.outcome import Outcome

NAMES = {"force": MetricName("force", "N")}


def records(design, factors, found, names=NAMES):
    """A study of points and the forces of their runs; None for a run that failed."""
    runs = [
        StudyRun(number, point.role, 1, point.values, *_ended(force))
        for number, (point, force) in enumerate(found, 1)
    ]
    return StudyRecords(design, factors, runs, names)


def _ended(force):
    if force is None:
        return "failed", "the rock is inside the sand"
    return "complete", "", (), {"force": float(force)}


# ------------------------------------------------------------------ what varies


@pytest.mark.parametrize(
    ("text", "varied"),
    [
        ("a=1,2, 3", Levels(("1", "2", "3"))),
        ("a=sand", Levels(("sand",))),
        ("a=compacted sand,poured sand", Levels(("compacted sand", "poured sand"))),
        ("a=0.6m..1.5m:4", Interval("0.6m", "1.5m", 4)),
        ("a=0.6..1.5 m", Interval("0.6 m", "1.5 m", None)),
        ("a=-4..-8", Interval("-4", "-8", None)),
        ("a=lognormal(2.5t, 0.3)", RandomValue("lognormal", ("2.5t", "0.3"))),
        ("a = triangular( 1 m,2 m, 4 m )", RandomValue("triangular", ("1 m", "2 m", "4 m"))),
    ],
)
def test_a_text_says_how_a_value_varies(text, varied):
    problems = []
    assert varied_of([text], problems) == {"a": varied}
    assert problems == []


def test_texts_that_vary_nothing_are_all_refused_with_their_place():
    problems = []
    texts = ["a", "=1", "b=", "c=1,,2", "d=gamma(1,2)", "e=1..", "f=1..2:x", "g=1", "g=2"]
    assert list(varied_of(texts, problems)) == ["g"]
    assert len(problems) == 8
    assert "choose one of normal" in str(problems[4])
    assert "--vary g" in str(problems[7])


def read(value):
    return float(str(value).removesuffix("m"))


@pytest.mark.parametrize(
    ("varied", "reason"),
    [
        (RandomValue("normal", ("1m", "0m")), "deviation must be positive"),
        (RandomValue("normal", ("1m",)), "takes 2 numbers: mean, standard deviation"),
        (RandomValue("lognormal", ("-1m", "0.1")), "median and deviation must be positive"),
        (RandomValue("triangular", ("1m", "0m", "2m")), "must ascend"),
        (RandomValue("weibull", ("1m", "2m")), "there is no distribution 'weibull'"),
        (Interval("2m", "1m"), "above the lower one"),
        (Interval("1m", "2m", 1), "give two at least"),
        (Levels(("1m", "1m")), "twice"),
        (Levels(()), "has no value"),
    ],
)
def test_what_cannot_vary_is_refused(varied, reason):
    _, problems = in_si("a", varied, "m", read)
    assert reason in "; ".join(map(str, problems))


def test_a_sample_of_a_distribution_has_its_percentiles():
    probabilities = np.array([0.5, 0.8413447460685429])
    lognormal = Factor("mass", "kg", RandomValue("lognormal", (2500.0, 0.3)))
    assert lognormal.at(probabilities) == pytest.approx([2500.0, 2500.0 * math.exp(0.3)])
    normal = Factor("height", "m", RandomValue("normal", (25.0, 2.0)))
    assert normal.at(probabilities) == pytest.approx([25.0, 27.0])
    triangular = Factor("x", "m", RandomValue("triangular", (0.0, 1.0, 4.0)))
    assert triangular.at(np.array([0.25])) == pytest.approx([1.0])  # the area left of the mode


def test_each_level_of_a_sample_is_as_probable_as_any_other():
    factor = Factor("sand", "1", Levels(("a", "b", "c")))
    drawn = factor.at(np.linspace(0.0, 1.0, 301))
    assert sorted(set(drawn)) == ["a", "b", "c"]
    assert max(map(drawn.count, "abc")) - min(map(drawn.count, "abc")) <= 1


def test_whole_numbers_without_a_unit_stay_whole():
    assert Factor("elements", "1", Interval(11.0, 31.0, 3)).levels() == [11, 21, 31]
    assert Factor("span", "m", Interval(8.0, 9.0, 2)).levels() == [8.0, 9.0]


# ------------------------------------------------------------------ designs

LENGTH = Factor("span", "m", Interval(8.0, 10.0, 3))
SAND = Factor("sand", "1", Levels(("loose", "dense")))
ANY = Factor("mass", "kg", RandomValue("uniform", (1.0, 2.0)))
RANGE = Factor("height", "m", Interval(0.0, 1.0))


def test_a_grid_has_every_combination_once():
    found = [tuple(point.values.values()) for point in points("grid", [LENGTH, SAND], 0, 0)]
    assert len(found) == len(set(found)) == 6
    assert set(found) == {(x, s) for x in (8.0, 9.0, 10.0) for s in ("loose", "dense")}


def test_one_at_a_time_varies_one_factor_and_begins_with_none():
    found = points("oat", [LENGTH, SAND], 0, 0)
    assert found[0] == DesignPoint({}, "base")
    assert [len(point.values) for point in found[1:]] == [1] * 5


@given(st.integers(2, 60), st.integers(0, 5))
def test_a_latin_hypercube_has_one_sample_in_each_part_of_each_factor(samples, draw):
    found = points("lhs", [ANY, RANGE], samples, draw)
    for name, low in (("mass", 1.0), ("height", 0.0)):
        places = sorted(int((point.values[name] - low) * samples) for point in found)
        assert places == list(range(samples))


def test_points_are_the_same_for_the_same_draw_and_differ_for_another():
    assert points("random", [ANY], 5, 3) == points("random", [ANY], 5, 3)
    assert points("random", [ANY], 5, 3) != points("random", [ANY], 5, 4)


def test_mixed_points_of_a_sobol_design_differ_from_the_first_sample_in_one_factor():
    found = points("sobol", [ANY, RANGE], 8, 1)
    by_role = {role: [p for p in found if p.role == role] for role in ("A", "B", "AB0", "AB1")}
    assert [len(listed) for listed in by_role.values()] == [8] * 4
    for i, name in enumerate(("mass", "height")):
        other = "height" if name == "mass" else "mass"
        for first, second, mixed in zip(by_role["A"], by_role["B"], by_role[f"AB{i}"]):
            assert mixed.values[name] == second.values[name]
            assert mixed.values[other] == first.values[other]


@pytest.mark.parametrize(
    ("design", "factors", "samples", "reason"),
    [
        ("grid", [ANY], None, "is a distribution"),
        ("grid", [RANGE], None, "needs the number of levels"),
        ("grid", [LENGTH], 10, "as many points as its levels make"),
        ("lhs", [LENGTH], 10, "no use for a number of levels"),
        ("lhs", [ANY], None, "needs a number of samples"),
        ("random", [ANY], 1, "two at least"),
        ("sobol", [ANY], 100, "give 64 or 128"),
        ("factorial", [SAND], None, "choose one of grid, oat"),
        ("random", [ANY], 200_000, "100,000 are allowed"),
    ],
)
def test_a_design_that_does_not_fit_is_refused(design, factors, samples, reason):
    assert reason in "; ".join(map(str, design_problems(design, factors, samples)))


# ------------------------------------------------------------------ statistics


@given(st.sampled_from([0.01, 0.05, 0.3, 0.5, 0.9, 0.95, 0.99]))
def test_a_percentile_has_two_bounds_from_the_number_of_values_on_that_is_told(share):
    enough = needed(share)
    for count, bounds in ((enough, True), (enough - 1, False)):
        interval = stats.quantile_test(np.arange(float(count)), p=share).confidence_interval(0.95)
        assert np.isfinite([interval.low, interval.high]).all() == bounds


def test_the_interval_of_a_mean_covers_it_as_often_as_it_says():
    source = np.random.default_rng(5)
    for count in (5, 40):
        covered = [
            mean.low <= 10.0 <= mean.high
            for mean in (mean_of(source.normal(10.0, 2.0, count)) for _ in range(300))
        ]
        assert 0.91 <= np.mean(covered) <= 0.98


def test_a_single_value_has_no_interval_and_equal_ones_have_no_width():
    alone = mean_of(np.array([3.0]))
    assert alone.value == 3.0
    assert math.isnan(alone.low)
    equal = mean_of(np.full(20, 3.0))
    assert (equal.low, equal.high) == (3.0, 3.0)


def test_percentiles_that_a_sample_does_not_bear_are_left_out():
    values = np.random.default_rng(1).random(100)
    assert [entry.share for entry in percentiles(values, [0.5, 0.95, 0.99])] == [0.5, 0.95]


def test_a_curve_of_exceedance_falls_to_0_and_its_band_holds_the_true_one():
    values = np.random.default_rng(2).exponential(1.0, 400)
    curve = exceedance(values)
    assert curve.probability[-1] == 0.0
    assert (np.diff(curve.probability) <= 0.0).all()
    inside = (curve.low <= np.exp(-curve.values)) & (np.exp(-curve.values) <= curve.high)
    assert inside[np.isfinite(curve.low)].mean() > 0.9


def ishigami(point):
    """Ishigami and Homma 1990: indices are known in closed form."""
    x, y, z = (point.values[name] for name in "xyz")
    return math.sin(x) + 7.0 * math.sin(y) ** 2 + 0.1 * z**4 * math.sin(x)


def test_sobol_indices_are_those_of_a_known_function():
    factors = [Factor(name, "1", Interval(-math.pi, math.pi)) for name in "xyz"]
    made = [(point, ishigami(point)) for point in points("sobol", factors, 1024, 0)]
    found = {index.factor: index for index in sobol_table(records("sobol", factors, made), "force")}
    for name, first, total in (("x", 0.3139, 0.5576), ("y", 0.4424, 0.4424), ("z", 0.0, 0.2437)):
        assert found[name].first == pytest.approx(first, abs=0.03)
        assert found[name].total == pytest.approx(total, abs=0.03)
        assert found[name].total_low < total + 0.01
        assert found[name].total_high > total - 0.01


def test_there_are_no_sobol_indices_of_few_samples_or_where_a_run_failed():
    factors = [Factor(name, "1", Interval(-math.pi, math.pi)) for name in "xyz"]
    few = [(point, ishigami(point)) for point in points("sobol", factors, 16, 0)]
    assert sobol_table(records("sobol", factors, few), "force") == []
    made = [(point, ishigami(point)) for point in points("sobol", factors, 64, 0)]
    made[70] = (made[70][0], None)
    assert sobol_table(records("sobol", factors, made), "force") == []


def test_a_rank_correlation_is_1_where_a_metric_rises_with_a_factor_and_small_where_it_does_not():
    drawn = points("random", [ANY, RANGE], 200, 7)
    made = [(point, point.values["mass"] ** 5) for point in drawn]
    first, second = ranks(records("random", [ANY, RANGE], made), "force")
    assert (first.factor, first.correlation) == ("mass", pytest.approx(1.0))
    assert first.is_clear
    assert abs(second.correlation) < 0.2
    assert ranks(records("random", [ANY], made[:9]), "force") == []


def test_the_widest_bar_of_a_tornado_is_that_of_the_strongest_factor():
    made = [
        (point, 10.0 * point.values["span"] + (point.values["sand"] == "dense"))
        for point in points("grid", [LENGTH, SAND], 0, 0)
    ]
    widest, other = spreads(records("grid", [SAND, LENGTH], made), "force")
    assert (widest.factor, widest.low, widest.high) == ("span", 80.5, 100.5)
    assert other.high - other.low == pytest.approx(1.0)


def test_values_between_bounds_are_grouped_by_thirds():
    made = [(point, point.values["height"]) for point in points("lhs", [RANGE], 300, 1)]
    (spread,) = spreads(records("lhs", [RANGE], made), "force")
    assert [mean.value for mean in spread.means] == pytest.approx([1 / 6, 1 / 2, 5 / 6], abs=0.01)


# ------------------------------------------------------------------ results


@pytest.fixture
def campaign():
    drawn = points("random", [ANY, SAND], 120, 1)
    made = [(p, 1e3 * p.values["mass"] + 50.0 * (p.values["sand"] == "dense")) for p in drawn]
    made[3] = (made[3][0], None)
    found = records("random", [ANY, SAND], made)
    return StudyResult("shed", found, ["force"], [0.5, 0.95, 0.99], {"case": "lab-impact"}, {})


def test_a_study_that_is_read_again_is_the_same(campaign, tmp_path):
    campaign.save(tmp_path / "study", pictures=True)
    again = saved_result(tmp_path / "study")
    assert again.records == campaign.records
    assert [str(table) for table in again.tables()] == [str(table) for table in campaign.tables()]
    assert again.warnings == campaign.warnings
    assert {file.name for file in campaign.pictures} == {
        "tornado.png",
        "effects.png",
        "exceedance.png",
    }


def test_runs_that_failed_are_counted_and_shown_and_in_no_mean(campaign):
    assert campaign.metrics["failed_runs"].value == 1
    assert "1 of 120 runs have no result" in campaign.warnings[0]
    assert "the rock is inside the sand" in str(campaign.tables()[-1])
    assert campaign.to_arrow().column("status").to_pylist().count("failed") == 1
    assert campaign.metrics["force_mean"].value == pytest.approx(1525.0, abs=80.0)


def test_percentiles_that_runs_without_a_result_took_away_are_told(campaign):
    assert campaign.shares == (0.5, 0.95)
    assert any("99 %: the 119 runs" in text for text in campaign.warnings)


def test_one_packing_is_told_where_its_scatter_is_missing(campaign):
    assert any("one packing of the sand" in text for text in campaign.warnings)


def test_a_file_of_the_user_in_the_folder_of_a_study_stays(campaign, tmp_path):
    place = tmp_path / "study"
    place.mkdir()
    (place / "notes.txt").write_text("mine")
    campaign.save(place, pictures=False)
    assert (place / "notes.txt").read_text() == "mine"
    other = tmp_path / "other"
    other.mkdir()
    (other / "runs.csv").write_text("mine")
    with pytest.raises(InputRefused, match="would be overwritten"):
        campaign.save(other, pictures=False)


def test_a_study_that_is_damaged_is_refused(campaign, tmp_path):
    place = campaign.save(tmp_path / "study", pictures=False)
    (place / "runs.parquet").write_bytes(b"PAR1")
    with pytest.raises(InputRefused, match="cannot be read"):
        saved_result(place)


def failing(orders, *rest, **others):
    return {o.key: Outcome(o.key, "failed", "the rock is inside the sand") for o in orders}


def test_a_study_without_a_single_result_says_why(monkeypatch, tmp_path):
    monkeypatch.setattr(study_run, "carry_out", failing)
    with pytest.raises(
        rockshed.StudyFailed, match=r"none of the 2 runs .* inside the sand"
    ) as lost:
        rockshed.study("lab-impact", {"rock.velocity0.y": [-4, -8]}, folder=tmp_path / "study")
    assert [run.status for run in lost.value.result.records.runs] == ["failed"] * 2
    assert (tmp_path / "study" / "runs.csv").is_file()


def test_a_study_without_a_result_ends_with_1_and_the_commonest_cause(monkeypatch, tmp_path):
    texts = ["sand: diverged at t = 0.3 s", "no process", "sand: diverged at t = 1.25e-2 s"]

    def failed(orders, *rest, **others):
        return {o.key: Outcome(o.key, "failed", t) for o, t in zip(orders, texts, strict=True)}

    monkeypatch.setattr(study_run, "carry_out", failed)
    words = ["study", "lab-impact", "--vary", "rock.velocity0.y=-4,-6,-8"]
    done = CliRunner().invoke(app, [*words, "--output-dir", str(tmp_path / "study")])
    assert done.exit_code == 1
    told = "none of the 3 runs has a result: sand: diverged at t = 0.3 s (2 of them); no process (1"
    assert told in " ".join(done.stderr.split())


def test_a_peak_whose_sign_is_chance_is_told_by_its_size():
    names = {
        "peak_shear": MetricName("peak shear", "N"),
        "peak_moment": MetricName("peak M", "N.m"),
    }
    names["height"] = MetricName("height", "m")
    values = [(3.0, -5.0, -1.0), (-4.0, -6.0, 1.0)]
    runs = [
        StudyRun(i, "", None, {}, "complete", metrics=dict(zip(names, row, strict=True)))
        for i, row in enumerate(values, 1)
    ]
    made = by_size(StudyRecords("random", [], runs, names))
    assert [list(run.metrics.values()) for run in made.runs] == [[3, -5, -1], [4, -6, 1]]
    assert [name.words for name in made.names.values()] == [
        "size of the peak shear",
        "peak M",
        "height",
    ]


def test_what_is_wrong_in_all_runs_is_told_once():
    project = Path(rockshed.__file__).parent / "examples" / "trial-shed.toml"
    speeds = rockshed.Interval(20.0, 24.0, levels=3)
    with pytest.raises(InputRefused) as refused:
        rockshed.study(project, {"rock.velocity": speeds})
    (problem,) = refused.value.problems
    start = "in design 1 (rock.velocity = 20 m/s) and 2 other runs: rock.velocity"
    assert problem.where.startswith(start)
    assert "two ways to say one thing" in problem.what


@contextmanager
def at_once(workers):
    """A crew that finds nothing to refuse, and the same force in every run."""

    def each(work, orders):
        for number, order in enumerate(orders):
            outcome = Outcome(
                order.key,
                "complete",
                metrics={"force": 1.0},
                units={"force": "N"},
                fmus=kept._present(order.system),
            )
            yield number, [] if work is check_one else outcome

    yield SimpleNamespace(facts={}, each=each)


def test_a_study_on_a_full_disk_says_so_and_what_goes_on(monkeypatch, tmp_path):
    def full(file, *rest):
        raise OSError(errno.ENOSPC, "No space left on device", str(file))

    monkeypatch.setattr(study_run, "processes", at_once)
    monkeypatch.setattr(kept, "_write", full)
    monkeypatch.setattr(StudyResult, "save", lambda result, folder, **rest: full(folder))
    folder = tmp_path / "study"
    words = ["--output-dir", str(folder)]
    done = CliRunner().invoke(
        app, ["study", "lab-impact", "--vary", "sand.modulus=2e6,3e6", *words]
    )
    assert done.exit_code == 1
    said = "".join(done.stderr.split())
    note = f"runs that have ended cannot be kept in {folder / '.finished-runs'}: No space left"
    assert said.count("".join(note.split())) == 1
    assert "Nospaceleftondevice" in said
    assert said.endswith(f"`rockshedresume{folder}`goesonfromwhathasended")


@pytest.mark.parametrize(
    ("vary", "rest", "reason"),
    [
        ({"rock.velocity0.z": [1, 2]}, {}, "did you mean"),
        ({"rock.velocity0.y": ["4 kg"]}, {}, "must be a velocity"),
        ({"rock.velocity0.y": [-4]}, {"values": {"rock.velocity0.y": -3}}, "has a value too"),
        ({"sand.seed": [1, 2]}, {"seeds": 3}, "are one thing"),
        ({}, {}, "nothing varies"),
        (
            {"rock.velocity0.y": rockshed.RandomValue("normal", ("-4 m/s", "1 m/s"))},
            {"samples": 60, "percentiles": [95]},
            "60 samples do not bear it: its 95 % interval has two bounds from 72 on",
        ),
        ({"rock.velocity0.y": [-4, -5]}, {"percentiles": [95]}, "is no sample"),
        ({"rock.velocity0.y": [-4]}, {"certificates": "x"}, "name it with scheduler"),
    ],
)
def test_a_study_that_means_nothing_is_refused_before_anything_runs(
    vary, rest, reason, monkeypatch
):
    monkeypatch.setattr(study_run, "carry_out", lambda *a, **k: pytest.fail("it runs"))
    with pytest.raises(InputRefused, match=reason):
        rockshed.study("lab-impact", vary, **rest)


def test_designs_that_a_project_refuses_are_refused_with_their_number(monkeypatch):
    monkeypatch.setattr(study_run, "carry_out", lambda *a, **k: pytest.fail("it runs"))
    project = Path(rockshed.__file__).parent / "sites" / "shed" / "template.toml"
    with pytest.raises(InputRefused, match=r"design 2 \(rock.mass = -5 kg\)"):
        rockshed.study(project, {"rock.mass": [2500.0, -5.0]})
