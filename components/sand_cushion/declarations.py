"""Variables and hidden state of the sand cushion.

Equations, frame, signs and sources: README.md in this folder.
"""

import math
from collections import namedtuple

from ..common.component import Size
from ..common.plausible import Plausible
from ..common.ports import Indices, Layout, Sizes, State, choice, count, inp, out, param
from ..common.roles import Role
from ..common.stepping import internal_step, stable_step
from ..common.units import cm, deg, kgf, standard_gravity

MOST_THREADS = 64
"""Threads that can share the work of a step."""

SQUARE, HEXAGONAL, RANDOM, PREPARED = 1, 2, 3, 4
FREE, LOCKED = 1, 2
FLOOR, BEAM_SURFACE, BEAM_DISCS = 1, 2, 3
FIXED, ON_BEAM = 1, 2
FLAT, ROUND = 1, 2
HELD, LINEAR = 1, 2
LAST, MEAN = 1, 2
DISC, LAYER = 1, 2
AS_SETTLED, LEVELLED = 1, 2

SIZES = {
    "discs": Size(370, 1, 1_000_000, "number of sand discs"),
    "elements": Size(24, 1, 2_000, "number of beam discs that the sand may touch"),
}

CALIBRATED_STIFFNESS_FACTOR = 0.342
"""Factor on the stiffness for locked rotation (1): fitted to table 5 and to the static test (fig.
13) of the paper, not derived."""

_BALL_RADIUS = 4.95 * cm
_BEAM_RADIUS = 2.5 * cm
_TABLE_3 = "Sonoda et al. 1993, table 3"
_EQ_1 = "Sonoda et al. 1993, eq. (1)"

ROW = 8
"""Numbers per body in ``body``, a cache line: x, y (m), vx, vy, surface speed omega r (m/s), radius
(m), 1/mass (1/kg), sqrt(mass)/2 (kg^0.5). Rock and beam discs have their angle (rad) in the place
of 1/mass."""
SPIN, RADIUS, INVERSE_MASS, ANGLE, HALF_ROOT = 4, 5, 6, 6, 7
FORCE_ROW = 4
"""Numbers per body in ``load``: force to the right and upwards, torque / radius (N), nothing."""
PARTNERS = 12
"""Room for contact candidates, per disc on average."""
INDEX = 0x7FFFFFFF
"""Mask that leaves every index as it is. The compiler then knows that an index is not negative, and
drops what serves negative ones."""
BLOCK = 64
"""Pairs for which the law of contact is computed together."""
UNBOUNDED = 1e30
"""Height (m) of a wall without end."""
LANES = 8
"""Pairs that are in a vector."""
MOTION = 8
"""Numbers that add up over the discs of a step; see vector/rows.py."""
PART = 12_500
"""Least number of discs in a part: threads share the parts. The division depends on the number of
discs only, so that the results do not depend on the number of threads."""
PLANES = 3
"""Number of boundaries that are planes: left wall, right wall, base."""

Kind = namedtuple("Kind", "sand rock base wall rock_base rock_wall")
KIND = Kind(*range(6))
"""Kinds of contact; each has a row of :data:`LAW` numbers in ``law``."""
Law = namedtuple(
    "Law",
    "normal damping tangential tangential_damping friction rolling unloading yielding pull bridge"
    " compliance",
)
LAW = Law(*range(11))
"""Places of the constants of a kind of contact: k_n (N/m); 2 h sqrt(k_n), c_n being that times
sqrt(m) (N^0.5 m^-0.5); k_s (N/m); 2 h sqrt(k_s); mu; rolling resistance mu_r; unloading stiffness K
k_n (N/m); part 1 - 1/K of the overlap that stays; capillary force / distance of centres (N/m);
longest bridge / distance of centres; 1/k_s (m/N)."""

Boundary = namedtuple(
    "Boundary", "geometry sand_contact rock_contact carrier transmits beam_mass side"
)
"""A boundary of the sand: its geometry, the kinds of its contacts with sand and with the rock, who
carries the force on it, whether that force counts as transmitted (1 or 0), whether dashpots of sand
on it take the mass of a beam disc (1 or 0), and for walls their side (-1 left, 1 right)."""
BOUNDARY_ROW = len(Boundary._fields)
"""Numbers per boundary in ``boundary``."""

