"""Variables of the hammer. Equations, frame and signs: README.md beside this file."""

from collections import namedtuple

from ..common.ports import Layout, State, choice, inp, out, param, switch
from ..common.roles import Role
from ..common.stepping import internal_step, stable_step
from ..common.units import cm, cm2, standard_gravity

KINEMATICS, WAVES = 1, 2
HeardPlaces = namedtuple("HeardPlaces", "wave rate length")
"""Places of the wave of the step before: mean (N), rate (N/s), length of the step (s)."""
HEARD = HeardPlaces(*range(3))
"""Places in ``heard``, which keeps the wave of the step before."""

MOST_BODIES = 3
"""Number of bodies of the train at most: ram, anvil, helmet."""
_UTO = "Uto et al. 1974, table 1: standard penetration test"

LAYOUT = Layout(
    (
        param("mass", "mass of the ram", 63.5, "kg", minimum=1e-6, source=_UTO),
        param("drop_height", "height of fall", 75 * cm, "m", minimum=0.0, source=_UTO),
        param(
            "efficiency",
            "part of the energy of the fall that the ram has when it strikes",
            1.0,
            "1",
            minimum=0.0,
            maximum=1.0,
        ),
        param(
            "gravity",
            "acceleration of gravity",
            standard_gravity,
            "m/s2",
            minimum=0.0,
            role=Role.GRAVITY,
        ),
        switch("weight", "whether the ram's weight acts during the blow too", True),
        param(
            "cushion.stiffness",
            "stiffness of the hammer cushion; 0: none, ram and head are rigid",
            0.0,
            "N/m",
            minimum=0.0,
        ),
        param(
            "cushion.restitution",
            "coefficient of restitution of the cushion: it gives back its square of the energy",
            1.0,
            "1",
            minimum=0.01,
            maximum=1.0,
        ),
        param(
            "anvil.mass",
            "mass of an anvil between ram and hammer cushion; 0: none",
            0.0,
            "kg",
            minimum=0.0,
        ),
        param(
            "anvil.stiffness",
            "stiffness of the contact of ram and anvil",
            1e10,
            "N/m",
            minimum=1.0,
        ),
        param(
            "anvil.restitution",
            "coefficient of restitution of ram and anvil",
            1.0,
            "1",
            minimum=0.01,
            maximum=1.0,
        ),
        param(
            "helmet.mass",
            "mass of the helmet (drive cap) between hammer cushion and head; 0: none",
            0.0,
            "kg",
            minimum=0.0,
        ),
        param(
            "pile_cushion.stiffness",
            "stiffness of the cushion between helmet and head; 0: none, the helmet is rigid on it",
            0.0,
            "N/m",
            minimum=0.0,
        ),
        param(
            "pile_cushion.restitution",
            "coefficient of restitution of the cushion between helmet and head",
            1.0,
            "1",
            minimum=0.01,
            maximum=1.0,
        ),
        param(
            "gas.force",
            "smallest force between ram and what is below it while the gas of a diesel burns",
            0.0,
            "N",
            minimum=0.0,
        ),
        param(
            "gas.hold",
            "time since the ram has touched for which the gas keeps its force",
            10e-3,
            "s",
            minimum=0.0,
        ),
        param(
            "gas.end",
            "time since the ram has touched at which the gas has lost its force, evenly from "
            "gas.hold on",
            12.5e-3,
            "s",
            minimum=0.0,
        ),
        param(
            "gap",
            "distance between ram and head at the start; the ram has its full velocity there",
            0.0,
            "m",
            minimum=0.0,
        ),
        param(
            "blow.interval",
            "time from blow to blow: the ram is put on the head again and has its full velocity; "
            "0: one blow",
            0.0,
            "s",
            minimum=0.0,
        ),
        choice(
            "port",
            "kinematics: takes position and velocity of the head; waves: takes impedance and wave "
            "of the rod. Both give the mean force of the step",
            ("kinematics", "waves"),
            "waves",
        ),
        internal_step(1e-6),
        inp("head.position", "position of the head, downwards; for the port kinematics", "m"),
        inp(
            "head.velocity",
            "velocity of the head, downwards, constant in the step; for the port kinematics",
            "m/s",
        ),
        inp(
            "head.wave",
            "wave that comes out of the rod, mean over the step; for the port waves",
            "N",
        ),
        inp(
            "head.impedance",
            "impedance of the rod; for the port waves",
            "N.s/m",
            5.8 * cm2 * 7850.0 * 5120.0,
            minimum=0.0,
            source=_UTO,
        ),
        out(
            "force",
            "force of the hammer on the head, mean over the step, downwards: compression positive",
            "N",
            initial_dependencies=(),
        ),
        out(
            "end_force",
            "force of the hammer on the head at the end of the step",
            "N",
            initial_dependencies=(),
        ),
        out(
            "position",
            "position of the ram, downwards; it touches the head where it equals head.reached",
            "m",
            initial_dependencies=("gap", "head.position", "port"),
        ),
        out(
            "velocity",
            "velocity of the ram, downwards",
            "m/s",
            initial_dependencies=("drop_height", "efficiency", "gravity"),
        ),
        out(
            "head.reached",
            "position of the head as the hammer knows it, downwards",
            "m",
            initial_dependencies=("head.position", "port"),
        ),
        out(
            "impact_velocity",
            "velocity with which the ram strikes, downwards",
            "m/s",
            initial_dependencies=("drop_height", "efficiency", "gravity"),
        ),
        out("cushion.compression", "compression of the cushion", "m", initial_dependencies=()),
        out(
            "touching",
            "1 while the hammer presses on the head, else 0",
            initial_dependencies=("drop_height", "efficiency", "gap", "gravity"),
        ),
        out(
            "separation",
            "time at which the ram last left the head; -1 before",
            "s",
            initial_dependencies=(),
        ),
        out("blows", "number of blows that have begun", initial_dependencies=()),
        stable_step(),
        out("energy.kinetic", "kinetic energy of the ram", "J", role=Role.STRIKING, label="hammer"),
        out(
            "energy.gravity",
            "potential energy of the ram, zero at position 0",
            "J",
            role=Role.GRAVITY_ENERGY,
            label="hammer",
        ),
        out(
            "energy.cushion",
            "elastic energy in the cushion",
            "J",
            role=Role.ELASTIC,
            label="hammer",
        ),
        out("helmet.position", "position of the helmet, downwards; of the head without one", "m"),
        out("helmet.velocity", "velocity of the helmet, downwards; 0 without one", "m/s"),
        out("energy.supplied", "energy supplied by the blows after the first, and by gas", "J"),
        out(
            "energy.cushion_loss",
            "energy dissipated in the cushion",
            "J",
            role=Role.DISSIPATED,
            label="lost in the hammer",
        ),
        out(
            "energy.contact",
            "energy lost between rigid ram and head: the error of the scheme when they separate",
            "J",
            role=Role.DISSIPATED,
            label="lost in the hammer",
        ),
        out(
            "energy.work.head",
            "work that the head has done on the hammer: negative where it is driven",
            "J",
            role=Role.WORK_INSIDE,
        ),
        out(
            "energy.residual",
            "energies + losses - work - supplied, minus their sum at the start",
            "J",
            role=Role.RESIDUAL,
        ),
        out("energy.start", "kinetic + gravity at the start", "J"),
    ),
    (
        State("largest", lambda sizes: 1),
        State("ends", lambda sizes: 1),
        State("heard", lambda sizes: len(HEARD)),
        State("masses", lambda sizes: MOST_BODIES),
        State("places", lambda sizes: MOST_BODIES),
        State("speeds", lambda sizes: MOST_BODIES),
        State("stiffnesses", lambda sizes: MOST_BODIES),
        State("restitutions", lambda sizes: MOST_BODIES),
        State("pressed", lambda sizes: MOST_BODIES),
        State("spring_forces", lambda sizes: MOST_BODIES),
        State("elapsed", lambda sizes: 1),
    ),
)
"""Variables and hidden arrays of the hammer.

``largest`` is the largest compression of the cushion in this blow (m), ``ends`` the force (N) at
the end of the last internal step. Of the train from the ram downwards: ``masses`` (kg), ``places``
(m) and ``speeds`` (m/s) of the bodies; ``stiffnesses`` (N/m), ``restitutions``, largest
compressions ``pressed`` (m) and mean ``spring_forces`` (N) of the springs below them; ``elapsed``
is the time (s) since the ram has touched."""
