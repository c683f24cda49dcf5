"""Experiments on the sand: at rest, falling, settled, laws of contact, a rock driven in."""

from collections.abc import Mapping

import numpy as np
from scipy.linalg import expm

from rockshed.components.common.ports import Sizes
from rockshed.components.common.units import standard_gravity as _g

from .declaration import Expected, Experiment, Given, Purpose, SerializedState, near, rows
from .recorded import recorded, recorded_state

_RADIUS, _THICKNESS, _DENSITY, _MODULUS = 0.005, 0.1, 1799.9999999999998, 2981221.599999999
_FACTOR, _DAMPING, _TANGENTIAL = 0.342, 0.2, 0.25
_FRICTION = np.pi / 6.0
_BOX, _WIDTH, _ROCK, _ROCK_MASS = 0.41500000000000004, 0.37, 0.0495, 4.0
_AXIS = -0.025
"""Height of the beam's discs whose top is at 0 (m)."""
_DT = 1e-5
_COLUMNS = 37
_AIR = 0.8
"""Height of a rock that is far above the sand (m)."""


def experiments(sizes: Sizes) -> tuple[Experiment, ...]:
    """Return the experiments.

    Parameters
    ----------
    sizes : mapping of str to int
        Of the FMU. There are experiments for whole rows of discs on a beam of at least two.
    """
    if sizes["discs"] % _COLUMNS or not 2 <= sizes["elements"] <= 200 or sizes["discs"] > 1000:
        return ()
    return (
        _rest(sizes["discs"]),
        _squeezed(),
        _sliding(),
        _lifted(sizes),
        _fall(sizes),
        *_driven(sizes),
        *_settled(sizes),
        *(_disturbed(sizes["discs"], seed) for seed in (1, 2, 3)),
        *(_density(sizes["discs"], share) for share in (0.9, 1.1)),
    )


def _weight(discs: int) -> float:
    """Return the weight of the sand (N)."""
    return discs * _DENSITY * np.pi * _RADIUS**2 * _THICKNESS * _g


def _rest(discs: int) -> Experiment:
    weight = _weight(discs)
    layers = discs // _COLUMNS
    k = _FACTOR * _MODULUS * _THICKNESS
    each = weight / discs
    # the base is pressed by all discs of a column, every contact above by one disc less
    loads = each * np.arange(layers, 0, -1)
    elastic = _COLUMNS * float((loads**2).sum()) / (2.0 * k)
    level = 2.0 * _RADIUS * layers - float(loads.sum()) / k
    return Experiment(
        "rest",
        Purpose.SMOKE,
        "The square lattice lies at rest on the beam: the base carries the weight of all discs; "
        "each contact is pressed in by what lies above it, which gives surface and elastic energy.",
        1e-4,
        10,
        {
            "transmitted_force": near(weight, 1e-6),
            "rock.force.x": Expected(0.0, 1e-12),
            "rock.force.y": Expected(0.0, 1e-12),
            "surface_level": near(level, 1e-9),
            "surface_height": near(level, 1e-9),
            "rock.above_surface": near(1.0 - _ROCK - level, 1e-9),
            "clearance": near(1.0 - _ROCK, 1e-9),
            "penetration": Expected(0.0, 1e-12),
            "energy.elastic": near(elastic, 1e-6),
            "energy.kinetic": Expected(0.0, 1e-12),
            "energy.residual": Expected(0.0, 1e-9),
        },
    )


def _wall_contact() -> tuple[float, float, float, float]:
    """Return k_n, c_n, k_s and c_s of rock and wall: ten times the sand's, with the rock's mass."""
    k = 10.0 * _FACTOR * _MODULUS * _THICKNESS
    return (
        k,
        2.0 * _DAMPING * np.sqrt(_ROCK_MASS * k),
        _TANGENTIAL * k,
        2.0 * _DAMPING * np.sqrt(_ROCK_MASS * _TANGENTIAL * k),
    )


def _squeezed() -> Experiment:
    """Rock that is pushed into the right wall, high above the sand."""
    step, steps, speed, gap = 1e-4, 30, 0.2, 5e-5
    k, c, _, _ = _wall_contact()
    begin = _BOX + _WIDTH - _ROCK - gap
    # within a step the rock stays where it has been put
    overlap = speed * (rows(step, steps, 1) - step) - gap
    force = np.where(overlap > 0.0, -(k * overlap + c * speed), 0.0)
    return Experiment(
        "rock-against-wall",
        Purpose.VALIDATION,
        "A rock is pushed into the side wall with 0.2 m/s: k_n d + c_n v of (1), with ten times "
        "the stiffness of sand and the rock's mass in the dashpot. To rounding.",
        step,
        steps,
        {
            "rock.force.x": near(force, 1e-9),
            "rock.force.y": Expected(0.0, 1e-9 * float(np.abs(force).max())),
            "rock.torque": Expected(0.0, 1e-9 * float(np.abs(force).max())),
        },
        {},
        {
            "rock.position.x": lambda time: begin + speed * time,
            "rock.position.y": _AIR,
            "rock.velocity.x": speed,
        },
        first=1,
    )


