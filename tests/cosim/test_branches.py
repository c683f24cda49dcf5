"""Many variants of a run at once: the numbers of each by itself, in one table; or a refusal."""

import pytest
from typer.testing import CliRunner

import rockshed
from rockshed.analyses.saved import saved_result
from rockshed.analyses.study.designs import LISTED, design_problems, points
from rockshed.analyses.study.factors import Factor, Levels, Listed
from rockshed.commands.app import app
from rockshed.core.errors import InputRefused


@pytest.fixture(scope="module")
def parent(tmp_path_factory):
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
        ("a\n1\n", ("--at", "5ms"), "--at: is for a single variant"),
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
