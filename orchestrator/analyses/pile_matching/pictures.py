"""The picture of a wave matching: measured and computed waves, force and velocity."""

from collections.abc import Mapping
from functools import partial
from typing import TYPE_CHECKING

from matplotlib.figure import Figure

from rockshed.components.common.units import kN, ms

from ...pictures.style import GREY, INK, ROCK, TRANSMITTED, WIDTH, legend, literal
from ..drawing import drawn
from ..frame import Drawing

if TYPE_CHECKING:
    from .result import PileMatch


def drawings(result: "PileMatch") -> Mapping[str, Drawing]:
    """Return a function for each figure of a matching.

    Parameters
    ----------
    result : PileMatch
        Of the matching.

    Returns
    -------
    dict of str to callable
        By the name of the file without its ending.
    """
    return {"matching": partial(matching, result)}


def matching(result: "PileMatch") -> Figure:
    """Draw what was measured, and what is computed with the matched soil.

    Parameters
    ----------
    result : PileMatch
        Of the matching.

    Returns
    -------
    matplotlib.figure.Figure
        Measured force and Z v; wave upwards and force, measured and computed.
    """
    model = result.model
    time = model.time / ms
    lines = [
        f"{literal(result.name)}: {result.summary}",
        "Compression positive. Dotted: the wave is back from the toe, counted from the largest "
        "force of the wave downwards.",
    ]
    with drawn(lines, WIDTH, 7.0) as figure:
        both, wave, force = figure.subplots(3, 1, sharex=True)
        both.plot(time, (model.down + model.up) / kN, color=INK, label="force, measured")
        both.plot(time, (model.down - model.up) / kN, "--", color=GREY, label="Z v, measured")
        wave.plot(time, model.up / kN, color=INK, label="wave upwards, measured")
        wave.plot(time, result.up / kN, "--", color=ROCK, label="computed")
        force.plot(time, (model.down + model.up) / kN, color=INK, label="force, measured")
        force.plot(time, (model.down + result.up) / kN, "--", color=TRANSMITTED, label="computed")
        back = time[model.down.argmax()] + 2.0 * model.pile.travel_time / ms
        for axes in (both, wave, force):
            axes.axhline(0.0, color=GREY, linewidth=0.7)
            axes.axvline(back, color=GREY, linewidth=0.7, linestyle=":")
            axes.set(ylabel="force (kN)")
            legend(axes)
        force.set(xlabel="time (ms)", xlim=(time[0], time[-1]))
    return figure
