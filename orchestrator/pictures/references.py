"""Lines at the values that others found for a metric."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from matplotlib.axes import Axes

from rockshed.components.common.units import SCREEN_UNITS

from ..references import Known
from ..tables import digits
from .style import reference_line

KnownMetrics = Mapping[str, Known]
"""References by the name of the metric."""

_FOUND_BY = {
    "experiment": ("{what} measured, {about}{value} {unit}", "--"),
    "paper": ("{what} in the paper's analysis, {about}{value} {unit}", ":"),
}


@dataclass(frozen=True)
class ReferenceLevel:
    """A level at which a reference lies.

    Attributes
    ----------
    value : float
        In the unit of the axis.
    text : str
        Who found it, with value and unit.
    dashes : str
        Dashes as matplotlib writes them.
    """

    value: float
    text: str
    dashes: str


def levels(known: Known | None, unit: str, what: str) -> Iterator[ReferenceLevel]:
    """Yield the level of each reference of a metric.

    Parameters
    ----------
    known : Known, optional
        References of the metric.
    unit : str
        Unit of the axis.
    what : str
        Name of the metric in words.
    """
    for who, reference in ({} if known is None else known.by()).items():
        words, dashes = _FOUND_BY.get(who, (f"{{what}} by {who}, {{value}} {{unit}}", "-."))
        value = reference.value / SCREEN_UNITS[unit]
        about = "≈ " if reference.note else ""
        text = words.format(what=what, about=about, value=digits(value), unit=unit)
        yield ReferenceLevel(value, text, dashes)


def draw_references(axes: Axes, known: Known | None, unit: str, what: str) -> None:
    """Draw a line for each reference of a metric.

    Parameters
    ----------
    axes : Axes
        Where to draw.
    known : Known, optional
        References of the metric.
    unit : str
        Unit of the axis.
    what : str
        Name of the metric in words.
    """
    for level in levels(known, unit, what):
        reference_line(axes, level.value, level.text, level.dashes)
