"""Variables of the shaking table. Equations, frame and signs: README.md beside this file."""

from rockshed.components.common.ports import Layout, out, param

LAYOUT = Layout(
    (
        param("amplitude", "amplitude", 0.02, "m", minimum=0.0),
        param("angular_frequency", "angular frequency", 20.0, "rad/s", minimum=0.0),
        out("position.y", "height of the table, upwards", "m", initial_dependencies=()),
        out("velocity.y", "velocity of the table, upwards", "m/s"),
        out(
            "acceleration.y", "acceleration of the table, upwards", "m/s2", initial_dependencies=()
        ),
    )
)
