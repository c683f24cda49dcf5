"""Variables of the mass. Equations, frame and signs: README.md beside this file."""

from rockshed.components.common.ports import Layout, inp, out, param
from rockshed.components.common.roles import Role

DIVERGED = 1

LAYOUT = Layout(
    (
        param("mass", "mass", 1.0, "kg", minimum=1e-9),
        param("stiffness", "stiffness of a spring to the ground; 0: none", 0.0, "N/m", minimum=0.0),
        param("position0.y", "position at the start, upwards", 0.0, "m"),
        param("velocity0.y", "velocity at the start, upwards", 0.0, "m/s"),
        inp("force.y", "force on the mass, upwards, constant in a step", "N"),
        out(
            "position.y",
            "position, upwards; 0 where the spring is without force",
            "m",
            initial_dependencies=("position0.y",),
        ),
        out("velocity.y", "velocity, upwards", "m/s", initial_dependencies=("velocity0.y",)),
        out("energy.kinetic", "kinetic energy", "J", role=Role.KINETIC),
        out("energy.elastic", "elastic energy of the spring", "J", role=Role.ELASTIC),
        out("energy.work", "work that the input force has done", "J", role=Role.WORK_INSIDE),
        out("energy.start", "kinetic + elastic at the start", "J"),
        out(
            "energy.residual",
            "kinetic + elastic - work - start: error of the balance",
            "J",
            role=Role.RESIDUAL,
        ),
    )
)
