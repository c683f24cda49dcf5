"""Variables of the bouncing ball. Equations, frame and signs: README.md beside this file."""

from rockshed.components.common.ports import Layout, inp, out, param
from rockshed.components.common.roles import Role
from rockshed.components.common.units import standard_gravity

TOO_MANY_BOUNCES, TABLE_FALLS = 1, 2

LAYOUT = Layout(
    (
        param("mass", "mass of the ball", 1.0, "kg", minimum=1e-9),
        param(
            "gravity", "acceleration of gravity, downwards", standard_gravity, "m/s2", minimum=0.1
        ),
        param(
            "restitution",
            "velocity away from the table after an impact over that towards it before",
            0.9,
            minimum=0.0,
            maximum=1.0,
        ),
        param("position0.y", "height of the ball's lowest point at the start", 0.5, "m"),
        param("velocity0.y", "velocity at the start, upwards", 0.0, "m/s"),
        inp("table.position.y", "height of the table at the start of the step", "m"),
        inp("table.velocity.y", "velocity of the table at the start of the step, upwards", "m/s"),
        inp(
            "table.acceleration.y",
            "acceleration of the table, constant in the step, upwards; above -gravity",
            "m/s2",
        ),
        out(
            "position.y",
            "height of the ball's lowest point",
            "m",
            initial_dependencies=("position0.y",),
        ),
        out("velocity.y", "velocity, upwards", "m/s", initial_dependencies=("velocity0.y",)),
        out("impacts", "number of impacts so far", initial_dependencies=()),
        out("last_impact.time", "time of the last impact; -1 before", "s", initial_dependencies=()),
        out("energy.kinetic", "kinetic energy", "J", role=Role.KINETIC),
        out("energy.gravity", "potential energy, zero at height 0", "J", role=Role.GRAVITY_ENERGY),
    )
)
