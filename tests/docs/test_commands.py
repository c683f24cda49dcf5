"""Commands that the documentation names are there, with their options."""

import re
import shlex
from pathlib import Path

import pytest
import typer

from rockshed.commands.app import COMMANDS, app

ROOT = Path(__file__).parents[2]
PAGES = (
    "README.md",
    "CONTRIBUTING.md",
    "orchestrator/README.md",
    "fmus/README.md",
    *(page.relative_to(ROOT).as_posix() for page in sorted((ROOT / "docs").glob("*.md"))),
    *(page.relative_to(ROOT).as_posix() for page in sorted((ROOT / "components").rglob("*.md"))),
)
QUOTED = re.compile(r"`([^`\n]+)`")
BLOCK = re.compile(r"^```sh\n(.*?)^```", re.MULTILINE | re.DOTALL)
OF_OTHERS = {
    "--version",
    "--dist",
    "--max-worker-restart",
    "--hypothesis-profile",
    "--junitxml",
    "--path",
    "--stepSize",
    "--stopTime",
}
"""Options of the program itself, of pytest, of hypothesis and of the command line of ecos."""


def options(name):
    """Return the options of a command."""
    group = typer.main.get_command(app)
    command = group.get_command(None, name)
    commands = [command]
    if hasattr(command, "list_commands"):
        commands += [command.get_command(None, each) for each in command.list_commands(None)]
    parameters = [parameter for each in commands for parameter in each.params]
    named = {name for p in parameters for name in (*p.opts, *p.secondary_opts)}
    return named | {"--help"}


def texts(page):
    """Return what stands between backquotes, and the lines of the blocks for the shell."""
    text = (ROOT / page).read_text(encoding="utf-8")
    lines = [line for block in BLOCK.findall(text) for line in block.splitlines()]
    return [*QUOTED.findall(text), *lines]


def calls(page):
    """Return name and words of every command of rockshed on a page."""
    for text in texts(page):
        for part in re.split(r"&&|\|\|", text):
            words = shlex.split(part, comments=True)
            starts = [i for i, word in enumerate(words) if Path(word).name == "rockshed"]
            for start in starts:
                if start + 1 < len(words):
                    yield words[start + 1], words[start + 2 :]


@pytest.mark.parametrize("page", PAGES)
def test_a_command_on_a_page_is_there_with_its_options(page):
    wrong = [
        f"rockshed {name} {word}"
        for name, words in calls(page)
        if name in COMMANDS
        for word in words
        if word.startswith("--") and word.partition("=")[0] not in options(name)
    ]
    wrong += [
        f"rockshed {name}"
        for name, _ in calls(page)
        if name not in {*COMMANDS, "COMMAND", "--version"}
    ]
    assert wrong == []


@pytest.mark.parametrize("page", PAGES)
def test_an_option_on_a_page_is_one_of_some_command(page):
    known = set().union(*map(options, COMMANDS), OF_OTHERS)
    named = {
        found for text in texts(page) for found in re.findall(r"(?<![\w-])--[a-z][\w-]*", text)
    }
    assert named - known == set()


def test_the_readme_has_every_command():
    assert set(COMMANDS) <= {name for name, _ in calls("README.md")}
