"""Two wrong inputs of one command: both are told at once, whatever the command.

Words that are none of the command, and numbers that an option does not take, are refused before.
"""

import pytest
from typer.testing import CliRunner

from rockshed.commands.app import COMMANDS, app

CAUSES = {
    "init": [(("taken", "--template", "nothing"), ("taken", "nothing"))],
    "build": [(("Nothing", "--size", "broken"), ("Nothing", "broken"))],
    "info": [
        (("missing.toml", "--diagram", "x.png"), ("missing.toml", "x.png")),
        (("missing.fmu", "--diagram", "x.png"), ("missing.fmu", "--diagram")),
    ],
    "simulate": [
        (("missing.fmu", "--input", "missing.csv"), ("missing.fmu", "missing.csv")),
        (("missing.fmu", "--start-values", "broken"), ("missing.fmu", "broken")),
    ],
    "check": [(("missing.fmu", "--probe", "nothing"), ("missing.fmu", "nothing"))],
    "export": [
        (("missing.toml", "new", "--set", "broken"), ("missing.toml", "broken")),
        (("missing.toml", "occupied"), ("missing.toml", "occupied")),
        (("missing.toml", "new.ssp", "--ssp", "3.0"), ("missing.toml", "3.0")),
        (("nowhere", "--format", "nothing"), ("nowhere", "nothing")),
        (("nowhere", "occupied", "--format", "csv"), ("nowhere", "occupied")),
        (("systems", "occupied", "--set", "a.b=1"), ("systems", "occupied")),
    ],
    "run": [
        (("missing.toml", "--set", "broken"), ("missing.toml", "broken")),
        (("missing.toml", "--output-dir", "occupied"), ("missing.toml", "occupied")),
        (("missing.toml", "--size", "broken", "--band"), ("missing.toml", "broken", "--band")),
    ],
    "branch": [
        (("nowhere", "--variants", "missing.csv"), ("nowhere", "missing.csv")),
        (
            ("nowhere", "--variants", "missing.csv", "--strict"),
            ("nowhere", "missing.csv", "--strict"),
        ),
        (("nowhere", "--set", "broken"), ("nowhere", "broken")),
        (("nowhere",), ("nowhere", "--set: is missing")),
        (("nowhere", "--set", "a.b=1", "--output-dir", "occupied"), ("nowhere", "occupied")),
    ],
    "plot": [
        (("nowhere", "elsewhere", "--variable", "x"), ("nowhere", "elsewhere")),
        (("nowhere", "--variable", "x", "--csv", "missing.csv"), ("nowhere", "missing.csv")),
        (("nowhere", "--csv", "missing.csv"), ("nowhere", "--csv")),
        (("nowhere", "--variable", "x", "--output", "x.doc"), ("nowhere", "x.doc")),
    ],
    "animate": [(("nowhere", "--output", "x.doc"), ("nowhere", "doc"))],
    "report": [(("nowhere", "--output", "x.doc"), ("nowhere", "x.doc"))],
    "page": [
        (("nowhere.toml", "--set", "broken"), ("nowhere.toml", "broken")),
        (("nowhere.toml", "--output", "occupied"), ("nowhere.toml", "occupied")),
    ],
    "bench": [(("nothing", "--quick"), ("nothing", "--quick"))],
    "reproduce": [
        (("nobody", "--output-dir", "taken"), ("nobody", "taken")),
        (("ushiro", "--only", "nothing", "--output-dir", "taken"), ("nothing", "taken")),
    ],
    "calibrate": [
        (("missing.csv", "--set", "broken"), ("missing.csv", "broken")),
        (("--stiffness", "much", "--set", "broken"), ("much", "broken")),
        (("missing.csv", "--rotation", "much"), ("missing.csv", "much")),
        (("pile", "missing.csv", "missing.toml"), ("missing.csv", "missing.toml")),
        (
            ("pile", "missing.csv", "missing.toml", "--output-dir", "occupied"),
            ("missing.csv", "missing.toml", "occupied"),
        ),
        (("rockfall", "missing.toml", "missing.csv"), ("missing.toml", "missing.csv")),
        (
            ("rockfall", "missing.toml", "no.csv", "--forecast", "other.toml", "--fit", "broken"),
            ("missing.toml", "no.csv", "other.toml", "broken"),
        ),
    ],
    "converge": [
        (("missing.toml", "--set", "broken"), ("missing.toml", "broken")),
        (("lab-impact", "--accuracy", "much", "--set", "broken"), ("much", "broken")),
        (("missing.ssp", "--accuracy", "much"), ("missing.ssp", "much")),
    ],
    "study": [
        (("missing.toml", "--vary", "broken", "--set", "x"), ("missing.toml", "broken", "x")),
        (("missing.toml", "--vary", "a.b=1,2", "--percentiles", "x"), ("missing.toml", "x")),
        (
            ("missing.toml", "--vary", "a.b=1,2", "--design", "x", "--percentiles", "y"),
            ("y", "miss"),
        ),
        (("missing.toml", "--vary", "a.b=1,2", "--design", "x"), ("missing.toml", "x")),
        (("missing.toml", "--vary", "a.b=1,2", "--output-dir", "taken"), ("missing.toml", "taken")),
    ],
    "rockfall": [
        (("missing.toml", "--preset", "nothing"), ("missing.toml", "nothing")),
        (("missing.toml", "--animation", "doc"), ("missing.toml", "doc")),
    ],
    "formula": [(("--mass", "much", "--height", "high"), ("much", "high"))],
    "pile": [(("missing.toml", "--output-dir", "occupied"), ("missing.toml", "occupied"))],
}
"""Words of each command with two wrong inputs or more, and what has to be told of each."""
SINGLE = {
    "list": "takes nothing",
    "doctor": "takes nothing",
    "resume": "takes a folder, which has the rest",
    "verify": "takes a folder, which has the rest",
}
"""Commands without two inputs that can be wrong, and why."""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder to stand in, with a folder that is not empty and a file where one would be."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "500")
    (tmp_path / "occupied").mkdir()
    for name in ("shed.toml", "notes.txt"):
        (tmp_path / "occupied" / name).write_text("mine")
    (tmp_path / "taken").write_text("a file")


@pytest.mark.parametrize(
    ("words", "causes"),
    [((command, *words), told) for command in CAUSES for words, told in CAUSES[command]],
    ids=lambda value: " ".join(value),
)
@pytest.mark.usefixtures("folder")
def test_two_wrong_inputs_are_both_told(words, causes):
    result = CliRunner().invoke(app, list(words))
    said = [line for line in result.stderr.splitlines() if line.strip()]
    assert result.exit_code == 2, result.stderr + result.stdout
    for cause in causes:
        assert any(cause in line for line in said), result.stderr
    assert len(said) >= len(causes), result.stderr  # a line for each


def test_every_command_with_two_inputs_is_tried():
    assert {*CAUSES, *SINGLE} == {*COMMANDS}
