"""A report as one HTML page that needs neither network nor other files.

Nothing of the result is ever taken for code: texts are escaped, numbers are data that the script of
the page reads, and a policy in the page lets the browser run that script and plotly.js and nothing
else, nor load anything.
"""

import base64
import gzip
import hashlib
import json
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any

from ..pictures.style import FAINT, INK
from ..temporary import TemporaryFolder
from .charts import thinned
from .form import Chapter, Chart, Document, Film, Illustration

HERE = Path(__file__).parent
GENERATOR = '<meta name="generator" content="rockshed'
"""Mark in the head of a page by which it is known as one of this program."""
_ROWS = 4000
"""Points of a curve, at most: more than a screen is wide."""
_FONT = "system-ui, -apple-system, 'Segoe UI', Roboto, sans-serif"
_KINDS = {".png": "image/png", ".svg": "image/svg+xml"}
"""Kinds of pictures by their ending."""


def page(report: Document) -> str:
    """Return the text of the page.

    Parameters
    ----------
    report : Document
        Of any result.

    Returns
    -------
    str
        HTML with figures, numbers and plotly.js inside.
    """
    from jinja2 import Environment, FileSystemLoader, StrictUndefined

    environment = Environment(
        loader=FileSystemLoader(HERE),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    collected = _Collected()
    chapters = [_shown(chapter, collected) for chapter in report.chapters]
    script = (HERE / "page.js").read_text(encoding="utf-8")
    return environment.get_template("page.html.j2").render(
        report=report,
        chapters=chapters,
        data=_packed(json.dumps(collected.as_data())),
        library=_packed_plotly() if collected.charts else "",
        script=script,
        style=(HERE / "page.css").read_text(encoding="utf-8"),
        policy=_policy(script, _plotly() if collected.charts else ""),
        version=_version(),
    )


class _Collected:
    """Charts and films of a page, which its script finds by their numbers."""

    def __init__(self) -> None:
        self.charts: list[Any] = []
        self.films: list[Any] = []

    def as_data(self) -> dict[str, Any]:
        """Return both as plain data, for the script."""
        return {"charts": self.charts, "films": self.films}


def _shown(chapter: Chapter, collected: _Collected) -> dict[str, Any]:
    """Return a chapter as the template takes it."""
    return {
        "chapter": chapter,
        "name": "".join(c if c.isalnum() else "-" for c in chapter.title.lower()),
        "illustrations": [
            _illustration(illustration, collected)
            for illustration in chapter.illustrations
            if illustration.on_page
        ],
    }


def _illustration(illustration: Illustration, collected: _Collected) -> dict[str, Any]:
    """Return the numbers of the charts and of the film; where there are none, the drawn picture."""
    first = len(collected.charts)
    collected.charts += [_figure(chart) for chart in illustration.charts]
    notes = [chart.note for chart in illustration.charts]
    film = None
    if illustration.film is not None:
        film = len(collected.films)
        collected.films.append(_film(illustration.film))
    shown = illustration.charts or illustration.film is not None
    image, reason = ("", "") if shown else _image(illustration)
    title = illustration.title
    if illustration.film is not None:
        title = illustration.film.component.capitalize()
    return {
        "title": title,
        "charts": list(zip(range(first, len(collected.charts)), notes, strict=True)),
        "film": film,
        "facts": illustration.film.facts if illustration.film else {},
        "image": image,
        "reason": reason,
    }


def _image(illustration: Illustration) -> tuple[str, str]:
    """Return the drawn picture as an address that the page has inside, or why there is none."""
    with TemporaryFolder("rockshed-") as folder:
        file = folder / f"picture{illustration.shown}"
        if reason := illustration.drawn_into(file):
            return "", reason
        kind = _KINDS[illustration.shown]
        return f"data:{kind};base64,{_base64(file.read_bytes())}", ""


def _figure(chart: Chart) -> dict[str, Any]:
    """Return a chart as plotly.js takes it."""
    from plotly.graph_objects import Figure, Scatter  # nobody else needs plotly

    traces = [
        Scatter(
            x=curve.x.astype("f4"),
            y=curve.y.astype("f4"),
            name=_plain(curve.label),
            meta=curve.label,
            mode="lines+markers" if curve.markers else "lines",
            line={"color": curve.colour, "dash": curve.dash, "width": 0.5 if curve.layer else 1.8},
            marker={"size": 4},
            stackgroup="energy" if curve.layer else None,
            fillcolor=curve.colour if curve.layer else None,
            hovertemplate="%{y:.4g}",
        )
        for curve in thinned(chart.curves, _ROWS)
    ]
    made: dict[str, Any] = json.loads(Figure(traces, _layout(chart)).to_json())
    return made


def _layout(chart: Chart) -> dict[str, Any]:
    axis = {
        "gridcolor": FAINT,
        "zerolinecolor": "#9a9a9a",
        "linecolor": "#9a9a9a",
        "ticks": "outside",
    }
    return {
        "template": {},
        "font": {"family": _FONT, "size": 13, "color": INK},
        "paper_bgcolor": "white",
        "plot_bgcolor": "white",
        "hovermode": "x unified",
        "margin": {"l": 30, "r": 16, "t": 36, "b": 52},
        "showlegend": False,
        "xaxis": {**axis, "title": {"text": _plain(chart.x_label)}, "hoverformat": ".4~g"},
        "yaxis": {
            **axis,
            "title": {"text": _plain(chart.y_label), "standoff": 10},
            "autorange": "reversed" if chart.downwards else True,
            "automargin": True,
        },
    }


def _plain(text: str) -> str:
    """Return a text that plotly.js shows letter for letter: it takes some HTML for format."""
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")


def _film(film: Film) -> dict[str, Any]:
    arrays = {
        name: {"kind": values.dtype.str[1:], "data": _base64(values.tobytes())}
        for name, values in film.arrays.items()
    }
    return {**film.facts, "arrays": arrays}


def _base64(content: bytes) -> str:
    return base64.b64encode(content).decode("ascii")


def _packed(text: str) -> str:
    """Return a text compressed, in letters that HTML takes for nothing but text."""
    return _base64(gzip.compress(text.encode(), 9, mtime=0))


@cache
def _plotly() -> str:
    """Return the library plotly.js, as the package has it."""
    from plotly.offline import get_plotlyjs

    return str(get_plotlyjs())


@cache
def _packed_plotly() -> str:
    return _packed(_plotly())


def _policy(*scripts: str) -> str:
    """Return the policy of the page: its scripts by their digests, no address, no other code."""
    digests = [hashlib.sha256(script.encode()).digest() for script in scripts if script]
    allowed = " ".join(f"'sha256-{_base64(digest)}'" for digest in digests)
    parts: Sequence[str] = (
        "default-src 'none'",
        f"script-src {allowed}",
        "style-src 'unsafe-inline'",
        "img-src data: blob:",
        "base-uri 'none'",
        "form-action 'none'",
    )
    return "; ".join(parts)


def _version() -> str:
    from ..versions import version_of

    return version_of("rockshed") or ""
