"""Variables of the bonded relay, two of which pass energy to each other."""

from rockshed.components.common.ports import Layout, inp, out

LAYOUT = Layout(
    (
        inp("force", "forces that it is given", "N", size="channels"),
        inp("position", "positions that it is shown", "m", size="channels"),
        out("spring", "forces that follow the positions, 1 N/m", "N", size="channels"),
        out("way", "positions that follow the forces, 0.5 m/N, from 1 m on", "m", size="channels"),
    )
)
"""Each force and position follows from one that is given."""
