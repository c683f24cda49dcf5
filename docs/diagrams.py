"""Draw the diagram of each component, ``diagram.png`` in its folder: ``python docs/diagrams.py``.

It goes into FMUs. It follows from the declarations, whose text stands in the file, so that a test
sees when it is out of date.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from textwrap import shorten, wrap

import matplotlib
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.image import imread
from matplotlib.patches import FancyArrowPatch, Rectangle
from PIL import Image
from PIL.PngImagePlugin import PngInfo

from rockshed.components.catalogue import NAMES, component
from rockshed.components.common.component import Component
from rockshed.components.common.ports import Causality, Variable

FILE = "diagram.png"
TEXT = "Description"
"""Entry in the head of the file with everything that is written in it."""
_INK, _GREY, _LINE, _BOX, _GROUP = "#222222", "#666666", "#8a99a8", "#e8eef4", "#b5540f"
_WIDTH, _LINE_HEIGHT, _LETTERS = 11.0, 0.15, 64
_LEFT, _RIGHT = 4.05, 6.95
"""Edges (inch) of the box of the component."""


@dataclass(frozen=True)
class Line:
    """A line of text at a side; ``arrow``: whether it is the name of a variable or of several."""

    text: str
    colour: str
    bold: bool = False
    arrow: bool = False


def lines(made: Component, causality: Causality) -> list[Line]:
    """Return what stands at the side of the inputs or of the outputs."""
    variables = [v for v in made.layout.variables if v.causality is causality]
    in_bonds = [
        (bond, [v for v in bond.members(made.layout.variables).values() if v in variables])
        for bond in made.bonds
    ]
    found = []
    for bond, members in in_bonds:
        title = f"terminal {bond.name}: {bond.description}"
        found.append(Line(shorten(title, _LETTERS, placeholder=" ..."), _GROUP, bold=True))
        for variable in members:
            found += _described(variable)
    told = {v.name for _, members in in_bonds for v in members}
    rest = [v for v in variables if v.name not in told]
    if rest and made.bonds:
        found.append(Line("besides", _GROUP, bold=True))
    ports = {_group(v) for v in made.layout.variables if v.causality is Causality.INPUT}
    for variable in rest:
        if not _group(variable) or _group(variable) in ports:
            found += _described(variable)
    return found + list(_gathered([v for v in rest if _group(v) and _group(v) not in ports]))


def _group(variable: Variable) -> str:
    """Return the name's first part, empty where it has one part."""
    return variable.name.partition(".")[0] if "." in variable.name else ""


def _named(variable: Variable) -> str:
    size = f"[{variable.size}]" if variable.size else ""
    return f"{variable.name}{size}   {variable.unit}".rstrip()


def _described(variable: Variable) -> Iterator[Line]:
    yield Line(_named(variable), _INK, bold=True, arrow=True)
    text = shorten(variable.description, 2 * _LETTERS - 8, placeholder=" ...")
    for part in wrap(text, _LETTERS):
        yield Line(part, _GREY)


def _gathered(variables: Sequence[Variable]) -> Iterator[Line]:
    """Yield the names of variables that no partner needs, those of one beginning together."""
    for group in dict.fromkeys(map(_group, variables)):
        members = [v for v in variables if _group(v) == group]
        units = {v.unit for v in members}
        common = units.pop() if len(units) == 1 else ""
        yield Line(f"{group}.*   {common}".rstrip(), _INK, bold=True, arrow=True)
        ends = (
            v.name.partition(".")[2] + ("" if common or v.unit in ("", "1") else f" {v.unit}")
            for v in members
        )
        for part in wrap(", ".join(ends), _LETTERS):
            yield Line(part, _GREY)


def written(made: Component) -> str:
    """Return everything that the diagram says."""
    sides = (lines(made, causality) for causality in (Causality.INPUT, Causality.OUTPUT))
    return "\n".join((made.name, made.title, *(line.text for side in sides for line in side)))


def draw(made: Component, file: Path) -> None:
    """Draw inputs on the left, the component in the middle, outputs on the right."""
    sides = [lines(made, causality) for causality in (Causality.INPUT, Causality.OUTPUT)]
    height = max(22, *map(len, sides)) * _LINE_HEIGHT + 0.5
    with matplotlib.rc_context({"text.parse_math": False, "font.family": "DejaVu Sans"}):
        figure = Figure((_WIDTH, height), dpi=100)
        axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
        axes.set(xlim=(0.0, _WIDTH), ylim=(0.0, height))
        axes.axis("off")
        box = Rectangle((_LEFT, 0.2), _RIGHT - _LEFT, height - 0.4, facecolor=_BOX, edgecolor=_LINE)
        axes.add_patch(box)
        _middle(axes, made, height)
        for side, is_output in zip(sides, (False, True), strict=True):
            _side(axes, side, height, is_output)
        _save(figure, file, written(made))


def _save(figure: Figure, file: Path, text: str) -> None:
    """Write the figure in 64 colours, with a text in its head."""
    FigureCanvasAgg(figure).draw()
    picture = Image.fromarray(np.asarray(figure.canvas.buffer_rgba())).convert("RGB")
    head = PngInfo()
    head.add_text(TEXT, text)
    picture.quantize(64, dither=Image.Dither.NONE).save(file, pnginfo=head, optimize=True)


def _middle(axes, made: Component, height: float) -> None:
    """Draw name, title, icon and frame of the component."""
    middle, top = (_LEFT + _RIGHT) / 2.0, height - 0.45
    axes.text(middle, top, made.name, ha="center", va="top", size=13, weight="bold", color=_INK)
    title = "\n".join(wrap(made.title, 38))
    axes.text(middle, top - 0.32, title, ha="center", va="top", size=8, color=_GREY)
    icon = made.folder / "icon.png"
    if icon.is_file():
        extent = (middle - 0.6, middle + 0.6, top - 2.1, top - 0.9)
        axes.imshow(imread(icon), extent=extent, aspect="auto", zorder=3)
        axes.set(xlim=(0.0, _WIDTH), ylim=(0.0, height))
    if any(v.name.endswith("position.x") for v in made.layout.variables):
        _frame(axes, middle - 0.3, top - 2.75)


def _frame(axes, x: float, y: float) -> None:
    """Draw the frame: x to the right, y upwards."""
    for name, way in (("x", (0.6, 0.0)), ("y", (0.0, 0.45))):
        end = (x + way[0], y + way[1])
        axes.add_patch(FancyArrowPatch((x, y), end, arrowstyle="-|>", mutation_scale=8, color=_INK))
        axes.text(end[0] + 0.05, end[1], name, va="center", size=8, color=_INK)


def _side(axes, side: Sequence[Line], height: float, is_output: bool) -> None:
    """Write the lines of a side, with an arrow at each name."""
    y = height - 0.4
    for line in side:
        x, align = (_RIGHT + 0.42, "left") if is_output else (_LEFT - 0.42, "right")
        weight = "bold" if line.bold else "normal"
        axes.text(x, y, line.text, ha=align, va="center", size=7, color=line.colour, weight=weight)
        if line.arrow:
            begin = _RIGHT if is_output else _LEFT - 0.35
            ends = ((begin, y), (begin + 0.35, y))
            axes.add_patch(FancyArrowPatch(*ends, arrowstyle="-|>", mutation_scale=8, color=_LINE))
        y -= _LINE_HEIGHT


if __name__ == "__main__":
    for name in NAMES:
        draw(component(name), component(name).folder / FILE)
