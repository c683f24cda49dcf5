"""From a TOML file to data of the right form; what is wrong with the form, each at its place."""

import re
import tomllib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Annotated, Any, TypeVar, get_args

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from ..core.errors import InputRefused, Problem
from ..core.system.names import nearest
from .places import Places, line_and_column, places

Number = Annotated[float, Field(allow_inf_nan=False, strict=True)]
Positive = Annotated[float, Field(gt=0.0, allow_inf_nan=False, strict=True)]
NotNegative = Annotated[float, Field(ge=0.0, allow_inf_nan=False, strict=True)]

_SHOWN = 20


class Data(BaseModel):
    """A part of an input file: no other keys, never changed."""

    model_config = ConfigDict(extra="forbid", frozen=True)


D = TypeVar("D", bound=Data)


def read_toml(path: Path) -> tuple[dict[str, Any], Places]:
    """Content of a TOML file, and where each value stands.

    Raises:
        InputRefused: it cannot be read, or is not TOML.
    """
    try:
        text = path.read_text(encoding="utf-8")
        return tomllib.loads(text), places(str(path), text)
    except tomllib.TOMLDecodeError as error:
        raise InputRefused([Problem(str(path), f"is not valid TOML: {error}")]) from error
    except UnicodeDecodeError as error:
        raise InputRefused(
            [
                Problem(
                    f"{path}, {_undecodable(path, error)}", "is not UTF-8 text", "save it as UTF-8"
                )
            ]
        ) from error
    except OSError as error:
        raise InputRefused(
            [Problem(str(path), f"cannot be read: {error.strerror or error}", "correct the path")]
        ) from error


def _undecodable(path: Path, error: UnicodeDecodeError) -> str:
    before = path.read_bytes()[: error.start].decode("utf-8")
    return line_and_column(before, len(before))


def formed(
    model: type[D], data: Mapping[str, Any], where: Places, problems: list[Problem]
) -> D | None:
    """The data as a ``model``; None, and the reasons in ``problems``, if its form is wrong."""
    try:
        return model.model_validate(data)
    except ValidationError as error:
        found: dict[tuple[Any, ...], list[str]] = {}
        for entry in error.errors():
            found.setdefault(_key(entry["loc"]), []).append(_sentence(entry))
        problems += [
            Problem(
                where.of(key),
                f"{_name(key)}: {' or '.join(dict.fromkeys(texts))}",
                _remedy(model, key, texts),
            )
            for key, texts in found.items()
        ]
        return None


def first(problems: list[Problem]) -> list[Problem]:
    """As many problems as a person reads, each once."""
    each = list(dict.fromkeys(problems))
    more = len(each) - _SHOWN
    return (
        each
        if more <= 0
        else [*each[:_SHOWN], Problem(f"{more} more", "are not listed", "correct these first")]
    )


def _key(location: tuple[Any, ...]) -> tuple[Any, ...]:
    return tuple(part for part in location if part not in ("bool", "float", "str"))


def _name(key: tuple[Any, ...]) -> str:
    """``barrier[1].height``: elements are counted from 1 for people."""
    text = ""
    for part in key:
        text += f"[{part + 1}]" if isinstance(part, int) else f".{part}" if text else str(part)
    return text


def _sentence(error: Any) -> str:
    if error["type"] == "extra_forbidden":
        return "there is no such key"
    if error["type"] == "missing":
        return "is missing"
    given = "" if isinstance(error["input"], dict | list) else f" (given: {error['input']!r})"
    message = re.sub(r"a valid dictionary.*", "a table", str(error["msg"]))
    return message[0].lower() + message[1:] + given


def _remedy(model: type[BaseModel], key: tuple[Any, ...], texts: list[str]) -> str:
    if "there is no such key" not in texts:
        return ""
    return nearest(str(key[-1]), known_keys(model, key[:-1]))


def known_keys(model: type[BaseModel], section: tuple[Any, ...] = ()) -> list[str]:
    """Keys of a section of the file, by the path to it."""
    owner = model
    for part in section:
        fields = {entry.alias or name: entry for name, entry in owner.model_fields.items()}
        if part in fields:
            owner = next(_models(fields[part].annotation), owner)
    return [entry.alias or name for name, entry in owner.model_fields.items()]


def _models(annotation: Any) -> Iterator[type[BaseModel]]:
    """The models in an annotation: of ``list[Line]``, ``dict[str, Material]``, ``LimitSpeed | None``."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for part in get_args(annotation):
        yield from _models(part)
