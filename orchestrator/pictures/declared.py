"""Pictures that components declare as data: curves of their outputs over time, and envelopes."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import cycle
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from rockshed.components.common.roles import Role
from rockshed.components.common.units import SCREEN_UNITS, ms

from ..core.results.metric import identifier
from ..core.results.reading import StoredRun
from ..metrics.energy import has_yielded, load_at_rest
from ..metrics.names import without_component
from ..metrics.roles import members_of
from ..metrics.screen_units import is_shown_in, screen_unit
from ..tables import digits
from .envelope import draw_envelope
from .references import KnownMetrics, draw_references
from .style import (
    BEAM,
    GREY,
    INK,
    ROCK,
    TRANSMITTED,
    WIDTH,
    figure,
    legend,
    literal,
    over_time,
    second_scale,
)

_COLOURS = (ROCK, TRANSMITTED, BEAM, INK, "#8a6d4b", "#6a4c93")
_PANEL = 2.0
"""Height of a panel (inch)."""
_FORCES = ("N", "kN", "kgf")


@dataclass
class DeclaredPanel:
    """A panel as it is declared, and the components that are drawn into it.

    Attributes
    ----------
    told : mapping
        The declaration, as ``run.json`` has it.
    components : list of str
        Names of the components in the system.
    """

    told: Mapping[str, Any]
    components: list[str] = field(default_factory=list)

    @property
    def is_envelope(self) -> bool:
        """Whether it is drawn along the component and not over time."""
        return "along" in self.told

    @property
    def common(self) -> bool:
        """Whether all components that declare it are drawn into one."""
        return bool(self.told.get("common"))

    @property
    def needed(self) -> str:
        """Output without which it is not drawn."""
        if self.is_envelope:
            return f"{self.told['variable']}[1]"
        return str(self.told["curves"][0]["variable"])


@dataclass(frozen=True)
class DeclaredPicture:
    """A picture with the panels of all components that declare it.

    Attributes
    ----------
    name : str
        Name of the file without its ending.
    panels : sequence of panels
        From top to bottom.
    """

    name: str
    panels: Sequence[DeclaredPanel]

    @property
    def columns(self) -> list[str]:
        """Columns of the results without which it is not drawn: the first one of each panel."""
        return [
            f"{component}.{panel.needed}" for panel in self.panels for component in panel.components
        ]

    def owner(self, panel: DeclaredPanel) -> str:
        """Return the component that a panel belongs to; empty if all belong to one.

        Parameters
        ----------
        panel : DeclaredPanel
            One of the panels.
        """
        owners = {panel.components[0] for panel in self.panels if not panel.common}
        return literal(panel.components[0]) if len(owners) > 1 and not panel.common else ""

    def draw(self, run: StoredRun, known: KnownMetrics, file: Path) -> None:
        """Draw the picture.

        Parameters
        ----------
        run : StoredRun
            The run.
        known : mapping of str to Known
            References by the name of the metric.
        file : Path
            File of the picture.
        """
        with figure(run, file, WIDTH, 1.0 + _PANEL * len(self.panels)) as made:
            rows = made.subplots(len(self.panels), 1, squeeze=False).ravel()
            for axes, panel in zip(rows, self.panels, strict=True):
                owner = self.owner(panel)
                if panel.is_envelope:
                    before = f"{owner}: " if owner else ""
                    draw_envelope(run, panel.components[0], panel.told, axes, before)
                else:
                    _draw_panel(run, panel, axes, owner)
                    _draw_known(panel, known, axes)
                legend(axes)
            drawn = zip(rows, self.panels, strict=True)
            _share_time(run, [axes for axes, panel in drawn if not panel.is_envelope])


def _as_shown(told: Mapping[str, Any], run: StoredRun) -> Mapping[str, Any]:
    """Return a declared panel in the units in which the run is shown."""
    second = told.get("second_unit", "")
    shown = screen_unit(told["unit"], run)
    return {**told, "unit": shown, "second_unit": second if is_shown_in(second, run) else ""}


def declared_pictures(run: StoredRun) -> list[DeclaredPicture]:
    """Return the pictures that the components of a run declare.

    Parameters
    ----------
    run : StoredRun
        The run.

    Returns
    -------
    list of DeclaredPicture
        One for each name.
    """
    pictures: dict[str, list[DeclaredPanel]] = {}
    for component, facts in run.provenance["components"].items():
        for picture in facts.get("pictures", ()):
            panels = pictures.setdefault(picture["name"], [])
            for told in (_as_shown(panel, run) for panel in picture["panels"]):
                shared = [p for p in panels if p.common and p.told == told]
                panels += [] if shared else [DeclaredPanel(told)]
                (shared or panels[-1:])[0].components.append(component)
    return [
        DeclaredPicture(name, sorted(panels, key=lambda panel: panel.common))
        for name, panels in pictures.items()
    ]


def _share_time(run: StoredRun, rows: Sequence[Axes]) -> None:
    """Give the panels of curves one axis of time, labelled at the lowest one."""
    for axes in rows[:-1]:
        axes.sharex(rows[-1])
        axes.tick_params(labelbottom=False)
    for axes in rows[-1:]:
        axes.set(xlabel="time (ms)")
        over_time(axes, run.series["time"] / ms)


@dataclass(frozen=True)
class DeclaredCurve:
    """A curve of a panel.

    Attributes
    ----------
    label : str
        Its name in the legend, empty where the panel has no other.
    values : array of float, shape (rows,)
        In the unit of the panel.
    colour : str
        That of the solid curve of which it is a part, if it is dashed.
    dashed : bool
        Whether it is a part of the curve before it.
    """

    label: str
    values: NDArray[np.float64]
    colour: str
    dashed: bool


def curves_of(run: StoredRun, panel: DeclaredPanel) -> Iterator[DeclaredCurve]:
    """Yield the curves of a panel whose outputs were recorded.

    Parameters
    ----------
    run : StoredRun
        The run.
    panel : DeclaredPanel
        A panel of curves over time.
    """
    colours = cycle(_COLOURS)
    for component in panel.components:
        colour = ""
        for curve in panel.told["curves"]:
            colour = colour if curve["dashed"] and colour else next(colours)
            name = f"{component}.{curve['variable']}"
            if name not in run.series or means_nothing(run, component, curve["variable"]):
                continue
            values = curve["factor"] * run.series[name]
            if curve["from_start"]:
                values = values - values[0]
            words = [literal(component)] if panel.common else []
            yield DeclaredCurve(
                ", ".join(filter(None, [*words, curve["label"]])),
                values / SCREEN_UNITS[panel.told["unit"]],
                colour,
                curve["dashed"],
            )


def means_nothing(run: StoredRun, component: str, variable: str) -> bool:
    """Tell whether a curve of a structure says nothing about this run.

    That is an elastic energy as its strain tells it where it has yielded, and the energy that it
    dissipates by yielding where it has not.

    Parameters
    ----------
    run : StoredRun
        The run.
    component, variable : str
        Of the curve.
    """
    unwanted = Role.ESTIMATED if has_yielded(run, component) else Role.PLASTIC
    return any(member.variable == variable for member in members_of(run, component, unwanted))


def label_of(panel: DeclaredPanel, owner: str) -> str:
    """Return the label of a panel's vertical axis.

    Parameters
    ----------
    panel : DeclaredPanel
        The panel.
    owner : str
        Component, put before the label; empty if it is the only one.
    """
    unit = panel.told["unit"]
    shown = "" if unit == "1" else f" ({unit})"
    return f"{owner}: {panel.told['label']}{shown}" if owner else f"{panel.told['label']}{shown}"


def loads_at_rest(run: StoredRun, panel: DeclaredPanel) -> list[str]:
    """Return a note for each load at rest that a panel of forces leaves out.

    Parameters
    ----------
    run : StoredRun
        The run.
    panel : DeclaredPanel
        A panel of curves over time.
    """
    unit = panel.told["unit"]
    if unit not in _FORCES:
        return []
    loads = [load_at_rest(run, component) for component in panel.components]
    return [
        f"beyond the load at rest, {digits(abs(load) / SCREEN_UNITS[unit])} {unit}"
        for load in loads
        if load
    ]


def _draw_panel(run: StoredRun, panel: DeclaredPanel, axes: Axes, owner: str) -> None:
    """Draw the curves of a panel."""
    told = panel.told
    for curve in curves_of(run, panel):
        axes.plot(
            run.series["time"] / ms,
            curve.values,
            "--" if curve.dashed else "-",
            color=curve.colour,
            linewidth=1.1,
            label=curve.label or None,
        )
    for text in loads_at_rest(run, panel):
        axes.plot([], [], linestyle="none", label=text)
    axes.axhline(0.0, color=GREY, linewidth=0.7)
    downwards = "\ndownwards" if told["downwards"] else ""
    axes.set(ylabel=label_of(panel, owner) + downwards)
    if told["downwards"]:
        axes.invert_yaxis()
    if told["second_unit"]:
        factor = SCREEN_UNITS[told["unit"]] / SCREEN_UNITS[told["second_unit"]]
        second_scale(axes, factor, f"({told['second_unit']})")


def known_in(panel: DeclaredPanel, known: KnownMetrics) -> KnownMetrics:
    """Return the references of the metric that a panel names.

    Parameters
    ----------
    panel : DeclaredPanel
        A panel of curves over time.
    known : mapping of str to Known
        References by the name of the metric.
    """
    return {
        name: references
        for name, references in known.items()
        if identifier(without_component(name)) == panel.told["references"]
    }


def _draw_known(panel: DeclaredPanel, known: KnownMetrics, axes: Axes) -> None:
    """Draw the references of the metric that a panel names."""
    for name, references in known_in(panel, known).items():
        draw_references(axes, references, panel.told["unit"], name)
