"""A ball that bounces on a shaking table."""

from pathlib import Path

from ...core.system.reading import system_from
from ...core.system.system import SystemSpec
from ..parts.ball import COMPONENT as BALL
from ..parts.table import COMPONENT as TABLE
from ..system import ExchangeOrder, FmuPart, FmuPaths, ImpactSystem
from .truth import AMPLITUDE, HEIGHT, RATE, RESTITUTION, ball_height


def make(files: FmuPaths, step: float, scheme: ExchangeOrder) -> SystemSpec:
    """Return ball and table; nothing acts on the table."""
    return system_from(
        {
            "name": "bouncing-ball",
            "components": {
                "ball": {
                    "fmu": files["ball"],
                    "parameters": {"position0.y": HEIGHT, "restitution": RESTITUTION},
                },
                "table": {
                    "fmu": files["table"],
                    "parameters": {"amplitude": AMPLITUDE, "angular_frequency": RATE},
                },
            },
            "order": ["ball", "table"],
            "connections": [
                "table.position.y -> ball.table.position.y",
                "table.velocity.y -> ball.table.velocity.y",
                "table.acceleration.y -> ball.table.acceleration.y",
            ],
            "master": scheme,
            "exchange_step": step,
            "stop_time": SYSTEM.stop_time,
        }
    )


SYSTEM = ImpactSystem(
    name="bouncing-ball",
    title="Bouncing ball on a shaking table: events inside a step",
    folder=Path(__file__).parent,
    parts={"ball": FmuPart(BALL), "table": FmuPart(TABLE)},
    make=make,
    quantity="ball.position.y",
    unit="m",
    truth=ball_height,
    stop_time=2.0,
    steps=(1.6e-2, 8e-3, 4e-3, 1e-3),
    step=4e-3,
    tolerance=1e-3,
    moments={"ball.*": "begin"},
)
