"""From a TOML file, or the same in Python, to data of the right form."""

import re
import tomllib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Annotated, Any, TypeVar, get_args

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from ..core.errors import InputRefused, Problem
from ..core.system.names import nearest
from .places import Key, Places, line_and_column, places

Number = Annotated[float, Field(allow_inf_nan=False, strict=True)]
Positive = Annotated[float, Field(gt=0.0, allow_inf_nan=False, strict=True)]
NotNegative = Annotated[float, Field(ge=0.0, allow_inf_nan=False, strict=True)]

_MOST_SHOWN = 20
"""Problems that a person reads at once."""
_UNKNOWN_KEY = "there is no such key"


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
    try:
        text = path.read_text(encoding="utf-8")
        return tomllib.loads(text), places(str(path), text)
    except tomllib.TOMLDecodeError as error:
        raise InputRefused([Problem(str(path), f"is not valid TOML: {error}")]) from error
    except UnicodeDecodeError as error:
        before = path.read_bytes()[: error.start]
        where = f"{path}, {line_and_column(before)}"
        raise InputRefused([Problem(where, "is not UTF-8 text", "save it as UTF-8")]) from error
    except OSError as error:
        reason = f"cannot be read: {error.strerror or error}"
        raise InputRefused([Problem(str(path), reason, "correct the path")]) from error


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
        sentences: dict[Key, list[str]] = {}
        for entry in error.errors():
            sentences.setdefault(_key(entry["loc"]), []).append(_sentence(entry))
        problems += [
            Problem(
                where.of(key),
                f"{_name(key)}: {' or '.join(dict.fromkeys(texts))}",
                _remedy(model, key, texts),
            )
            for key, texts in sentences.items()
        ]
        return None


def first(problems: list[Problem]) -> list[Problem]:
    """Return as many problems as a person reads, each once."""
    each = list(dict.fromkeys(problems))
    more = len(each) - _MOST_SHOWN
    if more <= 0:
        return each
    rest = Problem(f"{more} more", "are not listed", "correct these first")
    return [*each[:_MOST_SHOWN], rest]


def _key(location: tuple[Any, ...]) -> Key:
    return tuple(part for part in location if part not in ("bool", "float", "str"))


def _name(key: Key) -> str:
    """Write a key for people, who count from 1: ``barrier[1].height``."""
    parts = [f"[{part + 1}]" if isinstance(part, int) else f".{part}" for part in key]
    return "".join(parts).removeprefix(".")


def _sentence(error: Any) -> str:
    if error["type"] == "extra_forbidden":
        return _UNKNOWN_KEY
    if error["type"] == "missing":
        return "is missing"
    value = "" if isinstance(error["input"], dict | list) else f" (given: {error['input']!r})"
    message = re.sub(r"a valid dictionary.*", "a table", str(error["msg"]))
    return message[0].lower() + message[1:] + value


def _remedy(model: type[BaseModel], key: Key, texts: list[str]) -> str:
    if _UNKNOWN_KEY not in texts:
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
