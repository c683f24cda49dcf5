"""Options that say how values vary, and the texts in them: levels, ranges and distributions."""

import re
from collections.abc import Sequence
from typing import Annotated

import typer

from ..analyses.study.factors import KINDS, Interval, Levels, RandomValue, Varied
from ..core.errors import Problem
from ..core.input_text import shown

Vary = Annotated[
    list[str] | None,
    typer.Option(
        metavar="NAME=HOW",
        help="Vary a field of a project, component.parameter or a shared value: levels A,B,C, a "
        "range LOW..HIGH:LEVELS, or normal(MEAN, DEVIATION), lognormal(MEDIAN, DEVIATION OF LN), "
        "uniform(LOW, HIGH), triangular(LOW, MODE, HIGH). May be repeated.",
    ),
]
Design = Annotated[
    str | None,
    typer.Option(
        metavar="grid|oat|listed|random|lhs|sobol",
        help="Every combination, one at a time, the n-th values of all together, independent "
        "samples, Latin hypercube, or Sobol sequence; default grid, with a distribution random.",
    ),
]
SampleCount = Annotated[
    int | None, typer.Option(help="Samples that are drawn; sobol runs (factors + 2) times as many.")
]
AnotherDraw = Annotated[
    int | None, typer.Option(min=0, help="Another draw of the samples; default 0.")
]
ToldMetrics = Annotated[
    list[str] | None,
    typer.Option(
        "--metric",
        metavar="ID",
        help="Tell this metric (peak_transmitted_force, ...); default: forces, penetration, "
        "moment, deflection, utilisation. May be repeated.",
    ),
]
ToldPercentiles = Annotated[
    str | None,
    typer.Option(metavar="50,95", help="Percentiles that are told; default: all that are borne."),
]

_CALL = re.compile(r"(\w+)\s*\((.*)\)")
_COUNT = re.compile(r"[0-9]{1,15}")
_FORMS = "write NAME=A,B,C, NAME=LOW..HIGH:LEVELS or NAME=normal(MEAN, DEVIATION)"


def varied_of(texts: Sequence[str], problems: list[Problem]) -> dict[str, Varied]:
    """Read what varies, by name.

    Parameters
    ----------
    texts : sequence of str
        ``cushion.thickness=0.6m..1.5m:4``, ``cushion.material=sand,gravel``,
        ``rock.mass=lognormal(2.5t, 0.3)``; blanks do not matter.
    problems : list of Problem
        Texts that cannot be read, and names that are given twice, are appended.

    Returns
    -------
    dict of str to Varied
        By name; numbers are texts still.
    """
    found: dict[str, Varied] = {}
    for text in texts:
        name, equals, content = (part.strip() for part in text.partition("="))
        where = f"--vary {name}" if name else "--vary"
        if not (name and equals and content):
            problems.append(Problem("--vary", f"{shown(text)} varies nothing", _FORMS))
        elif name in found:
            problems.append(Problem(where, "is given twice", "keep one of them"))
        else:
            try:
                found[name] = _varied(content)
            except ValueError as error:
                problems.append(Problem(where, str(error), _FORMS))
    return found


def _varied(text: str) -> Varied:
    call = _CALL.fullmatch(text)
    if call:
        return _distribution(call[1], call[2])
    if ".." in text:
        return _interval(text)
    values = [part.strip() for part in text.split(",")]
    if not all(values):
        raise ValueError(f"{shown(text)} has an empty value")
    return Levels(tuple(values))


def _distribution(kind: str, content: str) -> RandomValue:
    parameters = tuple(part.strip() for part in content.split(","))
    if kind not in KINDS:
        known = ", ".join(KINDS)
        raise ValueError(f"there is no distribution {shown(kind)}: choose one of {known}")
    if not all(parameters):
        raise ValueError(f"{kind} takes {', '.join(KINDS[kind])}")
    return RandomValue(kind, parameters)


def _interval(text: str) -> Interval:
    low, _, rest = text.partition("..")
    high, colon, number = rest.partition(":")
    if not low.strip() or not high.strip():
        raise ValueError(f"{shown(text)} is no range")
    if colon and not _COUNT.fullmatch(number.strip()):
        raise ValueError(f"{shown(number.strip())} is no number of levels")
    levels = int(number) if colon else None
    low, high = low.strip(), high.strip()
    return Interval(_with_unit_of(low, high), high, levels)


def _with_unit_of(low: str, high: str) -> str:
    """Return a lower bound without a unit with that of the upper one: ``0.6..1.5m``."""
    unit = re.sub(r"^[+-]?[\d.]+(?:[eE][+-]?\d+)?\s*", "", high)
    return f"{low} {unit}" if unit and re.fullmatch(r"[+-]?[\d.]+(?:[eE][+-]?\d+)?", low) else low


def percentiles_of(text: str | None, problems: list[Problem]) -> list[float] | None:
    """Read percentiles, numbers in percent with commas between them.

    Parameters
    ----------
    text : str, optional
        As the option has it.
    problems : list of Problem
        Takes what is wrong with it.
    """
    if text is None:
        return None
    try:
        return [float(part) for part in text.split(",")]
    except ValueError:
        what = f"{text!r} is no list of numbers"
        problems.append(Problem("--percentiles", what, "write --percentiles 50,95"))
        return None
