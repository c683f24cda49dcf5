"""Variables of the falling rock. Equations, frame and signs: README.md beside this file."""

from ..common.plausible import Plausible
from ..common.ports import Layout, choice, inp, out, param
from ..common.roles import Role
from ..common.stepping import internal_step, stable_step
from ..common.units import cm, standard_gravity

SPHERE, DISC, GIVEN = 1, 2, 3
FREE, DRIVEN = 1, 2

_BALL_MASS = 4.0
_BALL_RADIUS = 4.95 * cm
_SONODA = "Sonoda et al. 1993, sec. 2 (1) b): steel ball of 4 kgf, diameter 9.9 cm, 8 m/s"

LAYOUT = Layout(
    (
        param(
            "mass",
            "mass of the rock",
            _BALL_MASS,
            "kg",
            minimum=1e-6,
            source=_SONODA,
            plausible=Plausible(1e-3, 1e6, ("t",)),
            role=Role.BODY_MASS,
        ),
        param(
            "radius",
            "radius of the rock",
            _BALL_RADIUS,
            "m",
            minimum=1e-6,
            source=_SONODA,
            plausible=Plausible(1e-3, 10.0, ("cm", "mm")),
            role=Role.BODY_RADIUS,
        ),
        choice(
            "shape",
            "what the moment of inertia follows from: sphere 2/5 m r2, disc 1/2 m r2, or the "
            "parameter moment_of_inertia",
            ("sphere", "disc", "given"),
            "sphere",
        ),
        param(
            "moment_of_inertia",
            "moment of inertia about the centre; used when shape is given",
            0.4 * _BALL_MASS * _BALL_RADIUS**2,
            "kg.m2",
            minimum=1e-15,
        ),
        choice(
            "motion",
            "free: moves under force, torque and weight; driven: keeps the velocities given for "
            "the start whatever acts on it, as in a testing machine",
            ("free", "driven"),
            "free",
            source="driven: Sonoda et al. 1993, fig. 12",
            role=Role.DRIVEN,
        ),
        param(
            "gravity",
            "acceleration of gravity, downwards",
            standard_gravity,
            "m/s2",
            minimum=0.0,
            role=Role.GRAVITY,
        ),
        param("position0.x", "position of the centre at the start, to the right", 0.0, "m"),
        param("position0.y", "position of the centre at the start, upwards", 1.0, "m"),
        param("angle0", "angle at the start, counter-clockwise", 0.0, "rad"),
        param(
            "velocity0.x",
            "velocity at the start, to the right",
            0.0,
            "m/s",
            plausible=Plausible(1e-3, 150.0, ("mm/s", "km/h")),
        ),
        param(
            "velocity0.y",
            "velocity at the start, upwards",
            -8.0,
            "m/s",
            source=_SONODA,
            plausible=Plausible(1e-3, 150.0, ("mm/s", "km/h")),
        ),
        param(
            "angular_velocity0", "angular velocity at the start, counter-clockwise", 0.0, "rad/s"
        ),
        internal_step(1e-5),
        inp("force.x", "force on the rock without its weight, to the right", "N"),
        inp("force.y", "force on the rock without its weight, upwards", "N"),
        inp("torque", "torque on the rock about its centre, counter-clockwise", "N.m"),
        out(
            "position.x",
            "position of the centre, to the right",
            "m",
            initial_dependencies=("position0.x",),
            role=Role.STRIKING_PLACE,
        ),
        out(
            "position.y",
            "position of the centre, upwards",
            "m",
            initial_dependencies=("position0.y",),
        ),
        out("angle", "angle, counter-clockwise", "rad", initial_dependencies=("angle0",)),
        out("velocity.x", "velocity, to the right", "m/s", initial_dependencies=("velocity0.x",)),
        out("velocity.y", "velocity, upwards", "m/s", initial_dependencies=("velocity0.y",)),
        out(
            "angular_velocity",
            "angular velocity, counter-clockwise",
            "rad/s",
            initial_dependencies=("angular_velocity0",),
        ),
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
            "potential energy in gravity, zero at y = 0",
            "J",
            role=Role.GRAVITY_ENERGY,
            label="gravity, above its least",
        ),
        out(
            "energy.work.contact",
            "work that the inputs force and torque have done on the rock",
            "J",
            role=Role.WORK_INSIDE,
        ),
        out(
            "energy.work.drive",
            "work that the machine has done on a driven rock: against its weight, force and torque",
            "J",
            role=Role.MACHINE_WORK,
        ),
        out(
            "energy.residual",
            "kinetic + gravity - works, minus their sum at the start: the error of the integration",
            "J",
            role=Role.RESIDUAL,
        ),
        out("energy.start", "kinetic + gravity at the start", "J"),
    )
)
