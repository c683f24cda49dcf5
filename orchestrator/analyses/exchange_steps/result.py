"""The result of a convergence study of exchange steps."""

from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any

from ...core.errors import counted
from ...core.results.columns import result_column, result_table
from ...core.results.metric import Metric
from ...tables import Table
from ..frame import Result, shared_folder
from .figures import Figure, Level
from .files import NAMES, write_files
from .tables import level_table, order_table, step_table


class ExchangeStepsResult(Result):
    """Figures of a system with the exchange step h, h/2, h/4, ...

    Attributes
    ----------
    levels : tuple of Level
        Runs from coarse to fine.
    figures_followed : tuple of Figure
        With their orders and errors.
    accuracy : float
        Error for which a step is recommended, as a part of a figure's size.
    origin : mapping of str to Any
        Case, or file of system or project.
    """

    kind = "exchange-steps"
    picture_folder = "."

    def __init__(
        self,
        name: str,
        levels: Sequence[Level],
        followed: Sequence[Figure],
        accuracy: float,
        origin: Mapping[str, Any],
    ) -> None:
        super().__init__()
        self._name = name
        self.levels = tuple(levels)
        self.figures_followed = tuple(followed)
        self.accuracy = accuracy
        self.origin = dict(origin)

    @classmethod
    def opened(cls, folder: str | Path) -> AbstractContextManager[Path]:
        """Open the folder of the results, in which other files stay as they are."""
        return shared_folder(folder, NAMES)

    @property
    def name(self) -> str:
        """Name of the system; it names the figures."""
        return self._name

    def step_for(self, figure: Figure) -> float | None:
        """Return the exchange step (s) with which a figure has the accuracy.

        Parameters
        ----------
        figure : Figure
            Of this study.

        Returns
        -------
        float or None
            The coarsest of h, h/2, h/4, ... that will do, extrapolated where it was not computed;
            None where none can be told. Of values without an order, the one from which on they
            scatter by less than the accuracy, or go on changing by less than a tenth of it.
        """
        halvings = figure.halvings(self.accuracy)
        return None if halvings is None else self.levels[0].step / 2**halvings

    @property
    def recommended_step(self) -> float | None:
        """Exchange step (s) with which every figure has the accuracy; None if one is unknown."""
        steps = [self.step_for(figure) for figure in self.figures_followed]
        known = [step for step in steps if step is not None]
        return min(known) if known and len(known) == len(steps) else None

    def metric_list(self) -> list[Metric]:
        """Return order, limit and error of the finest step of each figure, and the step."""
        found = []
        for figure in self.figures_followed:
            if figure.found.order is not None:
                found.append(Metric(f"order of {figure.name}", figure.found.order))
            if figure.limit is not None:
                found.append(Metric(f"limit of {figure.name}", figure.limit, figure.unit))
            share = figure.share(-1)
            if share is not None:
                found.append(Metric(f"error of {figure.name} at the finest step", share))
        if self.recommended_step is not None:
            found.append(Metric("recommended exchange step", self.recommended_step, "s"))
        return found

    @property
    def summary(self) -> str:
        """Number of figures that have an order, in one line."""
        orders = sum(figure.found.order is not None for figure in self.figures_followed)
        same = sum(
            figure.found.order is None and figure.found.is_known for figure in self.figures_followed
        )
        rest = f", {same} independent of the step" if same else ""
        return f"{len(self.levels)} steps, {counted(orders, 'figure')} with an order{rest}"

    @property
    def notes(self) -> list[str]:
        """The recommendation, and the meaning of the numbers."""
        found = [self._recommendation()]
        found += [self._doubt(figure) for figure in self.figures_followed if figure.found.reason]
        if len(self.levels) == 3:
            found.append("three steps give one order, which nothing confirms; four do")
        found.append(
            "error: value less limit by Richardson, as a part of the figure; of curves that of the "
            "largest difference; it is the error of the exchange alone"
        )
        found.append(
            "steps of components that divide the exchange step stayed as they are; others were "
            "halved with it, as were those of components without a step of their own"
        )
        return found

    def _doubt(self, figure: Figure) -> str:
        """Return why a figure has no order, and what can be seen nevertheless."""
        text = (
            f"{figure.name}: no order: {figure.found.reason}; values at its last three steps differ"
            f" by {100.0 * figure.spread:.2g} % at most"
        )
        seen = self.step_for(figure)
        if seen is None:
            return text
        return f"{text}; from {seen:.6g} s on they stay near: seen, not extrapolated"

    def _recommendation(self) -> str:
        wanted = f"for an accuracy of {100.0 * self.accuracy:g} %"
        if not self.figures_followed:
            return "nothing that was followed depends on the exchange step"
        step = self.recommended_step
        if step is None:
            without = [f.name for f in self.figures_followed if self.step_for(f) is None]
            return f"no exchange step can be recommended {wanted}: none is known for " + ", ".join(
                without
            )
        beyond = step < self.levels[-1].step
        told = ", finer than those that were computed: check it" if beyond else ""
        return f"recommended exchange step {wanted}: {step:.6g} s{told}"

    @property
    def warnings(self) -> list[str]:
        """Warnings of the runs, each with the steps that have it."""
        told: dict[str, list[str]] = {}
        for level in self.levels:
            for text in level.warnings:
                told.setdefault(text, []).append(f"{level.step:.6g} s")
        return [f"exchange step {', '.join(steps)}: {text}" for text, steps in told.items()]

    def tables(self) -> list[Table]:
        """Return the runs, the orders, and the values from step to step."""
        return [level_table(self.levels), order_table(self), step_table(self)]

    def to_arrow(self) -> Any:
        """Return a row for each figure and step, in SI."""
        rows = [(f, place) for f in self.figures_followed for place in range(len(self.levels))]
        at = [self.levels[place] for _, place in rows]
        units = [figure.unit for figure, _ in rows]
        values = [_at(figure.values, place) for figure, place in rows]
        differences = [_at(figure.differences, place) for figure, place in rows]
        errors = [_at(figure.found.errors, place) for figure, place in rows]
        residuals = [level.residual for level in at]
        return result_table(
            [
                result_column("figure", [f.name for f, _ in rows], "1", "what is followed"),
                result_column("unit", units, "1", "unit of value, difference and error"),
                result_column("exchange_step", [level.step for level in at], "s", "step"),
                result_column("value", values, "1", "in the unit of the row"),
                result_column("difference", differences, "1", "less that of the next step"),
                result_column("error", errors, "1", "estimated, less the limit"),
                result_column("order", [f.found.order for f, _ in rows], "1", "of the figure"),
                result_column("energy_residual", residuals, "J", "largest amount in the run"),
            ]
        )

    def write_files(self, folder: Path) -> list[Path]:
        """Write data and table into a folder, and return the files."""
        return write_files(self, folder)


def _at(values: Sequence[float], place: int) -> float | None:
    return values[place] if place < len(values) else None
