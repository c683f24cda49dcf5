"""The event-driven motion against a program of its own that steps through time, and finds its accelerations and impulses by solving
the equations of motion as linear systems.
"""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from tests.slope_rocks import G, mode, slope

MASS, RADIUS, FRICTION, ROUGHNESS, RESISTANCE = 14.0, 0.01, 0.4, 0.08, 2e4
STRENGTH, STIFFNESS, HARDENING = 1e10, 4e12, 0.5
ANGLE, END, TIMES = math.radians(30.0), 12.0, np.arange(1.0, 12.1, 1.0)
INERTIA = 0.4 * MASS * RADIUS**2
AREA = 0.25 * math.pi * RADIUS**2
NODES = [(-200.0, 200.0 * math.tan(ANGLE)), (0.0, 0.0), (500.0, 0.0)]
START = {"position0__x": -60.0, "position0__y": 60.0 * math.tan(ANGLE) + 4.0, "velocity0__x": 3.0}


def solve_line(angle, u, omega, tilt):
    """(1) as linear equations for u', omega', P, S: without slip first, else with the friction of the present slip."""
    s, c, slip = math.sin(tilt), math.cos(tilt), u + RADIUS * omega
    drag = math.pi * RADIUS**2 * RESISTANCE
    matrix = np.array([[MASS, 0, s, c], [0, 0, c, -s], [0, INERTIA, 0, RADIUS], [1, RADIUS, 0, 0]])
    right = np.array([MASS * G * math.sin(angle) - drag, MASS * G * math.cos(angle), 0.0, 0.0])
    if abs(slip) < 1e-6:
        found = np.linalg.solve(matrix, right)
        if abs(found[3]) <= FRICTION * found[2]:
            return found[0], found[1], True
        slip = found[3]
    matrix[3] = (0, 0, -math.copysign(FRICTION, slip), 1)
    found = np.linalg.solve(matrix, right)
    return found[0], found[1], False


def penetrate(v, pull):
    """Penetration and restitution: work of the ground N(delta) integrated, gravity counted on both ways."""

    def missing(delta):
        a = STIFFNESS * delta / STRENGTH
        work = STRENGTH * AREA * (delta - STRENGTH / STIFFNESS * (1.0 - math.exp(-a)))
        return work - 0.5 * MASS * v * v - MASS * pull * delta

    delta = brentq(missing, 2.0 * MASS * pull / (STIFFNESS * AREA), 100.0, xtol=1e-15)
    force = STRENGTH * AREA * (1.0 - math.exp(-STIFFNESS * delta / STRENGTH))
    back = HARDENING * force**2 / (2.0 * STIFFNESS * AREA) - MASS * pull * delta
    return delta, math.sqrt(max(0.0, 2.0 * back / MASS)) / abs(v)


def solve_impact(angle, u, v, omega):
    """(19) as linear equations for u2, v2, omega2 and both impulses."""
    delta, e = penetrate(v, G * math.cos(angle))
    tilt = min(
        0.5 * math.acos(max(-1.0, 1.0 - delta / RADIUS)), math.atan(abs(u) / ((1.0 + e) * abs(v)))
    )
    s, c = math.sin(tilt), math.cos(tilt)
    matrix = np.array(
        [
            [MASS, 0, 0, s, c],
            [0, MASS, 0, -c, s],
            [0, 0, INERTIA, 0, RADIUS],
            [0, 1, 0, 0, 0],
            [1, 0, RADIUS, 0, 0],
        ]
    )
    right = np.array([MASS * u, MASS * v, INERTIA * omega, -e * v, 0.0])
    found = np.linalg.solve(matrix, right)
    if abs(found[4]) > FRICTION * found[3]:
        matrix[4] = (0, 0, 0, -math.copysign(FRICTION, found[4]), 1)
        right[4] = 0.0
        found = np.linalg.solve(matrix, right)
    return found[:3]


class Stepper:
    """The same rock in steps of dt: explicit Euler, events where a step has passed them. RADIUS is small against everything."""

    def __init__(self, dt):
        self.dt, self.flying = dt, True
        self.x, self.y = START["position0__x"], START["position0__y"]
        self.vx, self.vy, self.omega = START["velocity0__x"], 0.0, 0.0

    def surface(self):
        """Inclination of the cell below, and height of a centre that touches it; the two cells meet on their bisector."""
        angle = ANGLE if self.x < RADIUS * math.tan(0.5 * ANGLE) else 0.0
        return angle, RADIUS / math.cos(angle) - self.x * math.tan(angle)

    def strike(self, angle):
        s, c = math.sin(angle), math.cos(angle)
        u, v, self.omega = solve_impact(
            angle, self.vx * c - self.vy * s, self.vx * s + self.vy * c, self.omega
        )
        self.flying = v * v > 2.0 * G * c * ROUGHNESS * RADIUS
        v = v if self.flying else 0.0
        self.vx, self.vy = u * c + v * s, v * c - u * s
        self.angle = angle

    def step(self):
        if self.flying:
            self.x, self.y = self.x + self.dt * self.vx, self.y + self.dt * self.vy
            self.vy -= G * self.dt
            angle, ground = self.surface()
            if self.y < ground:
                self.y = ground
                if self.vx * math.sin(angle) + self.vy * math.cos(angle) < 0.0:
                    self.strike(angle)
            return
        angle, s, c = self.angle, math.sin(self.angle), math.cos(self.angle)
        u = self.vx * c - self.vy * s
        if u == 0.0:
            return
        gain, turn, grips = solve_line(angle, u, self.omega, 0.5 * math.acos(1.0 - ROUGHNESS))
        before = u + RADIUS * self.omega
        self.x += self.dt * u * c
        u, self.omega = u + self.dt * gain, self.omega + self.dt * turn
        if not grips and before * (u + RADIUS * self.omega) <= 0.0:
            self.omega = -u / RADIUS
        u = max(u, 0.0)
        self.vx, self.vy = u * c, -u * s
        angle, self.y = self.surface()
        if angle != self.angle:
            self.strike(angle)


def stepped(dt):
    rock, rows, per_second = Stepper(dt), [], round(1.0 / dt)
    for i in range(round(END / dt)):
        rock.step()
        if (i + 1) % per_second == 0:
            rows.append((rock.x, rock.y))
    return np.array(rows)


@pytest.fixture(scope="module")
def exact():
    rock = slope(
        NODES,
        mass=MASS,
        radius=RADIUS,
        friction=FRICTION,
        roughness=ROUGHNESS,
        resistance=RESISTANCE,
        strength=STRENGTH,
        stiffness=STIFFNESS,
        hardening=HARDENING,
        **START,
    )
    rows, modes = [], set()
    for i in range(round(100 * END)):
        rock.step(i / 100, 0.01)
        modes.add(mode(rock))
        if (i + 1) % 100 == 0:
            rows.append((rock["position.x"], rock["position.y"]))
    assert {"flight", "rolling"} <= modes
    assert rock["impacts"] >= 4
    assert rows[-1][0] > 0.0
    return np.array(rows)


def test_time_stepping_converges_to_the_events_at_first_order(exact):
    steps = np.array([2e-3, 1e-3, 5e-4, 2.5e-4, 1.25e-4])
    errors = np.array([np.abs(stepped(dt) - exact).mean() for dt in steps])
    order = np.polyfit(np.log(steps), np.log(errors), 1)[0]
    assert 0.7 < order < 1.3
    assert errors[-1] < 0.15 * errors[0]
