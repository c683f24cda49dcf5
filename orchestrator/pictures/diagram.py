"""The diagram of a system: which component gives which values to which, at what rate.

Components stand on a diagonal in the order of their turns. What one gives another stands in its row
and in the column of the other: above the diagonal what is handed on, below it what comes back
(an N2 chart, as in Lambe & Martins, Struct. Multidisc. Optim. 46 (2012) 273). Nothing can lie on
anything else there, however many components there are.

Letters have one width, so that the place of every text is known without a font.
"""

import re
import unicodedata
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import accumulate, pairwise
from math import inf
from pathlib import Path
from textwrap import wrap
from xml.etree import ElementTree

from ..core.system.names import split_name
from ..core.system.parts import Connection
from ..core.system.system import SystemSpec

_INK, _GREY, _LINE, _BOX = "#222222", "#666666", "#8a99a8", "#e8eef4"
_BOND, _BOND_BOX = "#b5540f", "#fbeee2"
_LOOP = "#6a2c91"
_DASHES = "6 3"
"""Colour and dashes of what stands in an algebraic loop; dashes are seen without colours too."""
_FONT = "'DejaVu Sans Mono', Menlo, Consolas, monospace"
_ADVANCE = 0.61
"""Width of a letter, in sizes of the font; that of the fonts above is 0.55 to 0.602."""
_NAME, _SMALL = 13.0, 10.5
"""Sizes (px) of the names of components and of everything else."""
_LEADING = 1.35
"""Height of a line, in sizes of the font."""
_PAD, _GAP, _MARGIN = 7.0, 16.0, 14.0
"""Lengths (px) around a text, between boxes, around the diagram."""
_ROOM: Sequence[tuple[float, tuple[int, int]]] = ((6, (24, 7)), (9, (20, 6)), (inf, (16, 5)))
"""Letters of a line and lines of a box of values, by the number of components up to which they
hold."""
_ELEMENT = re.compile(r"\[(\d+)\]")


@dataclass(frozen=True)
class Text:
    """A line of text.

    Attributes
    ----------
    text : str
        Without line breaks.
    size : float
        Of the font (px).
    colour : str
        Hexadecimal.
    bold : bool
        Whether it is bold.
    """

    text: str
    size: float = _SMALL
    colour: str = _INK
    bold: bool = False

    @property
    def width(self) -> float:
        """Width (px); East Asian letters are two wide."""
        wide = sum(unicodedata.east_asian_width(letter) in "WF" for letter in self.text)
        return (len(self.text) + wide) * _ADVANCE * self.size


@dataclass(frozen=True)
class _Box:
    """Lines of text in a frame; ``title`` is shown under the mouse."""

    lines: Sequence[Text]
    title: str
    is_bond: bool = False
    in_loop: bool = False

    @property
    def width(self) -> float:
        """Width of the frame (px), around its longest line."""
        return max(line.width for line in self.lines) + 2 * _PAD

    @property
    def colour(self) -> str:
        """Colour of the way of these values."""
        if self.in_loop:
            return _LOOP
        return _BOND if self.is_bond else _LINE

    @property
    def height(self) -> float:
        """Height of the frame (px), around all lines."""
        return sum(_LEADING * line.size for line in self.lines) + 2 * _PAD


Cell = tuple[int, int]
"""Row, of the component that gives, and column, of the one that takes."""


def system_diagram(
    system: SystemSpec, loops: Sequence[str] = (), fmus: Mapping[str, str] | None = None
) -> str:
    """Draw a system.

    Parameters
    ----------
    system : SystemSpec
        Its FMUs are not looked at.
    loops : sequence of str
        Its algebraic loops, ``a.y -> b.u -> b.y -> a.u -> a.y``; components and connections in one
        are marked.
    fmus : mapping of str to str, optional
        Names of the FMUs by component, where they are others than those of the system.

    Returns
    -------
    str
        An SVG picture, as text.
    """
    order = [name for name in system.order if name in system.components]
    order += [name for name in system.components if name not in order]
    named = {name: spec.fmu for name, spec in system.components.items()} | dict(fmus or {})
    boxes = {(i, i): _component(system, name, i, named[name]) for i, name in enumerate(order)}
    boxes |= _cells(system, order, next(room for most, room in _ROOM if len(order) <= most))
    for cell in _in_loops(loops, order) & boxes.keys():
        boxes[cell] = replace(boxes[cell], in_loop=True)
    return _Drawing(system, len(order), boxes).svg()


