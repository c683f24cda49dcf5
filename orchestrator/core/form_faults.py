"""Faults of the form of data, in words of the person who has written them."""

from collections.abc import Callable, Mapping
from typing import Any

from .input_text import shown

UNKNOWN_KEY = "there is no such key"
MISSING = "is missing"

_ALTERNATIVES = ("bool", "int", "float", "str")
"""Names of the alternatives of a type, which pydantic puts into the path of a value."""
AS_NUMBER, AS_DISTRIBUTION = "as a number", "as a distribution"
"""Alternatives of a quantity, likewise; no key is called so."""
_WORDS: Mapping[str, str] = {
    "extra_forbidden": UNKNOWN_KEY,
    "missing": MISSING,
    "finite_number": "must be a finite number",
    "string_too_short": "must not be empty",
    "string_pattern_mismatch": "must be a letter or _, followed by letters, digits or _",
}
"""Sentences by the type of the fault."""
_KINDS = {
    "float": "must be a number",
    "int": "must be a whole number",
    "bool": "must be true or false",
    "string": "must be text",
    "list": "must be a list",
    "tuple": "must be a list",
    "dict": "must be a table",
    "model": "must be a table",
    "mapping": "must be a table",
}
"""Sentences by the first word of the type of the fault."""
_BOUNDS = {
    "greater_than": "must be greater than {gt}",
    "greater_than_equal": "must be greater than or equal to {ge}",
    "less_than": "must be less than {lt}",
    "less_than_equal": "must be less than or equal to {le}",
    "literal_error": "must be one of {expected}",
    "too_short": "has {actual_length} entries, and must have {min_length} or more",
    "too_long": "has too many entries: {max_length} at most",
}
"""Sentences with the values of the fault, by its type."""


def location(path: tuple[Any, ...]) -> tuple[Any, ...]:
    """Return the keys of a value, without the names of the alternatives of its type."""
    path = tuple(part for part in path if part not in (AS_NUMBER, AS_DISTRIBUTION))
    last = path[-1] if path else None
    is_alternative = isinstance(last, str) and (
        last in _ALTERNATIVES or last.startswith(("constrained-", "function-"))
    )
    return path[:-1] if is_alternative and len(path) > 1 else path


def sentence(error: Mapping[str, Any]) -> str:
    """Say what is wrong with the form of a value.

    Parameters
    ----------
    error : mapping
        Entry of ``errors()`` of pydantic's ``ValidationError``.

    Returns
    -------
    str
        Continues the name of the value, which is added where a fault is about it.
    """
    kind = str(error["type"])
    context = error.get("ctx", {})
    value = error["input"]
    if kind == "value_error":
        return str(context.get("error", "is wrong"))
    if kind in ("extra_forbidden", "missing"):
        return _WORDS[kind]
    given = "" if isinstance(value, dict) else f" (given: {shown(value)})"
    return _sentence_of(kind, context) + given


def _sentence_of(kind: str, context: Mapping[str, Any]) -> str:
    if kind in _WORDS:
        return _WORDS[kind]
    if kind in _BOUNDS:
        values = {name: _number(value) for name, value in context.items()}
        return _BOUNDS[kind].format_map(values)
    return _KINDS.get(kind.partition("_")[0], "is not of the right form")


def _number(value: Any) -> Any:
    return f"{value:g}" if isinstance(value, float) else value


def sentences(
    errors: list[Any], key: Callable[[tuple[Any, ...]], Any] = location
) -> dict[Any, list[str]]:
    """Return the faults of each value, each sentence once.

    Parameters
    ----------
    errors : list
        ``errors()`` of pydantic's ``ValidationError``.
    key : callable
        Returns the key of a value from its path.

    Returns
    -------
    dict
        Sentences by key, in the order of the errors.
    """
    found: dict[Any, list[str]] = {}
    for error in errors:
        texts = found.setdefault(key(error["loc"]), [])
        text = sentence(error)
        if text not in texts:
            texts.append(text)
    return found
