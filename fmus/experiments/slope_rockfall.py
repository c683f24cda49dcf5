"""Experiments on the rock on a slope: flight, impact, rolling and sliding on planes."""

from collections.abc import Mapping
from dataclasses import astuple, dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from rockshed.components.common.ports import Sizes
from rockshed.components.common.units import standard_gravity as _g

from .declaration import Expected, Experiment, Given, Purpose, near, rows

_MASS, _RADIUS = 1361.3568165555769, 0.5
_ROUNDING = 1e-9
_PICOSECOND = 1e-9
"""Share for the whole picoseconds in which the component counts time."""
_FLIGHT, _ROLLING, _SLIDING = 1.0, 2.0, 3.0
"""Modes of motion, as the output counts them."""


def experiments(sizes: Sizes) -> tuple[Experiment, ...]:
    """Return the experiments.

    Parameters
    ----------
    sizes : mapping of str to int
        Of the FMU: the number of cells of the profile.
    """
    cells = sizes["cells"]
    return (
        _flight(cells),
        _roll(cells),
        _slide(cells),
        _slip_ends(cells),
        _bounce(cells, 0.4, Purpose.VALIDATION),
        _soil(cells),
        _received(cells),
        *(_bounce(cells, share, Purpose.UNCERTAINTY) for share in (0.3, 0.35, 0.45)),
    )


def _plane(cells: int, angle: float, **values: float) -> Mapping[str, Given]:
    """Return the parameters of a plane that descends to the right by an angle (rad), no chance."""
    length = 1000.0
    ends = length * np.arange(1, cells + 1)
    zero = dict.fromkeys(
        ("tilt", "tilt_deviation", "roughness", "roughness_deviation", "resistance"), 0.0
    )
    of_cells = {**zero, **values}
    return {
        "limit_speed.mean": 1e6,
        "limit_speed.deviation": 0.0,
        "profile.x": -length,
        "profile.y": length * float(np.tan(angle)),
        "end.x": tuple(ends - length),
        "end.y": tuple(np.tan(angle) * (length - ends)),
        **{name: (value,) * cells for name, value in of_cells.items()},
    }


def _energies(
    speed2: "NDArray[np.float64]", spin2: "NDArray[np.float64]", height: "NDArray[np.float64]"
) -> dict[str, Expected]:
    """Return what is expected of the energies of a sphere."""
    inertia = 0.4 * _MASS * _RADIUS**2
    kinetic = _MASS * speed2 / 2.0 + inertia * spin2 / 2.0
    scale = float(np.abs(kinetic).max() + np.abs(_MASS * _g * height).max())
    return {
        "energy.kinetic": Expected(kinetic, _ROUNDING * scale),
        "energy.gravity": Expected(_MASS * _g * height, _ROUNDING * scale),
        "energy.residual": Expected(0.0, _ROUNDING * scale),
    }


def _flight(cells: int) -> Experiment:
    step, steps = 0.05, 12
    t = rows(step, steps)
    x, y = 1.0 + 1.5 * t, 102.0 - _g * t**2 / 2.0
    speed = -_g * t
    slope = np.arctan2(4.0, 6.0)
    # the centre meets the ground where it is a radius away from the first cell
    meets = brentq(
        lambda s: (
            (102.0 - _g * s**2 / 2.0 - 100.0) * np.cos(slope)
            + (1.0 + 1.5 * s) * np.sin(slope)
            - _RADIUS
        ),
        0.1,
        3.0,
        xtol=1e-15,
    )
    return Experiment(
        "flight",
        Purpose.SMOKE,
        "From its start values the rock flies on a parabola; next_event.time is when it meets the "
        "first cell, 4 down on 6 m. To rounding, and times to a picosecond.",
        step,
        steps,
        {
            "position.x": near(x, _ROUNDING),
            "position.y": near(y, _ROUNDING),
            "velocity.x": near(1.5, _ROUNDING),
            "velocity.y": near(speed, _PICOSECOND),
            "mode": Expected(_FLIGHT, 0.0),
            "impacts": Expected(0.0, 0.0),
            "next_event.time": near(meets, _PICOSECOND),
            **_energies(1.5**2 + speed**2, np.zeros_like(t), y),
        },
        {"end.x": _stairs(cells, 6.0, 0.0), "end.y": _stairs(cells, -4.0, 100.0)},
    )


