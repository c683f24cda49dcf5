"""Build the documentation site: pages into build/pages, the site into build/site.

READMEs and the pages of this folder stay readable in the repository: their links go to files, and
are turned into links between pages here. Tables of components come from their declarations, the
command line from its own help, the reference from the names that ``rockshed`` offers.
"""

import posixpath
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from shutil import copyfile, rmtree
from types import ModuleType
from typing import TYPE_CHECKING, Any, cast

if TYPE_CHECKING:
    import click

ROOT = Path(__file__).resolve().parents[1]
PAGES = ROOT / "build" / "pages"
SITE = ROOT / "build" / "site"

IMPACT = "impact.html"
"""The impact in the browser, made with the site."""

READMES = {
    "README.md": "index.md",
    "orchestrator/README.md": "systems.md",
    "fmus/README.md": "fmus.md",
    "CONTRIBUTING.md": "contributing.md",
    "CHANGELOG.md": "changelog.md",
}
"""Pages by the file of the repository that they show."""

SHOWN = {"orchestrator/__init__.py": "api/index.md"}
"""Pages that are made of a module, by the module: links to it go to its page."""

CONTENTS = {
    "Use": (
        "getting-started",
        "designer",
        "slope-to-shed",
        "python",
        "command-line",
        "systems",
        "system-files",
        "ssp",
        "fmi",
        "scenarios",
        "masters",
        "adaptive",
        "results",
        "checkpoints",
        "studies",
        "report",
        "page",
        "check",
        "impact-systems",
        "experiments",
        "wasm",
        "compatibility",
        "fmus",
        "security",
        "limits",
    ),
    "Physics": (
        "components/index",
        "rockfall",
        "forecasts",
        "formulas",
        "papers",
        "sonoda1993",
        "convergence",
        "piles",
    ),
    "Reference": ("api/index", "api/components", "api/core", "api/analyses", "api/papers"),
    "Project": ("glossary", "contributing", "changelog"),
}
"""Pages by chapter of the table of contents."""

MODULES = {
    "components": (
        "Components",
        "Parts that a component is made of.",
        (
            "rockshed.components.common.ports",
            "rockshed.components.common.component",
            "rockshed.components.common.units",
        ),
    ),
    "core": (
        "Co-simulation core",
        "Systems, runs and results behind the Python API.",
        (
            "rockshed.core.errors",
            "rockshed.core.run",
            "rockshed.core.system.system",
            "rockshed.core.system.parts",
            "rockshed.core.system.scenario",
            "rockshed.core.system.reading",
            "rockshed.core.system.schedule",
            "rockshed.core.results.reading",
            "rockshed.core.results.metric",
            "rockshed.tables",
        ),
    ),
    "analyses": (
        "Analyses",
        "Rockfall campaigns, driven piles and calibration.",
        (
            "rockshed.analyses.rockfall.run",
            "rockshed.analyses.pile.run",
            "rockshed.analyses.calibration.run",
            "rockshed.analyses.study.run",
            "rockshed.analyses.study.factors",
            "rockshed.analyses.back_analysis.run",
        ),
    ),
    "papers": (
        "Papers",
        "Parts that the reproduction of a paper is made of.",
        ("rockshed.papers.study", "rockshed.papers.reproduction", "rockshed.papers.statistics"),
    ),
}
"""Pages of the reference: title, introduction and modules."""

_LINK = re.compile(r"(\]\()([^)#\s]+)(#[^)\s]*)?(\))")


def main() -> int:
    """Lay out the pages and build the site; return the exit code of sphinx."""
    from sphinx.cmd.build import main as sphinx

    lay_out()
    return sphinx(["-W", "--keep-going", "-q", "-b", "html", str(PAGES), str(SITE)])


def lay_out() -> None:
    """Write every page into :data:`PAGES`, with the files that they link to."""
    rmtree(PAGES, ignore_errors=True)
    texts = {source: (ROOT / source).read_text(encoding="utf-8") for source in sources()}
    for source, text in texts.items():
        write(page_of(source), moved(source, text) + appendix(source))
    for name, text in reference().items():
        write(name, text)
    for place in linked_files(texts):
        target = PAGES / uri_of(place)
        target.parent.mkdir(parents=True, exist_ok=True)
        copyfile(ROOT / place, target)
    copyfile(ROOT / "docs" / "conf.py", PAGES / "conf.py")
    play()


def play() -> None:
    """Write the impact in the browser, to which the page about it links."""
    import rockshed

    rockshed.page("lab-impact", PAGES / IMPACT)


