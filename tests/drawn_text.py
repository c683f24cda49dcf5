"""Texts of a figure that cover one another, are cut, or lie on what others have drawn."""

from collections.abc import Iterator
from contextlib import contextmanager
from itertools import combinations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.legend import Legend
from matplotlib.text import Text
from matplotlib.transforms import Bbox

_TOUCH = 1.5
"""Pixels by which boxes may overlap: there is no ink at their edges."""


@contextmanager
def _recorded() -> Iterator[dict[Text, Bbox]]:
    """Record the boxes of all texts that are drawn."""
    drawn: dict[Text, Bbox] = {}
    draw = Text.draw

    def recording(self, renderer, *args, **kwargs):
        draw(self, renderer, *args, **kwargs)
        if self.get_visible() and self.get_text().strip():
            drawn[self] = Text.get_window_extent(self, renderer)

    Text.draw = recording
    try:
        yield drawn
    finally:
        Text.draw = draw


def faults(figure: Figure) -> list[str]:
    """Return in words what is wrong with the texts of a figure; nothing if all can be read."""
    canvas = FigureCanvasAgg(figure)
    with _recorded() as texts:
        canvas.draw()
    boxes = {text: _shrunk(box) for text, box in texts.items()}
    return [
        *_covering(boxes),
        *_cut(boxes, figure),
        *_on_panels(boxes, figure),
        *_on_curves(figure),
        *(f"{_words(text)} is set as a formula" for text in boxes if _is_formula(text)),
    ]


def _shrunk(box: Bbox) -> Bbox:
    return Bbox.from_extents(*(box.x0 + _TOUCH, box.y0 + _TOUCH, box.x1 - _TOUCH, box.y1 - _TOUCH))


def _words(text: Text) -> str:
    return repr(text.get_text()[:50])


def _is_formula(text: Text) -> bool:
    return text.get_parse_math() and "$" in text.get_text().replace(r"\$", "")


def _covering(boxes: dict[Text, Bbox]) -> Iterator[str]:
    for (one, first), (other, second) in combinations(boxes.items(), 2):
        if first.overlaps(second):
            yield f"{_words(one)} and {_words(other)} overlap"


def _cut(boxes: dict[Text, Bbox], figure: Figure) -> Iterator[str]:
    width, height = figure.bbox.size
    for text, box in boxes.items():
        if box.x0 < 0 or box.y0 < 0 or box.x1 > width or box.y1 > height:
            yield f"{_words(text)} is cut by the edge of the picture"


def _on_panels(boxes: dict[Text, Bbox], figure: Figure) -> Iterator[str]:
    """Yield texts on a panel to which they do not belong, and panels that have no size."""
    for axes in figure.axes:
        panel = axes.get_window_extent()
        is_small = min(panel.width, panel.height) < 0.3 * figure.dpi
        if is_small and axes.axison and axes.get_label() != "<colorbar>":
            yield f"a panel of {panel.width:.0f} x {panel.height:.0f} pixels"
        if not axes.axison:
            continue
        inner = set(axes.texts)
        for text, box in boxes.items():
            is_twin = isinstance(text.axes, Axes) and _same_place(text.axes, axes)
            if text in inner or (is_twin and text in text.axes.texts):
                continue
            if box.overlaps(_shrunk(panel)) and not _in_legend_inside(text, axes):
                yield f"{_words(text)} lies on a panel"


def _same_place(one: Axes, other: Axes) -> bool:
    return bool(np.allclose(one.get_window_extent().extents, other.get_window_extent().extents))


def _in_legend_inside(text: Text, axes: Axes) -> bool:
    """Tell whether a text is one of a legend inside its own panel; curves are looked at apart."""
    legend = axes.get_legend()
    return legend is not None and text in (*legend.get_texts(), legend.get_title())


def _on_curves(figure: Figure) -> Iterator[str]:
    """Yield legends, and names inside a panel, that a curve runs through."""
    for axes in figure.axes:
        legend = axes.get_legend()
        boxes = [("the legend", _extent(legend))] if legend else []
        for words, box in boxes:
            for line in axes.get_lines():
                points = line.get_transform().transform_path(line.get_path())
                if len(points.vertices) > 2 and points.intersects_bbox(box, filled=False):
                    yield f"{words} lies on a curve"
                    break


def _extent(legend: Legend) -> Bbox:
    return _shrunk(legend.get_window_extent())
