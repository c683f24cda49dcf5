"""From a TOML file, or the same in Python, to data of the right form.

Where a part of the form is wrong, the rest is checked all the same: the values that are refused are
left out, and a check that asks for one of them ends there.
"""

from collections.abc import Callable, Collection, Iterable, Mapping
from difflib import get_close_matches
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeVar, get_origin

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, TypeAdapter, ValidationError
from pydantic.fields import FieldInfo

from ..core.errors import Problem, in_order
from ..core.form_faults import UNKNOWN_KEY, sentences
from ..core.form_keys import known_keys, models_in
from ..core.input_text import read_text, toml_content
from ..core.system.names import nearest
from .places import Key, Places, places


def _not_tiny(value: float) -> float:
    if value < SMALLEST:
        raise ValueError(f"must be {SMALLEST:g} or more (given: {value:g})")
    return value


LARGEST, SMALLEST = 1e30, 1e-30
"""Limits of the values in SI units; products of several are finite, and so are quotients."""
Number = Annotated[float, Field(ge=-LARGEST, le=LARGEST, allow_inf_nan=False, strict=True)]
Positive = Annotated[
    float,
    Field(gt=0.0, le=LARGEST, allow_inf_nan=False, strict=True),
    AfterValidator(_not_tiny),
]
NotNegative = Annotated[float, Field(ge=0.0, le=LARGEST, allow_inf_nan=False, strict=True)]

_MOST_SHOWN = 20
"""Problems that a person reads at once."""


class UnformedError(Exception):
    """A value is asked for whose form has been refused."""


class Data(BaseModel):
    """A part of an input file: no other keys, never changed."""

    model_config = ConfigDict(extra="forbid", frozen=True, defer_build=True)

    if not TYPE_CHECKING:  # else any name would do

        def __getattr__(self, name: str) -> Any:
            """Refuse a value that :func:`formed` has left out.

            Raises
            ------
            UnformedError
                There is a field of this name.
            """
            if name in type(self).model_fields:
                raise UnformedError(name)
            return super().__getattr__(name)


D = TypeVar("D", bound=Data)
R = TypeVar("R")


def read_toml(path: Path) -> tuple[dict[str, Any], Places]:
    """Read a TOML file.

    Parameters
    ----------
    path : Path
        Of the file.

    Returns
    -------
    content : dict
        Of the file.
    places : Places
        Of its values.

    Raises
    ------
    InputRefused
        It cannot be read, or is not TOML.
    """
    text = read_text(path)
    content = toml_content(path, text)
    return content, places(str(path), text)


def formed(model: type[D], data: Mapping[str, Any], where: Places, problems: list[Problem]) -> D:
    """Bring data into the form of a model, as far as it has one.

    Parameters
    ----------
    model : type of Data
        The form.
    data : mapping
        Content of a file.
    where : Places
        Of its values.
    problems : list of Problem
        Faults of the form are appended.

    Returns
    -------
    Data
        Without the values whose form is wrong: who asks for one of them meets
        :class:`UnformedError`.
    """
    try:
        return model.model_validate(data)
    except ValidationError as error:
        found = sentences(error.errors())
        problems += [_problem(model, key, texts, where) for key, texts in found.items()]
        meant = [key for key, texts in found.items() if UNKNOWN_KEY in texts]
        refused = {*found, *(known for key in meant for known in _meant(model, key))}
        return _formed_part(model, data, refused, ())


def if_formed(check: Callable[..., R], *arguments: Any) -> R | None:
    """Carry out what needs data of the right form.

    Parameters
    ----------
    check : callable
        What is carried out.
    *arguments
        Its arguments.

    Returns
    -------
    Any
        Its result; None where it asks for a value whose form has been refused.
    """
    try:
        return check(*arguments)
    except UnformedError:
        return None