_RECEIVER = {
    "receiver.present": 1.0,
    "receiver.left": 0.0,
    "receiver.right": 20.0,
    "receiver.bottom": 10.0,
    "receiver.top": 40.0,
}
"""Box above the plane in which the rock is from the start on."""


def _received(cells: int) -> Experiment:
    """Rock in the receiver under force and torque."""
    step, steps, dt = 1e-3, 20, 1e-5
    t = rows(step, steps)
    force_x, force_y, torque, spin0 = 2e3, 5e3, 300.0, 0.5
    ax, ay = force_x / _MASS, force_y / _MASS - _g
    alpha = torque / (0.4 * _MASS * _RADIUS**2)
    way_x, way_y = 3.0 * t + ax * t**2 / 2.0, -2.0 * t + ay * t**2 / 2.0
    turned = spin0 * t + alpha * t**2 / 2.0
    late = 1.1 * dt * steps * step / 2.0
    return Experiment(
        "received",
        Purpose.VALIDATION,
        "In the receiver the rock moves under force, torque and weight: v = v0 + a t, x = x0 + v0 "
        "t + a t2/2, angle and spin likewise. Semi-implicit Euler has velocities and work to "
        "rounding, and places off by a dt t/2.",
        step,
        steps,
        {
            "position.x": Expected(10.0 + way_x, late * abs(ax)),
            "position.y": Expected(30.0 + way_y, late * abs(ay)),
            "angle": Expected(turned, late * alpha),
            "velocity.x": near(3.0 + ax * t, _PICOSECOND),
            "velocity.y": near(-2.0 + ay * t, _PICOSECOND),
            "angular_velocity": near(spin0 + alpha * t, _PICOSECOND),
            "energy.work.contact": near(
                force_x * way_x + force_y * way_y + torque * turned, _PICOSECOND
            ),
            "handovers": Expected(1.0, 0.0),
        },
        {
            **_plane(cells, 0.3),
            "position0.x": 10.0,
            "position0.y": 30.0,
            "velocity0.x": 3.0,
            "velocity0.y": -2.0,
            "angular_velocity0": spin0,
            **_RECEIVER,
        },
        {"force.x": force_x, "force.y": force_y, "torque": torque},
    )


def _stairs(cells: int, each: float, start: float) -> tuple[float, ...]:
    return tuple(start + each * number for number in range(1, cells + 1))


def _roll(cells: int) -> Experiment:
    angle, step, steps = 0.3, 0.1, 20
    t = rows(step, steps)
    speed = 5.0 / 7.0 * _g * np.sin(angle) * t
    way = speed * t / 2.0
    y = _RADIUS / np.cos(angle) - way * np.sin(angle)
    return Experiment(
        "rolling",
        Purpose.VALIDATION,
        "A sphere rolls down a smooth plane of 0.3 rad: 5/7 g sin of the angle. To rounding.",
        step,
        steps,
        {
            "position.x": near(way * np.cos(angle), _PICOSECOND),
            "position.y": near(y, _PICOSECOND),
            "velocity.x": near(speed * np.cos(angle), _PICOSECOND),
            "angular_velocity": near(-speed / _RADIUS, _PICOSECOND),
            "mode": Expected(_ROLLING, 0.0),
            **_energies(speed**2, (speed / _RADIUS) ** 2, y),
        },
        {**_plane(cells, angle, friction=0.9), "on_slope": 1.0, **_standing(0.0)},
    )


def _standing(speed: float) -> dict[str, float]:
    """Return a start at x = 0 with a velocity to the right."""
    return {"position0.x": 0.0, "velocity0.x": speed, "velocity0.y": 0.0}


