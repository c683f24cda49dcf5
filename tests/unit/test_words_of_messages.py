"""Messages name arguments as Python does, and a command shows them as its options."""

import ast
import re
from pathlib import Path

import pytest
from typer.main import get_command
from typer.testing import CliRunner

import rockshed
from rockshed.commands.app import app
from rockshed.commands.screen import Screen
from rockshed.commands.words import OF_RUN, OPTIONS, SAME, in_options, option, options_here
from rockshed.core.errors import Problem

LIBRARY = Path(rockshed.__file__).parent
NAMED = re.compile(r"(?<![\w.'\"/=-])([a-z_]+)=(?=[\w.\"(]|$)")
PYTHON_ALONE = {"system"}
"""Arguments that no command has; their messages say that they are for Python."""
NOT_ARGUMENTS = {"sep", "ssp_path", "step", "description", "factor", "offset", "unit"}
"""The separator that a table tells, arguments of other programs, attributes of XML."""


def texts(tree):
    """Yield the texts of a module that are no docstrings."""
    alone = {
        id(node.value)
        for node in ast.walk(tree)
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
    }
    for node in ast.walk(tree):
        is_text = isinstance(node, ast.Constant) and isinstance(node.value, str)
        if is_text and id(node) not in alone:
            yield node.value


def named_in_messages():
    """Return the arguments that texts of the library name, with the places."""
    found = {}
    for file in sorted(LIBRARY.rglob("*.py")):
        folder = file.relative_to(LIBRARY).parts[0]
        if folder in ("commands", "bench", "components", "fmus"):
            continue
        for text in texts(ast.parse(file.read_text("utf-8"))):
            if " " in text and "<" not in text:
                for name in NAMED.findall(text):
                    found.setdefault(name, []).append(f"{file.name}: {text}")
    return found


def options(command):
    """Yield the options of all commands."""
    for name in getattr(command, "known", {}):
        yield from options(command.get_command(None, name))
    for each in getattr(command, "commands", {}).values():
        if each is not None:
            yield from options(each)
    for each in command.params:
        yield from each.opts


def test_every_argument_that_a_message_names_is_shown_as_an_option():
    found = named_in_messages()
    known = {*OPTIONS, *SAME, *PYTHON_ALONE, *NOT_ARGUMENTS}
    assert {"sizes", "scheduler", "design", "checkpoint_every"} <= set(found)
    assert {name: places for name, places in found.items() if name not in known} == {}


def test_a_value_in_a_message_is_written_as_python_has_it():
    """A word without quotes is no value in Python, and would stay as it is on a command line."""
    places = [place for places in named_in_messages().values() for place in places]
    bare = re.compile(rf"\b(?:{'|'.join({*OPTIONS, *SAME})})=(?!True|False|None)[A-Za-z]")
    assert [place for place in places if bare.search(place)] == []


@pytest.mark.parametrize("argument", sorted({*OPTIONS, *SAME}))
def test_every_option_that_takes_the_place_of_an_argument_is_one_of_a_command(argument):
    known = set(options(get_command(app)))
    assert set(re.findall(r"--[a-z-]+", option(argument))) <= known


def test_an_option_that_the_command_does_not_have_is_named_with_the_one_that_has_it():
    run = get_command(app).get_command(None, "run")
    assert {opt for each in run.params for opt in each.opts} >= OF_RUN
    build = "anew (`rockshed build`, sizes=...)"
    with options_here({"--set"}):
        assert in_options("give it with sizes=...") == "give it with `rockshed run --size`"
        assert in_options(build) == "anew (`rockshed build`, --size)"
        assert in_options("choose samples=4") == "choose --samples 4"
    with options_here({"--size"}):
        assert in_options("give it with sizes=...") == "give it with --size"
        assert in_options(build) == "anew (`rockshed build`, --size)"


@pytest.mark.parametrize(
    ("command", "told"), [("converge", "with `rockshed run --size`"), ("run", "with --size")]
)
def test_a_size_among_the_values_is_refused_with_an_option_that_is_there(command, told):
    done = CliRunner().invoke(app, [command, "lab-impact", "--set", "beam.elements=3"])
    assert done.exit_code == 2
    assert f"give beam.elements = 3 {told}" in " ".join(done.output.split())


def test_all_that_a_screen_says_is_in_its_words(capsys):
    screen = Screen()
    text = 'build it with sizes=..., runtime="native", samples=200 and in_process=True'
    for say in (screen.note, screen.warn, screen.fail, screen.say):
        say(text)
    screen.refuse([Problem("x", text, text)])
    shown = "".join(capsys.readouterr())
    words = "build it with --size, --runtime native, --samples 200 and --in-process"
    assert in_options(text) == words
    assert " ".join(shown.split()).count(words) == 6
    assert "=" not in shown
