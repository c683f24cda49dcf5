"""Variables of the rock on its slope.

Equations, frame, signs and sources are in README.md of this folder.
"""

from collections import namedtuple

from ..common.component import Size
from ..common.ports import (
    Indices,
    Kind,
    Layout,
    Sizes,
    State,
    choice,
    count,
    inp,
    out,
    param,
    switch,
)
from ..common.roles import Role
from ..common.stepping import internal_step, stable_step
from ..common.units import kN, standard_gravity

SPHERE, DISC, GIVEN, ELLIPSE = 1, 2, 3, 4
PRINTED, NONE, CONSISTENT = 1, 2, 3
RELATIVE, ABSOLUTE = 1, 2
NORMAL, UNIFORM, LOGNORMAL, TRIANGULAR = 1, 2, 3, 4
FLIGHT, ROLLING, SLIDING, SPINNING, REST, RECEIVED = range(1, 7)
IMPACT, NODE, TAKE_OFF, GRIP, HALT, ENTER, LEAVE = range(1, 8)
"""Events that end a stretch of motion: impact on a cell, passing to the next cell, limit speed, end
of slip, end of motion or spin, entering and leaving the receiver."""

SIZES = {"cells": Size(15, 1, 5000, "straight cells of the slope")}

NEVER = 1e30
"""Time (s) of an event that does not come, and coordinate (m) that no rock reaches."""
STEEPEST_JOINT = 0.5235987755982988
"""Largest turn (rad, 30 degrees) at a joint of the path of the rock's centre round an outer corner;
see geometry.py."""
JOINTS = 15
"""Lines of the path per cell, at most: its facet and seven tangents at either end, as a corner
turns by less than 180 degrees."""

Path = namedtuple("Path", "left right x y sin cos angle ahead_right ahead_left cell")
PATH = Path(*range(10))
"""Columns of a line of the path: bounds in x (m), a point on it (m), sine, cosine and angle (rad)
of its inclination, angle of the next facet of the slope in either direction (its own if it belongs
to a facet), number of the cell it takes its material from."""

Ground = namedtuple(
    "Ground",
    "strength stiffness hardening friction resistance tilt tilt_deviation roughness "
    "roughness_deviation undulation by_coefficients normal_restitution tangential_restitution "
    "scaling_speed",
)
GROUND = Ground(*range(14))
"""Columns of a cell's material: q_d, k, epsilon, mu, c_o, mean and deviation of K_s, mean and
deviation of R_o; height S of the undulation (m); 1 for impacts by coefficients, R_n, R_t and the
speed of their scaling (m/s)."""

Body = namedtuple(
    "Body",
    "time x y angle vx vy omega ax ay alpha mode line next_time next_event next_line direction "
    "roughness sin cos normal_force shear_force drag limit_speed draws stalled impacts impact "
    "friction roughness_loss resistance work handovers handover_time seed trial",
)
BODY = Body(*range(35))
"""The rock at its last event: time (s), state of motion, constant accelerations until the next
event, mode, line of the path; the next event; direction of motion, R_o, sine and cosine of phi, and
the forces P, S, C (N) of the line motion; limit speed V_lim; number of random numbers drawn, of
events in a row without progress, and of impacts; dissipated energies and work of the inputs (J);
number of hand-overs and time of the last; which trial it is."""

Clock = namedtuple("Clock", "origin begun")
CLOCK = Clock(*range(2))
"""The tool's time at the start of the trial, and the time of the trial at which the FMU has begun
(s); see lead_time."""

EXAMPLE = (
    (0, 100),
    (6, 96),
    (12, 84),
    (20, 76),
    (26, 64),
    (34, 58),
    (40, 50),
    (47, 45),
    (54, 36),
    (62, 31),
    (70, 24),
    (78, 19),
    (88, 13),
    (98, 9),
    (110, 5),
    (140, 4),
)
"""An example slope of 100 m height (m); its upper 60 % are rock, the rest is soil."""
_RADIUS, _DENSITY = 0.5, 2600.0
_MASS = 4.0 / 3.0 * 3.141592653589793 * _RADIUS**3 * _DENSITY
_TABLE_1 = "Ushiro, table 1"


def _node(number: int, sizes: Sizes, axis: int) -> float:
    """Return a coordinate (m) of a node of the example slope, divided into the present cells."""
    place = number * (len(EXAMPLE) - 1) / sizes["cells"]
    first = min(int(place), len(EXAMPLE) - 2)
    low, high = EXAMPLE[first][axis], EXAMPLE[first + 1][axis]
    return low + (place - first) * (high - low)


def _last_cell(sizes: Sizes) -> int:
    return sizes["cells"] - 1


def _last_line(sizes: Sizes) -> int:
    return JOINTS * sizes["cells"] - 1


