"""Variables of the loaded spring. Equations, frame and signs: README.md beside this file."""

from rockshed.components.common.ports import Layout, inp, out, param

DIVERGED = 1

LAYOUT = Layout(
    (
        param("stiffness", "stiffness of the spring", 5e5, "N/m", minimum=0.0),
        param("amplitude", "amplitude of the load", 1e3, "N", minimum=0.0),
        param("angular_frequency", "angular frequency of the load", 10.0, "rad/s", minimum=0.0),
        inp("displacement", "displacement, downwards", "m"),
        out("force", "load less the force of this spring, downwards", "N"),
    )
)
