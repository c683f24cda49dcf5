"""Assignments ``name=value``, as options of the command line are written, read as values."""

from collections.abc import Sequence
from typing import cast

from ..core.errors import Problem
from ..core.system.fields import Value


def values_of(
    option: str, texts: Sequence[str], problems: list[Problem], name_of: str = "component.name"
) -> dict[str, Value]:
    """Read values by name.

    Parameters
    ----------
    option : str
        The option that they stand in, for messages.
    texts : sequence of str
        ``name=value``, ``sand.modulus=3e6`` for instance.
    problems : list of Problem
        Texts that are no assignments, and names that are given twice, are appended.
    name_of : str
        What is assigned to, for messages.

    Returns
    -------
    dict of str to Value
        Numbers where the texts are some; words stay text.
    """
    values: dict[str, Value] = {}
    for text in texts:
        name, equals, value = (part.strip() for part in text.partition("="))
        if name and equals and value and name in values:
            what = f"is given twice: {values[name]} and {_value(value)}"
            problems.append(Problem(f"{option} {name}", what, "keep one of them"))
        elif name and equals and value:
            values[name] = _value(value)
        else:
            remedy = f"write {option} {name_of}=value"
            problems.append(Problem(option, f"{text!r} is no assignment", remedy))
    return values


def sizes_of(texts: Sequence[str], problems: list[Problem]) -> dict[str, int]:
    """Read sizes by name; what is no whole number is refused where the sizes are known.

    Parameters
    ----------
    texts : sequence of str
        ``name=number``.
    problems : list of Problem
        Texts that are no assignments are appended.

    Returns
    -------
    dict of str to int
        Sizes by name.
    """
    return cast(dict[str, int], values_of("--size", texts, problems))


def _value(text: str) -> Value:
    """Return a number where the text is one."""
    for read in (int, float):
        try:
            return read(text)
        except ValueError:
            continue
    return text
