"""The ground under an impulsive load: Mogami's plate with its sand, or Smith's soil at the toe of a rod."""

from pathlib import Path

from ..common.component import Component
from ..common.shown import Curve, Panel, Picture
from . import kernel
from .declarations import LAYOUT

COMPONENT = Component(
    name="ImpulsiveGround",
    title="Ground under an impulsive load: settling plate (Mogami), soil at a toe (Smith)",
    layout=LAYOUT,
    initialise=kernel.initialise,
    evaluate=kernel.evaluate,
    step=kernel.step,
    folder=Path(__file__).parent,
    check=kernel.problems,
    faults={
        **kernel.FAULTS,
        kernel.DIVERGED: "settlement or work is no longer a finite number (force.y = {force.y} N, toe.velocity = {toe.velocity} "
        "m/s, toe.wave = {toe.wave} N): reduce the exchange step or the step of the component that computes them",
    },
    default_step=1e-5,
    pictures=(
        Picture(
            "piles",
            (
                Panel(
                    "settlement of the toe",
                    "mm",
                    (Curve("settlement"), Curve("permanent_set", "set", dashed=True)),
                    downwards=True,
                    common=True,
                ),
            ),
        ),
    ),
)
