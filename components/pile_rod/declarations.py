"""Variables of the pile rod. Equations, frame and signs: README.md beside this file."""

from collections import namedtuple

from ..common.component import Size
from ..common.ports import Indices, Layout, Sizes, State, choice, inp, out, param
from ..common.roles import Role
from ..common.shown import Reported, Statistic
from ..common.stepping import internal_step, stable_step
from ..common.units import cm2, mm

CHARACTERISTICS, SMITH, MODIFIED_SMITH, REPAIRED = 1, 2, 3, 4
KINEMATICS, WAVES = 1, 2
DOWN, UP = 1, 2
PARALLEL, SEQUENTIAL = 1, 2
FREE, FIXED, MATCHED, REFLECTION, SOIL, PORT = 1, 2, 3, 4, 5, 6

SIZES = {
    "segments": Size(100, 1, 100_000, "segments of equal travel time"),
    "sections": Size(
        1, 1, 10_000, "sections with one length, area, modulus and density each, from head to toe"
    ),
    "ground_segments": Size(
        1, 1, 100_000, "segments of the ground as a rod, in the schemes modified_smith and repaired"
    ),
}

_UTO = "Uto et al. 1974, table 1: standard penetration test"
_SPEED = 5120.0
_DENSITY = 7850.0

Clock = namedtuple("Clock", "waiting head_impulse toe_impulse behind")
CLOCK = Clock(*range(4))
"""Places in ``clock``: time (s) since the last whole internal step, impulses of the inputs (N s) in
it, and the time (s) by which a rod that learns its forces afterwards is behind."""

Ram = namedtuple("Ram", "position velocity touching wave rate length")
RAM = Ram(*range(6))
"""Places in ``ram_state``: position (m) and velocity (m/s), downwards, whether it lies on the head,
and of the step before the wave (N) that came up to it, its rate (N/s) and the length (s)."""


def _nodes(sizes: Sizes) -> int:
    """Return the number of nodes: head, lower ends of the segments of rod and ground."""
    return sizes["segments"] + 1 + sizes["ground_segments"]


def _segments(sizes: Sizes) -> int:
    return sizes["segments"]


