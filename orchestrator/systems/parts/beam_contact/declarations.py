"""Variables of the contact of ball and beam. Equations, frame and signs: README.md."""

from rockshed.components.common.ports import Layout, inp, out, param
from rockshed.components.common.roles import Role

DIVERGED = 1

LAYOUT = Layout(
    (
        param("stiffness", "stiffness of the contact", 1e7, "N/m", minimum=0.0),
        inp("ball.position.y", "height of the ball's lowest point, upwards", "m"),
        inp(
            "beam.position.y",
            "height of the disc above the unloaded axis, upwards",
            "m",
            size="elements",
        ),
        out("ball.force.y", "force on the ball, upwards", "N"),
        out(
            "beam.force.y",
            "force on the disc, upwards; of the middle disc alone",
            "N",
            size="elements",
        ),
        out("energy.elastic", "elastic energy of the contact", "J", role=Role.ELASTIC),
    )
)
