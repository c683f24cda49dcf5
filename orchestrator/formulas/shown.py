"""Tables of values by formulas, with those of a run beside them."""

from collections.abc import Iterable, Mapping

from rockshed.components.common.units import SCREEN_UNITS

from ..tables import Table, digits
from .estimate import FormulaValue

_UNITS = {"N": "kN", "m": "m"}
"""Unit on the screen, by the unit of an estimate."""
_WORDS = {True: "yes", False: "no", None: "not known"}


def table_of(
    estimates: Iterable[FormulaValue],
    computed: Mapping[str, Mapping[str, float]] | None = None,
    title: str = "",
) -> Table:
    """Return a table of estimates, with computed values beside them where there are any.

    Parameters
    ----------
    estimates : iterable of FormulaValue
        From :func:`rockshed.formulas.estimates`.
    computed : mapping of str to mapping, optional
        Values of a run by quantity (SI units), under the title of a column that has their deviation
        from each estimate.
    title : str
        Of the table.

    Returns
    -------
    Table
        A row for each estimate; notes with source, range and parameters of each formula.
    """
    listed = list(estimates)
    beside = computed or {}
    columns = ("quantity", "formula", "value", "unit", *beside, "in its range", "verified")
    made = Table(columns, right=("value", *beside), title=title)
    for estimate in listed:
        unit = _UNITS[estimate.unit]
        value = estimate.value / SCREEN_UNITS[unit]
        shown = digits(value, 3)
        against = [_deviation(estimate, of) for of in beside.values()]
        range_and_proof = (_WORDS[estimate.within_range], _WORDS[estimate.verified])
        made.add(estimate.quantity, estimate.name, shown, unit, *against, *range_and_proof)
    made.notes = notes_of(listed)
    return made


def notes_of(estimates: Iterable[FormulaValue]) -> list[str]:
    """Return a line on each formula: parameters, verification, range and source.

    Parameters
    ----------
    estimates : iterable of FormulaValue
        Estimates.
    """
    lines = {
        e.name: f"{e.name}: {e.remark}. Range: {e.validity}. Source: {e.source}." for e in estimates
    }
    return list(lines.values())


def _deviation(estimate: FormulaValue, computed: Mapping[str, float]) -> str:
    found = computed.get(estimate.quantity)
    if found is None or not estimate.value:
        return ""
    return f"{100.0 * (found / estimate.value - 1.0):+.0f} %"
