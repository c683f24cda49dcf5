"""Documentation inside an FMU: README, variables and sizes of its component as an HTML page."""

from collections.abc import Iterable
from html import escape

from rockshed.components.common.component import Component
from rockshed.components.common.ports import Causality, Kind, Sizes, Variable

from ..parts import Files, picture

_STYLE = (
    "body{font-family:sans-serif;max-width:64em;margin:2em auto;padding:0 1em;line-height:1.5}"
    "table{border-collapse:collapse}th,td{border:1px solid #bbb;"
    "padding:.2em .5em;text-align:left;vertical-align:top}"
    "pre{background:#f4f4f4;padding:.5em;overflow-x:auto}"
)


EXPERIMENTS_PAGE = "documentation/fmi-ls-ref.html"
"""Place of the page about the experiments inside an FMU."""
DIAGRAM = "documentation/diagram.png"
"""Place of the diagram of the ports inside an FMU, as FMI 3.0 names it."""


def documentation(component: Component, sizes: Sizes, others: Files) -> Files:
    """Return the files of the documentation inside an FMU: its page with the others.

    Parameters
    ----------
    component : Component
        Declarations and README.
    sizes : mapping of str to int
        Sizes with which the FMU is built.
    others : Files
        Files of the FMU that the page shows or leads to, where they are among them.
    """
    files = others | picture(component, DIAGRAM, "diagram.png")
    return files | {"documentation/index.html": index_html(component, sizes, files).encode()}


def index_html(component: Component, sizes: Sizes, others: Files) -> str:
    """Return the page ``documentation/index.html``.

    Parameters
    ----------
    component : Component
        The component.
    sizes : mapping of str to int
        Sizes that the FMU is built with.
    others : Files
        Files beside the page.
    """
    from markdown_it import MarkdownIt

    body = MarkdownIt("commonmark").enable("table").render(component.documentation())
    if DIAGRAM in others:
        body += (
            f'<h2>Ports</h2>\n<p><img src="{_beside(DIAGRAM)}" style="max-width:100%" '
            'alt="Inputs on the left, outputs on the right, with units and signs"></p>\n'
        )
    if EXPERIMENTS_PAGE in others:
        body += (
            f'<h2>Experiments</h2>\n<p><a href="{_beside(EXPERIMENTS_PAGE)}">What is done with '
            "this FMU, and what has to come out</a></p>\n"
        )
    body += "<h2>Variables</h2>\n" + table(
        ("name", "causality", "unit", "start", "range", "description", "source"),
        (_row(variable, sizes) for variable in component.layout.ordered),
    )
    if sizes:
        body += "<h2>Sizes of this FMU</h2>\n" + table(
            ("name", "value", "description"),
            (
                (name, str(value), component.sizes[name].description)
                for name, value in sizes.items()
            ),
        )
    return page(component.title, body)


def _beside(path: str) -> str:
    """Return a file's address as seen from the page."""
    return path.removeprefix("documentation/")


def page(title: str, body: str) -> str:
    """Return a page in HTML.

    Parameters
    ----------
    title : str
        Its title, as text.
    body : str
        Its content, as HTML.

    Returns
    -------
    str
        HTML.
    """
    return (
        f'<!DOCTYPE html>\n<html lang="en">\n<head><meta charset="utf-8">'
        f"<title>{escape(title)}</title>"
        f"<style>{_STYLE}</style></head>\n<body>\n{body}</body>\n</html>\n"
    )


def table(head: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """Return a table in HTML.

    Parameters
    ----------
    head : iterable of str
        Names of the columns.
    rows : iterable of iterable of str
        Cells of each row.

    Returns
    -------
    str
        HTML.
    """

    def line(tag: str, cells: Iterable[str]) -> str:
        return "<tr>" + "".join(f"<{tag}>{escape(cell)}</{tag}>" for cell in cells) + "</tr>\n"

    return "<table>\n" + line("th", head) + "".join(line("td", row) for row in rows) + "</table>\n"


def _row(variable: Variable, sizes: Sizes) -> tuple[str, ...]:
    name = variable.name if variable.size is None else f"{variable.name}[1..{sizes[variable.size]}]"
    return (
        name,
        variable.causality,
        variable.unit,
        _start(variable, sizes),
        _range(variable),
        variable.description,
        variable.source,
    )


def _start(variable: Variable, sizes: Sizes) -> str:
    """Return the start value; of an array the first and the last."""
    if variable.causality is Causality.OUTPUT:
        return ""
    last = 0 if variable.size is None else sizes[variable.size] - 1
    first_and_last = dict.fromkeys((variable.start_at(0, sizes), variable.start_at(last, sizes)))
    return " ... ".join(_shown(variable, value) for value in first_and_last)


def _shown(variable: Variable, value: float) -> str:
    if variable.kind is Kind.ENUMERATION:
        return variable.choices[int(value) - 1]
    return str(bool(value)).lower() if variable.kind is Kind.BOOLEAN else f"{value:.9g}"


def _range(variable: Variable) -> str:
    if variable.kind is Kind.ENUMERATION:
        return ", ".join(variable.choices)
    bounds = (("≥", variable.minimum), ("≤", variable.maximum))
    return ", ".join(f"{sign} {bound:g}" for sign, bound in bounds if bound is not None)