def write(page: str, text: str) -> None:
    """Write a page."""
    file = PAGES / page
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text, encoding="utf-8")


# ---------------------------------------------------------------- files and pages


def components() -> dict[str, str]:
    """Return the names of all components by their folder."""
    from rockshed.components.catalogue import NAMES, component

    return {component(name).folder.name: name for name in NAMES}


def sources() -> list[str]:
    """Return the files of the repository that become a page."""
    own = sorted(file.relative_to(ROOT).as_posix() for file in (ROOT / "docs").glob("*.md"))
    return [*READMES, *own, *(f"components/{folder}/README.md" for folder in components())]


def page_of(source: str) -> str:
    """Return the page that shows a file."""
    if source.startswith("docs/"):
        return source.removeprefix("docs/")
    return READMES.get(source) or f"{posixpath.dirname(source)}.md"


def resolved(source: str, target: str) -> str | None:
    """Return the file of the repository that a link of a file goes to; None for the web."""
    if re.match(r"[a-z]+:", target):
        return None
    place = posixpath.normpath(posixpath.join(posixpath.dirname(source), target))
    return place if (ROOT / place).is_file() else None


def uri_of(place: str) -> str:
    """Return where the site has a file of the repository."""
    if place in SHOWN:
        return SHOWN[place]
    if place in sources():
        return page_of(place)
    if place.startswith("docs/"):
        return place.removeprefix("docs/")
    return f"files/{place}.txt" if place.endswith(".md") else f"files/{place}"


def linked_files(texts: dict[str, str]) -> list[str]:
    """Return the files that pages link to and that are no pages themselves."""
    places = {
        resolved(source, link[2]) for source in texts for link in _LINK.finditer(texts[source])
    }
    return sorted(place for place in places if place and place not in (*sources(), *SHOWN))


def moved(source: str, text: str) -> str:
    """Turn the links of a file between files of the repository into links between pages."""
    start = posixpath.dirname(page_of(source)) or "."

    def link(found: re.Match[str]) -> str:
        before, target, anchor, after = found.groups()
        place = resolved(source, target)
        if place is None:
            return found[0]
        return f"{before}{posixpath.relpath(uri_of(place), start)}{anchor or ''}{after}"

    return _LINK.sub(link, text)


# ---------------------------------------------------------------- texts that are made


def appendix(source: str) -> str:
    """Return the part of a page that is made, below the text of its file."""
    made = {
        "README.md": contents,
        "docs/check.md": probes,
        "docs/command-line.md": commands,
        "docs/glossary.md": old_names,
        "docs/page.md": lambda: f"\n## Try it\n\n[The laboratory impact]({IMPACT})\n",
    }
    if source in made:
        return "\n" + made[source]()
    parts = source.split("/")
    return variables(parts[1]) if parts[0] == "components" else ""


def contents() -> str:
    """Return the table of contents."""
    parts = []
    for chapter, pages in CONTENTS.items():
        lines = "\n".join(pages)
        parts.append(f"```{{toctree}}\n:hidden:\n:caption: {chapter}\n\n{lines}\n```\n")
    return "\n".join(parts)


def probes() -> str:
    """Return the table of what `rockshed check` looks at."""
    from rockshed.checking.table import PROBES

    rows = [f"| `{probe.name}` | {probe.about} |" for probe in PROBES]
    return "\n".join(["\n## All probes\n", "| probe | what it looks at |", "|---|---|", *rows, ""])


def variables(folder: str) -> str:
    """Return the tables of a component's sizes and variables."""
    from rockshed.components.catalogue import component

    chosen = component(components()[folder])
    sizes = {name: size.default for name, size in chosen.sizes.items()}
    lines = [f"\n\n## Variables of {chosen.name}\n"]
    if sizes:
        lines += ["Sizes, fixed when an FMU is built:", "", "| size | default | meaning |"]
        lines.append("|---|---|---|")
    for name, size in chosen.sizes.items():
        lines.append(f"| `{name}` | {size.default} | {cell(size.description)} |")
    for causality in ("parameter", "input", "output"):
        lines.append(f"\n### {causality.capitalize()}s of {chosen.name}\n")
        lines += variable_table(chosen.layout.ordered, causality, sizes)
    return "\n".join(lines) + "\n"


