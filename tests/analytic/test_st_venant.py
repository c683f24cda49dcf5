"""The closed form against an integration of the delay equation, and its special cases."""

import math
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from rockshed.components.pile_rod.st_venant import StVenant


def by_steps(problem, reflections):
    """Velocity of the mass over time: M V' = -Z (V - 2 b), b = alpha (V - b)(t - tau), by Runge and Kutta between reflections."""
    period = 2.0 * problem.travel_time
    pieces, start = [], problem.speed

    def returned(time):
        n = int(time // period) - 1
        if n < 0:
            return 0.0
        return problem.reflection * (
            float(pieces[n].sol(time - period)[0]) - returned(time - period)
        )

    for n in range(reflections + 1):

        def slope(time, state, n=n):
            inside = min(max(time, n * period * (1 + 1e-15)), (n + 1) * period * (1 - 1e-12))
            return [-problem.impedance / problem.mass * (state[0] - 2.0 * returned(inside))]

        pieces.append(
            solve_ivp(
                slope,
                (n * period, (n + 1) * period),
                [start],
                rtol=1e-10,
                atol=1e-12,
                dense_output=True,
            )
        )
        start = pieces[-1].y[0, -1]
    return lambda time: float(pieces[min(int(time // period), reflections)].sol(time)[0])


@pytest.mark.parametrize("alpha", [-1.0, -0.5, 0.5, 1.0])
def test_every_reflection_is_that_of_the_delay_equation(alpha):
    problem = StVenant(mass=150.0, speed=2.0, impedance=2e4, travel_time=2e-3, reflection=alpha)
    velocity = by_steps(problem, 4)
    for time in np.linspace(1e-5, 0.0199, 41):
        assert problem.velocity(time) == pytest.approx(velocity(time), abs=1e-7 * problem.speed)


@pytest.mark.parametrize("alpha", [-1.0, -0.5, 0.5, 1.0])
@pytest.mark.parametrize("mass", [20.0, 63.5, 1000.0])
def test_force_is_what_stops_the_mass_and_ends_at_the_separation(alpha, mass):
    problem = StVenant(mass, 3.8, 23311.0, 2e-3, alpha)
    end = problem.separation()
    pieces = np.unique(np.append(np.arange(0.0, end, 4e-3), end))
    impulse = 0.0
    for left, right in pairwise(pieces):
        nodes, weights = np.polynomial.legendre.leggauss(40)
        times = left + (right - left) * 0.5 * (nodes + 1.0)
        forces = problem.force(times)
        assert forces.min() > 0.0
        impulse += 0.5 * (right - left) * float(weights @ forces)
    assert impulse == pytest.approx(mass * (problem.speed - problem.rebound()), rel=1e-9)
    assert problem.force(end * (1 + 1e-9)) <= 1e-6 * problem.first_force


def test_until_the_first_reflection_it_is_an_exponential():
    problem = StVenant(63.5, 3.8, 23311.0, 2e-3, 0.0)
    assert problem.force(1e-3) == pytest.approx(
        3.8 * 23311.0 * math.exp(-23311.0 / 63.5 * 1e-3), rel=1e-14
    )
    assert problem.separation() is None
    assert problem.rebound() is None
