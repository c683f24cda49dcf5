"""System files with one fault of each kind, or with several: told with line and column, at once."""

import re
import shutil
from functools import partial
from pathlib import Path

import pytest
from typer.testing import CliRunner

import rockshed
from rockshed.commands.app import app
from rockshed.core.errors import InputRefused
from rockshed.fmus.build import build_if_needed
from rockshed.runs.system_file import SystemFile

RIGHT = """\
name = "two"
exchange_step = 1e-3
stop_time = 0.02
state_interval = 1e-2
master = "jacobi"
order = ["a", "b"]
record = ["a.*"]
watch = ["a.position.x"]
isolate = []
connections = [
    "a.angle -> b.torque",
    {source = "a.position.x", target = "b.force.x", factor = "3 kN/m"},
]

[components.a]
fmu = "FMU"
step = 1e-3
record_states = true

[components.a.parameters]
mass = 2.0
"position0.x" = 0.5

[components.b]
fmu = "FMU"

[shared.weight]
value = 9.8
targets = ["a.gravity", "b.gravity"]

[energy_alarm]
reference = "a.energy.kinetic"

[iteration]
window = 1e-3

[[scenario.set]]
port = "a.force.x"
value = 1.0
at = 0.01

[[scenario.fault]]
port = "b.force.x"
kind = "cut"
from = 0.01
"""
TORQUE = '"a.angle -> b.torque"'
RIGHT = RIGHT.replace(TORQUE, '{source = "a.angle", target = "b.torque", factor = 1.0}')
TORQUE = '{source = "a.angle", target = "b.torque", factor = 1.0}'
FAULTS = {
    "a time of another kind": ("stop_time = 0.02", 'stop_time = "2 kg"', 3),
    "a time that is none": ("stop_time = 0.02", 'stop_time = "soon"', 3),
    "a time that does not fit": ("stop_time = 0.02", "stop_time = 0.0205", 3),
    "an end before the start": ("stop_time = 0.02", "stop_time = -1.0", 3),
    "an interval that does not fit": ("state_interval = 1e-2", "state_interval = 1.5e-3", 4),
    "a key that there is not": ('master = "jacobi"', 'mastr = "jacobi"', 5),
    "a word that there is not": ('master = "jacobi"', 'master = "gauss"', 5),
    "an order without a component": ('order = ["a", "b"]', 'order = ["a"]', 6),
    "an order of others": ('order = ["a", "b"]', 'order = ["a", "b", "c"]', 6),
    "a record of nothing": ('record = ["a.*"]', 'record = ["a.nothing"]', 7),
    "a watch of nothing": ('watch = ["a.position.x"]', 'watch = ["a.nothing"]', 8),
    "no such component to isolate": ("isolate = []", 'isolate = ["c"]', 9),
    "text that is no connection": (TORQUE, '"a.angle > b.torque"', 11),
    "a source that there is not": (TORQUE, '"a.angl -> b.torque"', 11),
    "a component that there is not": (TORQUE, '"c.angle -> b.torque"', 11),
    "units that do not fit": (TORQUE, '"a.angle -> b.torque"', 11),
    "an input that is driven twice": (TORQUE, '"a.torque -> b.force.x"', 11),
    "a factor of another kind": ("3 kN/m", "3 kN", 12),
    "a factor that is none": ('"3 kN/m"', '"much"', 12),
    "a step that does not fit": ("step = 1e-3\nrecord", "step = 0.7e-3\nrecord", 17),
    "a step that is none": ("step = 1e-3\nrecord", "step = 0\nrecord", 17),
    "a key of a component": ("record_states = true", "record_state = true", 18),
    "a value of another kind": ("mass = 2.0", 'mass = "2 m"', 21),
    "a value out of range": ("mass = 2.0", "mass = -2.0", 21),
    "a word for a number": ("mass = 2.0", 'mass = "heavy"', 21),
    "a list for a number": ("mass = 2.0", "mass = [2.0]", 21),
    "a parameter that there is not": ("mass = 2.0", "maas = 2.0", 21),
    "a key with a dot": ('"position0.x" = 0.5', "position0.x = 0.5", 22),
    "a value that is set and fed": (
        '[components.b]\nfmu = "FMU"',
        '[components.b]\nfmu = "FMU"\nparameters = {torque = 1.0}',
        26,
    ),
    "a shared value of another kind": ("value = 9.8", 'value = "9.8 kg"', 28),
    "a target that there is not": ('"a.gravity", ', '"a.gravty", ', 28),
    "a reference that there is not": ("a.energy.kinetic", "a.energy.kinetc", 32),
    "a reference of another kind": ("a.energy.kinetic", "5 kg", 32),
    "a window of another kind": ("window = 1e-3", 'window = "1 m"', 35),
    "a port that there is not": ('port = "a.force.x"', 'port = "a.force.z"', 38),
    "a scenario's value of another kind": ("value = 1.0\nat", 'value = "1 m"\nat', 39),
    "a time of no exchange": ("at = 0.01", "at = 0.0105", 40),
    "a condition of another kind": ("at = 0.01", 'when = "a.position.x < 3 kg"', 40),
    "a fault of nothing": ('port = "b.force.x"', 'port = "b.force.y"', 43),
    "a kind that there is not": ('kind = "cut"', 'kind = "broken"', 44),
    "a begin beyond the end": ("from = 0.01", "from = 10.0", 45),
}
"""What is right, what stands there instead, and its line or that of the value it spoils."""


