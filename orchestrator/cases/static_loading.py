"""The static loading test of Sonoda et al. (1993), fig. 12.

A disc is pushed into the sand at 1 cm/s, in a box on a rigid floor.
"""

from collections.abc import Mapping

from rockshed.components.common.units import cm, kgf

from ..core.system.fields import Value
from ..core.system.parts import ComponentSpec, EnergyAlarm, SharedValue
from ..core.system.schedule import Scheme
from ..core.system.system import SystemSpec
from ..references import Known, Reference, References
from .sand_models import SandLayer
from .sonoda1993 import (
    BALL_MASS,
    BALL_RADIUS,
    BOX_WIDTH,
    DEFAULT_TEST,
    DISC_RADIUS,
    LAYER,
    SAND,
    STATIC_RATIO,
    differs,
    discs_in,
    impact_bonds,
    impact_connections,
    of_the_test,
    soil,
    tests,
)

NAME = "static-test"
DEPTH = 4 * cm
"""Penetration (m) to which the secant spring constant k counts."""
BOX = 1
"""Number of the sand box, that of 37 cm."""
DISCS = discs_in(BOX)
SPEED = 1 * cm
"""Speed of the rock, downwards (m/s)."""
GAP = 0.05 * cm
"""Distance (m) between rock and sand at the start."""
STOP = (GAP + DEPTH + 0.05 * cm) / SPEED
"""End of the run (s): a little deeper than 4 cm, for the mean of the load around it."""
_WIDTH = BOX_WIDTH[BOX]

COUPLINGS: Mapping[str, tuple[Scheme, float, str, str]] = {
    "impulse": ("sequential", 1e-3, "linear", "mean"),
    "paper": ("sequential", 1e-5, "held", "last"),
}
"""Master, exchange step (s), kinematics and forces of the sand by coupling.

impulse: sand first, the rock's motion extrapolated, which is exact here, mean forces. paper: sand
first, inputs held.
"""
_SAND_STEP = 5e-5
"""Stable up to E_bar = 200 kgf/cm2 with the calibrated sand, up to 60 with the literal one."""
E_BAR = (20.0, 40.0, 60.0, 80.0, 100.0)
"""Fictitious moduli of fig. 13 (kgf/cm2)."""


LAYER_OF_SAND = SandLayer(
    _WIDTH,
    LAYER,
    DISC_RADIUS,
    BALL_RADIUS,
    SPEED,
    soil(tests()[DEFAULT_TEST]),
    STOP + 1 * cm / SPEED,
    falling=False,
    step=4e-5,
)
"""The sand of test 4, for the models of it; the level of a random surface may be lower by 1 cm."""


def rock_height(surface: float) -> float:
    """Return the height of the rock's centre at the start.

    Parameters
    ----------
    surface : float
        Height of the sand's surface over the floor (m).

    Returns
    -------
    float
        Height over the floor (m).
    """
    return surface + BALL_RADIUS + GAP


def static_system(
    fmus: Mapping[str, str], coupling: str = "impulse", discs: int = DISCS
) -> SystemSpec:
    """Return the static test as a co-simulation of ``rock`` and ``sand``, with the sand of test 4.

    The origin is the left wall's foot.

    Parameters
    ----------
    fmus : mapping of str to str
        Files of the FMUs by component.
    coupling : str
        Key of :data:`COUPLINGS`.
    discs : int
        Number that ``sand`` was built with; the rock starts above the layer that so many make on a
        square lattice.

    Returns
    -------
    SystemSpec
        The co-simulation.
    """
    master, exchange, kinematics, forces = COUPLINGS[coupling]
    modulus = tests()[DEFAULT_TEST].modulus
    return SystemSpec(
        name=NAME,
        description="Sonoda et al. 1993, fig. 12: static loading test",
        master=master,
        order=["sand", "rock"],
        components={
            "sand": _sand(fmus["sand"], kinematics, forces),
            "rock": _rock(fmus["rock"], discs, exchange),
        },
        shared={
            "rock_radius": SharedValue(
                value=BALL_RADIUS, targets=["rock.radius", "sand.rock.radius"]
            ),
            "rock_mass": SharedValue(value=BALL_MASS, targets=["rock.mass", "sand.rock.mass"]),
        },
        connections=impact_connections(["rock"]),
        bonds=impact_bonds(["rock"]),
        energy_alarm=EnergyAlarm(share=0.005, reference=0.5 * paper_stiffness(modulus) * DEPTH**2),
        stop_time=STOP,
        exchange_step=exchange,
        output_interval=5e-3,
        state_interval=0.1,
        watch=[
            "sand.transmitted_force",
            "sand.rock.force.y",
            "sand.penetration",
            "sand.clearance",
        ],
    )


def _sand(fmu: str, kinematics: str, forces: str) -> ComponentSpec:
    parameters: dict[str, Value] = {
        "modulus": tests()[DEFAULT_TEST].modulus,
        "box.left": 0.0,
        "box.width": _WIDTH,
        "base": "floor",
        "kinematics": kinematics,
        "forces": forces,
        "internal_step": _SAND_STEP,
    }
    return ComponentSpec(fmu=fmu, record_states=True, parameters=parameters)


def _rock(fmu: str, discs: int, exchange: float) -> ComponentSpec:
    """Return the driven rock above the layer that so many discs make on a square lattice."""
    columns = round(_WIDTH / (2 * DISC_RADIUS))
    parameters: dict[str, Value] = {
        "motion": "driven",
        "shape": "disc",
        "position0.x": 0.5 * _WIDTH,
        "position0.y": rock_height(-(-discs // columns) * 2 * DISC_RADIUS),
        "velocity0.y": -SPEED,
        "internal_step": exchange,
    }
    return ComponentSpec(fmu=fmu, parameters=parameters)


def paper_stiffness(modulus: float) -> float:
    """Return the secant spring constant k that the paper computed: k = 1.29 E_bar, table 4.

    Parameters
    ----------
    modulus : float
        Fictitious modulus E_bar (Pa).

    Returns
    -------
    float
        Spring constant (N/m).
    """
    return STATIC_RATIO * modulus * cm


def references(changed: Mapping[str, Value]) -> References:
    """Return what is known of a static test with other values or sizes.

    Parameters
    ----------
    changed : mapping of str to Value
        Values and sizes that differ, by ``component.name``.

    Returns
    -------
    references : References
        With every E_bar, but only of this test.
    """
    others = [
        name
        for name in changed
        if name == "sand.damping" or (of_the_test(name) and name != "rock.position0.y")
    ]
    if others:
        return References(remarks=[f"not compared: {differs(others)}"])
    modulus = float(changed.get(SAND[0], tests()[DEFAULT_TEST].modulus))
    stiffness = paper_stiffness(modulus)
    inside = min(E_BAR) <= round(modulus / kgf * cm**2, 6) <= max(E_BAR)
    note = "table 4: k = 1.29 E_bar" + (
        "" if inside else f", extrapolated from E_bar = {min(E_BAR):g} to {max(E_BAR):g} kgf/cm2"
    )
    return References(
        {
            "secant spring constant k": Known(Reference(stiffness, note)),
            "load at 4 cm": Known(Reference(stiffness * DEPTH, note)),
        }
    )
