"""The beam: a chain of rigid discs with axial and bending springs.

It is a rigid bodies spring model (RBSM).
"""

from pathlib import Path

from ..common.component import Component
from ..common.ports import Bond
from ..common.shown import Curve, Envelope, Panel, Picture
from .declarations import LAYOUT, SIZES
from .faults import FAULTS

COMPONENT = Component(
    name="RBSMBeam",
    title="Beam: chain of rigid discs with axial and bending springs (RBSM)",
    layout=LAYOUT,
    kernels=f"{__name__}.kernel",
    folder=Path(__file__).parent,
    sizes=SIZES,
    faults=FAULTS,
    default_step=1e-5,
    bonds=(
        Bond("beam", "motion of the discs, force on them", idle="no force acts on the beam"),
        Bond(
            "support",
            "motion of the supports, mean force on them",
            "support.",
            named={"force.y": "support.mean_force.y"},
        ),
    ),
    pictures=(
        Picture(
            "beam",
            (
                Panel("deflection", "mm", (Curve("midspan.deflection"),), downwards=True),
                Panel(
                    "energy of the beam",
                    "J",
                    (
                        Curve("energy.elastic", "elastic, all: the paper's eqs (5), (6)"),
                        Curve("energy.bending", "of it in bending", dashed=True),
                        Curve("energy.axial", "of it axial"),
                        Curve("energy.strain_estimate", "from the midspan strain: its eq. (7)"),
                        Curve("energy.plastic", "dissipated by yielding"),
                    ),
                    second_unit="kgf cm",
                    references="peak_beam_energy_from_the_midspan_strain",
                ),
            ),
        ),
        Picture(
            "moment",
            (
                Envelope("bending moment", "kN m", "moment", "position.x", "support.moment"),
                Panel("moment at midspan", "kN m", (Curve("midspan.moment"),)),
            ),
        ),
        Picture(
            "shear",
            (
                Envelope(
                    "shear force", "kN", "shear", "position.x", "support.shear", at_edges=True
                ),
                Panel(
                    "support reaction",
                    "kN",
                    (
                        Curve("support.force.y[1]", "left", factor=-1.0),
                        Curve("support.force.y[2]", "right", factor=-1.0),
                    ),
                ),
            ),
        ),
    ),
)