Column = namedtuple("Column", "x y vx vy spin reach root")
COLUMN = Column(*range(7))
"""Columns of the block of pairs: differences of positions (m) and velocities (m/s), sums of surface
speeds (m/s), radii (m) and half roots of mass (kg^0.5). The law leaves force to the right and
upwards, tangential and normal force (N) in the first four."""

Tally = namedtuple(
    "Tally",
    "elastic stretched normal_dashpot tangential_dashpot sliding released plastic capillary",
)
TALLY = Tally(*range(8))
"""Energies that add up over the pairs of a step, a number for each lane of the vectors: those of
normal and tangential springs, of the dashpots, of sliding, of springs of contacts that opened, of
yielding and of capillary bridges. Most are still to be scaled."""

Roll = namedtuple("Roll", "elastic lost")
ROLL = Roll(*range(2))
"""Energies (J) of rolling resistance that add up over the pairs of a step."""

Sum = namedtuple(
    "Sum",
    "elastic normal_dashpot tangential_dashpot sliding rolling plastic capillary rock beam "
    "transmitted "
    "travelled beam_key unready touched",
)
SUM = Sum(*range(14))
"""Places of the sums that go on from step to step in ``sums``: energies and works (J),
transmitted force (N), way of the fastest disc since the list was made (m), key of the beam's
place, the status of the start, which is not OK until rock and beam are where they may be, and
whether the rock has touched anything (1 or 0)."""


def _bodies(sizes: Sizes) -> int:
    """Return the number of bodies: discs, rock, beam discs, and for each part one far away.

    That one is the partner in pairs that fill up a block. The number is even.
    """
    return (sizes["discs"] + 1 + sizes["elements"] + _parts(sizes) + 1) // 2 * 2


