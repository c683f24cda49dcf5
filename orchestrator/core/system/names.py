"""Names of ports: array shorthand, patterns, and the nearest name to one that does not exist."""

import re
from collections.abc import Container, Iterable, Sequence
from difflib import get_close_matches

_RANGE = re.compile(r"\[(?:\*|(\d+)\.\.(\d+))\]")
_LONGEST_NUMBER = 18
"""Digits of an index of an array, at most."""

_MOST_LISTED = 12
"""Names that are all listed where none comes near."""
MOST_ELEMENTS = 1_000_000
"""Elements of an array that a shorthand stands for, at most."""


def split_name(text: str, components: Container[str]) -> tuple[str, str]:
    """Split ``component.port`` into component and port.

    Parameters
    ----------
    text : str
        A name; components inside systems have dots in their names, and so have ports.
    components : container of str
        Names of components. The longest one that the text begins with is taken.

    Returns
    -------
    (str, str)
        Where the text begins with no component, what stands before and behind its first dot.
    """
    at = text.find(".")
    first = at
    found = -1
    while at >= 0:
        if text[:at] in components:
            found = at
        at = text.find(".", at + 1)
    at = found if found >= 0 else first
    return (text[:at], text[at + 1 :]) if at >= 0 else (text, "")


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

    Raises
    ------
    ValueError
        It stands for more than :data:`MOST_ELEMENTS` elements.
    """
    found = _RANGE.search(name)
    if found is None:
        return [name]
    head = name[: found.start()]
    tail = name[found.end() :]
    if found.group(1) is not None:
        return [f"{head}[{i}]{tail}" for i in _indices(*found.groups())]
    element = re.compile(re.escape(head) + r"\[(\d+(?:,\d+)*)\]" + re.escape(tail))
    found_names = (m for m in map(element.fullmatch, known) if m)
    indices = sorted(tuple(map(int, m.group(1).split(","))) for m in found_names)
    return [f"{head}[{','.join(map(str, index))}]{tail}" for index in indices]


def _indices(first: str, last: str) -> range:
    if max(len(first), len(last)) > _LONGEST_NUMBER:
        raise ValueError(f"has an index of more than {_LONGEST_NUMBER} digits")
    indices = range(int(first), int(last) + 1)
    if len(indices) > MOST_ELEMENTS:
        most = f"{MOST_ELEMENTS:,} are the most"
        raise ValueError(f"stands for {len(indices):,} elements, and {most}")
    return indices


def matches(shorthand: str, name: str) -> bool:
    """Tell whether a shorthand stands for a name, or both are the same."""
    found = _RANGE.search(shorthand)
    if found is None or shorthand == name:
        return shorthand == name
    head, tail = re.escape(shorthand[: found.start()]), re.escape(shorthand[found.end() :])
    if found.group(1) is None:
        return re.fullmatch(rf"{head}\[\d+(,\d+)*\]{tail}", name) is not None
    element = re.fullmatch(rf"{head}\[(\d{{1,{_LONGEST_NUMBER}}})\]{tail}", name)
    if element is None:
        return False
    first, last = found.groups()
    fits = max(len(first), len(last)) <= _LONGEST_NUMBER
    return fits and int(first) <= int(element.group(1)) <= int(last)


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
    if len(names) > _MOST_LISTED:
        close = get_close_matches(name, names, 3, 0.0)
        return f"the nearest of {len(names):,} are {', '.join(close)}"
    return f"there are {', '.join(names)}"
