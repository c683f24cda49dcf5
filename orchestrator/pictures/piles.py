"""Pictures of rods and the ground under them, from a run."""

from pathlib import Path

from rockshed.components.common.units import kN, mm, ms

from ..core.results.reading import Run
from ..metrics import headlines as h
from .style import BEAM, GREY, ROCK, SAND, TRANSMITTED, WIDTH, figure, legend, over_time

_CURVES = (
    ("head.contact_force", ROCK, "-", "force at the head"),
    ("head.zv", ROCK, "--", "Z v there"),
    ("toe.contact_force", TRANSMITTED, "-", "force at the toe"),
)
_GROUNDS = (SAND, BEAM, TRANSMITTED, ROCK)


def blow(run: Run, file: Path) -> None:
    """For each rod the force at its head beside Z v, and at its toe; below, the settlement of the ground."""
    rods, grounds, time = (
        h.named(run, "PileRod"),
        h.named(run, "ImpulsiveGround"),
        run.series["time"] / ms,
    )
    panels = len(rods) + bool(grounds)
    with figure(run, file, WIDTH, 1.0 + 2.0 * panels) as made:
        rows = made.subplots(panels, 1, sharex=True, squeeze=False).ravel()
        for axes, rod in zip(rows, rods):
            for column, colour, dashes, name in _CURVES:
                axes.plot(
                    time,
                    run.series[f"{rod}.{column}"] / kN,
                    dashes,
                    color=colour,
                    linewidth=1.1,
                    label=name,
                )
            axes.axhline(0.0, color=GREY, linewidth=0.7)
            axes.set(ylabel=f"{rod} (kN)")
            if load := h.preload(run, rod):
                axes.annotate(
                    f"beyond the load at rest, {abs(load) / kN:.1f} kN at the head",
                    (1.0, 0.0),
                    xycoords="axes fraction",
                    xytext=(-3, 3),
                    textcoords="offset points",
                    ha="right",
                    va="bottom",
                    fontsize=8,
                    color=GREY,
                )
        legend(rows[0], loc="upper right", ncols=3)
        for ground, colour in zip(grounds, _GROUNDS):
            axes = rows[-1]
            axes.plot(
                time,
                run.series[f"{ground}.settlement"] / mm,
                color=colour,
                label=f"{ground}, set {run.series[f'{ground}.permanent_set'][-1] / mm:.2f} mm",
            )
            axes.axhline(
                run.series[f"{ground}.permanent_set"][-1] / mm,
                color=colour,
                linewidth=0.8,
                linestyle=":",
            )
        if grounds:
            rows[-1].set(ylabel="settlement of the toe (mm)")
            rows[-1].invert_yaxis()
            legend(rows[-1], loc="upper right")
        rows[-1].set(xlabel="time (ms)")
        over_time(rows[-1], time)