def _slide(cells: int) -> Experiment:
    angle, friction, step, steps = 0.7, 0.1, 0.1, 15
    t = rows(step, steps)
    speed = _g * (np.sin(angle) - friction * np.cos(angle)) * t
    spin = -friction * _g * np.cos(angle) / (0.4 * _RADIUS) * t
    way = speed * t / 2.0
    slipped = way + _RADIUS * spin * t / 2.0
    y = _RADIUS / np.cos(angle) - way * np.sin(angle)
    return Experiment(
        "sliding",
        Purpose.VALIDATION,
        "A sphere slides down a plane of 0.7 rad that is too smooth for rolling: g (sin - mu cos), "
        "spin from mu P r/I, friction times the way of the slip. To rounding.",
        step,
        steps,
        {
            "position.x": near(way * np.cos(angle), _PICOSECOND),
            "velocity.y": near(-speed * np.sin(angle), _PICOSECOND),
            "angular_velocity": near(spin, _PICOSECOND),
            "mode": Expected(_SLIDING, 0.0),
            "energy.friction": near(friction * _MASS * _g * np.cos(angle) * slipped, _PICOSECOND),
            **_energies(speed**2, spin**2, y),
        },
        {**_plane(cells, angle, friction=friction), "on_slope": 1.0, **_standing(0.0)},
    )


def _slip_ends(cells: int) -> Experiment:
    """Rock without spin that slides until it rolls."""
    angle, friction, speed0, step, steps = 0.2, 0.3, 6.0, 0.1, 20
    t = rows(step, steps)
    down, held = _g * np.sin(angle), friction * _g * np.cos(angle)
    turn = speed0 / (3.5 * held - down)
    slides = np.minimum(t, turn)
    rolls = np.maximum(t - turn, 0.0)
    at_turn = speed0 + (down - held) * turn
    speed = speed0 + (down - held) * slides + 5.0 / 7.0 * down * rolls
    way = speed0 * slides + (down - held) * slides**2 / 2.0
    way += at_turn * rolls + 5.0 / 7.0 * down * rolls**2 / 2.0
    spin = np.where(t < turn, -2.5 * held * slides, -speed) / _RADIUS
    return Experiment(
        "slip-ends",
        Purpose.VALIDATION,
        "A sphere without spin slides down a plane of 0.2 rad; friction turns it until it rolls, "
        "at u0/(7/2 mu g cos - g sin). To rounding, and times to a picosecond.",
        step,
        steps,
        {
            "position.x": near(way * np.cos(angle), _PICOSECOND),
            "position.y": near(_RADIUS / np.cos(angle) - way * np.sin(angle), _PICOSECOND),
            "velocity.x": near(speed * np.cos(angle), _PICOSECOND),
            "angular_velocity": near(spin, _PICOSECOND),
            "mode": Expected(np.where(t < turn, _SLIDING, _ROLLING), 0.0),
            **_energies(speed**2, spin**2, _RADIUS / np.cos(angle) - way * np.sin(angle)),
        },
        {
            **_plane(cells, angle, friction=friction),
            "on_slope": 1.0,
            **_standing(speed0 * np.cos(angle)),
            "velocity0.y": -speed0 * np.sin(angle),
        },
    )


@dataclass(frozen=True)
class _Jump:
    """A jump from flat ground, or the fall before the first one: SI, as it begins."""

    begin: float
    place: float
    height: float
    along: float
    up: float
    spin: float
    lost: float

    @property
    def lasts(self) -> float:
        """Time (s) to the next impact."""
        return float((self.up + np.sqrt(self.up**2 + 2.0 * _g * self.height)) / _g)

    @property
    def energy(self) -> float:
        """Kinetic energy (J) of a sphere as it begins."""
        spun = 0.4 * _RADIUS**2 * self.spin**2
        return _MASS * (self.along**2 + self.up**2 + spun) / 2.0

    def following(self, normal: float, tangential: float) -> "_Jump":
        """Return the jump after an impact with these coefficients of restitution, rolling."""
        lasts, along = self.lasts, tangential * self.along
        made = _Jump(
            self.begin + lasts,
            self.place + self.along * lasts,
            0.0,
            along,
            -normal * (self.up - _g * lasts),
            -along / _RADIUS,
            0.0,
        )
        lost = self.energy + _MASS * _g * self.height - made.energy
        return replace(made, lost=self.lost + lost)


_JUMPS = 5
"""Jumps that are compared, the fall among them."""
_SPREAD = (
    "R_n is known as 0.3 to 0.45: the height of the first jump goes with R_n2, -44 to +27 % "
    "against 0.4."
)


def _jumps(normal: float, tangential: float, fall: float, along: float) -> list[_Jump]:
    """Return the fall from a height (m) with a speed to the right (m/s), and the jumps after it."""
    jumps = [_Jump(0.0, 0.0, fall, along, 0.0, 0.0, 0.0)]
    while len(jumps) <= _JUMPS:
        jumps.append(jumps[-1].following(normal, tangential))
    return jumps


