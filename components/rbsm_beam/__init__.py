"""The beam: a chain of rigid discs with axial and bending springs (rigid bodies spring model, RBSM)."""

from pathlib import Path

from ..common.component import Component
from ..common.ports import Bond
from ..common.shown import Curve, Panel, Picture
from . import kernel
from .declarations import LAYOUT, SIZES

COMPONENT = Component(
    name="RBSMBeam",
    title="Beam: chain of rigid discs with axial and bending springs (RBSM)",
    layout=LAYOUT,
    initialise=kernel.initialise,
    evaluate=kernel.evaluate,
    step=kernel.step,
    folder=Path(__file__).parent,
    sizes=SIZES,
    faults={
        kernel.BOX_OFF_BEAM: "the box, from box.left = {box.left} m on, {box.width} m wide, does not stand within the span "
        "from axis.x = {axis.x} m on, {span} m long, and has mass or sand in it: give box.left and "
        "box.width, or box.mass = 0 and cushion.weight = 0",
        kernel.DIVERGED: "the beam diverged: a displacement exceeds half the span ({span} m) or is no longer a number (midspan"
        " deflection {midspan.deflection} m, transmitted force {transmitted_force} N); internal_step is "
        "{internal_step} s and the largest stable one {stable_step} s: reduce internal_step below that, or,"
        " if it is, the exchange step of the component that computes the forces",
    },
    default_step=1e-5,
    bonds=(
        Bond("beam", "motion of the discs, force on them"),
        Bond("support", "motion of the supports, force on them", "support."),
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
                    ),
                    second_unit="kgf cm",
                    references="peak_beam_energy_from_the_midspan_strain",
                ),
            ),
        ),
    ),
)
