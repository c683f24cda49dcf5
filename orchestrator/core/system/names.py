"""Names of ports: array shorthand, patterns, and the nearest name to one that does not exist."""

import re
from collections.abc import Iterable, Sequence
from difflib import get_close_matches

_RANGE = re.compile(r"\[(?:\*|(\d+)\.\.(\d+))\]")


def is_shorthand(name: str) -> bool:
    """Tell whether a name stands for several elements of an array."""
    return _RANGE.search(name) is not None


def expand(name: str, known: Iterable[str]) -> list[str]:
    """Return the names that a shorthand stands for, by rising index.

    Parameters
    ----------
    name : str
        ``x[*]`` for all elements that are known, ``x[1..24]`` for exactly these.
    known : iterable of str
        Names that there are.

    Returns
    -------
    list of str
        The name itself where it is no shorthand.
    """
    found = _RANGE.search(name)
    if found is None:
        return [name]
    head = name[: found.start()]
    tail = name[found.end() :]
    if found.group(1) is not None:
        return [f"{head}[{i}]{tail}" for i in range(int(found.group(1)), int(found.group(2)) + 1)]
    element = re.compile(re.escape(head) + r"\[(\d+)\]" + re.escape(tail))
    indices = sorted(int(m.group(1)) for m in map(element.fullmatch, known) if m)
    return [f"{head}[{i}]{tail}" for i in indices]


def matches(shorthand: str, name: str) -> bool:
    """Tell whether a shorthand stands for a name, or both are the same."""
    return shorthand == name or name in expand(shorthand, [name])


def select(pattern: str, known: Sequence[str]) -> list[str]:
    """Return the names that fit a pattern in which ``*`` stands for any text, also in ``[*]``."""
    regular = re.compile(re.escape(pattern).replace(r"\*", ".*"))
    return [name for name in known if regular.fullmatch(name)]


def nearest(name: str, known: Iterable[str]) -> str:
    """Suggest the known names that come nearest to one that is not known.

    Parameters
    ----------
    name : str
        Not among the known ones.
    known : iterable of str
        Names that there are.

    Returns
    -------
    str
        For the remedy of a problem.
    """
    names = list(known)
    close = get_close_matches(name, names, 3, 0.5)
    if close:
        return f"did you mean {' or '.join(close)}?"
    if not names:
        return "there are none"
    more = ", ..." if len(names) > 12 else ""
    return f"there are {', '.join(names[:12])}{more}"
