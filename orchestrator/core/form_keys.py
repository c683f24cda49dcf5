"""Keys that a part of data may have, from its form."""

from collections.abc import Iterator
from typing import Any, get_args

from pydantic import BaseModel


def known_keys(model: type[BaseModel], section: tuple[Any, ...] = ()) -> list[str]:
    """Return the keys that a section of a file may have.

    Parameters
    ----------
    model : type of BaseModel
        Form of the file.
    section : tuple
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
            owner = next(models_in(fields[str(part)].annotation), owner)
    return [entry.alias or name for name, entry in owner.model_fields.items()]


def models_in(annotation: Any) -> Iterator[type[BaseModel]]:
    """Yield the models in an annotation.

    Parameters
    ----------
    annotation : Any
        As ``list[Line]``, ``dict[str, Material]``, ``LimitSpeed | None``.
    """
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for part in get_args(annotation):
        yield from models_in(part)