def _parts(sizes: Sizes) -> int:
    """Return the room for parts; small cushions are one part and leave the other one empty."""
    return max(2, sizes["discs"] // PART)


def _pairs(sizes: Sizes) -> int:
    return PARTNERS * sizes["discs"] + (_parts(sizes) + 2) * BLOCK


def _edges(sizes: Sizes) -> int:
    return 4 * sizes["discs"] + 2 * (sizes["elements"] + PLANES) + 8


def _cells(sizes: Sizes) -> int:
    return 4 * sizes["discs"] + 64


def _discs(sizes: Sizes) -> int:
    return sizes["discs"]


def _planes(sizes: Sizes) -> int:
    """Return the number of the last boundary."""
    return sizes["discs"] + sizes["elements"] + PLANES


_ROWS = (Indices(lambda sizes: _pairs(sizes) // BLOCK * BLOCK, ascending=True),)
_EDGE_ROWS = (Indices(_edges, ascending=True),)
_PARTNERS = (Indices(_planes, _discs),)
_PAIRS = (
    Indices(lambda sizes: ROW * (sizes["discs"] - 1), multiple=ROW, bits=(0, 32)),
    Indices(lambda sizes: ROW * (_bodies(sizes) - 1), multiple=ROW, bits=(32, 32)),
)
_KINDS = tuple(
    Indices(lambda sizes: len(KIND) - 1, first=first, every=BOUNDARY_ROW) for first in (1, 2)
)
"""Indices that hidden arrays hold; the last are kinds of contact in the table of boundaries."""


def _beam_x(number: int, sizes: Sizes) -> float:
    return (2 * number + 1) * _BEAM_RADIUS


LAYOUT = Layout(
    variables=(
        # the cushion
        param(
            "box.left",
            "x of the left side wall's inner face",
            41.5 * cm,
            "m",
            role=Role.BOX_LEFT,
        ),
        param(
            "box.width",
            "distance of the side walls",
            37 * cm,
            "m",
            minimum=1e-6,
            source="Sonoda et al. 1993, fig. 2",
            plausible=Plausible(1e-2, 200.0, ("cm", "mm")),
            role=Role.BOX_WIDTH,
        ),
        param(
            "box.wall_height",
            "height of the side walls for the rock, above base.y, or above the beam's top where "
            "they stand on "
            "it; for sand they have no end",
            UNBOUNDED,
            "m",
            minimum=0.0,
        ),
        param(
            "box.wall_thickness", "thickness of the side walls for the rock", 0.2, "m", minimum=1e-6
        ),
        param(
            "base.y",
            "y of the floor, used when base = floor; side walls fixed in space count their height"
            " from it",
            0.0,
            "m",
        ),
        param(
            "disc.radius",
            "radius of a sand disc (mean radius of a random packing)",
            0.5 * cm,
            "m",
            minimum=1e-9,
            source="Sonoda et al. 1993, sec. 3 (2): diameter 1.0 cm",
            role=Role.GRAIN_RADIUS,
            plausible=Plausible(1e-4, 1.0, ("cm", "mm")),
        ),
        param(
            "disc.spread",
            "random packing: radii are uniform within radius * (1 - spread, 1 + spread)",
            0.0,
            minimum=0.0,
            maximum=0.5,
        ),
        param(
            "thickness",
            "effective thickness dL of the cushion, out of the plane",
            10 * cm,
            "m",
            minimum=1e-6,
            source="Sonoda et al. 1993, sec. 3 (2)",
            formerly=("depth",),
            plausible=Plausible(1e-3, 50.0, ("cm", "mm")),
            role=Role.EFFECTIVE_WIDTH,
        ),
        param(
            "density",
            "density of a disc, or of the layer with its voids (density_of)",
            0.0018 * kgf / cm**3 / kgf,
            "kg/m3",
            minimum=1e-6,
            source=_TABLE_3,
            formerly=("unit_weight",),
            plausible=Plausible(500.0, 5000.0, ("kN/m3", "t/m3")),
        ),
        choice(
            "density_of",
            "body that density belongs to: a disc; or the layer, whose discs are heavier by 1 / "
            "solid_fraction",
            ("disc", "layer"),
            "disc",
            formerly=("unit_weight_of",),
        ),
        param(
            "solid_fraction",
            "part of the layer that discs fill: what packing = prepared is brought to; also used "
            "by cohesion "
            "and density_of = layer. The default is that of a square lattice",
            math.pi / 4.0,
            minimum=0.5,
            maximum=0.9,
        ),
        param(
            "gravity",
            "acceleration of gravity, downwards",
            standard_gravity,
            "m/s2",
            minimum=0.0,
            role=Role.GRAVITY,
        ),
        choice(
            "packing",
            "arrangement of the discs at the start; random: as they settle, prepared: settled "
            "until they have "
            "solid_fraction",
            ("square", "hexagonal", "random", "prepared"),
            "square",
        ),
        choice(
            "surface",
            "surface of a prepared layer: as it settled; or levelled, discs that stand out being "
            "put into hollows",
            ("as_settled", "levelled"),
            "as_settled",
        ),
        param(
            "lattice_shift",
            "square and hexagonal packing: each disc is moved at random by up to this part of its"
            " diameter",
            0.0,
            minimum=0.0,
            maximum=0.5,
        ),
        count(
            "seed",
            "random packing and lattice shift: number of the sample",
            1,
            minimum=0,
            maximum=2**31 - 1,
        ),
        param(
            "settling.time",
            "longest time of settling under gravity before the start; ends earlier when discs rest",
            2.0,
            "s",
            minimum=0.0,
        ),
        # the contact law
        param(
            "modulus",
            "fictitious modulus E_bar of the sand",
            30.4 * kgf / cm**2,
            "Pa",
            minimum=1e-6,
            source="Sonoda et al. 1993, table 4, test 4",
            plausible=Plausible(1e5, 1e9, ("kgf/cm2", "MPa", "kPa")),
        ),
        choice(
            "rotation",
            "locked: a disc's rotation is left out (calibrated model); free: three freedoms a "
            "disc (literal model)",
            ("free", "locked"),
            "locked",
        ),
        param(
            "stiffness_factor",
            "factor on all contact stiffnesses of the sand; a calibration for locked rotation, 1 "
            "is eq. (1) "
            "to the letter",
            CALIBRATED_STIFFNESS_FACTOR,
            minimum=1e-9,
        ),
        param(
            "damping",
            "damping constant h of normal and tangential dashpots",
            0.2,
            minimum=0.0,
            source=_TABLE_3,
        ),
        param("tangential_ratio", "s = k_s / k_n", 0.25, minimum=1e-9, source=_TABLE_3),
        param(
            "friction_angle",
            "angle of friction phi; mu = tan(phi)",
            30 * deg,
            "rad",
            minimum=0.0,
            maximum=1.5,
            source=_TABLE_3,
            plausible=Plausible(0.05, 1.3, ("deg",)),
        ),
        param(
            "rolling_resistance",
            "rolling friction: largest rolling moment / (normal force * radius); with free "
            "rotation",
            0.0,
            minimum=0.0,
        ),
        param(
            "unloading_ratio",
            "unloading stiffness / loading stiffness of the contacts of sand (Walton and Braun); "
            "1 is elastic",
            1.0,
            minimum=1.0,
            maximum=1e3,
        ),
        param(
            "cohesion",
            "cohesion of the moist sand, by capillary forces between its discs (Rumpf); 0 is dry",
            0.0,
            "Pa",
            minimum=0.0,
            plausible=Plausible(1.0, 5e5, ("kPa", "kgf/cm2")),
        ),
        param(
            "cohesion_range",
            "length at which a capillary bridge breaks / distance of the centres",
            0.05,
            minimum=1e-3,
            maximum=0.25,
        ),
        param(
            "rock.stiffness_ratio",
            "k_n rock-sand / its value after eq. (1)",
            1.0,
            minimum=1e-9,
            source=_EQ_1,
        ),
        param(
            "base.stiffness_ratio",
            "k_n base-sand / its value after eq. (1)",
            1.0,
            minimum=1e-9,
            source=_EQ_1,
        ),
        param(
            "wall.stiffness_ratio",
            "k_n wall-sand / its value after eq. (1)",
            1.0,
            minimum=1e-9,
            source=_EQ_1,
        ),
        param(
            "rock_base.stiffness_ratio",
            "k_n rock-base and rock-wall / k_n sand-sand; the paper gives none",
            10.0,
            minimum=1e-9,
        ),
        param(
            "wall.friction_angle",
            "angle of friction at the side walls",
            30 * deg,
            "rad",
            minimum=0.0,
            maximum=1.5,
        ),
        # what the cushion rests on and between
        choice(
            "base",
            "what carries the sand: a rigid floor, the beam's top as a surface, or the beam's "
            "discs as discs",
            ("floor", "beam_surface", "beam_discs"),
            "beam_surface",
        ),
        choice(
            "base.shape",
            "how eq. (1) is read for the base. flat: k_n = E_bar dL, as on a plate, the beam's top"
            " being flat and "
            "its discs those of the computation; round: with the radius of the beam discs (base ="
            " beam_discs)",
            ("flat", "round"),
            "flat",
        ),
        choice(
            "walls",
            "side walls fixed in space, or standing on the beam",
            ("fixed", "on_beam"),
            "fixed",
        ),
        param("rock.radius", "radius of the rock", _BALL_RADIUS, "m", minimum=1e-6),
        param(
            "rock.mass",
            "mass of the rock, for the dashpots of its contact with base and walls",
            4.0,
            "kg",
            minimum=1e-6,
        ),
        param("beam.radius", "radius of a beam disc", _BEAM_RADIUS, "m", minimum=1e-6),
        param(
            "beam.disc_mass",
            "mass of a beam disc, for the dashpots of its contacts with sand; 0 takes the sand "
            "disc's there",
            0.0,
            "kg",
            minimum=0.0,
        ),
        # integration and exchange
        internal_step(1e-5),
        count(
            "threads",
            "threads that share the work of a step; their number changes no bit. Of use from some"
            " 50,000 discs on",
            1,
            minimum=1,
            maximum=MOST_THREADS,
        ),
        choice(
            "kinematics",
            "motion of rock and beam within a communication step: as given (held), or going on "
            "with the velocity "
            "given (linear)",
            ("held", "linear"),
            "held",
        ),
        choice(
            "forces",
            "forces returned: those of the last internal step, or the mean over the communication "
            "step, which keeps "
            "the impulse",
            ("last", "mean"),
            "last",
        ),
        # inputs
        inp("rock.position.x", "position of the rock's centre, to the right", "m", 0.6),
        inp("rock.position.y", "position of the rock's centre, upwards", "m", 1.0),
        inp("rock.angle", "angle of the rock, counter-clockwise", "rad"),
        inp("rock.velocity.x", "velocity of the rock, to the right", "m/s"),
        inp("rock.velocity.y", "velocity of the rock, upwards", "m/s"),
        inp("rock.angular_velocity", "angular velocity of the rock, counter-clockwise", "rad/s"),
        inp(
            "beam.position.x",
            "position of a beam disc's centre, to the right",
            "m",
            _beam_x,
            size="elements",
        ),
        inp(
            "beam.position.y",
            "position of a beam disc's centre, upwards",
            "m",
            -_BEAM_RADIUS,
            size="elements",
        ),
        inp("beam.angle", "angle of a beam disc, counter-clockwise", "rad", size="elements"),
        inp("beam.velocity.x", "velocity of a beam disc, to the right", "m/s", size="elements"),
        inp("beam.velocity.y", "velocity of a beam disc, upwards", "m/s", size="elements"),
        inp(
            "beam.angular_velocity",
            "angular velocity of a beam disc, counter-clockwise",
            "rad/s",
            size="elements",
        ),
        # outputs
        out("rock.force.x", "contact force on the rock, to the right", "N"),
        out("rock.force.y", "contact force on the rock, upwards", "N", role=Role.ON_BODY),
        out(
            "rock.torque",
            "torque of the contact forces on the rock about its centre, counter-clockwise",
            "N.m",
        ),
        out("beam.force.x", "contact force on a beam disc, to the right", "N", size="elements"),
        out(
            "beam.force.y",
            "contact force on a beam disc, upwards",
            "N",
            size="elements",
            role=Role.ON_STRUCTURE,
        ),
        out(
            "beam.torque",
            "torque of the contact forces on a beam disc about its centre",
            "N.m",
            size="elements",
        ),
        out(
            "transmitted_force",
            "force of sand and rock on base (and on walls that stand on the beam), positive "
            "downwards",
            "N",
            source="Sonoda et al. 1993, eq. (4)",
            role=Role.TRANSMITTED,
        ),
        out(
            "penetration",
            "depth of the rock's lowest point under surface_level; 0 until the rock first touches, "
            "and above it",
            "m",
            role=Role.PENETRATION,
        ),
        out(
            "clearance",
            "distance of the rock's surface from the base, or from its continuation where the rock "
            "is beside it, in the last internal step; negative where it presses into it",
            "m",
            role=Role.CLEARANCE,
        ),
        out(
            "rock.above_surface",
            "height of the rock's lowest point above surface_level; negative below it",
            "m",
            role=Role.ABOVE_SURFACE,
        ),
        out(
            "surface_level",
            "mean height of the sand's surface between the walls at the start: of the highest disc "
            "in each column as wide as the largest",
            "m",
        ),
        out(
            "surface_height",
            "height of the sand's surface at the start, under the rock",
            "m",
            role=Role.SURFACE,
        ),
        out(
            "layer.solid_fraction",
            "part of the layer that discs fill at the start; its height is twice that of their "
            "centre of "
            "gravity",
            "1",
        ),
        out(
            "layer.height",
            "height of the layer at the start: twice that of its centre of gravity above the base",
            "m",
        ),
        out(
            "unbalanced_force_ratio",
            "largest unbalanced force on a disc at the start / its weight, or largest speed in "
            "sqrt(g r) if that is more; settling ends at 1e-6, or when settling.time is over",
            role=Role.UNBALANCED,
            formerly=("unrest",),
        ),
        stable_step(),
        out(
            "energy.kinetic",
            "kinetic energy of the discs",
            "J",
            role=Role.KINETIC,
            label="sand, kinetic",
        ),
        out(
            "energy.elastic",
            "elastic energy of all contacts, normal, tangential and rolling",
            "J",
            role=Role.ELASTIC,
            label="sand, elastic and capillary",
        ),
        out(
            "energy.gravity",
            "potential energy of the discs in gravity, zero at y = 0",
            "J",
            role=Role.GRAVITY_ENERGY,
            label="gravity, above its least",
        ),
        out(
            "energy.normal_dashpot",
            "energy dissipated in normal dashpots",
            "J",
            role=Role.DISSIPATED,
            label="lost in normal dashpots",
        ),
        out(
            "energy.tangential_dashpot",
            "energy dissipated in tangential dashpots",
            "J",
            role=Role.DISSIPATED,
            label="lost in tangential dashpots",
        ),
        out(
            "energy.sliding",
            "energy dissipated in sliding contacts",
            "J",
            role=Role.DISSIPATED,
            label="lost in sliding",
        ),
        out(
            "energy.rolling",
            "energy dissipated by rolling resistance",
            "J",
            role=Role.DISSIPATED,
            label="lost in rolling",
        ),
        out(
            "energy.plastic",
            "energy lost in contacts that do not spring back, less what their capillary bridges "
            "gained",
            "J",
            role=Role.DISSIPATED,
            label="lost in yielding contacts",
        ),
        out(
            "energy.capillary",
            "potential energy of the capillary bridges, zero where there is none",
            "J",
            role=Role.ELASTIC,
            label="sand, elastic and capillary",
        ),
        out(
            "energy.work.rock",
            "work that the rock has done on the sand",
            "J",
            role=Role.WORK_INSIDE,
        ),
        out(
            "energy.work.beam",
            "work that the beam has done on the sand (and on the walls standing on it)",
            "J",
            role=Role.WORK_INSIDE,
        ),
        out(
            "energy.residual",
            "kinetic + elastic + capillary + gravity + dissipated - work, minus the sum at the "
            "start",
            "J",
            role=Role.RESIDUAL,
        ),
        out("energy.start", "kinetic + elastic + capillary + gravity at the start", "J"),
    ),
    states=(
        # to spring: places in the buffer that are multiples of a cache line
        State("body", lambda n: ROW * _bodies(n)),
        State("load", lambda n: FORCE_ROW * _bodies(n)),
        State("block", lambda n: BLOCK * len(COLUMN) * _parts(n)),
        State("tally", lambda n: LANES * len(TALLY) * _parts(n)),
        State("motion", lambda n: MOTION * _parts(n)),
        State("spring", _pairs),
        State("angle", lambda n: n["discs"]),
        State("rolling", lambda n: len(ROLL) * _parts(n)),
        State("spring_before", _pairs),
        State("roll", _pairs),
        State("roll_before", _pairs),
        State("plastic", _pairs),
        State("plastic_before", _pairs),
        State("edge_plastic", _edges),
        State("edge_plastic_before", _edges),
        State("edge_roll", _edges),
        State("edge_roll_before", _edges),
        State("edge_spring", _edges),
        State("edge_spring_before", _edges),
        State("law", lambda n: len(KIND) * len(LAW)),
        State("sums", lambda n: len(SUM)),
        State("boundary_reference", lambda n: 2 * (n["elements"] + 1)),
        State(
            "boundary",
            lambda n: BOUNDARY_ROW * (n["elements"] + 1 + PLANES),
            integer=True,
            indices=_KINDS,
        ),
        State(
            "part",
            lambda n: _parts(n) + 1,
            integer=True,
            indices=(Indices(_discs, ascending=True),),
        ),
        State("row", lambda n: n["discs"] + 1, integer=True, indices=_ROWS),
        State("row_before", lambda n: n["discs"] + 1, integer=True, indices=_ROWS),
        State("across", lambda n: n["discs"] + 1, integer=True, indices=_ROWS),
        State("across_before", lambda n: n["discs"] + 1, integer=True, indices=_ROWS),
        State("pair", _pairs, integer=True, indices=_PAIRS),
        State("pair_before", _pairs, integer=True, indices=_PAIRS),
        State("edge_row", lambda n: n["discs"] + 2, integer=True, indices=_EDGE_ROWS),
        State("edge_row_before", lambda n: n["discs"] + 2, integer=True, indices=_EDGE_ROWS),
        State("edge_body", _edges, integer=True, indices=(Indices(_discs),)),
        State("edge_partner", _edges, integer=True, indices=_PARTNERS),
        State("edge_partner_before", _edges, integer=True, indices=_PARTNERS),
        State("cell_start", lambda n: _cells(n) + 1, integer=True, indices=(Indices(_discs),)),
        State("cell_disc", lambda n: n["discs"], integer=True, indices=(Indices(_discs),)),
        State("disc_cell", lambda n: n["discs"], integer=True, indices=(Indices(_cells),)),
    ),
)
