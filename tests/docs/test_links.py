"""Links of the documentation lead somewhere, in the repository and on the site."""

import posixpath
import re
import subprocess
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
LINK = re.compile(r"\]\(([^)\s]+)\)")
HEADING = re.compile(r"^#+\s+(.*)$", re.MULTILINE)
CODE = re.compile(r"^```.*?^```", re.MULTILINE | re.DOTALL)
FOLDERS = ("orchestrator", "components", "fmus", "tests", "docs")
PLACE = re.compile(r"`((?:[\w.-]+/)+[\w-]+\.(?:py|toml|md|c|h|csv|j2))`")


def pages():
    """Return the Markdown files of the repository."""
    top = [path.name for path in ROOT.glob("*.md")]
    below = [
        path.relative_to(ROOT).as_posix()
        for folder in FOLDERS
        for path in (ROOT / folder).rglob("*.md")
    ]
    return sorted([*top, *below])


def anchors(text):
    """Return the anchors that GitHub and the site give to the headings of a page."""
    found = set()
    for heading in HEADING.findall(CODE.sub("", text)):
        words = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).replace("`", "").lower()
        anchor = re.sub(r"[^\w\- ]", "", words).replace(" ", "-")
        number = sum(
            re.fullmatch(rf"{re.escape(anchor)}(-\d+)?", other) is not None for other in found
        )
        found.add(f"{anchor}-{number}" if number else anchor)
    return found


def dead_links(folder, page):
    """Return the relative links of a page that lead to no file, or to no heading of a page."""
    text = (folder / page).read_text(encoding="utf-8")
    dead = []
    for link in LINK.findall(CODE.sub("", text)):
        place, _, anchor = link.partition("#")
        if re.match(r"[a-z]+:", link):
            continue
        target = folder / posixpath.normpath(posixpath.join(posixpath.dirname(page), place))
        target = target if place else folder / page
        is_dead = not target.is_file() or (
            anchor and target.suffix == ".md" and anchor not in anchors(target.read_text("utf-8"))
        )
        if is_dead:
            dead.append(link)
    return dead


@pytest.mark.parametrize("page", pages())
def test_every_link_of_a_page_leads_to_a_file_of_the_repository(page):
    assert dead_links(ROOT, page) == []


@pytest.mark.parametrize("page", pages())
def test_every_file_that_a_page_names_is_there(page):
    text = (ROOT / page).read_text(encoding="utf-8")
    starts = (ROOT, ROOT / page / "..", ROOT / "orchestrator")
    missing = [
        place
        for place in PLACE.findall(CODE.sub("", text))
        if not any((start / place).resolve().is_file() for start in starts)
    ]
    assert missing == []


def test_every_link_of_the_site_leads_to_a_page_of_it(tmp_path, monkeypatch):
    spec = spec_from_file_location("site_of_the_documentation", ROOT / "docs" / "build.py")
    build = module_from_spec(spec)
    spec.loader.exec_module(build)
    monkeypatch.setattr(build, "PAGES", tmp_path)
    build.lay_out()
    laid_out = [path.relative_to(tmp_path).as_posix() for path in tmp_path.rglob("*.md")]
    assert {"index.md", "systems.md", "api/index.md", "components/rbsm_beam.md"} <= set(laid_out)
    dead = {page: links for page in laid_out if (links := dead_links(tmp_path, page))}
    assert dead == {}


@pytest.mark.parametrize(
    ("page", "folders"),
    [
        (
            "orchestrator/README.md",
            ("orchestrator/core", "orchestrator/sites", "orchestrator/analyses"),
        ),
        ("orchestrator/README.md", ("orchestrator/input_files",)),
        ("fmus/README.md", ("fmus",)),
    ],
)
def test_a_page_says_what_each_module_of_its_folders_is_for(page, folders):
    quoted = " ".join(re.findall(r"`([^`\n]+)`", (ROOT / page).read_text(encoding="utf-8")))
    named = set(re.findall(r"\w+", quoted))
    modules = (path for folder in folders for path in (ROOT / folder).rglob("*.py"))
    own = (path for path in modules if "dist" not in path.parts and path.stem != "__init__")
    assert [str(path) for path in own if path.stem not in named] == []


@pytest.mark.parametrize("page", ["README.md", "CONTRIBUTING.md"])
def test_a_table_of_folders_has_every_folder_of_the_package(page):
    tracked = subprocess.run(
        ["git", "ls-files", "orchestrator"], cwd=ROOT, capture_output=True, text=True, check=True
    ).stdout.splitlines()
    if not tracked:
        pytest.skip("no checkout")
    folders = {place.split("/")[1] for place in tracked if place.count("/") > 1}
    text = (ROOT / page).read_text(encoding="utf-8")
    rows = [
        line for line in text.splitlines() if line.startswith("| ") and "`orchestrator/" in line
    ]
    named = {name for row in rows for name in re.findall(r"`(?:orchestrator/)?(\w+)/`", row)}
    assert folders <= named
