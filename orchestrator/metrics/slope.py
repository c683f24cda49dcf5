"""The slope that the rock of a run comes from: its campaign and the choice."""

from collections.abc import Mapping
from typing import Any

from rockshed.components.common.units import kJ

from ..core.results.facts import number_of, table_of
from ..core.results.reading import StoredRun
from ..tables import Table, digits

_QUANTITIES = {"energy": ("kinetic energy", "kJ", kJ), "speed": ("speed", "m/s", 1.0)}
"""Words, unit and size of its unit of the quantities that a rock is chosen by."""
_CONFIDENCE = "95 % confidence"
AS_SPHERE = (
    "on the cushion a rock from a slope is a disc of the campaign's radius with its mass, moment "
    "of inertia and spin; an elongated block too, whose radius is the root of the product of its "
    "semi-axes"
)
"""Shape of the rock in the sand."""


def slope_of(run: StoredRun) -> Mapping[str, Any]:
    """Return what the provenance of a run tells of its slope; empty if there is none.

    Parameters
    ----------
    run : StoredRun
        The run.
    """
    return table_of(run.provenance, "slope")


def _value(told: Mapping[str, Any], value: object) -> str:
    """Return a value of the quantity by which the rock was chosen, with its unit."""
    _, unit, size = _QUANTITIES[str(told["quantity"])]
    number = float(value) / size if isinstance(value, int | float) else float("nan")
    return f"{digits(number, 4)} {unit}"


def choice_in_words(told: Mapping[str, Any]) -> str:
    """Return which rock of a campaign was taken.

    Parameters
    ----------
    told : mapping
        From :func:`slope_of`, not empty.
    """
    words = _QUANTITIES[str(told["quantity"])][0]
    rock = f"the rock is that of trial {told['trial']} on the slope {told['name']}"
    value = f"{words} at the cushion's surface, {_value(told, told['value'])}"
    percent = number_of(told, "percent")
    if percent is None:
        return f"{rock}, as chosen: its {value}"
    ends = f"{_value(told, told['low'])} to {_value(told, told['high'])}"
    return (
        f"{rock}: its {value}, is that which {percent:g} % of the {told['strikes']:,} rocks that "
        f"strike the cushion do not exceed ({ends} with {_CONFIDENCE})"
    )


def slope_notes(run: StoredRun) -> list[str]:
    """Return what a reader has to know of the slope of a run; nothing where there is none.

    Parameters
    ----------
    run : StoredRun
        The run.
    """
    told = slope_of(run)
    if not told:
        return []
    return [
        choice_in_words(told),
        f"campaign, seed {told['seed']}: {told['rocks']}",
        "E0 is the kinetic energy at the hand-over, a little above the cushion",
    ]


def slope_table(run: StoredRun) -> Table:
    """Return campaign and choice as a table; empty where there is no slope.

    Parameters
    ----------
    run : StoredRun
        The run.
    """
    made = Table(("quantity", "value", "unit"), right=("value",))
    told = slope_of(run)
    if not told:
        return made
    share, roof = table_of(told, "share"), table_of(told, "roof")
    words, unit, size = _QUANTITIES[str(told["quantity"])]
    made.add("site file", str(told["file"]), "")
    made.add("trials", f"{told['trials']}", "")
    made.add("seed", f"{told['seed']}", "")
    made.add("rocks that strike the cushion", f"{told['strikes']}", "")
    for name, which in (("part of all", "value"), ("at least", "low"), ("at most", "high")):
        made.add(name, digits(100.0 * (number_of(share, which) or 0.0), 4), "%")
    for name, key in (("left support, x", "x"), ("top of the roof, y", "y")):
        made.add(f"{name} on the profile", digits(number_of(roof, key) or 0.0, 5), "m")
    if percent := number_of(told, "percent"):
        made.add("percentile", f"{percent:g}", "%")
    made.add(f"{words} at the cushion's surface", digits(told["value"] / size, 4), unit)
    for name, which in (("at least", "low"), ("at most", "high")):
        if (bound := number_of(told, which)) is not None:
            made.add(name, digits(bound / size, 4), unit)
    made.add("trial", f"{told['trial']}", "")
    return made
