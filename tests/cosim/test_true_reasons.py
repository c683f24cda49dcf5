"""A request that is refused: the true reasons, all of them, causes without what follows from them."""

import shutil

import pytest
from typer.testing import CliRunner

from rockshed.commands.app import app
from rockshed.core.errors import InputRefused
from rockshed.core.run import simulate
from rockshed.core.system import names
from rockshed.core.system.planning import make_plan
from rockshed.runs import simulation
from rockshed.runs.system import System
from tests.cosim.mocks import Mock, inp, out, par, wired


@pytest.fixture
def rockshed(tmp_path, monkeypatch):
    """Run a command in an empty folder, and return its exit code and what it said, in one line."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "500")

    def command(*arguments):
        result = CliRunner().invoke(app, [str(a) for a in arguments])
        return result.exit_code, " ".join((result.stderr + result.stdout).split())

    return command


def run(rockshed, *arguments):
    return rockshed("run", "lab-impact", "--in-process", "--no-figures", *arguments)


def problems(system, sources):
    with pytest.raises(InputRefused) as refusal:
        make_plan(system, sources)
    return [str(problem) for problem in refusal.value.problems]


# ------------------------------------------------------------------ names and options


@pytest.mark.parametrize("twice", [["rock.mass=4", "rock.mass=5"], ["rock.mass=4"] * 2])
def test_a_value_that_is_given_twice_is_refused(rockshed, twice):
    code, said = run(rockshed, *(word for text in twice for word in ("--set", text)))
    assert code == 2
    assert "--set rock.mass: is given twice: 4 and" in said


def test_a_size_that_is_given_twice_is_refused(rockshed):
    code, said = run(rockshed, "--size", "sand.discs=9", "--size", "sand.discs=10")
    assert code == 2
    assert "--size sand.discs: is given twice: 9 and 10" in said


def test_an_option_that_is_given_twice_is_refused(rockshed):
    code, said = run(rockshed, "--stop-time", "0.001", "--stop-time", "0.002")
    assert code == 2
    assert "--stop-time is given 2 times; keep one of them" in said


def test_a_value_under_its_older_and_its_present_name_is_refused(rockshed):
    code, said = run(rockshed, "--set", "sand.unit_weight=1700", "--set", "sand.density=1800")
    assert code == 2
    assert "sand.unit_weight: is the older name of sand.density, and both are given" in said


def test_an_element_that_is_set_with_its_array_and_alone_is_refused():
    mock = Mock([inp("x[1]"), inp("x[2]")])
    twice = {"a": {"parameters": {"x[*]": 0.0, "x[2]": 1.0}}}
    system, sources = wired({"a": mock}, [], components=twice)
    (said,) = problems(system, sources)
    assert said == "a.x[2]: is set twice in components.a.parameters; remove one of both"


def test_a_size_that_is_set_as_a_value_is_pointed_at_the_option_for_sizes(rockshed):
    code, said = run(rockshed, "--set", "sand.discs=400")
    assert code == 2
    assert "sand.discs: is a size, which an FMU is built with" in said
    assert "→ give sand.discs = 400 with --size" in said


def test_a_value_that_is_given_as_a_size_is_pointed_at_the_option_for_values(rockshed):
    code, said = run(rockshed, "--size", "sand.modulus=3e6")
    assert code == 2
    assert (
        "--size sand.modulus: modulus is no size, but a variable → give sand.modulus with --set"
        in said
    )
    code, said = rockshed("build", "SandCushion", "--size", "modulus=3e6")
    assert code == 2
    assert "it is a variable, and gets its value when a run begins" in said


def test_a_size_in_a_system_file_is_told_to_be_fixed_in_the_fmu():
    constant = par("discs", 3, kind="Integer")
    mock = Mock([constant])
    xml = mock.model_description().replace(b"variability='fixed'", b"variability='constant'")
    mock.model_description = lambda: xml.replace(b"'parameter'", b"'local'")
    system, sources = wired({"a": mock}, [], components={"a": {"parameters": {"discs": 4}}})
    (said,) = problems(system, sources)
    assert "a.discs: is a constant, fixed when the FMU was built, and cannot be set" in said
    assert "build the FMU anew with another one" in said


# ------------------------------------------------------------------ targets


@pytest.mark.parametrize(
    ("target", "said"),
    [
        (
            ".",
            ".: is a folder; a run takes a case of `rockshed list`, a system file (TOML) or an SSP",
        ),
        ("exported", "→ name the file exported/system.toml"),
        ("results", "→ it holds the results of a run: `rockshed plot results` draws them"),
        ("some/", "some/: is a folder; a run takes"),
        ("A.FMU", "A.FMU: is an FMU, and a run takes a case"),
        ("plant.ssp", "plant.ssp: there is no such file"),
        ("notes.txt", "notes.txt: is a file whose name does not end in .toml"),
        ("lab-impakt", "→ did you mean lab-impact"),
    ],
)
@pytest.mark.parametrize("command", ["run", "info", "export"])
def test_a_target_that_is_no_system_is_called_what_it_is(rockshed, tmp_path, target, said, command):
    for folder in ("exported", "results", "some"):
        (tmp_path / folder).mkdir()
    (tmp_path / "exported/system.toml").touch()
    (tmp_path / "results/run.json").touch()
    (tmp_path / "notes.txt").touch()
    if command == "info" and target == "A.FMU":
        said = "A.FMU: there is no such file"
    code, found = rockshed(command, target, *(["new"] if command == "export" else []))
    assert code == 2
    assert said in found


def test_a_folder_in_the_place_of_an_fmu_is_called_a_folder(rockshed, tmp_path):
    (tmp_path / "a.fmu").mkdir()
    lines = ["name = 'x'", "exchange_step = 1", "stop_time = 1", "[components.a]", "fmu = 'a.fmu'"]
    (tmp_path / "x.toml").write_text("\n".join(lines))
    code, said = rockshed("run", "x.toml")
    assert code == 2
    assert "a.fmu: is a folder, and no FMU" in said
    code, said = rockshed("info", "a.fmu")
    assert code == 2
    assert "a.fmu: is a folder" in said


def test_an_fmu_with_capital_letters_at_the_end_of_its_name_is_shown(rockshed, tmp_path, rock_fmu):
    shutil.copy(rock_fmu, tmp_path / "X.FMU")
    code, said = rockshed("info", "X.FMU")
    assert code == 0
    assert "FallingRock" in said


# ------------------------------------------------------------------ all at once


def test_all_wrong_connections_are_told_at_once_those_of_a_wrong_form_too(
    rockshed, tmp_path, rock_fmu
):
    shutil.copy(rock_fmu, tmp_path / "rock.fmu")
    (tmp_path / "x.toml").write_text(
        """name = "x"
