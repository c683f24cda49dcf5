"""Variables of the spring buffer. Equations, frame and signs: README.md beside this file."""

from rockshed.components.common.ports import Layout, inp, out, param
from rockshed.components.common.roles import Role
from rockshed.components.common.shown import Reported, Statistic
from rockshed.components.common.stepping import stable_step

DIVERGED = 1

LAYOUT = Layout(
    (
        param("mass", "mass of the plate", 5.0, "kg", minimum=1e-6),
        param("stiffness", "stiffness of the spring", 2e6, "N/m", minimum=0.0),
        param("damping", "constant of the dashpot", 2e3, "N.s/m", minimum=0.0),
        inp("force.y", "force on the plate, upwards", "N"),
        out(
            "position.y",
            "position of the plate from that at the start, upwards",
            "m",
            initial_dependencies=(),
        ),
        out("velocity.y", "velocity of the plate, upwards", "m/s", initial_dependencies=()),
        out(
            "compression",
            "compression of the spring since the start",
            "m",
            initial_dependencies=(),
            reported=(Reported("largest compression", unit="mm", decimals=3),),
        ),
        out(
            "ground.force.y",
            "force of spring and dashpot on the ground, downwards",
            "N",
            initial_dependencies=(),
            reported=(Reported("largest force on the ground", unit="kN"),),
        ),
        stable_step(),
        out(
            "energy.kinetic",
            "kinetic energy of the plate",
            "J",
            role=Role.KINETIC,
            label="buffers, kinetic and elastic",
        ),
        out(
            "energy.elastic",
            "elastic energy of the spring",
            "J",
            role=Role.ELASTIC,
            label="buffers, kinetic and elastic",
        ),
        out(
            "energy.damping",
            "energy that the dashpot has dissipated",
            "J",
            role=Role.DISSIPATED,
            label="lost in the buffers",
            reported=(Reported("dissipated energy", Statistic.LAST, "J", 3),),
        ),
        out(
            "energy.work.contact",
            "work that the input force has done on the plate",
            "J",
            role=Role.WORK_INSIDE,
        ),
        out(
            "energy.residual",
            "kinetic + elastic + dissipated - work: error of the balance",
            "J",
            role=Role.RESIDUAL,
        ),
    )
)
