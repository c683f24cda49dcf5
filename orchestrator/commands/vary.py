"""Texts that say how a value varies: levels, ranges and distributions."""

import re
from collections.abc import Sequence

from ..analyses.study.factors import KINDS, Interval, Levels, RandomValue, Varied
from ..core.errors import Problem
from ..core.input_text import shown

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