def _bounce(cells: int, normal: float, purpose: Purpose) -> Experiment:
    """Jumps on a flat cell whose coefficients of restitution are given."""
    step, fall, along, tangential = 0.05, 3.0, 2.0, 0.7
    jumps = _jumps(normal, tangential, fall, along)
    steps = int(jumps[-1].begin / step)
    t = rows(step, steps)
    number = np.searchsorted([jump.begin for jump in jumps], t, side="right") - 1
    found = np.array([astuple(jumps[each]) for each in number]).T
    begin, place, height, across, up, spin, lost = found
    since = t - begin
    y = _RADIUS + height + up * since - _g * since**2 / 2.0
    up = up - _g * since
    flat = _plane(
        cells,
        0.0,
        by_coefficients=1.0,
        normal_restitution=normal,
        tangential_restitution=tangential,
    )
    return Experiment(
        f"bounce-{100 * normal:.0f}",
        purpose,
        "Jumps on flat ground whose coefficients of restitution are given, tangential 0.7: each "
        "leaves with R_n of the normal and R_t of the tangential speed, rolling. Times to a "
        "picosecond, so heights to 1e-8. " + (_SPREAD if purpose is Purpose.UNCERTAINTY else ""),
        step,
        steps,
        {
            "position.x": near(place + across * since, 1e-8),
            "position.y": near(y, 1e-8),
            "velocity.x": near(across, 1e-8),
            "velocity.y": near(up, 1e-8),
            "angular_velocity": near(spin, 1e-8),
            "impacts": Expected(number, 0.0),
            "energy.impact": near(lost, 1e-8),
            **_energies(across**2 + up**2, spin**2, y),
        },
        {**flat, **_standing(along), "position0.y": _RADIUS + fall},
    )


_GROUND = {"strength": 8e5, "stiffness": 8e6, "hardening": 0.4}
"""Ground that yields: Pa, N/m3, 1."""


def _restitution(speed: float) -> float:
    """Return Ushiro's coefficient of restitution (24) to (27), upright and without gravity."""
    strength, stiffness = _GROUND["strength"], _GROUND["stiffness"]
    area = 0.25 * np.pi * _RADIUS**2

    def pressed(depth: float) -> float:
        return float(1.0 - np.exp(-stiffness * depth / strength))

    depth = brentq(
        lambda d: (
            d - strength / stiffness * pressed(d) - _MASS * speed**2 / (2.0 * strength * area)
        ),
        1e-9,
        2.0 * _RADIUS,
        xtol=1e-15,
    )
    force = strength * area * pressed(depth)
    return float(np.sqrt(_GROUND["hardening"] * force**2 / (_MASS * stiffness * area)) / speed)


def _soil(cells: int) -> Experiment:
    """Upright impact on ground that yields, until just before the next one."""
    step, fall = 0.05, 6.0
    speed = float(np.sqrt(2.0 * _g * fall))
    up = _restitution(speed) * speed
    lands = speed / _g
    steps = int((lands + 2.0 * up / _g) / step)
    t = rows(step, steps)
    since = t - lands
    flies = since < 0.0
    y = np.where(flies, fall - _g * t**2 / 2.0, up * since - _g * since**2 / 2.0)
    return Experiment(
        "impact-on-soil",
        Purpose.VALIDATION,
        "Ushiro's impact, upright and with gravity left out: the depth from (26), the force from "
        "(24) and the restitution from (27), then a jump upwards. Times to a picosecond.",
        step,
        steps,
        {
            "position.y": near(_RADIUS + y, 1e-8),
            "velocity.y": near(np.where(flies, -_g * t, up - _g * since), 1e-8),
            "velocity.x": Expected(0.0, 1e-9),
            "impacts": Expected(np.where(flies, 0.0, 1.0), 0.0),
            "energy.impact": near(np.where(flies, 0.0, _MASS * (speed**2 - up**2) / 2.0), 1e-8),
            "energy.residual": Expected(0.0, 1e-9 * _MASS * speed**2),
        },
        {
            **_plane(cells, 0.0, **_GROUND),
            **_standing(0.0),
            "position0.y": _RADIUS + fall,
            "restitution.gravity": "none",
        },
    )
