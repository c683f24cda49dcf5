"""Variables of the ground under a plate, a support or a rod.

Equations, frame and signs: README.md in this folder.
"""

from collections import namedtuple

from ..common.ports import Layout, State, choice, inp, out, param
from ..common.roles import Role
from ..common.shown import Reported, Statistic
from ..common.stepping import internal_step, stable_step
from ..common.units import cm, cm2, deg, kgf, mm

SETTLEMENT, KINEMATICS, WAVE = 1, 2, 3
SMITH, MOGAMI = 1, 2

Body = namedtuple("Body", "settlement velocity spring slack gap clock")
BODY = Body(*range(6))
"""Places in ``body``, the ground's state; all count downwards.

They are settlement (m) and velocity (m/s) of the plate (of the toe, where Smith's soil has no
mass), force of Smith's spring (N), way until it pushes (m), gap between plate and toe (m), time
since the plate's onset of motion (s)."""

_MOGAMI = "Mogami and Tamura 1973"
_PLATE = 200.0 * cm2
_R0, _R1 = 0.5519 * kgf, 874.0 * kgf
"""Ends of the resistance (N) by (12), for a weight of 14.70 kg that falls 30 cm on the plate of
200 cm2: R_m at I = 0, and 2 R_m - R0."""
_MASS = (
    "impulse0",
    "impulse0.mass",
    "plate.mass",
    "plate.radius",
    "soil.depth",
    "soil.spread",
    "soil.density",
    "soil.mass_form",
)
_PORT = (
    "port",
    "law",
    "preload",
    "quake",
    "ultimate_resistance",
    "contact.stiffness",
    "toe.position",
    "toe.velocity",
    "toe.wave",
    "toe.impedance",
    "force.y",
    "damping",
    *_MASS,
)