def _sliding() -> Experiment:
    """Rock that is drawn down along the left wall."""
    step, steps, speed, overlap = 1e-4, 40, -0.2, 2e-4
    k, _, k_s, c_s = _wall_contact()
    since = rows(step, steps, 1) - step  # it is put against the wall for the second step
    normal = np.where(since > step / 2.0, k * overlap, 0.0)
    # the spring grows with every internal step until spring and dashpot reach mu N
    friction = np.minimum((k_s * since + c_s) * -speed, np.tan(_FRICTION) * normal)
    touching, apart = _BOX + _ROCK - overlap, _BOX + _ROCK + 1e-3
    return Experiment(
        "rock-along-wall",
        Purpose.VALIDATION,
        "A rock is drawn down along the side wall with 0.2 m/s: spring and dashpot of the tangent "
        "grow to mu N, and then it slides. Torque is friction times the radius. To rounding.",
        step,
        steps,
        {
            "rock.force.x": near(normal, 1e-9),
            "rock.force.y": near(friction, 1e-9),
            "rock.torque": near(-_ROCK * friction, 1e-9),
        },
        {},
        {
            "rock.position.x": lambda time: touching if time > step / 2.0 else apart,
            "rock.position.y": lambda time: _AIR + speed * time,
            "rock.velocity.y": speed,
        },
        first=1,
    )


def _lifted(sizes: Sizes) -> Experiment:
    """Sand whose beam jumps up by less than the overlaps of its own weight."""
    layers = sizes["discs"] // _COLUMNS
    step, steps, jump = 1e-4, 60, 4e-7
    k = _FACTOR * _MODULUS * _THICKNESS
    mass = _weight(sizes["discs"]) / sizes["discs"] / _g
    c = 2.0 * _DAMPING * np.sqrt(mass * k)
    chain = 2.0 * np.eye(layers) - np.eye(layers, k=1) - np.eye(layers, k=-1)
    chain[-1, -1] = 1.0  # nothing lies on the highest disc
    zero, one = np.zeros((layers, layers)), np.eye(layers)
    rates = np.block([[zero, one], [-k / mass * chain, -c / mass * chain]])
    # places count from those that the discs have when the wave has died out: the jump higher
    start = np.concatenate([np.full(layers, -jump), np.zeros(layers)])
    since = rows(step, steps, 1) - step  # it jumps when the second step begins
    motion = np.array([expm(rates * time) @ start for time in since])
    pressed = -k * motion[:, 0] - c * motion[:, layers]
    extra = np.where(since > step / 2.0, _COLUMNS * pressed, 0.0)
    return Experiment(
        "beam-lifted",
        Purpose.VALIDATION,
        "The beam jumps up by 0.4 micrometres, less than the overlaps of the sand's weight: each "
        "column swings as a chain of masses with k_n and c_n of (1) between them, solved by the "
        "exponential of its matrix. Semi-implicit Euler is off by a share of omega dt/2.",
        step,
        steps,
        {
            "transmitted_force": Expected(
                _weight(sizes["discs"]) + extra, 4e-3 * _COLUMNS * k * jump
            ),
            "rock.force.y": Expected(0.0, 1e-12),
        },
        {"internal_step": 1e-6},
        {
            "beam.position.y": (lambda time: _AXIS + (jump if time > step / 2.0 else 0.0),)
            * sizes["elements"]
        },
        first=1,
    )


def _driven(sizes: Sizes) -> tuple[Experiment, ...]:
    """Rock that is driven into the sand: no closed form is known, so what came out is kept."""
    return _pushed_in(
        "driven-rock",
        sizes,
        "A turning rock is driven into the sand with 4 m/s, beside the middle. No closed form "
        "is known: the values are what this model gave when they were recorded, for comparison "
        "of tools and versions. The bits are the same on all processors; tools round times.",
        {"kinematics": "linear"},
        0.1,
    )