def _in_loops(loops: Iterable[str], order: Sequence[str]) -> set[Cell]:
    """Return the cells of all components and connections that stand in a loop."""
    turns = {name: turn for turn, name in enumerate(order)}
    cells: set[Cell] = set()
    for loop in loops:
        names = [split_name(port, turns)[0] for port in loop.split(" -> ")]
        owners = [turns[name] for name in names if name in turns]
        cells |= {*zip(owners, owners), *pairwise(owners)}
    return cells


# ---------------------------------------------------------------------- what stands in the boxes


def _component(system: SystemSpec, name: str, place: int, fmu: str) -> _Box:
    """Return the box of a component: name, FMU, step."""
    step = system.step(name)
    turn = "" if system.master == "jacobi" else f"{place + 1} "
    model = Path(fmu).stem if fmu.endswith(".fmu") else fmu.partition(" (")[0]
    lines = [Text(_cut(f"{turn}{name}", 20), _NAME, bold=True)]
    lines += [Text(_cut(model, 22), colour=_GREY)] if model else []
    lines.append(Text(f"step {_time(step)}"))
    ratio = step / system.exchange_step
    if ratio < 1.0:
        lines.append(Text(f"{round(1.0 / ratio)} an exchange"))
    elif ratio > 1.0:
        lines.append(Text(f"{round(ratio)} exchanges"))
    own = [
        c
        for c in system.connections
        if {_owner(system, c.source), _owner(system, c.target)} == {name}
    ]
    if own:
        lines.append(Text("feeds itself", colour=_GREY))
    return _Box(lines, f"{name}: {fmu}, step {step:g} s")


def _owner(system: SystemSpec, end: str) -> str:
    return split_name(end, system.components)[0]


def _cells(system: SystemSpec, order: Sequence[str], room: tuple[int, int]) -> dict[Cell, _Box]:
    """Return the boxes of the values that go from one component to another."""
    turns = {name: turn for turn, name in enumerate(order)}
    grouped: dict[Cell, list[Connection]] = {}
    for connection in system.connections:
        source, _ = split_name(connection.source, turns)
        target, _ = split_name(connection.target, turns)
        if source in turns and target in turns:
            grouped.setdefault((turns[source], turns[target]), []).append(connection)
            if connection.terminals:
                back = {"source": connection.target, "target": connection.source}
                turned = connection.model_copy(update=back)
                grouped.setdefault((turns[target], turns[source]), []).append(turned)
    bonds: dict[Cell, list[str]] = {}
    for name, bond in system.bonds.items():
        if bond.giver in turns and bond.taker in turns:
            bonds.setdefault((turns[bond.giver], turns[bond.taker]), []).append(name)
            bonds.setdefault((turns[bond.taker], turns[bond.giver]), [])
    return {
        cell: _cell(connections, bonds.get(cell), order[cell[0]], room)
        for cell, connections in grouped.items()
        if cell[0] != cell[1]
    }


def _cell(
    connections: Sequence[Connection],
    bonds: Sequence[str] | None,
    source: str,
    room: tuple[int, int],
) -> _Box:
    """Return the box of some connections; ``room``: letters of a line, and lines."""
    width, most = room
    entries = condensed(
        (c.source.removeprefix(f"{source}."), _way_in_words(c)) for c in connections
    )
    lines = [Text(_cut(name, width), colour=_BOND, bold=True) for name in bonds or ()]
    texts = [line for entry in entries for line in wrap(entry, width, break_on_hyphens=False)]
    shown = texts if len(texts) <= most else texts[: most - 1]
    lines += [Text(_cut(text, width)) for text in shown]
    if len(shown) < len(texts):
        lines.append(Text("...", colour=_GREY))
    title = "\n".join(f"{c.source} -> {c.target}{_way_in_words(c)}" for c in connections)
    return _Box(lines, title, bonds is not None)


def _way_in_words(connection: Connection) -> str:
    if connection.terminals:
        return " (terminal)"
    if not connection.is_linear:
        return ""
    offset = f" {connection.offset:+g}" if connection.offset else ""
    return f" ×{connection.factor:g}{offset}"


