"""A reproduction as one HTML page that needs no other file: tables, figures, runs."""

import base64
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from .report import HEADINGS, NUMBERS, Part, cells


def page(parts: Sequence[Part], content: Mapping[str, Any]) -> str:
    """Return the text of the page.

    Parameters
    ----------
    parts : sequence of Part
        Studies with their rows and figures.
    content : mapping
        Content of ``reproduction.json``.

    Returns
    -------
    str
        HTML with the figures inside.
    """
    from jinja2 import Environment, FileSystemLoader, StrictUndefined

    environment = Environment(
        loader=FileSystemLoader(Path(__file__).parent),
        autoescape=True,
        undefined=StrictUndefined,
        keep_trailing_newline=True,
    )
    environment.filters["base64"] = encoded
    environment.filters["cells"] = cells
    return environment.get_template("page.html.j2").render(
        parts=parts, content=content, headings=HEADINGS, numbers=NUMBERS, fmus=fmus(content)
    )


def encoded(file: Path) -> str:
    """Return the content of a file in base 64."""
    return base64.b64encode(file.read_bytes()).decode("ascii")


def fmus(content: Mapping[str, Any]) -> list[str]:
    """Return component and SHA-256 of every FMU of the runs, each once."""
    return sorted(
        {
            f"{component}: {digest}"
            for run in content["runs"]
            for component, digest in run["fmus"].items()
        }
    )
