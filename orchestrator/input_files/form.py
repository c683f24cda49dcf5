"""From a TOML file, or the same in Python, to data of the right form."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Annotated, Any, TypeVar, get_args

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationError

from ..core.errors import Problem
from ..core.form_faults import UNKNOWN_KEY, sentences
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


class Data(BaseModel):
    """A part of an input file: no other keys, never changed."""

    model_config = ConfigDict(extra="forbid", frozen=True)


D = TypeVar("D", bound=Data)


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


def formed(
    model: type[D], data: Mapping[str, Any], where: Places, problems: list[Problem]
) -> D | None:
    """Bring data into the form of a model.

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
    Data or None
        None where the form is wrong.
    """
    try:
        return model.model_validate(data)
    except ValidationError as error:
        problems += [
            _problem(model, key, texts, where) for key, texts in sentences(error.errors()).items()
        ]
        return None


def _problem(model: type[BaseModel], key: Key, texts: list[str], where: Places) -> Problem:
    place = where.of(key)
    name = _name(key)
    prefix = f"{name}: " if place != name else ""  # an argument of this name is its own place
    return Problem(place, prefix + " or ".join(texts), _remedy(model, key, texts))


def first(problems: list[Problem]) -> list[Problem]:
    """Return as many problems as a person reads, each once."""
    each = list(dict.fromkeys(problems))
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


def known_keys(model: type[BaseModel], section: Key = ()) -> list[str]:
    """Return the keys that a section of a file may have.

    Parameters
    ----------
    model : type of Data
        Form of the file.
    section : Key
        Of the section; the whole file by default.

    Returns
    -------
    list of str
        As they are written in the file.
    """
    owner = model
    for part in section:
        fields = {entry.alias or name: entry for name, entry in owner.model_fields.items()}
        if part in fields:
            owner = next(_models(fields[str(part)].annotation), owner)
    return [entry.alias or name for name, entry in owner.model_fields.items()]


def _models(annotation: Any) -> Iterator[type[BaseModel]]:
    """Yield the models in an annotation.

    Of ``list[Line]``, ``dict[str, Material]``, ``LimitSpeed | None``.
    """
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for part in get_args(annotation):
        yield from _models(part)
