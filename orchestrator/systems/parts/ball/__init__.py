"""A ball that bounces on a moving table and finds its impacts itself."""

from pathlib import Path

from rockshed.components.common.component import Component

from .declarations import LAYOUT, TABLE_FALLS, TOO_MANY_BOUNCES

COMPONENT = Component(
    name="BouncingBall",
    title="Bouncing ball on a moving table: impacts as events inside a step",
    layout=LAYOUT,
    kernels=f"{__name__}.kernel",
    folder=Path(__file__).parent,
    faults={
        TOO_MANY_BOUNCES: "more than 1000 impacts in one communication step: the ball has come to "
        "rest on the table, which this component does not compute",
        TABLE_FALLS: "the table falls faster than the ball: table.acceleration.y = "
        "{table.acceleration.y} m/s2 has to be above -gravity = -{gravity} m/s2",
    },
    default_step=1e-3,
    default_stop_time=1.0,
)