def variable_table(variables: Any, causality: str, sizes: dict[str, int]) -> Iterator[str]:
    """Yield the lines of the table of parameters, inputs or outputs."""
    starts = causality != "output"
    yield "| name | unit |" + (" default |" if starts else "") + " meaning | source |"
    yield "|---|---|" + ("---|" if starts else "") + "---|---|"
    for variable in variables:
        if variable.causality == causality:
            length = f"[1..{variable.size}]" if variable.size else ""
            start = f" {start_text(variable, sizes)} |" if starts else ""
            meaning = f"{cell(variable.description)} | {cell(variable.source)}"
            yield f"| `{variable.name}{length}` | {variable.unit} |{start} {meaning} |"


def start_text(variable: Any, sizes: dict[str, int]) -> str:
    """Return the start value of a variable as text."""
    value = variable.start_at(0, sizes)
    if variable.choices:
        return f"`{variable.choices[int(value) - 1]}` of {', '.join(variable.choices)}"
    return ("no", "yes")[int(value)] if variable.kind == "Boolean" else f"{value:.6g}"


def cell(text: str) -> str:
    """Return a text that may stand in a cell of a table."""
    escaped = " ".join(text.split()).replace("|", "\\|").replace("*", "\\*").replace("_", "\\_")
    return escaped.replace("<", "&lt;").replace("[", "\\[")


def commands() -> str:
    """Return the help of every command and of its subjects."""
    import click
    import typer

    from rockshed.commands.app import app

    group = typer.main.get_command(app)
    context = click.Context(group, info_name="rockshed", terminal_width=90)
    return "\n".join(
        f"## {inner.command_path}\n\n```text\n{inner.command.get_help(inner)}\n```\n"
        for inner in contexts(context)
    )


def contexts(context: "click.Context") -> "Iterator[click.Context]":
    """Yield a context for every command of a group, and for those of groups in it."""
    import click

    group = cast("click.Group", context.command)
    for name in group.list_commands(context):
        command = group.get_command(context, name)
        if command is not None and not command.hidden:
            inner = click.Context(command, context, info_name=name, terminal_width=90)
            yield inner
            if hasattr(command, "list_commands"):
                yield from contexts(inner)


def old_names() -> str:
    """Return the table of the names that variables of components had before."""
    from rockshed.components.catalogue import component

    lines = ["### Parameters", "", "| component | old | new |", "|---|---|---|"]
    for name in components().values():
        for variable in component(name).layout.variables:
            for old in getattr(variable, "formerly", ()):
                lines.append(f"| {name} | `{old}` | `{variable.name}` |")
    return "\n".join(lines) + "\n"


def reference() -> dict[str, str]:
    """Return the pages of the reference by their place."""
    pages = {"components/index.md": component_list(), "api/index.md": face()}
    for name, (title, text, modules) in MODULES.items():
        members = "\n\n".join(automatic("module", module) for module in modules)
        pages[f"api/{name}.md"] = f"# {title}\n\n{text}\n\n{members}\n"
    return pages


def automatic(kind: str, name: str) -> str:
    """Return the directive that shows the docstrings of a module, class or function."""
    return f"## {name}\n\n```{{eval-rst}}\n.. auto{kind}:: {name}\n```"


def face() -> str:
    """Return the reference of the names that ``import rockshed`` offers."""
    import rockshed

    names = [name for name in getattr(rockshed, "__all__", ()) if name != "__version__"]
    members = "\n\n".join(
        automatic(kind_of(getattr(rockshed, name)), f"rockshed.{name}") for name in names
    )
    text = "The names of `import rockshed`. [How they work together](../python.md)."
    return f"# Python API reference\n\n{text}\n\n{members}\n"


def kind_of(member: object) -> str:
    """Return what a public name is, as the directive that shows it calls it."""
    if isinstance(member, type):
        return "class"
    return "module" if isinstance(member, ModuleType) else "function"


def component_list() -> str:
    """Return the list of all components."""
    from rockshed.components.catalogue import component

    lines = ["# Components", "", "| FMU | inputs | outputs | parameters |", "|---|---|---|---|"]
    for folder, name in components().items():
        kinds = [variable.causality.value for variable in component(name).layout.variables]
        counts = " | ".join(str(kinds.count(kind)) for kind in ("input", "output", "parameter"))
        lines.append(f"| [{name}]({folder}.md): {cell(component(name).title)} | {counts} |")
    pages = "\n".join(components())
    return "\n".join(lines) + f"\n\n```{{toctree}}\n:hidden:\n\n{pages}\n```\n"


if __name__ == "__main__":
    sys.exit(main())
