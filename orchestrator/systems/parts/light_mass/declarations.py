"""Variables of the light mass. Equations, frame and signs: README.md beside this file."""

from rockshed.components.common.ports import Layout, inp, out, param
from rockshed.components.common.roles import Role

DIVERGED = 1

LAYOUT = Layout(
    (
        param("mass", "mass", 1.0, "kg", minimum=1e-9),
        param("stiffness", "stiffness of the spring to the ground", 1e7, "N/m", minimum=1e-9),
        param(
            "partner.stiffness",
            "stiffness of the spring to the body above",
            1e6,
            "N/m",
            minimum=0.0,
        ),
        param("position0.y", "position at the start, upwards", 0.0, "m"),
        param("velocity0.y", "velocity at the start, upwards", 0.0, "m/s"),
        inp("partner.position.y", "position of the body above, upwards", "m"),
        inp("partner.velocity.y", "velocity of the body above, upwards; not used", "m/s"),
        out("partner.force.y", "force on the body above, upwards", "N"),
        out("position.y", "position, upwards", "m", initial_dependencies=("position0.y",)),
        out("velocity.y", "velocity, upwards", "m/s", initial_dependencies=("velocity0.y",)),
        out("stable_step", "longest communication step that is stable", "s"),
        out("energy.kinetic", "kinetic energy", "J", role=Role.KINETIC),
        out("energy.elastic", "elastic energy of both springs", "J", role=Role.ELASTIC),
    )
)