LAYOUT = Layout(
    (
        choice(
            "port",
            "settlement: takes force.y, gives the plate's position; kinematics: takes position and "
            "velocity of a toe, gives the force on it; wave: takes the wave and the impedance of a "
            "rod's toe, gives the force on it",
            ("settlement", "kinematics", "wave"),
            "settlement",
        ),
        choice(
            "law",
            "smith: a spring that yields, damped, without mass but for the plate's; mogami: a "
            "rigid plate with a mass of sand against a resistance linear in time since onset",
            ("smith", "mogami"),
            "mogami",
        ),
        param(
            "plate.radius",
            "radius of the plate; the default has 200 cm2",
            (_PLATE / 3.141592653589793) ** 0.5,
            "m",
            minimum=1e-4,
            source=_MOGAMI,
        ),
        param(
            "plate.mass",
            "mass of the plate; not printed, assumed is steel of 2 cm",
            3.14,
            "kg",
            minimum=0.0,
        ),
        param(
            "box.width",
            "lesser side of the box of sand, which the plate must fit into; 0: open ground",
            35 * cm,
            "m",
            minimum=0.0,
            source=_MOGAMI,
        ),
        param(
            "soil.depth",
            "depth l of the sand that moves with the plate; 0: none moves",
            45 * cm,
            "m",
            minimum=0.0,
            source=_MOGAMI,
        ),
        param(
            "soil.spread",
            "angle by which it widens with the depth",
            45 * deg,
            "rad",
            minimum=0.0,
            maximum=85 * deg,
            source=_MOGAMI,
        ),
        param(
            "soil.density",
            "density of the sand; not printed, assumed",
            1600.0,
            "kg/m3",
            minimum=0.0,
        ),
        choice(
            "soil.mass_form",
            "derived: 12 r2, the momentum of the frustum of sand; printed: 3 r2",
            ("derived", "printed"),
            "derived",
            source=f"{_MOGAMI}, eq. (1)",
        ),
        param(
            "resistance.start",
            "R0, resistance at the onset of motion; read from (12) at I = 0",
            _R0,
            "N",
            minimum=0.0,
            source=f"{_MOGAMI}, eqs (2), (12)",
        ),
        param(
            "resistance.end",
            "R1, resistance when resistance.time has passed, and from then on",
            _R1,
            "N",
            minimum=0.0,
            source=f"{_MOGAMI}, eqs (2), (12)",
        ),
        param(
            "resistance.time",
            "t_f, time since the onset of motion in which the resistance runs from R0 to R1",
            8.3e-3,
            "s",
            minimum=1e-9,
            source=f"{_MOGAMI}, eqs (2), (6)",
        ),
        param(
            "quake",
            "Q, elastic way of Smith's soil up to its ultimate resistance",
            2.5 * mm,
            "m",
            minimum=1e-12,
            source="Uto et al., eq. (6), after Smith",
        ),
        param(
            "ultimate_resistance",
            "R_u of Smith's soil",
            20e3,
            "N",
            minimum=1e-3,
            source="Uto et al., eq. (6), after Smith",
        ),
        param(
            "damping",
            "J of Smith's soil: its force is that of the spring times 1 + J v",
            0.0,
            "s/m",
            minimum=0.0,
        ),
        param(
            "contact.stiffness",
            "spring between toe and plate, for kinematics with mogami",
            1e8,
            "N/m",
            minimum=1.0,
        ),
        param(
            "preload",
            "static load that the ground carries in equilibrium at the start and on; forces and "
            "waves of the ports count beyond it",
            0.0,
            "N",
            minimum=0.0,
        ),
        param(
            "impulse0",
            "impulse that the plate has received at the start, downwards",
            0.0,
            "N.s",
            minimum=0.0,
        ),
        param(
            "impulse0.mass",
            "mass of the body that gave impulse0 and moves on with the plate; without impulse0 "
            "there is none",
            14.70,
            "kg",
            minimum=0.0,
            source=f"{_MOGAMI}, eq. (1): G is the weight of body and plate; third of four weights",
        ),
        internal_step(1e-5),
        inp(
            "force.y",
            "settlement: force on the plate beyond the preload, upwards (negative presses)",
            "N",
        ),
        inp("toe.position", "kinematics: displacement of the toe since the start, downwards", "m"),
        inp("toe.velocity", "kinematics: velocity of the toe, downwards", "m/s"),
        inp(
            "toe.wave",
            "wave: c of F = c - Z v, the wave that comes out of the toe, compression positive; v "
            "is downwards",
            "N",
        ),
        inp(
            "toe.impedance",
            "wave: Z of the rod at the toe; kinematics, settlement: for step_limit; 0: unknown",
            "N.s/m",
            minimum=0.0,
        ),
        out(
            "position.y",
            "position of the plate (smith: of the toe) from that at the start, upwards",
            "m",
            initial_dependencies=(),
        ),
        out("velocity.y", "velocity of the plate (smith: of the toe), upwards", "m/s"),
        out(
            "settlement",
            "settlement of the plate (smith: of the toe) since the start, downwards",
            "m",
            initial_dependencies=(),
            reported=(Reported("largest settlement", unit="mm", decimals=3),),
        ),
        out(
            "permanent_set",
            "what of the settlement would stay without load: all of a plate's, of Smith's soil "
            "what it slid",
            "m",
            initial_dependencies=(),
            reported=(Reported("permanent set", Statistic.LAST, "mm", 3),),
        ),
        out(
            "toe.force",
            "force of the ground on the toe beyond the preload at the end of the step, upwards: "
            "compression positive",
            "N",
            initial_dependencies=_PORT,
        ),
        out(
            "toe.mean_force",
            "mean of toe.force over the step: its impulse divided by the step",
            "N",
            initial_dependencies=_PORT,
        ),
        out(
            "resistance",
            "force with which the ground resists at the end of the step, preload included, upwards",
            "N",
        ),
        out(
            "virtual_mass",
            "mass that moves: plate, sand, and the body that gave impulse0",
            "kg",
            initial_dependencies=_MASS,
        ),
        stable_step(),
        out(
            "step_limit",
            "longest communication step that the port bears with a rod of the impedance "
            "toe.impedance; 1e6 where nothing limits it",
            "s",
        ),
        out(
            "energy.kinetic",
            "kinetic energy of plate and sand, and of the body that gave impulse0",
            "J",
            role=Role.KINETIC,
            label="ground, kinetic and elastic",
        ),
        out(
            "energy.elastic",
            "energy of the springs",
            "J",
            role=Role.ELASTIC,
            label="ground, kinetic and elastic",
        ),
        out(
            "energy.preload",
            "potential energy of the static load, zero at the start",
            "J",
            initial_dependencies=(),
            role=Role.ELASTIC,
            label="ground, kinetic and elastic",
        ),
        out(
            "energy.plastic",
            "energy that sliding against the resistance has dissipated",
            "J",
            initial_dependencies=(),
            role=Role.DISSIPATED,
            label="lost at shaft and toe",
        ),
        out(
            "energy.damping",
            "energy that the damping has dissipated",
            "J",
            initial_dependencies=(),
            role=Role.DISSIPATED,
            label="lost at shaft and toe",
        ),
        out(
            "energy.work.contact",
            "work that the ports' force has done on the ground",
            "J",
            initial_dependencies=(),
            role=Role.WORK_INSIDE,
        ),
        out(
            "energy.residual",
            "energies + dissipated - work, minus their sum at the start: error of the integration",
            "J",
            initial_dependencies=(),
            role=Role.RESIDUAL,
        ),
        out("energy.start", "kinetic + elastic + preload at the start", "J"),
    ),
    (State("body", lambda sizes: len(BODY)),),
)
