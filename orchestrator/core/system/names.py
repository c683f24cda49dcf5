"""Names of ports: array shorthand, patterns, and the nearest name to one that does not exist."""

import re
from collections.abc import Iterable, Sequence
from difflib import get_close_matches

_RANGE = re.compile(r"\[(?:\*|(\d+)\.\.(\d+))\]")


def is_shorthand(name: str) -> bool:
    """Whether the name stands for several elements of an array."""
    return _RANGE.search(name) is not None


def expand(name: str, known: Iterable[str]) -> list[str]:
    """The names that a shorthand stands for, by rising index: ``x[*]`` all that are ``known``, ``x[1..24]`` exactly these."""
    found = _RANGE.search(name)
    if found is None:
        return [name]
    head, tail = name[: found.start()], name[found.end() :]
    if found.group(1) is not None:
        return [f"{head}[{i}]{tail}" for i in range(int(found.group(1)), int(found.group(2)) + 1)]
    element = re.compile(re.escape(head) + r"\[(\d+)\]" + re.escape(tail))
    indices = sorted(int(m.group(1)) for m in map(element.fullmatch, known) if m)
    return [f"{head}[{i}]{tail}" for i in indices]


def matches(shorthand: str, name: str) -> bool:
    """Whether ``shorthand`` stands for ``name``, or both are the same."""
    return shorthand == name or name in expand(shorthand, [name])


def select(pattern: str, known: Sequence[str]) -> list[str]:
    """The names that fit a pattern in which ``*`` stands for any text, also in ``[*]``."""
    regular = re.compile(re.escape(pattern).replace(r"\*", ".*"))
    return [name for name in known if regular.fullmatch(name)]


def nearest(name: str, known: Iterable[str]) -> str:
    """A remedy that names what was probably meant."""
    names = list(known)
    close = get_close_matches(name, names, 3, 0.5)
    if close:
        return f"did you mean {' or '.join(close)}?"
    return (
        f"there are {', '.join(names[:12])}{', ...' if len(names) > 12 else ''}"
        if names
        else "there are none"
    )
