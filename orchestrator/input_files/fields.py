"""Quantities as fields of input files: kinds with their units, and ranges that are usual."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Annotated, Any, get_args, get_origin

from pydantic import BaseModel, BeforeValidator, Field
from pydantic.fields import FieldInfo

from rockshed.components.common.plausible import Plausible

from ..core.errors import Problem
from .form import Data, NotNegative, Number, Positive
from .places import Key, Places
from .quantities import InUnit, doubt

Length = Annotated[Positive, BeforeValidator(InUnit("m"))]
Place = Annotated[Number, BeforeValidator(InUnit("m"))]
Distance = Annotated[NotNegative, BeforeValidator(InUnit("m"))]
Area = Annotated[Positive, BeforeValidator(InUnit("m2"))]
SectionModulus = Annotated[Positive, BeforeValidator(InUnit("m3"))]
SecondMoment = Annotated[Positive, BeforeValidator(InUnit("m4"))]
Mass = Annotated[Positive, BeforeValidator(InUnit("kg"))]
MassPerLength = Annotated[NotNegative, BeforeValidator(InUnit("kg/m"))]
Density = Annotated[Positive, BeforeValidator(InUnit("kg/m3"))]
Pressure = Annotated[Positive, BeforeValidator(InUnit("Pa"))]
Cohesion = Annotated[NotNegative, BeforeValidator(InUnit("Pa"))]
Force = Annotated[Positive, BeforeValidator(InUnit("N"))]
Resistance = Annotated[NotNegative, BeforeValidator(InUnit("N"))]
Moment = Annotated[Positive, BeforeValidator(InUnit("N.m"))]
Energy = Annotated[NotNegative, BeforeValidator(InUnit("J"))]
Stiffness = Annotated[Positive, BeforeValidator(InUnit("N/m"))]
Speed = Annotated[Positive, BeforeValidator(InUnit("m/s"))]
Velocity = Annotated[Number, BeforeValidator(InUnit("m/s"))]
Acceleration = Annotated[NotNegative, BeforeValidator(InUnit("m/s2"))]
Angle = Annotated[Number, BeforeValidator(InUnit("rad"))]
AngularVelocity = Annotated[Number, BeforeValidator(InUnit("rad/s"))]
Duration = Annotated[Positive, BeforeValidator(InUnit("s"))]
Rate = Annotated[Positive, BeforeValidator(InUnit("1/s"))]
StressGradient = Annotated[Positive, BeforeValidator(InUnit("N/m3"))]
SoilDamping = Annotated[NotNegative, BeforeValidator(InUnit("s/m"))]

_USUAL, _UNIT = "usual", "unit"


def field(
    meaning: str,
    default: Any = None,
    usual: tuple[float, float] | None = None,
    likely: Sequence[str] = (),
    unit: str = "",
    **rest: Any,
) -> Any:
    """Declare a field of a form.

    Parameters
    ----------
    meaning : str
        Its meaning, for the documentation.
    default : Any
        Its value where it is left out; ``...`` where it has to be given.
    usual : tuple of float, optional
        Range (SI) beyond which a value is doubted.
    likely : sequence of str
        Units in which such a value may have been meant, the likeliest first.
    unit : str
        SI unit, where the kind of the field does not tell it.
    **rest
        Other arguments of ``pydantic.Field``.

    Returns
    -------
    Any
        The field.
    """
    extra: dict[str, Any] = {_USUAL: Plausible(*usual, tuple(likely))} if usual else {}
    if unit:
        extra[_UNIT] = unit
    return Field(default, description=meaning, json_schema_extra=extra, **rest)


def unit_of(entry: FieldInfo) -> str:
    """Return the SI unit of a field; empty if it is no quantity.

    Parameters
    ----------
    entry : FieldInfo
        Of a form.

    Returns
    -------
    str
        Key of :data:`rockshed.components.common.units.UNITS`.
    """
    if unit := str(_extra(entry).get(_UNIT, "")):
        return unit
    parts = [*entry.metadata, *_parts(entry.annotation)]
    readers = (part.func for part in parts if isinstance(part, BeforeValidator))
    return next((reader.unit for reader in readers if isinstance(reader, InUnit)), "")


def _extra(entry: FieldInfo) -> Mapping[str, Any]:
    extra = entry.json_schema_extra
    return extra if isinstance(extra, Mapping) else {}


def _parts(annotation: Any) -> Iterator[Any]:
    """Yield whatever an annotation is made of."""
    for part in (*get_args(annotation), *getattr(annotation, "__metadata__", ())):
        yield part
        yield from _parts(part)


ANY = "NAME"
"""Stands in the name of a field for a name that the user chooses."""
EACH = "[]"
"""Stands behind the name of a list of tables."""


def fields(model: type[BaseModel], prefix: str = "") -> Iterator[tuple[str, FieldInfo]]:
    """Yield all fields of a form by name, those of the tables in it instead of the tables.

    Parameters
    ----------
    model : type of BaseModel
        The form.
    prefix : str
        Name of the table that it is the form of, with a dot; empty for the whole file.

    Yields
    ------
    name : str
        ``cushion.thickness``, ``cushion.layers[].material``, ``material.NAME.modulus``.
    entry : FieldInfo
        Its declaration.
    """
    for key, entry in model.model_fields.items():
        name = f"{prefix}{entry.alias or key}"
        inner = next(_forms(entry.annotation), None)
        if inner is None:
            yield name, entry
            continue
        origin: Any = get_origin(entry.annotation)
        many = {list: EACH, dict: f".{ANY}"}.get(origin, "")
        yield from fields(inner, f"{name}{many}.")


def _forms(annotation: Any) -> Iterator[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for part in get_args(annotation):
        yield from _forms(part)


def doubts(data: Data, where: Places) -> list[str]:
    """Return the values of an input file that are beyond what is usual.

    Parameters
    ----------
    data : Data
        The file in its form.
    where : Places
        Of the values in the file.

    Returns
    -------
    list of str
        A sentence for each, with its place and the unit in which it may have been meant.
    """
    return [
        f"{where.of(key)}: {_name(key)} {reason}"
        for key, value, entry in _numbers(data, ())
        if (reason := _doubt_of(value, entry))
    ]


def explained(problems: Sequence[Problem], doubted: Sequence[str]) -> list[Problem]:
    """Return problems with what is doubted at their places, which may be their cause.

    Parameters
    ----------
    problems : sequence of Problem
        Of a file.
    doubted : sequence of str
        Of :func:`doubts`, each with its place.

    Returns
    -------
    list of Problem
    """
    made = []
    for problem in problems:
        place = f"{problem.where}: "
        reasons = [text.removeprefix(place) for text in doubted if text.startswith(place)]
        remedy = "; ".join(filter(None, [problem.remedy, *reasons]))
        made.append(replace(problem, remedy=remedy))
    return made


def _doubt_of(value: float, entry: FieldInfo) -> str | None:
    usual = usual_of(entry)
    return doubt(value, unit_of(entry) or "1", usual) if usual else None


def usual_of(entry: FieldInfo) -> Plausible | None:
    """Return the range of a field beyond which a value is doubted; None if there is none.

    Parameters
    ----------
    entry : FieldInfo
        Of a form.
    """
    usual = _extra(entry).get(_USUAL)
    return usual if isinstance(usual, Plausible) else None


def _name(key: Key) -> str:
    return ".".join(str(part + 1 if isinstance(part, int) else part) for part in key)


def _numbers(data: BaseModel, key: Key) -> Iterator[tuple[Key, float, FieldInfo]]:
    """Yield key, value and field of every number of a form that is given and has a usual range."""
    for name, entry in type(data).model_fields.items():
        if name not in data.model_fields_set:  # those that are refused are not in it
            continue
        yield from _within(getattr(data, name), (*key, entry.alias or name), entry)


def _within(value: Any, key: Key, entry: FieldInfo) -> Iterator[tuple[Key, float, FieldInfo]]:
    if isinstance(value, BaseModel):
        yield from _numbers(value, key)
    elif isinstance(value, Mapping):
        for name, inner in value.items():
            yield from _within(inner, (*key, name), entry)
    elif isinstance(value, list | tuple):
        for number, inner in enumerate(value):
            yield from _within(inner, (*key, number), entry)
    elif usual_of(entry) and isinstance(value, float | int) and not isinstance(value, bool):
        yield key, float(value), entry