@pytest.fixture
def written(rock_fmu, tmp_path, monkeypatch):
    """Writes a system file with other texts in it."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "300")

    def write(*faults):
        text = RIGHT
        for right, wrong in faults:
            assert text.count(right) == 1, right
            text = text.replace(right, wrong)
        (tmp_path / "two.toml").write_text(text.replace("FMU", str(rock_fmu)))
        return tmp_path / "two.toml"

    return write


def refused(*words):
    done = CliRunner().invoke(app, [*map(str, words)])
    assert done.exit_code == 2, done.output
    return re.sub(" +", " ", done.output)


def lines(said):
    return [int(line) for line in re.findall(r"two\.toml, line (\d+), column \d+: ", said)]


def test_the_right_file_runs(written):
    done = CliRunner().invoke(app, ["run", str(written()), "--no-figures", "--output-dir", "run"])
    assert done.exit_code == 0, done.output


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_is_told_with_its_line(written, fault):
    right, wrong, line = FAULTS[fault]
    said = refused("run", written((right, wrong)).name, "--no-figures", "--output-dir", "run")
    assert line in lines(said), said
    assert said.count("two.toml") == len(lines(said)), said  # none without a line


@pytest.mark.parametrize("words", [("info",), ("info", "--toml"), ("converge",)])
def test_other_commands_tell_the_line_too(written, words):
    file = written(("mass = 2.0", "mass = -2.0"), ("at = 0.01", "at = 0.0105"))
    assert lines(refused(words[0], file.name, *words[1:])) == [21, 40]


def test_a_value_that_an_fmu_refuses_has_its_line(written):
    file = written(("mass = 2.0", "mass = -2.0"))
    system = rockshed.System.load(file)
    assert [p.where for p in system.validate()] == [f"{file}, line 21, column 1: a.mass"]
    for refusing in (partial(rockshed.simulate, system), system.describe):
        with pytest.raises(InputRefused, match=r"line 21, column 1: a\.mass"):
            refusing()
    file.write_text(file.read_text().partition("[[scenario")[0])
    with pytest.raises(InputRefused, match=r"line 21, column 1: a\.mass"):
        rockshed.System.load(file).save(file.parent / "two.ssp")


def test_faults_of_form_hide_no_others_and_all_are_told_in_the_order_of_the_file(written):
    file = written(
        ("stop_time = 0.02", 'stop_time = "2 kg"'),  # form: the times cannot be looked at
        ('watch = ["a.position.x"]', 'watch = ["a.nothing"]'),
        (TORQUE, '"a.angl -> b.torque"'),
        ("3 kN/m", "3 kN"),
        ("record_states = true", "record_state = true"),  # form
        ("mass = 2.0", 'mass = "2 m"'),
        ('"position0.x" = 0.5', '"position0.z" = 0.5'),
        ('[components.b]\nfmu = "FMU"', '[components.b]\nfmu = "missing.fmu"'),
        ('"a.gravity", ', '"a.gravty", '),
        ("value = 1.0\nat", "valu = 1.0\nat"),  # form, twice
        ('port = "b.force.x"', 'port = "a.force.z"'),
    )
    said = refused("run", file.name)
    assert lines(said) == [3, 8, 11, 12, 18, 21, 22, 25, 28, 37, 39, 43]
    assert said.count("two.toml") == 12


def test_entries_behind_a_faulty_one_keep_their_numbers(written):
    more = '\n[[scenario.set]]\nport = "a.force.z"\nvalue = 1.0\nat = 0.01\n'
    file = written(("value = 1.0\nat", "valu = 1.0\nat"), ("from = 0.01\n", f"from = 0.01\n{more}"))
    said = refused("run", file.name)
    assert "line 48, column 1: scenario.set.1.port" in said


def test_a_component_without_an_fmu_hides_nothing_and_makes_no_faults(written):
    file = written(('[components.b]\nfmu = "FMU"', '[components.b]\nfm = "FMU"'))
    assert lines(refused("run", file.name)) == [24, 25]
    file = written(
        ('[components.b]\nfmu = "FMU"', '[components.b]\nfm = "FMU"'), ("mass = 2.0", "mass = -1.0")
    )
    assert lines(refused("run", file.name)) == [21, 24, 25]


def test_a_value_of_an_option_is_not_looked_for_in_the_file(written):
    file = written(('record = ["a.*"]', 'record = ["a.nothing"]'))
    options = ("--set", "a.mass=-1", "--set", "weight=heavy", "--stop-time", "0.0205")
    said = refused("run", file.name, *options)
    assert lines(said) == [7]
    for told in (" --stop-time: 0.0205 s", " a.mass: -1", " a.gravity: 'heavy'", " b.gravity:"):
        assert f"\n{told}" in said, said


def test_options_are_looked_at_where_the_file_is_refused(written):
    file = written(("record_states = true", "record_state = true"))
    options = ("--set", "a.mass=2 m", "--set", "b.nothing=1", "--stop-time", "0.0205")
    said = refused("run", file.name, *options)
    assert lines(said) == [18]
    for told in (" --stop-time: 0.0205 s", " a.mass: '2 m'", " b.nothing: b has no variable"):
        assert f"\n{told}" in said, said


def test_a_table_of_inputs_that_is_wrong_is_told_with_the_rest(written, tmp_path):
    file = written(
        ("[[scenario.set]]", '[scenario]\ninputs = "in.csv"\n[[scenario.set]]'),
        ("record_states = true", "record_state = true"),
    )
    (tmp_path / "in.csv").write_text("time,a.torque\n0,x\n")
    said = refused("run", file.name)
    assert lines(said) == [18]
    assert "in.csv, line 2, column 3" in said


@pytest.mark.parametrize(
    "text",
    [
        'components = 3\nname = "x"\nstop_time = 1\nexchange_step = 1',
        'components = {a = 3}\nname = "x"\nstop_time = 1\nexchange_step = 1',
        'components = {time = {fmu = "x"}}\nconnections = 3\nscenario = 4\nshared = {a = 1}',
        'components = {a = {fmu = "x", parameters = 3}}\nscenario = {set = 3, fault = [1, 2]}',
        "connections = [1, {source = 3}]\nbonds = [1]\niteration = {connections = [3]}\nname = 3",
    ],
)
def test_a_file_of_whatever_form_is_refused_with_its_faults(tmp_path, text):
    (tmp_path / "odd.toml").write_text(text)
    with pytest.raises(InputRefused):
        SystemFile.read(tmp_path / "odd.toml").system()


def test_a_study_tells_the_lines_of_its_file_and_not_of_what_varies(written):
    file = written(
        ("mass = 2.0", "mass = -2.0"),  # in its place are those that vary
        ('watch = ["a.position.x"]', 'watch = ["a.nothing"]'),
        ('"position0.x" = 0.5', '"position0.z" = 0.5'),
    )
    said = refused("study", file.name, "--vary", "a.mass=1 kg,2 m", "--set", "a.radius=0.1")
    assert lines(said) == [8, 22]
    assert "--vary a.mass: must be a mass, in kg (given: '2 m'" in said


def test_the_page_on_system_files_shows_a_file_that_runs_and_what_is_told_of_a_wrong_one(
    rock_fmu, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "100")
    page = (Path(__file__).parents[2] / "docs/system-files.md").read_text(encoding="utf-8")
    right, said = (page.split(f"```{kind}\n")[1].split("```")[0] for kind in ("toml", "text"))
    shutil.copy(rock_fmu, "FallingRock.fmu")
    shutil.copy(build_if_needed("SandCushion"), "SandCushion.fmu")
    Path("drop.toml").write_text(right.replace('"20 ms"', '"0.1 ms"'))
    done = CliRunner().invoke(app, ["run", "drop.toml", "--no-figures", "-q"])
    assert done.exit_code == 0, done.output
    for sound, wrong in (
        ('"20 ms"', '"2 kg"'),
        ("rock.force.y ->", "rock.forc.y ->"),
        ('"4 kg"', "-1"),
    ):
        assert right.count(sound) == 1
        right = right.replace(sound, wrong)
    Path("drop.toml").write_text(right)
    told = CliRunner().invoke(app, ["run", "drop.toml", "--no-figures", "-q"]).output
    assert [line.rstrip() for line in told.splitlines()] == said.splitlines()
