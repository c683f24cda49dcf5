"""Declarations of what is shown of a component.

Metrics that follow from an output, and pictures as data.
"""

from dataclasses import dataclass
from enum import StrEnum

from .units import SCREEN_UNITS


class Statistic(StrEnum):
    """How a metric follows from an output over time.

    Of an array, the largest of its elements' metrics is taken.
    """

    LARGEST = "largest"
    LEAST = "least"
    FIRST = "first"
    LAST = "last"


@dataclass(frozen=True, slots=True)
class Reported:
    """A metric that is reported of an output, also as a row of the table of a run.

    Attributes
    ----------
    name : str
        In words; the component's name is put before it.
    statistic : Statistic
        How it follows from the output.
    unit : str
        Key of :data:`rockshed.components.common.units.SCREEN_UNITS`, in which the table shows it.
    decimals : int
        Decimals in the table.
    """

    name: str
    statistic: Statistic = Statistic.LARGEST
    unit: str = "1"
    decimals: int = 2

    def __post_init__(self) -> None:
        _check_unit(self.name, self.unit)


@dataclass(frozen=True, slots=True)
class Curve:
    """An output over time.

    Attributes
    ----------
    variable : str
        Name of a scalar output, or ``name[1]`` for an element.
    label : str
        Its name in the legend; empty where the panel has one curve.
    factor : float
        Multiplies the values: -1 turns the sign.
    from_start : bool
        Subtract the value at the start.
    dashed : bool
        Draw it dashed.
    """

    variable: str
    label: str = ""
    factor: float = 1.0
    from_start: bool = False
    dashed: bool = False


@dataclass(frozen=True, slots=True)
class Panel:
    """Curves over one axis.

    Attributes
    ----------
    label : str
        Quantity on the axis; the unit is added.
    unit : str
        Key of :data:`rockshed.components.common.units.SCREEN_UNITS`.
    curves : tuple of Curve
        Curves in the panel.
    second_unit : str
        Unit of a second scale at the right; empty for none.
    downwards : bool
        Whether the axis counts downwards.
    common : bool
        Whether all components that declare the panel are drawn into one.
    references : str
        Identifier of the metric whose references are drawn as lines; empty for none.
    """

    label: str
    unit: str
    curves: tuple[Curve, ...]
    second_unit: str = ""
    downwards: bool = False
    common: bool = False
    references: str = ""

    def __post_init__(self) -> None:
        for unit in filter(None, (self.unit, self.second_unit)):
            _check_unit(self.label, unit)


@dataclass(frozen=True, slots=True)
class Envelope:
    """An array output along a component, in place of time.

    Drawn are its envelope over the run and its values when one of them is farthest from zero.

    Attributes
    ----------
    label : str
        Quantity on the axis; the unit is added.
    unit : str
        Key of :data:`rockshed.components.common.units.SCREEN_UNITS`.
    variable : str
        Name of the array, without index.
    along : str
        Name of the array of its places (m) in order; those at the start are taken.
    ends : str
        Name of an array whose first two values are those half a spacing before the first place and
        after the last one; empty for none.
    at_edges : bool
        Whether the values stand half a spacing before their places, and the second of ``ends``
        behind the last of them.
    """

    label: str
    unit: str
    variable: str
    along: str
    ends: str = ""
    at_edges: bool = False

    def __post_init__(self) -> None:
        _check_unit(self.label, self.unit)


@dataclass(frozen=True, slots=True)
class Picture:
    """A picture of a component: panels one below the other, curves over one axis of time.

    Attributes
    ----------
    name : str
        Name of the file without its ending. Components that declare one name are drawn into one
        picture.
    panels : tuple of Panel or Envelope
        From top to bottom.
    """

    name: str
    panels: tuple[Panel | Envelope, ...]


def _check_unit(name: str, unit: str) -> None:
    if unit not in SCREEN_UNITS:
        raise ValueError(
            f"{name}: unknown unit {unit!r} for the screen; known are {', '.join(SCREEN_UNITS)}"
        )