LAYOUT = Layout(
    (
        choice(
            "scheme",
            "characteristics: exact for every travelling wave; smith: masses and springs; "
            "modified_smith: the ground as a rod of masses and springs; repaired: that with the "
            "mean mass at interfaces",
            ("characteristics", "smith", "modified_smith", "repaired"),
            "characteristics",
            source="smith: Uto et al. 1974, eqs (2)-(5), corrected",
        ),
        param(
            "section.length",
            "length of the section",
            lambda i, sizes: 10.0 / sizes["sections"],
            "m",
            minimum=1e-6,
            size="sections",
        ),
        param(
            "section.area",
            "area of the section",
            5.8 * cm2,
            "m2",
            minimum=1e-12,
            size="sections",
            source=_UTO,
        ),
        param(
            "section.modulus",
            "Young's modulus of the section",
            _DENSITY * _SPEED**2,
            "Pa",
            minimum=1.0,
            size="sections",
            source=_UTO + ", density times wave speed squared",
        ),
        param(
            "section.density",
            "density of the section",
            _DENSITY,
            "kg/m3",
            minimum=1e-3,
            size="sections",
            source=_UTO,
        ),
        choice(
            "head.port",
            "kinematics: takes a force that is constant in the step, gives position and velocity; "
            "waves: gives the wave that comes out of the rod in the next step, takes the mean "
            "force that goes with it",
            ("kinematics", "waves"),
            "kinematics",
        ),
        choice(
            "head.direction",
            "direction in which force, position, velocity and wave of the head's port are positive",
            ("down", "up"),
            "down",
        ),
        param(
            "head.preload",
            "part of head.force that the rod carries at rest at the start; it is left out of "
            "everything else",
            0.0,
            "N",
            role=Role.LOAD_AT_REST,
        ),
        param(
            "head.partner.stiffness",
            "stiffness of what acts on the head, 0 if unknown: the step of a port with kinematics "
            "is limited to impedance / stiffness",
            0.0,
            "N/m",
            minimum=0.0,
        ),
        param(
            "head.partner.mass",
            "mass of what acts on the head if that is a rigid mass, 0 if not: the step of a port "
            "with kinematics is limited to mass / impedance",
            0.0,
            "kg",
            minimum=0.0,
        ),
        param(
            "ram.mass",
            "rigid mass that strikes the head, the first element of Smith's chain; 0: none",
            0.0,
            "kg",
            minimum=0.0,
        ),
        param(
            "ram.velocity",
            "velocity of the ram when it touches the head at the start, downwards",
            3.8353,
            "m/s",
            source="fall of 75 cm; " + _UTO,
        ),
        choice(
            "toe.condition",
            "what the toe stands on",
            ("free", "fixed", "matched", "reflection", "soil", "port"),
            "soil",
        ),
        choice(
            "toe.port",
            "kinematics or waves, as at the head; used when toe.condition is port",
            ("kinematics", "waves"),
            "kinematics",
        ),
        param(
            "toe.partner.stiffness",
            "stiffness of what acts on the toe, 0 if unknown; see head.partner.stiffness",
            0.0,
            "N/m",
            minimum=0.0,
        ),
        param(
            "toe.reflection",
            "reflected part of the displacement: -1 fixed, 0 matched, 1 free; used when "
            "toe.condition is reflection",
            0.0,
            minimum=-1.0,
            maximum=1.0,
            source="Uto et al. 1974, eq. (7)",
        ),
        param(
            "toe.quake",
            "displacement of the toe at which the static resistance is exhausted",
            2.5 * mm,
            "m",
            minimum=1e-9,
            source="Smith 1960, 0.1 in",
        ),
        param(
            "toe.resistance",
            "ultimate static resistance under the toe; no tension",
            30e3,
            "N",
            minimum=0.0,
        ),
        param(
            "toe.damping",
            "Smith's damping under the toe: static resistance times this times velocity is added",
            0.5,
            "s/m",
            minimum=0.0,
            source="Smith 1960, 0.15 s/ft",
        ),
        param(
            "shaft.quake",
            "displacement at which the segment's shaft slips",
            2.5 * mm,
            "m",
            minimum=1e-9,
            size="segments",
        ),
        param(
            "shaft.resistance",
            "ultimate static resistance at the lower end of the segment, either way",
            0.0,
            "N",
            minimum=0.0,
            size="segments",
        ),
        param(
            "shaft.damping",
            "Smith's damping at the segment",
            0.16,
            "s/m",
            minimum=0.0,
            size="segments",
            source="Smith 1960, 0.05 s/ft",
        ),
        param(
            "gravity",
            "acceleration of gravity on rod and ram, downwards; 0: everything counts from the "
            "position under the weight",
            0.0,
            "m/s2",
            minimum=0.0,
            role=Role.GRAVITY,
        ),
        param("gauge.depth", "depth of the gauge below the head", 0.0, "m", minimum=0.0),
        choice(
            "exchange",
            "what the mean force given to a port of waves belongs to. parallel: to the step that "
            "has ended; sequential: to the step that follows, because the partner has made it "
            "already",
            ("parallel", "sequential"),
            "parallel",
        ),
        internal_step(1.0),
        inp(
            "head.force",
            "force on the head, or on the ram if there is one; positive in head.direction (down: "
            "compression)",
            "N",
        ),
        inp("toe.force", "force of the ground on the toe, upwards: compression positive", "N"),
        out(
            "head.position",
            "displacement of the head, in head.direction",
            "m",
            initial_dependencies=(),
            role=Role.LOADED_POSITION,
        ),
        out(
            "head.velocity",
            "velocity of the head, in head.direction",
            "m/s",
            initial_dependencies=(),
        ),
        out(
            "head.wave",
            "2 Z b: wave that comes out of the head, mean over the next step, in head.direction",
            "N",
        ),
        out("head.impedance", "impedance at the head", "N.s/m"),
        out(
            "head.contact_force",
            "force on the head in the last internal step, compression positive",
            "N",
            initial_dependencies=(),
            reported=(Reported("largest force at the head", unit="kN"),),
        ),
        out(
            "head.zv",
            "impedance times velocity of the head, downwards",
            "N",
            initial_dependencies=(),
        ),
        out("toe.position", "displacement of the toe, downwards", "m", initial_dependencies=()),
        out("toe.velocity", "velocity of the toe, downwards", "m/s", initial_dependencies=()),
        out(
            "toe.wave",
            "2 Z f: wave that comes out of the toe, mean over the next step, compression positive",
            "N",
        ),
        out("toe.impedance", "impedance at the toe", "N.s/m"),
        out(
            "toe.contact_force",
            "force of the ground on the toe in the last internal step, compression positive",
            "N",
            initial_dependencies=(),
            reported=(Reported("largest force at the toe", unit="kN"),),
        ),
        out(
            "toe.set",
            "part of the toe's displacement that stays: plastic displacement of the soil under it",
            "m",
            initial_dependencies=(),
        ),
        out(
            "gauge.force", "force at the gauge, compression positive", "N", initial_dependencies=()
        ),
        out("gauge.velocity", "velocity at the gauge, downwards", "m/s", initial_dependencies=()),
        out("gauge.zv", "impedance times velocity at the gauge", "N", initial_dependencies=()),
        out(
            "gauge.stress",
            "stress at the gauge, compression positive",
            "Pa",
            initial_dependencies=(),
        ),
        out(
            "ram.position",
            "position of the ram relative to the head at the start, downwards",
            "m",
            initial_dependencies=(),
        ),
        out(
            "ram.speed",
            "velocity of the ram, downwards",
            "m/s",
            initial_dependencies=("ram.mass", "ram.velocity"),
        ),
        out(
            "ram.touching",
            "1 if the ram lies on the head, else 0",
            initial_dependencies=("ram.mass",),
        ),
        out(
            "ram.separation",
            "time at which the ram last left the head; -1 before",
            "s",
            initial_dependencies=(),
        ),
        out("travel_time", "time of a wave from head to toe", "s"),
        out("time_step", "internal step in use", "s"),
        stable_step(),
        out("head.step_limit", "longest communication step that the head's port bears", "s"),
        out("toe.step_limit", "longest communication step that the toe's port bears", "s"),
        out(
            "step_limit",
            "longest communication step that both ports bear; a longer one is refused",
            "s",
        ),
        out("exchange_step", "length of the last communication step", "s", initial_dependencies=()),
        out(
            "delay",
            "time by which everything that is computed lies before the end of the communication "
            "step",
            "s",
            initial_dependencies=(),
            formerly=("lag",),
        ),
        out(
            "force",
            "force in the segment, compression positive",
            "N",
            size="segments",
            initial_dependencies=(),
        ),
        out(
            "velocity",
            "velocity in the segment, downwards (masses and springs: at its lower end)",
            "m/s",
            size="segments",
            initial_dependencies=(),
        ),
        out(
            "stress",
            "stress in the segment, compression positive",
            "Pa",
            size="segments",
            initial_dependencies=(),
        ),
        out(
            "stress.compression",
            "largest compressive stress so far",
            "Pa",
            size="segments",
            initial_dependencies=(),
            reported=(Reported("largest compressive stress", Statistic.LAST, "MPa"),),
        ),
        out(
            "stress.tension",
            "largest tensile stress so far, positive",
            "Pa",
            size="segments",
            initial_dependencies=(),
            reported=(Reported("largest tensile stress", Statistic.LAST, "MPa"),),
        ),
        out(
            "shaft.force",
            "resistance of the segment's shaft, upwards positive, without damping",
            "N",
            size="segments",
            initial_dependencies=(),
        ),
        out(
            "energy.kinetic",
            "kinetic energy of the rod",
            "J",
            role=Role.KINETIC,
            label="rods, kinetic and elastic",
        ),
        out(
            "energy.elastic",
            "elastic energy of the rod",
            "J",
            role=Role.ELASTIC,
            label="rods, kinetic and elastic",
        ),
        out(
            "energy.ram", "kinetic energy of the ram", "J", role=Role.KINETIC, label="ram, kinetic"
        ),
        out(
            "energy.soil",
            "elastic energy in the soil at shaft and toe",
            "J",
            role=Role.ELASTIC,
            label="ground, kinetic and elastic",
        ),
        out(
            "energy.ground",
            "energy in the ground as a rod, or in the spring that stands for it",
            "J",
            role=Role.ELASTIC,
            label="ground, kinetic and elastic",
        ),
        out("energy.ground.elastic", "elastic part of energy.ground", "J"),
        out(
            "energy.radiated",
            "energy that has left through the toe for good",
            "J",
            role=Role.DISSIPATED,
            label="left through the toe",
        ),
        out(
            "energy.plastic",
            "energy dissipated by the static resistance of the soil",
            "J",
            role=Role.DISSIPATED,
            label="lost at shaft and toe",
        ),
        out(
            "energy.damping",
            "energy dissipated by the damping of the soil",
            "J",
            role=Role.DISSIPATED,
            label="lost at shaft and toe",
        ),
        out(
            "energy.contact",
            "energy lost between ram and head: the error of the scheme when they separate",
            "J",
            role=Role.DISSIPATED,
            label="lost at shaft and toe",
        ),
        out("energy.work.head", "work of head.force", "J", role=Role.WORK_INSIDE),
        out(
            "energy.work.toe",
            "work of toe.force on the rod, negative where the rod drives the ground",
            "J",
            role=Role.WORK_INSIDE,
        ),
        out("energy.work.gravity", "work of the weight", "J", role=Role.WORK_OUTSIDE),
        out(
            "energy.transferred",
            "largest value so far of the work done on the head, by the ram or head.force",
            "J",
            reported=(Reported("transferred energy", Statistic.LAST, "J"),),
        ),
        out("energy.head", "work done on the head, by the ram or head.force", "J"),
        out(
            "energy.naive",
            "kinetic + elastic energy with both at their own times, as printed; masses and springs "
            "only",
            "J",
            source="Uto et al. 1974",
        ),
        out(
            "energy.residual",
            "energies + losses - works, minus their sum at the start: the error of the balance",
            "J",
            role=Role.RESIDUAL,
        ),
        out("energy.start", "kinetic + elastic at the start", "J"),
    ),
    (
        State("clock", lambda sizes: len(CLOCK)),
        State("ram.state", lambda sizes: len(RAM)),
        State("impedance", _segments),
        State("cell.area", _segments),
        State("down", _segments),
        State("up", _segments),
        State("soil", _nodes),
        State("place", _nodes),
        State("rate", _nodes),
        State("mass", _nodes),
        State("spring", _nodes),
        State("toe.soil", lambda sizes: 1),
        State(
            "free",
            lambda sizes: 3,
            integer=True,
            indices=(
                Indices(_segments, first=0, every=3),
                Indices(_segments, first=1, every=3),
                Indices(lambda sizes: _nodes(sizes) - 1, first=2),
            ),
        ),
    ),
)
"""Variables and hidden arrays of the pile rod.

``down`` and ``up`` are velocities (m/s) of the waves in each segment; ``place`` (m), ``rate`` (m/s)
and ``mass`` (kg) are those of the nodes, ``spring`` (N/m) is below each. ``soil`` is the elastic
displacement (m) of the shaft's soil at each node, ``toe.soil`` of that below the toe. ``free`` has
the numbers of segments without reflection at head and toe, and the last moving node."""
