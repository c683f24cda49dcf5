"""Variables of the spring without mass. Equations, frame and signs: README.md beside this file."""

from rockshed.components.common.ports import Layout, inp, out, param

DIVERGED = 1

LAYOUT = Layout(
    (
        param("stiffness", "stiffness", 1e6, "N/m", minimum=1e-9),
        inp("force", "force, downwards", "N"),
        out("displacement", "displacement, downwards", "m"),
    )
)