_SETTLED: dict[str, Given] = {
    "packing": "prepared",
    "solid_fraction": 0.81,
    "rotation": "free",
    "kinematics": "linear",
}
"""Parameters of sand that settles until it is as dense as asked for."""


def _settled(sizes: Sizes) -> tuple[Experiment, ...]:
    """Sand that has settled, at rest and with a rock; its state is in the FMU."""
    state = recorded_state("settled-sand", sizes)
    if state is None:
        return ()
    at_rest = Experiment(
        "settled-sand",
        Purpose.VALIDATION,
        "Discs that have settled until they are as dense as asked for (to 0.01) lie at rest: the "
        "base carries their weight less what rough walls take. The state after settling is "
        "inside; a tool that takes none settles the sand by the parameters, with the same bits.",
        1e-4,
        20,
        {
            "layer.solid_fraction": Expected(float(str(_SETTLED["solid_fraction"])), 0.01),
            "transmitted_force": near(_weight(sizes["discs"]), 5e-2),
            "energy.kinetic": Expected(0.0, 1e-9),
            "energy.residual": Expected(0.0, 1e-9),
        },
        _SETTLED,
        state=state,
    )
    return at_rest, *_pushed_in(
        "rock-into-settled-sand",
        sizes,
        "The rock of driven-rock is driven into the settled sand, whose state is inside. Recorded, "
        "too.",
        _SETTLED,
        0.102,
        state,
    )


def _pushed_in(
    name: str,
    sizes: Sizes,
    description: str,
    parameters: Mapping[str, Given],
    surface: float,
    state: SerializedState | None = None,
) -> tuple[Experiment, ...]:
    """Return the recorded experiment of a turning rock that is driven in from above a surface."""
    step, steps, speed, spin = 1e-4, 60, -4.0, 5.0
    tables = recorded(name, dict(sizes))
    if not tables:
        return ()
    begin = surface + _ROCK
    return (
        Experiment(
            name,
            Purpose.SMOKE,
            description,
            step,
            steps,
            {output: near(values, 1e-6) for output, values in tables.items()},
            parameters,
            {
                "rock.position.x": 0.62,
                "rock.position.y": lambda time: begin + speed * time,
                "rock.angle": lambda time: spin * time,
                "rock.velocity.y": speed,
                "rock.angular_velocity": spin,
            },
            first=5,
            every=5,
            state=state,
        ),
    )


def _fall(sizes: Sizes) -> Experiment:
    """Sand whose beam is taken away."""
    discs = sizes["discs"]
    step, steps, sinking = 1e-3, 40, 2.0
    t = rows(step, steps, 4, 4)
    weight = _weight(discs)
    heights = weight * _RADIUS * (discs // _COLUMNS)
    fallen = _g * (t - step) ** 2 / 2.0  # the beam is away when the second step begins
    return Experiment(
        "beam-taken-away",
        Purpose.VALIDATION,
        "The beam sinks faster than the sand, from the second step on: every disc falls by g t2/2, "
        "until then the beam stays. The overlaps of its own weight open with a thousandth of the "
        "energy.",
        step,
        steps,
        {
            "transmitted_force": Expected(0.0, 1e-6 * weight),
            "energy.gravity": Expected(heights - weight * fallen, 1.5e-3 * heights),
            "energy.kinetic": Expected(weight * fallen, 1.5e-3 * heights),
        },
        {},
        {"beam.position.y": (lambda time: _AXIS - sinking * time,) * sizes["elements"]},
        first=4,
        every=4,
    )


def _disturbed(discs: int, seed: int) -> Experiment:
    weight = _weight(discs)
    return Experiment(
        f"disturbed-lattice-{seed}",
        Purpose.UNCERTAINTY,
        "Three lattices that chance has disturbed by a thousandth of a radius: the base carries "
        "the weight less what rough walls take.",
        1e-4,
        10,
        {
            "transmitted_force": near(weight, 2e-2),
            "energy.kinetic": Expected(0.0, 1e-9),
            "energy.residual": Expected(0.0, 1e-6),
        },
        {"lattice_shift": 1e-3, "seed": float(seed)},
    )


def _density(discs: int, share: float) -> Experiment:
    weight = share * _weight(discs)
    return Experiment(
        f"density-{100 * share:.0f}",
        Purpose.UNCERTAINTY,
        "Density known to 10 %: the base carries 10 % more or less.",
        1e-4,
        10,
        {
            "transmitted_force": near(weight, 1e-6),
            "energy.residual": Expected(0.0, 1e-9),
        },
        {"density": share * _DENSITY},
    )
