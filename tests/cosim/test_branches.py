"""Many variants of a run at once: the numbers of each by itself, in one table; or a refusal."""

from pathlib import Path

import pytest
from typer.testing import CliRunner

import rockshed
from rockshed.analyses.saved import saved_result
from rockshed.analyses.study.designs import LISTED, design_problems, points
from rockshed.analyses.study.factors import Factor, Levels, Listed
from rockshed.commands.app import app
from rockshed.core.errors import InputRefused
from rockshed.core.results.bits import first_difference

pytestmark = pytest.mark.usefixtures("own_fmus")

SUPPORT = "beam.support.position.y[2]"
"""An input that nothing feeds."""


@pytest.fixture(scope="module")
def parent(own_fmus, tmp_path_factory):
    """A run of a case with FMUs, and with states to begin from."""
    place = tmp_path_factory.mktemp("parent") / "run"
    system = rockshed.case("lab-impact", values={"rock.velocity0.y": -7.0}, stop_time=0.001)
    return rockshed.simulate(system, place, checkpoint_every=5e-4)


def command(*words):
    return CliRunner().invoke(app, [str(word) for word in words])


def test_variants_of_a_table_have_the_numbers_of_each_by_itself(parent, tmp_path):
    table = tmp_path / "variants.csv"
    table.write_text("rock.velocity0.y;sand.modulus\n-4,0;2e6\n-6;2e6\n-6;4e6\n")
    words = ("--variants", table, "--workers", 1, "--no-figures", "--output-dir", tmp_path / "all")
    told = command("branch", parent.folder, *words)
    assert told.exit_code == 0, told.output
    found = saved_result(tmp_path / "all")
    assert found.records.design == LISTED
    inputs = [dict(run.inputs) for run in found.records.runs]
    assert [list(values.values()) for values in inputs] == [[-4.0, 2e6], [-6.0, 2e6], [-6.0, 4e6]]
    for values, run in zip(inputs[::2], found.records.runs[::2], strict=True):
        alone = rockshed.branch(parent, values)
        for name in ("peak_transmitted_force", "penetration"):
            assert run.metrics[name] == alone.metrics[name].value


def test_variants_with_gaps_or_without_values_are_refused(parent):
    with pytest.raises(InputRefused, match=r"variant 2: has no value of rock\.mass"):
        rockshed.branches(parent, [{"rock.mass": 2.0}, {"rock.radius": 0.1}])
    with pytest.raises(InputRefused, match="variants: have no values"):
        rockshed.branches(parent, [])
    with pytest.raises(InputRefused, match=r"rock\.masse"):
        rockshed.branches(parent, [{"rock.masse": 2.0}])


def test_variants_of_a_run_in_its_process_are_refused(tmp_path):
    system = rockshed.case("lab-impact", in_process=True, stop_time=0.0005)
    run = rockshed.simulate(system, tmp_path / "run")
    with pytest.raises(InputRefused, match="has components in its process"):
        rockshed.branches(run, [{"rock.velocity0.y": -4.0}])


@pytest.mark.parametrize(
    ("text", "words", "told"),
    [
        ("a\n1\n", ("--strict",), "--strict: is for a single variant"),
        ("a\n1\n", ("--vary", "b=1,2"), "--vary: means nothing beside --variants"),
        (f"{SUPPORT}\n0\n1 kg\n", ("--at", "0.5ms"), f"line 3, column 1: {SUPPORT}: must be"),
        ("a,b\n1\n", (), "line 2: has 1 field, and the first line 2"),
        ("a,a\n1,2\n", (), "has 'a' twice"),
        ("a\n", (), "has no variant"),
    ],
)
def test_tables_that_are_none_are_refused_at_their_line(parent, tmp_path, text, words, told):
    table = tmp_path / "variants.csv"
    table.write_text(text)
    refused = command("branch", parent.folder, "--variants", table, *words)
    assert refused.exit_code == 2
    assert told in " ".join(refused.stderr.split())


def test_a_listed_design_takes_as_many_values_of_all():
    first, second = Factor("a", "1", Listed((1, 1, 2))), Factor("b", "1", Levels((3, 4, 5)))
    made = points(LISTED, [first, second], 0, 0)
    assert [point.values for point in made] == [
        {"a": 1, "b": 3},
        {"a": 1, "b": 4},
        {"a": 2, "b": 5},
    ]
    (problem,) = design_problems(LISTED, [first, Factor("b", "1", Levels((3, 4)))], None)
    assert "2 and 3 values do not go together" in problem.what


# ---------------------------------------------------------------- from a later time on