exchange_step = 0.1
stop_time = 1.0
connections = ["a.no -> b.force.x", "a.position.x", "a.position.x -> b.mass", "c.y -> b.no"]
[components.a]
fmu = "rock.fmu"
[components.b]
fmu = "rock.fmu"
[bonds.wrong]
giver = "a"
"""
    )
    code, said = rockshed("run", "x.toml")
    assert code == 2
    for text in (
        "x.toml, line 4, column 37: connections.1: 'a.position.x' is no connection",
        "x.toml, line 9, column 1: bonds.wrong.taker: is missing",
        "x.toml, line 4, column 16: a.no -> b.force.x: a has no variable 'no'",
        "a.position.x -> b.mass: b.mass is of the causality parameter",
        "c.y -> b.no: there is no component 'c'",
        "c.y -> b.no: b has no variable 'no'",
    ):
        assert text in said


def test_limits_of_steps_are_told_together_with_times_that_do_not_fit(tmp_path):
    ports = [out("step_limit", "s")]
    mocks = {name: Mock(ports, start=lambda v: v.update(step_limit=1e-3)) for name in "ab"}
    system, sources = wired(mocks, [], exchange_step=0.1, output_interval=0.15, stop_time=0.25)
    with pytest.raises(InputRefused) as refusal:
        simulate(system, tmp_path / "run", sources=sources)
    where = [problem.where for problem in refusal.value.problems]
    assert where == ["output_interval", "stop_time", "exchange_step", "a", "b"]
    assert "exceeds step_limit = 0.001 s" in refusal.value.problems[-1].what


def refusing(parameters, inputs):
    """A mock that refuses its parameters (status Error) or its inputs (Discard) at the start."""
    told = (3, "the parameters are wrong") if parameters else (2, "the inputs are wrong")
    return Mock([inp("x"), out("y")], start=lambda v: told if parameters or inputs else None)


def test_what_follows_from_a_refused_parameter_is_left_out(tmp_path):
    mocks = {"cause": refusing(True, False), "next": refusing(False, True)}
    system, sources = wired(mocks, ["cause.y -> next.x"])
    with pytest.raises(InputRefused) as refusal:
        simulate(system, tmp_path / "run", sources=sources)
    assert [str(p) for p in refusal.value.problems] == ["cause: the parameters are wrong"]


def test_refused_inputs_are_told_where_nothing_else_is_wrong(tmp_path):
    mocks = {"cause": refusing(False, False), "next": refusing(False, True)}
    system, sources = wired(mocks, ["cause.y -> next.x"])
    with pytest.raises(InputRefused) as refusal:
        simulate(system, tmp_path / "run", sources=sources)
    assert [str(p) for p in refusal.value.problems] == ["next: the inputs are wrong"]


# ------------------------------------------------------------------ limits


@pytest.mark.parametrize(
    ("shorthand", "said"),
    [
        ("x[1..200000000]", "stands for 200,000,000 elements, and 1,000,000 are the most"),
        ("x[1.." + "9" * 5000 + "]", "has an index of more than 18 digits"),
    ],
)
def test_a_range_of_more_elements_than_an_array_can_have_is_refused(shorthand, said):
    mock = Mock([inp("x[1]"), out("y[1]")])
    end = shorthand.replace("x", "y")
    system, sources = wired({"a": mock, "b": mock}, [f"a.{end} -> b.{shorthand}"])
    found = problems(system, sources)
    assert len(found) == 2
    assert all(said in text for text in found)


def test_a_shared_value_is_found_under_its_targets_however_long_their_range():
    assert names.matches("a.x[1..200000000]", "a.x[7]")
    assert not names.matches("a.x[2..200000000]", "a.x[1]")
    assert not names.matches("a.x[1..3]", "a.x[one]")
    assert names.matches("a.x[*]", "a.x[12]")
    assert not names.matches("a.x[*]", "a.xy[12]")


def test_one_thing_is_not_counted_in_the_plural():
    mock = Mock([inp("x[1]"), inp("x[2]"), out("y")])
    system, sources = wired({"a": mock, "b": mock}, ["a.y -> b.x[*]"])
    (said,) = problems(system, sources)
    assert "connects 1 output with 2 inputs" in said


# ------------------------------------------------------------------ no false warning


def test_an_internal_step_that_the_exchange_cuts_short_gives_no_warning(rockshed):
    code, said = run(rockshed, "--set", "sand.internal_step=1e-3", "--stop-time", "0.0002")
    assert code == 0, said
    assert "unstable" not in said
    assert "warning: sand" not in said  # that it ends early is another one


# ------------------------------------------------------------------ texts


def test_texts_are_recorded_apart_from_numbers():
    mock = Mock([out("level"), out("phase", kind="String"), out("word", kind="String")])
    plan = make_plan(*wired({"a": mock}, [], record=["a.level", "*.ph*"]))
    assert [end.name for end in plan.recorded] == ["a.level"]
    assert [end.name for end in plan.recorded_texts] == ["a.phase"]


def test_a_text_that_is_to_be_watched_is_refused():
    mock = Mock([out("level"), out("phase", kind="String")])
    system, sources = wired({"a": mock}, [], watch=["a.phase", "a.level"])
    said = problems(system, sources)
    assert "watch: 'a.phase' is text, which has no extremes; leave it out" in said


# ------------------------------------------------------------------ steps without an end


@pytest.mark.parametrize(
    "ports", [[par("internal_step", 1e-6, "s")], [par("internal_step", 1.0, "s"), out("time_step")]]
)
def test_more_internal_steps_than_a_run_can_wait_for_are_refused(tmp_path, ports):
    mock = Mock(ports, start=lambda v: v.update(time_step=1e-6) if len(ports) > 1 else None)
    system, sources = wired({"a": mock}, [], exchange_step=1.0)
    with pytest.raises(InputRefused) as refusal:
        simulate(system, tmp_path / "run", sources=sources)
    (problem,) = refusal.value.problems
    assert "internal steps of 1e-06 s are 1e+06 in each communication step" in problem.what
    assert "at most 100,000 can be made" in problem.what


def test_a_rod_that_is_too_stiff_for_its_step_is_refused():
    pile = System.new("pile", exchange_step=1.0, stop_time=1.0)
    pile = pile.add("rod", "PileRod", {"section.modulus[*]": 1e16, "head.port": "waves"})
    with pytest.raises(InputRefused, match=r"rod.time_step: internal steps of .* can be made"):
        simulation.simulate(pile)