def _end_x(number: int, sizes: Sizes) -> float:
    return _node(number + 1, sizes, 0)


def _end_y(number: int, sizes: Sizes) -> float:
    return _node(number + 1, sizes, 1)


def _material(name: str, description: str, rock: float, soil: float, unit: str = "1", **rest):
    def start(number: int, sizes: Sizes) -> float:
        return rock if number < 0.6 * sizes["cells"] else soil

    return param(
        name,
        description,
        start,
        unit,
        minimum=rest.pop("minimum", 0.0),
        size="cells",
        source=_TABLE_1,
        **rest,
    )


def _undulation_or_coefficient(name: str, description: str, unit: str = "1", **rest):
    """Return a parameter of every cell that is zero, with which nothing happens."""
    return param(name, description, 0.0, unit, minimum=0.0, size="cells", **rest)


_DISTRIBUTIONS = ("truncated_normal", "uniform", "lognormal", "triangular")
_MODES = ("flight", "rolling", "sliding", "spinning", "rest", "received")
_START = ("position0.x", "position0.y")

LAYOUT = Layout(
    variables=(
        # the rock
        param(
            "mass",
            "mass of the rock; the default has 2600 kg/m3",
            _MASS,
            "kg",
            minimum=1e-6,
            role=Role.BODY_MASS,
        ),
        param(
            "radius",
            "radius of the rock",
            _RADIUS,
            "m",
            minimum=1e-6,
            source=_TABLE_1,
            role=Role.BODY_RADIUS,
        ),
        choice(
            "shape",
            "what the moment of inertia follows from: sphere 2/5 m r2, disc 1/2 m r2, the "
            "parameter moment_of_inertia, or an ellipse of semi-axes a and b, 1/5 m (a2 + b2)",
            ("sphere", "disc", "given", "ellipse"),
            "sphere",
        ),
        param(
            "elongation",
            "a / b of an ellipse whose semi-axes are a = r sqrt(a/b) and b = r / sqrt(a/b); used "
            "when shape is ellipse",
            1.0,
            minimum=1.0,
            maximum=10.0,
        ),
        param(
            "moment_of_inertia",
            "moment of inertia about the centre; used when shape is given",
            0.4 * _MASS * _RADIUS**2,
            "kg.m2",
            minimum=1e-15,
        ),
        param(
            "gravity",
            "acceleration of gravity, downwards",
            standard_gravity,
            "m/s2",
            minimum=1e-3,
            role=Role.GRAVITY,
        ),
        param(
            "position0.x",
            "position of the centre at the start, to the right",
            1.0,
            "m",
            source=_TABLE_1,
        ),
        param(
            "position0.y",
            "position of the centre at the start, upwards",
            102.0,
            "m",
            source=_TABLE_1,
        ),
        switch(
            "on_slope",
            "start in contact with the slope at position0.x; position0.y is not used",
            False,
        ),
        param("angle0", "angle at the start, counter-clockwise", 0.0, "rad"),
        param("velocity0.x", "velocity at the start, to the right", 1.5, "m/s", source=_TABLE_1),
        param("velocity0.y", "velocity at the start, upwards", 0.0, "m/s", source=_TABLE_1),
        param(
            "angular_velocity0",
            "angular velocity at the start, counter-clockwise",
            0.0,
            "rad/s",
            source=_TABLE_1,
        ),
        # chance
        count(
            "seed",
            "number of the sample: trials of one seed belong together",
            1,
            minimum=0,
            maximum=2**31 - 1,
        ),
        count("trial", "number of the trial in the sample", 0, minimum=0, maximum=2**31 - 1),
        count(
            "hypercube",
            "Latin hypercube: so many trials in a row share out the range of each of their random "
            "numbers; 0: independent trials",
            0,
            minimum=0,
            maximum=2**31 - 1,
        ),
        param(
            "limit_speed.mean",
            "V_lim: speed at which a rock in line motion takes off, mean",
            12.0,
            "m/s",
            minimum=0.0,
            source=_TABLE_1,
        ),
        param(
            "limit_speed.deviation",
            "V_lim, standard deviation",
            2.0,
            "m/s",
            minimum=0.0,
            source=_TABLE_1,
        ),
        param(
            "truncation",
            "normal variates are drawn within this many standard deviations of the mean",
            1.96,
            minimum=1e-3,
            maximum=5.0,
            source="Ushiro, eq. (32)",
        ),
        choice(
            "limit_speed.distribution",
            "distribution of V_lim with this mean and deviation",
            _DISTRIBUTIONS,
            "truncated_normal",
            source="Ushiro, eq. (32)",
        ),
        choice(
            "roughness.distribution",
            "distribution of R_o",
            _DISTRIBUTIONS,
            "truncated_normal",
            source="Ushiro, eq. (32)",
        ),
        choice(
            "tilt.distribution",
            "distribution of K_s",
            _DISTRIBUTIONS,
            "truncated_normal",
            source="Ushiro, eq. (32)",
        ),
        # model options
        choice(
            "restitution.gravity",
            "gravity while the rock penetrates: printed takes its work out of the rebound only, "
            "eq. (27); none leaves it out; consistent counts it on the way in and out",
            ("printed", "none", "consistent"),
            "consistent",
        ),
        switch(
            "tilt_cap",
            "limit the angle phi of an impact so that the penetrated ground cannot throw the rock "
            "back; off as printed, and energy may then be gained",
            True,
        ),
        choice(
            "tilt.meaning",
            "K_s: relative = change of the slope angle / slope angle, as printed; absolute = that "
            "change itself in rad",
            ("relative", "absolute"),
            "relative",
        ),
        param(
            "area_factor",
            "loaded area / (pi r2): 1/4 as printed in eq. (25); 1 is the section of the rock",
            0.25,
            minimum=1e-6,
        ),
        # the receiver
        switch(
            "receiver.present",
            "hand the rock over when its centre enters the receiver, a box without slope in it",
            False,
        ),
        param("receiver.left", "left side of the receiver", 0.0, "m"),
        param("receiver.right", "right side of the receiver", 0.0, "m"),
        param("receiver.bottom", "lower side of the receiver", 0.0, "m"),
        param("receiver.top", "upper side of the receiver", 0.0, "m"),
        param(
            "frame.x",
            "x, in the frame of the profile, of the origin from which position.x is put out: where "
            "other components have theirs",
            0.0,
            "m",
        ),
        param("frame.y", "the same for position.y, upwards", 0.0, "m"),
        param(
            "lead_time",
            "begin so long before the rock enters the receiver for the first time, or at the "
            "start of the trial if that is later; 1e30: at the start of the trial",
            NEVER,
            "s",
            minimum=0.0,
        ),
        internal_step(1e-5),
        # the slope
        param(
            "profile.x", "x of the slope's first node", float(EXAMPLE[0][0]), "m", source=_TABLE_1
        ),
        param(
            "profile.y", "y of the slope's first node", float(EXAMPLE[0][1]), "m", source=_TABLE_1
        ),
        param("end.x", "x of the cell's right node", _end_x, "m", size="cells", source=_TABLE_1),
        param("end.y", "y of the cell's right node", _end_y, "m", size="cells", source=_TABLE_1),
        _material(
            "strength",
            "q_d: ultimate bearing pressure of the ground",
            3000 * kN,
            800 * kN,
            "Pa",
            minimum=1e-3,
        ),
        _material(
            "stiffness",
            "k: coefficient of ground reaction",
            30000 * kN,
            8000 * kN,
            "N/m3",
            minimum=1e-3,
        ),
        _material(
            "hardening",
            "epsilon: stiffening of the ground when it is unloaded",
            0.6,
            0.4,
            maximum=1.0,
        ),
        _material("friction", "mu: coefficient of dynamic friction", 0.6, 0.5),
        _material(
            "resistance",
            "c_o: resistance of the surface (vegetation) to line motion, per section of the rock",
            0.0,
            0.3 * kN,
            "Pa",
        ),
        _material(
            "tilt", "K_s: change of the slope angle at an impact, mean", 0.0, 0.0, minimum=None
        ),
        _material("tilt_deviation", "K_s, standard deviation", 0.10, 0.10),
        _material(
            "roughness",
            "R_o: height of the roughness / radius of the rock, mean",
            0.10,
            0.15,
            maximum=2.0,
        ),
        _material("roughness_deviation", "R_o, standard deviation", 0.03, 0.04),
        _undulation_or_coefficient(
            "undulation",
            "S: height of the surface's undulation over the radius of the rock, which turns the "
            "surface by up to arctan(S / r) at an impact, on flat cells too",
            "m",
        ),
        _undulation_or_coefficient(
            "by_coefficients",
            "1: impacts have the coefficients of restitution below; 0: they follow DRSP",
            maximum=1.0,
        ),
        _undulation_or_coefficient(
            "normal_restitution", "R_n: coefficient of normal restitution", maximum=1.0
        ),
        _undulation_or_coefficient(
            "tangential_restitution", "R_t: coefficient of tangential restitution", maximum=1.0
        ),
        _undulation_or_coefficient(
            "scaling_speed",
            "K: R_n is divided by 1 + (normal speed / K)2, 9.144 m/s in CRSP; 0: it is not",
            "m/s",
        ),
        # inputs
        inp("force.x", "force on the rock in the receiver without its weight, to the right", "N"),
        inp("force.y", "force on the rock in the receiver without its weight, upwards", "N"),
        inp(
            "torque",
            "torque on the rock in the receiver about its centre, counter-clockwise",
            "N.m",
        ),
        # outputs
        out(
            "position.x",
            "position of the centre, to the right from frame.x",
            "m",
            role=Role.STRIKING_PLACE,
        ),
        out("position.y", "position of the centre, upwards from frame.y", "m"),
        out("angle", "angle, counter-clockwise", "rad"),
        out("velocity.x", "velocity, to the right", "m/s"),
        out("velocity.y", "velocity, upwards", "m/s"),
        out("angular_velocity", "angular velocity, counter-clockwise", "rad/s"),
        out(
            "mode",
            "what the rock does; received: it is handed over",
            kind=Kind.ENUMERATION,
            choices=_MODES,
            minimum=1.0,
            maximum=float(len(_MODES)),
        ),
        out("cell", "number of the cell below the rock, from 1", kind=Kind.INTEGER),
        out("height", "distance of the rock from the cell below it, along the cell's normal", "m"),
        out(
            "next_event.time",
            "time at which the motion changes next if no force acts, rounded up to a picosecond; "
            "1e30 if never",
            "s",
        ),
        out("impacts", "number of impacts so far", kind=Kind.INTEGER),
        out(
            "received",
            "the rock is handed over: it is in the receiver",
            kind=Kind.BOOLEAN,
            role=Role.HANDED_OVER,
        ),
        out("handover.time", "time of the last hand-over; 1e30 before the first", "s"),
        out("handovers", "number of hand-overs so far", kind=Kind.INTEGER),
        stable_step(),
        out(
            "energy.kinetic",
            "kinetic energy, translation and rotation",
            "J",
            role=Role.STRIKING,
            label="rock, kinetic",
        ),
        out(
            "energy.gravity",
            "potential energy in gravity, zero at position.y = 0",
            "J",
            initial_dependencies=None,
            role=Role.GRAVITY_ENERGY,
            label="gravity, above its least",
        ),
        out(
            "energy.impact",
            "energy dissipated in impacts",
            "J",
            role=Role.LEFT_BEHIND,
            label="lost on the slope, in the run",
        ),
        out(
            "energy.friction",
            "energy dissipated by sliding friction in line motion",
            "J",
            role=Role.LEFT_BEHIND,
            label="lost on the slope, in the run",
        ),
        out(
            "energy.roughness",
            "energy dissipated by roughness in line motion",
            "J",
            role=Role.LEFT_BEHIND,
            label="lost on the slope, in the run",
        ),
        out(
            "energy.resistance",
            "energy dissipated by the resistance of the surface in line motion",
            "J",
            role=Role.LEFT_BEHIND,
            label="lost on the slope, in the run",
        ),
        out(
            "energy.work.contact",
            "work that the inputs force and torque have done on the rock",
            "J",
            role=Role.WORK_INSIDE,
        ),
        out(
            "energy.residual",
            "kinetic + gravity + dissipated - work, minus their sum at the start",
            "J",
            role=Role.RESIDUAL,
        ),
        out("energy.start", "kinetic + gravity at the start of the trial", "J"),
        out(
            "fault.cell",
            "number of the cell that the initialisation refuses, 0 if none",
            kind=Kind.INTEGER,
        ),
        out("fault.value", "what is wrong with that cell: end.x, tilt, roughness or friction"),
        out("fault.roughness", "largest roughness of that cell"),
        out("fault.locking", "mu tan(phi) of that cell with its largest roughness"),
    ),
    states=(
        State(
            "path",
            lambda sizes: JOINTS * sizes["cells"] * len(PATH),
            indices=(Indices(_last_cell, first=PATH.cell, every=len(PATH)),),
        ),
        State("ground", lambda sizes: sizes["cells"] * len(GROUND)),
        State(
            "body",
            lambda sizes: len(BODY),
            indices=(
                Indices(_last_line, first=BODY.line, every=len(BODY)),
                Indices(_last_line, first=BODY.next_line, every=len(BODY)),
                Indices(lambda sizes: 1, -1, first=BODY.direction, every=len(BODY)),
            ),
        ),
        State("clock", lambda sizes: len(CLOCK)),
        State("order.begin", lambda sizes: sizes["cells"] + 1),
        State("order", lambda sizes: sizes["cells"], integer=True, indices=(Indices(_last_cell),)),
        State(
            "lines",
            lambda sizes: 1,
            integer=True,
            indices=(Indices(lambda sizes: JOINTS * sizes["cells"], 1),),
        ),
        State("started", lambda sizes: 1, integer=True, indices=(Indices(lambda sizes: 1),)),
    ),
)
