"""The sand cushion: discs that touch, after the distinct element method of Sonoda et al. (1993)."""

from pathlib import Path

from ..common.component import Component
from ..common.ports import Bond
from . import kernel
from .declarations import LAYOUT, SIZES

COMPONENT = Component(
    name="SandCushion",
    title="Sand cushion: 2-D distinct elements",
    layout=LAYOUT,
    initialise=kernel.initialise,
    evaluate=kernel.evaluate,
    step=kernel.step,
    folder=Path(__file__).parent,
    sizes=SIZES,
    faults={
        kernel.LIST_FULL: "there is no more room for contact candidates (12 a disc): reduce disc.spread "
        "({disc.spread}) or the overlap of the discs",
        kernel.DIVERGED: "the energy of the discs is no longer a finite number: the internal step {internal_step} s stands against "
        "a stable step of {stable_step} s; reduce internal_step or the exchange step",
        kernel.ROCK_INSIDE: "the rock starts inside the sand: its lowest point lies {penetration} m under the surface at "
        "{surface_height} m; raise the rock's position0.y by at least that much",
        kernel.ROCK_BESIDE: "the rock starts in or behind a side wall: with its radius of {rock.radius} m at x = "
        "{rock.position.x} m it does not fit into the box from {box.left} m on, {box.width} m wide; "
        "move the rock or widen the box, or give the walls a box.wall_height over which it comes",
        kernel.DISC_TOO_WIDE: "a sand disc of radius {disc.radius} m (spread {disc.spread}) does not fit into the box, which is "
        "{box.width} m wide: make the discs smaller or the box wider",
        kernel.TOO_LOOSE: "the sand cannot lie as loosely as solid_fraction = {solid_fraction}: with its friction it falls to "
        "{layer.solid_fraction}; ask for that, raise friction_angle, rolling_resistance or cohesion, or take "
        "packing = random",
        kernel.TOO_DENSE: "the sand cannot be packed as densely as solid_fraction = {solid_fraction}: it reaches "
        "{layer.solid_fraction}; ask for less, or raise disc.spread",
        kernel.SMOOTH_BUT_COHESIVE: "cohesion = {cohesion} Pa needs friction: its capillary force has tan(phi) below the line, "
        "and friction_angle is 0; give it a value, or cohesion = 0",
        kernel.BEAM_TOO_NARROW: "the beam is narrower than the cushion, whose box begins at box.left = {box.left} m and is "
        "box.width = {box.width} m wide: make the beam longer, move the box or set base = floor",
        kernel.BEAM_GAPS: "there are gaps between the beam discs: beam.radius = {beam.radius} m is less than half the distance of "
        "their centres; set it to half that distance, or set base = beam_surface",
        kernel.BEAM_UNORDERED: "the beam discs must follow each other from left to right (beam.position.x[i] ascending)",
    },
    default_step=1e-5,
    bonds=(
        Bond("rock", "motion of the rock, force on it", "rock."),
        Bond("beam", "motion of the beam's discs, force on them", "beam."),
    ),
    contents="granular.discs",
)