def condensed(names: Iterable[tuple[str, str]]) -> list[str]:
    """Return names of ports in few words: ``force.x .y``, ``angle[1..24]``.

    Parameters
    ----------
    names : iterable of (str, str)
        Names, and what stands behind each.
    """
    arrays: dict[tuple[str, str], list[str]] = {}
    for name, behind in names:
        arrays.setdefault((_ELEMENT.sub("[]", name), behind), []).append(name)
    parents: dict[tuple[str, str], list[str]] = {}
    for (name, behind), elements in arrays.items():
        numbers = {int(number) for e in elements for number in _ELEMENT.findall(e)[:1]}
        shown = f"[{min(numbers)}..{max(numbers)}]" if len(numbers) > 1 else f"{[*numbers]}"
        parent, dot, last = name.rpartition(".")
        whole = (parent + dot).replace("[]", shown), behind
        parents.setdefault(whole, []).append(last.replace("[]", shown))
    return [
        parent + (" ." if parent else ", ").join(lasts) + behind
        for (parent, behind), lasts in parents.items()
    ]


def _cut(text: str, most: int) -> str:
    return text if len(text) <= most else f"{text[: most - 1]}…"


def _time(seconds: float) -> str:
    return f"{seconds:g} s" if seconds >= 1.0 else f"{1e3 * seconds:g} ms"


# ---------------------------------------------------------------------- where they stand


@dataclass
class _Drawing:
    """Puts boxes into rows and columns, and lines between them."""

    system: SystemSpec
    number: int
    boxes: Mapping[Cell, _Box]

    def svg(self) -> str:
        """Return the picture: head, lines, boxes over them, legend."""
        widths = [self._largest(1, i, "width") for i in range(self.number)]
        heights = [self._largest(0, i, "height") for i in range(self.number)]
        across = sum(widths) + _GAP * (self.number - 1) + 2 * _MARGIN
        head = self._head(max(across, 36 * _ADVANCE * _SMALL))
        self.x = _middles(widths, _MARGIN)
        self.y = _middles(heights, _MARGIN + _height(head) + 0.5 * _GAP)
        below = self.y[-1] + 0.5 * heights[-1] + _GAP
        legend = self._legend(max(across, 36 * _ADVANCE * _SMALL))
        width = max([across, *(line.width + 2 * _MARGIN for line in (*head, *legend))])
        height = below + _height(legend) + _MARGIN
        picture = ElementTree.Element("svg", _of_picture(width, height, self.system.name))
        ElementTree.SubElement(picture, "title").text = self.system.name
        picture.append(_rectangle(0.0, 0.0, width, height, "#ffffff", "none"))
        _write(picture, head, _MARGIN, _MARGIN, "start")
        between = [cell for cell in self.boxes if cell[0] != cell[1]]
        for cell in sorted(between, key=lambda c: (self.boxes[c].in_loop, self.boxes[c].is_bond)):
            self._line(picture, cell)
        for cell, box in self.boxes.items():
            self._box(picture, cell, box)
        _write(picture, legend, _MARGIN, below, "start")
        return ElementTree.tostring(picture, encoding="unicode")

    def _largest(self, axis: int, place: int, length: str) -> float:
        return max(getattr(box, length) for cell, box in self.boxes.items() if cell[axis] == place)

    def _head(self, width: float) -> list[Text]:
        system = self.system
        told = (
            f"{system.name}: {system.master} master, exchange every {_time(system.exchange_step)} "
            f"until {_time(system.stop_time)}"
        )
        return [Text(line, colour=_GREY) for line in _wrapped(told, width)]

    def _legend(self, width: float) -> list[Text]:
        told = ["A row gives, a column takes."]
        if self.system.master == "sequential" and self.number > 1:
            told.append("Above the diagonal: values of this exchange, below: of the last.")
        elif self.system.master == "implicit" and self.number > 1:
            told.append("Values of one exchange, which is repeated until they fit together.")
        elif self.number > 1:
            told.append("All take the values of the beginning of an exchange.")
        lines = [Text(line, colour=_GREY) for text in told for line in _wrapped(text, width)]
        if any(box.is_bond for box in self.boxes.values()):
            said = "Orange: a power bond, whose energy is accounted for."
            lines += [Text(line, colour=_BOND) for line in _wrapped(said, width)]
        if any(box.in_loop for box in self.boxes.values()):
            said = f"Purple, dashed: an algebraic loop{self._way_of_loops()}."
            lines += [Text(line, colour=_LOOP) for line in _wrapped(said, width)]
        return lines

    def _way_of_loops(self) -> str:
        is_solved = self.system.master == "implicit"
        return ", whose values are iterated" if is_solved else ", which has a delay of an exchange"

    def _line(self, picture: ElementTree.Element, cell: Cell) -> None:
        """Draw the way of values: along the row of the giver, then along the taker's column."""
        row, column = cell
        giver, taker = self.boxes[row, row], self.boxes[column, column]
        to_right = 1.0 if column > row else -1.0
        begin = self.x[row] + to_right * 0.5 * giver.width
        end = self.y[column] - to_right * 0.5 * taker.height
        x, y = self.x[column], self.y[row]
        box = self.boxes[cell]
        colour = box.colour
        thick = "1.2" if colour == _LINE else "2.4"
        points = f"M{begin:.1f} {y:.1f}H{x:.1f}V{end - to_right * 6.0:.1f}"
        style = {"fill": "none", "stroke": colour, "stroke-width": thick}
        style |= {"stroke-dasharray": _DASHES} if box.in_loop else {}
        ElementTree.SubElement(picture, "path", {"d": points, **style})
        tip = f"M{x:.1f} {end:.1f}l-4 {-to_right * 8.0:.1f}h8z"
        ElementTree.SubElement(picture, "path", {"d": tip, "fill": colour})

    def _box(self, picture: ElementTree.Element, cell: Cell, box: _Box) -> None:
        group = ElementTree.SubElement(picture, "g")
        ElementTree.SubElement(group, "title").text = box.title
        x, y = self.x[cell[1]] - 0.5 * box.width, self.y[cell[0]] - 0.5 * box.height
        is_component = cell[0] == cell[1]
        of_values = (_BOND_BOX, _BOND) if box.is_bond else ("#ffffff", _LINE)
        fill, edge = (_BOX, _INK) if is_component else of_values
        frame = _rectangle(x, y, box.width, box.height, fill, edge)
        frame.set("rx", "5" if is_component else "2")
        if box.in_loop:
            for key, value in (
                ("stroke", _LOOP),
                ("stroke-width", "2"),
                ("stroke-dasharray", _DASHES),
            ):
                frame.set(key, value)
        group.append(frame)
        _write(group, box.lines, self.x[cell[1]], y + _PAD, "middle")


