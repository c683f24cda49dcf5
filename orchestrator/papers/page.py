"""A reproduction as one HTML page that needs no other file: tables, figures, what was run."""

import base64
from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path
from string import Template
from typing import Any

from .report import HEADINGS, NUMBERS, Part, cells
from .study import Row


def page(parts: Sequence[Part], content: Mapping[str, Any]) -> str:
    """The text of the page; ``content`` is that of ``reproduction.json``."""
    template = Template((Path(__file__).parent / "page.html").read_text(encoding="utf-8"))
    return template.substitute(
        title=escape(f"{content['paper']}: reproduced"),
        facts=_facts(content),
        parts="\n".join(map(_part, parts)),
        contents="".join(
            f'<li><a href="#{p.study.name}">{escape(p.study.title)}</a></li>' for p in parts
        ),
        runs=_runs(content["runs"]),
    )


def _facts(content: Mapping[str, Any]) -> str:
    count = len(content["runs"])
    ended = sum(run["status"] == "complete" for run in content["runs"])
    versions = ", ".join(f"{name} {version}" for name, version in content["versions"].items())
    lines = [
        f"{'Quick' if content['quick'] else 'Full'} reproduction of {content['started']}: {count} runs, {ended} of them "
        f"complete, in {content['wall_time']:.0f} s with {content['workers']} processes.",
        "Deviations are computed / reference - 1. ±: standard deviation over seeds.",
        versions,
    ]
    return "".join(f"<p>{escape(line)}</p>" for line in lines)


def _part(part: Part) -> str:
    notes = "".join(f"<p>{escape(note)}</p>" for note in part.study.notes)
    figures = "".join(_figure(file) for file in part.figures)
    return (
        f'<section id="{part.study.name}"><h2>{escape(part.study.title)}</h2>{notes}{figures}'
        f"<table>{_heading((*HEADINGS, 'note'))}<tbody>{''.join(map(_row, part.rows))}</tbody></table></section>"
    )


def _heading(names: Sequence[str]) -> str:
    return "<thead><tr>" + "".join(f"<th>{escape(name)}</th>" for name in names) + "</tr></thead>"


def _figure(file: Path) -> str:
    return f'<img alt="{escape(file.stem)}" src="data:image/png;base64,{base64.b64encode(file.read_bytes()).decode("ascii")}">'


def _row(row: Row) -> str:
    fields = [
        f"<td{' class=number' if name in NUMBERS else ''}>{escape(text)}</td>"
        for name, text in zip(HEADINGS, cells(row), strict=True)
    ]
    return f"<tr>{''.join(fields)}<td class=note>{escape(row.note)}</td></tr>"


def _runs(runs: Sequence[Mapping[str, Any]]) -> str:
    hashes = sorted(
        {f"{component}: {digest}" for run in runs for component, digest in run["fmus"].items()}
    )
    listed = "".join(
        f"<tr><td>{escape(run['name'])}</td><td>{escape(run['status'])}</td>"
        f"<td class=number>{run['wall_time']:.2f}</td></tr>"
        for run in runs
    )
    return (
        f"<p>FMUs (SHA-256)</p><ul>{''.join(f'<li>{escape(text)}</li>' for text in hashes)}</ul>"
        f"<table>{_heading(('run', 'status', 'wall time (s)'))}<tbody>{listed}</tbody></table>"
    )
