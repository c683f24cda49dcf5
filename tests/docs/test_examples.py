"""Examples in the documentation and in docstrings do what they say."""

import doctest
import re
from importlib import import_module
from pathlib import Path

import pytest
from typer.testing import CliRunner

from rockshed.commands.app import app

ROOT = Path(__file__).parents[2]
PAGES = (
    "README.md",
    "CONTRIBUTING.md",
    *(f"docs/{page.name}" for page in sorted((ROOT / "docs").glob("*.md"))),
)
LONG = ("README.md", "CONTRIBUTING.md", "docs/python.md", "docs/getting-started.md")
"""Pages whose examples take more than 20 s."""

FOLDERS = {"orchestrator": "rockshed", "components": "rockshed.components", "fmus": "rockshed.fmus"}


def blocks(page):
    """Return the blocks of Python of a page, each with as many empty lines before it as there are
    lines above it, so that an error names its line."""
    text = (ROOT / page).read_text(encoding="utf-8")
    return [
        "\n" * text[: found.start(1)].count("\n") + found[1]
        for found in re.finditer(r"^```python\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
    ]


def modules_with_examples():
    """Return the modules whose docstrings have examples."""
    for folder, package in FOLDERS.items():
        for file in sorted((ROOT / folder).rglob("*.py")):
            if ">>> " in file.read_text(encoding="utf-8") and "dist" not in file.parts:
                parts = file.relative_to(ROOT / folder).with_suffix("").parts
                yield ".".join((package, *parts)).removesuffix(".__init__")


@pytest.fixture
def elsewhere(tmp_path, monkeypatch):
    """Work in an empty folder, beside which the examples of the repository lie."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "agg")
    for place in ("orchestrator/examples", "tests/cosim/outside"):
        (tmp_path / place).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / place).symlink_to(ROOT / place)


@pytest.mark.parametrize(
    "page",
    [
        pytest.param(page, marks=[pytest.mark.slow] if page in LONG else [])
        for page in PAGES
        if blocks(page)
    ],
)
def test_blocks_of_python_on_a_page_run_one_after_the_other(page, elsewhere):
    names = {"__name__": "__main__"}
    for block in blocks(page):
        exec(compile(block, str(ROOT / page), "exec"), names)


def test_the_system_file_of_the_guide_runs_with_the_fmus_that_it_tells_to_build(elsewhere):
    text = (ROOT / "orchestrator" / "README.md").read_text(encoding="utf-8")
    system = re.search(r"^```toml\n(name = \"drop\".*?)^```", text, re.MULTILINE | re.DOTALL)[1]
    Path("drop.toml").write_text(system.replace("stop_time = 0.02", "stop_time = 0.002"))
    built = re.search(r"`rockshed (build [^`]*--output-dir \.)`", text)[1]
    assert CliRunner().invoke(app, built.split()).exit_code == 0
    (code,) = blocks("orchestrator/README.md")
    names = {}
    exec(compile(code, "orchestrator/README.md", "exec"), names)
    assert names["run"].status == "complete"
    assert names["run"].metrics["coupling_rock_energy"].unit == "J"


@pytest.mark.parametrize("name", list(modules_with_examples()))
def test_examples_in_docstrings_give_what_they_show(name, elsewhere):
    failed, tried = doctest.testmod(import_module(name), optionflags=doctest.ELLIPSIS)
    assert tried > 0
    assert failed == 0


def test_the_sweep_of_the_guide_is_the_one_of_the_example():
    _, _, code = (ROOT / "docs" / "examples" / "sweep.py").read_text().split('"""')
    assert any(block.strip() == code.strip() for block in blocks("docs/python.md"))