def _of_picture(width: float, height: float, name: str) -> dict[str, str]:
    return {
        "xmlns": "http://www.w3.org/2000/svg",
        "role": "img",
        "aria-label": f"diagram of the system {name}",
        "width": f"{width:.0f}",
        "height": f"{height:.0f}",
        "viewBox": f"0 0 {width:.0f} {height:.0f}",
        "font-family": _FONT,
    }


def _middles(lengths: Sequence[float], begin: float) -> list[float]:
    """Return the middles of rows or columns of these lengths, one behind the other."""
    edges = accumulate((length + _GAP for length in lengths), initial=begin)
    return [edge + 0.5 * length for edge, length in zip(edges, lengths)]


def _height(lines: Iterable[Text]) -> float:
    return sum(_LEADING * line.size for line in lines)


def _wrapped(text: str, width: float) -> list[str]:
    return wrap(text, max(20, int((width - 2 * _MARGIN) / (_ADVANCE * _SMALL))))


def _rectangle(
    x: float, y: float, width: float, height: float, fill: str, edge: str
) -> ElementTree.Element:
    places = {"x": x, "y": y, "width": width, "height": height}
    told = {name: f"{value:.1f}" for name, value in places.items()}
    return ElementTree.Element("rect", {**told, "fill": fill, "stroke": edge})


def _write(
    picture: ElementTree.Element, lines: Iterable[Text], x: float, top: float, anchor: str
) -> None:
    """Write lines below one another from a height on."""
    for line in lines:
        top += _LEADING * line.size
        told = {
            "x": f"{x:.1f}",
            "y": f"{top - 0.32 * line.size:.1f}",
            "font-size": f"{line.size:g}",
            "fill": line.colour,
            "text-anchor": anchor,
        }
        if line.bold:
            told["font-weight"] = "bold"
        ElementTree.SubElement(picture, "text", told).text = line.text
