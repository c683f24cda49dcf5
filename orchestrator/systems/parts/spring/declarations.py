"""Variables of the spring. Equations, frame and signs: README.md beside this file."""

from rockshed.components.common.ports import Layout, inp, out, param
from rockshed.components.common.roles import Role

DIVERGED = 1

LAYOUT = Layout(
    (
        param("stiffness", "stiffness", 1e6, "N/m", minimum=0.0),
        param(
            "tension_ratio",
            "stiffness in tension as a part of that in compression; 0: a contact, it only pushes",
            0.0,
            minimum=0.0,
        ),
        param("length", "distance of the two bodies at which it is without force", 0.0, "m"),
        inp("lower.position.y", "position of the lower body, upwards", "m"),
        inp("lower.velocity.y", "velocity of the lower body, upwards; not used", "m/s"),
        inp("upper.position.y", "position of the upper body, upwards", "m"),
        inp("upper.velocity.y", "velocity of the upper body, upwards; not used", "m/s"),
        out("lower.force.y", "force on the lower body, upwards", "N"),
        out("upper.force.y", "force on the upper body, upwards", "N"),
        out("compression", "length - (upper position - lower position)", "m"),
        out("energy.elastic", "elastic energy", "J", role=Role.ELASTIC),
        out(
            "energy.work",
            "work that the two bodies, where they were shown, have done on the spring",
            "J",
            role=Role.WORK_INSIDE,
        ),
        out("energy.start", "elastic energy at the start", "J"),
        out(
            "energy.residual",
            "elastic - work - start: error of the balance",
            "J",
            role=Role.RESIDUAL,
        ),
    )
)