def told_if_formed(check: Callable[..., Iterable[Problem]], *arguments: Any) -> list[Problem]:
    """Return what a check finds, up to the first value whose form has been refused.

    Parameters
    ----------
    check : callable
        Yields problems.
    *arguments
        Its arguments.

    Returns
    -------
    list of Problem
    """
    found: list[Problem] = []
    try:
        for problem in check(*arguments):
            found.append(problem)
    except UnformedError:
        pass
    return found


def _meant(model: type[BaseModel], key: Key) -> list[Key]:
    """Return the keys that an unknown one may have been meant for; those are not missing then."""
    near = get_close_matches(str(key[-1]), known_keys(model, key[:-1]), 3, 0.5)
    return [(*key[:-1], name) for name in near]


def _formed_part(
    model: type[D], data: Mapping[str, Any], refused: Collection[Key], above: Key
) -> D:
    """Return data without the values that are refused, or have anything refused in them."""
    values: dict[str, Any] = {}
    given: set[str] = set()
    for name, entry in model.model_fields.items():
        key = (*above, entry.alias or name)
        if key[-1] in data:
            try:
                values[name] = _formed_value(entry, data[str(key[-1])], refused, key)
            except UnformedError:
                continue
            given.add(name)
        elif not entry.is_required() and key not in refused:
            values[name] = entry.get_default(call_default_factory=True)
    made = model.model_construct(_fields_set=given)
    made.__dict__.clear()  # of the defaults of what is refused
    made.__dict__.update(values)
    return made


def _formed_value(entry: FieldInfo, value: Any, refused: Collection[Key], key: Key) -> Any:
    """Return a value of a field.

    Raises
    ------
    UnformedError
        It is refused.
    """
    if not any(other[: len(key)] == key for other in refused):
        return _validated(entry, value)
    inner = next((part for part in models_in(entry.annotation) if issubclass(part, Data)), None)
    if inner is None or key in refused or not isinstance(value, dict | list):
        raise UnformedError(key)
    if isinstance(value, list):
        return [_formed_entry(inner, each, refused, (*key, i)) for i, each in enumerate(value)]
    if get_origin(entry.annotation) is dict:
        return {
            name: _formed_entry(inner, each, refused, (*key, name)) for name, each in value.items()
        }
    return _formed_part(inner, value, refused, key)


def _validated(entry: FieldInfo, value: Any) -> Any:
    """Return a value in the form of its field.

    Raises
    ------
    UnformedError
        It has another one: that of an alternative was refused.
    """
    try:
        return TypeAdapter(entry.rebuild_annotation()).validate_python(value)
    except ValidationError as error:
        raise UnformedError from error


def _formed_entry(model: type[D], value: Any, refused: Collection[Key], key: Key) -> D:
    """Return a table of several.

    Raises
    ------
    UnformedError
        It is none.
    """
    if key in refused or not isinstance(value, dict):
        raise UnformedError(key)
    return _formed_part(model, value, refused, key)


def _problem(model: type[BaseModel], key: Key, texts: list[str], where: Places) -> Problem:
    place = where.of(key)
    name = _name(key)
    prefix = f"{name}: " if place != name else ""  # an argument of this name is its own place
    return Problem(place, prefix + " or ".join(texts), _remedy(model, key, texts))


def first(problems: list[Problem]) -> list[Problem]:
    """Return as many problems as a person reads, each once, in the order of each file."""
    each = in_order(problems)
    more = len(each) - _MOST_SHOWN
    if more <= 0:
        return each
    rest = Problem(f"{more} more", "are not listed", "correct these first")
    return [*each[:_MOST_SHOWN], rest]


def _name(key: Key) -> str:
    """Write a key for people, who count from 1: ``barrier[1].height``."""
    parts = [f"[{part + 1}]" if isinstance(part, int) else f".{part}" for part in key]
    return "".join(parts).removeprefix(".")


def _remedy(model: type[BaseModel], key: Key, texts: list[str]) -> str:
    if UNKNOWN_KEY not in texts:
        return ""
    return nearest(str(key[-1]), known_keys(model, key[:-1]))