@pytest.mark.parametrize("at", ["0.5ms", "0.73ms"])
def test_variants_from_a_later_time_have_the_numbers_of_each_by_itself(parent, tmp_path, at):
    """At a checkpoint, and at a time to which the run first goes on from it."""
    levels = f"{SUPPORT}=-0.002mm,-1e-6,0.001 mm"
    words = ("--at", at, "--vary", levels, "--workers", 1, "--no-figures")
    told = command("branch", parent.folder, *words, "--output-dir", tmp_path / "all")
    assert told.exit_code == 0, told.output
    found = saved_result(tmp_path / "all").records.runs
    assert [run.inputs[SUPPORT] for run in found] == [-2e-6, -1e-6, 1e-6]
    for run in found[::2]:
        alone = rockshed.branch(parent, dict(run.inputs), at=1e-3 * float(at.removesuffix("ms")))
        same = [alone.metrics[name].value in (value, -value) for name, value in run.metrics.items()]
        assert all(same), [name for name, good in zip(run.metrics, same, strict=True) if not good]
        assert len(same) > 50
    assert found[0].metrics != found[2].metrics


def test_all_that_cannot_be_set_on_the_way_is_told_at_once_before_anything_runs(parent, tmp_path):
    words = [
        *("--at", "0.0005003", "--set", "sand.modulus=3e6", "--workers", 1),
        *("--vary", f"{SUPPORT}=1 kg,0", "--vary", "rock.mass=2,3", "--vary", "beem.x=1,2"),
        *("--output-dir", tmp_path / "all"),
    ]
    refused = command("branch", parent.folder, *words)
    assert refused.exit_code == 2
    told = " ".join(refused.stderr.split())
    for text in (
        "--at: 0.0005003 s is no time of an exchange",
        "--set sand.modulus: is a fixed parameter: FMI sets it before the start alone",
        f"--vary {SUPPORT}: must be a length, in m",
        "--vary rock.mass: is a fixed parameter",
        "--vary beem.x: names no component of the run",
    ):
        assert text in told
    assert not list(tmp_path.iterdir())


def test_a_value_that_is_set_on_the_way_may_have_a_unit(parent, tmp_path):
    words = ("--at", "0.5ms", "--no-figures", "--output-dir", tmp_path / "run", "--set")
    done = command("branch", parent.folder, *words, f"{SUPPORT}=-0.001mm")
    assert done.exit_code == 0, done.output
    plain = rockshed.branch(parent, {SUPPORT: -1e-6}, at=5e-4)
    assert first_difference(plain, rockshed.read_run(tmp_path / "run")) is None
    refused = command("branch", parent.folder, *words, f"{SUPPORT}=1 kg")
    assert f"{SUPPORT}: '1 kg': must be a length, in m" in " ".join(refused.stderr.split())


def test_options_of_many_variants_are_refused_for_one(parent):
    refused = command("branch", parent.folder, "--set", "rock.mass=3", "--workers", 2)
    assert refused.exit_code == 2
    assert "--workers: is for many variants, and this is one" in " ".join(refused.stderr.split())


def test_variants_that_are_interrupted_go_on_to_the_same_table(parent, tmp_path):
    values = {SUPPORT: [-1e-6 * number for number in range(1, 6)]}
    conduct = {"at": 5e-4, "workers": 1}
    whole = rockshed.branches(parent, values, **conduct, folder=tmp_path / "whole")

    def stop(stage, done, total):
        if done == 3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        rockshed.branches(parent, values, **conduct, folder=tmp_path / "cut", progress=stop)
    assert len(list((tmp_path / "cut/.finished-runs").glob("run-*"))) == 3
    done = command("resume", tmp_path / "cut", "--no-figures")
    assert done.exit_code == 0, done.output
    assert "3 of 5 runs have ended before" in done.stderr
    tables = [Path(place, "runs.csv").read_text() for place in (whole.folder, tmp_path / "cut")]
    assert tables[0] == tables[1]


def test_samples_of_a_distribution_are_variants_too(parent):
    drawn = {SUPPORT: rockshed.RandomValue("normal", (0.0, "0.001 mm"))}
    found = rockshed.branches(parent, drawn, at=5e-4, samples=3, workers=1)
    assert found.records.design == "random"
    assert len({run.inputs[SUPPORT] for run in found.records.complete}) == 3


def test_variants_on_the_way_of_a_run_in_its_process_are_refused(tmp_path):
    system = rockshed.case("lab-impact", in_process=True, stop_time=0.0005)
    run = rockshed.simulate(system, tmp_path / "run", checkpoint_every=1e-4)
    with pytest.raises(InputRefused, match="has components in its process"):
        rockshed.branches(run, {SUPPORT: [0.0]}, at=2e-4)


def test_variants_from_the_start_of_a_variant_on_the_way_are_refused(parent, tmp_path):
    """The run of a case has no values that change on the way, and would forget them."""
    variant = rockshed.branch(parent, {SUPPORT: -1e-6}, at=5e-4, folder=tmp_path / "variant")
    with pytest.raises(InputRefused, match="is a variant whose values changed on the way"):
        rockshed.branches(variant, [{"rock.mass": 3.0}])
