"""Truths of the impact systems against other formulas, and against integrations of their equations."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from rockshed.systems import (
    ball_on_beam,
    bouncing_ball,
    hammer_on_rod,
    stiff_contact,
    terminals,
    two_rates,
)
from rockshed.systems.algebraic_loop.truth import AMPLITUDE, FIRST, RATE, SECOND, displacement
from rockshed.systems.catalogue import NAMES, impact_system
from rockshed.systems.parts.ball import COMPONENT as BALL
from rockshed.systems.parts.light_mass import COMPONENT as LIGHT
from rockshed.systems.parts.mass import COMPONENT as MASS
from rockshed.systems.parts.spring import COMPONENT as SPRING


def integrated(slope, start, times):
    """Positions and velocities over time, by Runge and Kutta of high order."""
    found = solve_ivp(
        slope, (0.0, times[-1]), start, t_eval=times, rtol=1e-12, atol=1e-14, method="DOP853"
    )
    return found.y


def test_the_hammer_slows_down_as_an_exponential_until_the_first_reflection():
    truth = hammer_on_rod.truth
    times = np.linspace(0.0, 2.0 * truth.LENGTH / truth.WAVE_SPEED, 50, endpoint=False)
    decay = np.exp(-truth.IMPEDANCE / truth.MASS * times)
    np.testing.assert_allclose(truth.hammer_velocity(times), truth.SPEED * decay, rtol=1e-13)


def test_the_hammer_flies_on_with_the_velocity_of_the_separation():
    truth = hammer_on_rod.truth
    end = truth.PROBLEM.separation()
    later = truth.hammer_velocity(np.array([end * (1.0 - 1e-9), end * 1.01, end * 1.08]))
    assert later[0] == pytest.approx(later[1], rel=1e-6)
    assert later[1] == later[2] == truth.PROBLEM.rebound()


def test_the_modes_of_the_two_rates_are_an_integration_of_their_equations():
    truth = two_rates.truth
    times = np.linspace(0.0, 0.05, 101)

    def slope(_time, state):
        slow, slow_rate, light, light_rate = state
        force = truth.JOINING * (slow - light)
        return [
            slow_rate,
            (-truth.HEAVY_SPRING * slow - force) / truth.HEAVY,
            light_rate,
            (-truth.LIGHT_SPRING * light + force) / truth.LIGHT_MASS,
        ]

    start = [truth.START, 0.0, truth.start_of_light(), 0.0]
    found = integrated(slope, start, times)[0]
    np.testing.assert_allclose(truth.slow_position(times), found, atol=1e-9 * truth.START)


def test_the_modes_of_the_bodies_with_terminals_are_an_integration_of_their_equations():
    truth = terminals.truth
    times = np.linspace(0.0, 0.16, 101)

    def slope(_time, state):
        lower, lower_rate, upper, upper_rate = state
        force = truth.JOINING * (lower - upper)
        return [
            lower_rate,
            (-truth.SPRINGS[0] * lower - force) / truth.MASSES[0],
            upper_rate,
            (-truth.SPRINGS[1] * upper + force) / truth.MASSES[1],
        ]

    found = integrated(slope, [0.0, truth.SPEED, 0.0, 0.0], times)[2]
    np.testing.assert_allclose(truth.upper_position(times), found, atol=1e-11)


def test_the_ball_meets_the_table_with_the_law_of_impact():
    """At each impact both are at the same height, and the relative velocities are as -e."""
    truth = bouncing_ball.truth
    found = truth.impacts(2.0)
    assert len(found) == 7
    for time in found:
        ahead = truth.ball_height(np.array([time - 1e-6, time, time + 1e-6]))
        assert ahead[1] == pytest.approx(truth.AMPLITUDE * math.sin(truth.RATE * time), abs=1e-12)
        table = truth.AMPLITUDE * truth.RATE * math.cos(truth.RATE * time)
        before, after = np.diff(ahead) / 1e-6 - table
        assert after == pytest.approx(-truth.RESTITUTION * before, rel=1e-3)
    first = math.sqrt(2.0 * truth.HEIGHT / 9.80665)
    assert found[0] == pytest.approx(first, rel=0.01)


def test_the_struck_body_leaves_as_after_an_elastic_impact():
    truth = stiff_contact.truth
    times = np.array([0.0, math.pi / truth.RATE, 4e-3])
    first, apart, end = truth.struck_velocity(times)
    elastic = 2.0 * truth.STRIKER * truth.SPEED / (truth.STRIKER + truth.STRUCK)
    assert first == 0.0
    assert apart == pytest.approx(elastic, rel=1e-14)
    assert end == apart


def test_the_force_of_the_ball_on_the_beam_takes_its_momentum():
    truth = ball_on_beam.truth
    nodes, weights = np.polynomial.legendre.leggauss(400)
    end = ball_on_beam.SYSTEM.stop_time
    times = 0.5 * end * (nodes + 1.0)
    forces = truth.force(times)
    assert forces.min() > 0.0  # it presses until the end of the run
    impulse = 0.5 * end * float(weights @ forces)
    step = 1e-7
    pressed = truth.force(np.array([end - step, end])) / truth.STIFFNESS
    sunk = truth.deflection(np.array([end - step, end])) + pressed  # way of the ball
    speed = float(np.diff(sunk)[0]) / step
    assert impulse == pytest.approx(truth.MASS * (truth.SPEED - speed), rel=1e-4)


def test_further_modes_change_the_deflection_by_next_to_nothing(monkeypatch):
    truth = ball_on_beam.truth
    times = np.linspace(0.0, 4e-3, 41)
    few = truth.deflection(times)
    monkeypatch.setattr(truth, "MODES", 120)
    many = truth.deflection(times)
    assert np.abs(many - few).max() < 4e-8 * np.abs(many).max()


def test_the_motion_of_ball_and_beam_solves_its_equation_to_the_digits_of_its_numbers():
    """Rates are roots of 1 = k sum(p_n^2 / m_n / (w^2 - w_n^2)), found between those of the parts."""
    truth = ball_on_beam.truth
    number = np.arange(1, 2 * truth.MODES, 2)
    line_mass = truth.DENSITY * truth.AREA
    masses = np.append(truth.MASS, np.full(truth.MODES, 0.5 * line_mass * truth.SPAN))
    bending = truth.MODULUS * truth.SECOND_MOMENT / line_mass
    own = np.append(0.0, (number * np.pi / truth.SPAN) ** 4 * bending)
    press = np.append(-1.0, (-1.0) ** np.arange(truth.MODES))
    times = np.linspace(0.0, 4e-3, 41)
    moved = np.zeros_like(times)
    for pole in range(own.size):
        distance = own - own[pole]
        gap = distance[pole + 1] if pole + 1 < own.size else (truth.STIFFNESS / masses).sum()
        above = brentq(
            lambda beyond, apart: 1.0 + (truth.STIFFNESS / masses / (apart - beyond)).sum(),
            *(1e-14 * gap, (1.0 - 1e-14) * gap),
            args=(distance,),
            xtol=1e-300,
            rtol=1e-15,
        )
        shape = press / masses / (distance - above)
        rate = np.sqrt(own[pole] + above)
        share = shape[0] * masses[0] * truth.SPEED / (rate * (masses * shape**2).sum())
        moved += (press[1:] @ shape[1:]) * share * np.sin(rate * times)
    found = truth.deflection(times)
    np.testing.assert_allclose(found, moved, rtol=0.0, atol=1e-12 * moved.max())


def test_the_two_springs_of_the_loop_bear_the_load_together():
    times = np.linspace(0.0, 0.64, 33)
    both = (FIRST + SECOND) * displacement(times)
    np.testing.assert_allclose(both, AMPLITUDE * np.sin(RATE * times), rtol=1e-14)


@pytest.mark.parametrize("name", NAMES)
def test_steps_are_multiples_of_the_finer_ones_and_of_the_time(name):
    system = impact_system(name)
    assert system.step in system.steps
    for coarse, fine in zip(system.steps, system.steps[1:]):
        assert coarse / fine == pytest.approx(round(coarse / fine), rel=1e-12)
    assert system.stop_time / system.steps[0] == pytest.approx(
        round(system.stop_time / system.steps[0]), rel=1e-12
    )


# ---------------------------------------------------------------------- their parts


@pytest.mark.parametrize("stiffness", [0.0, 3e4])
def test_a_mass_is_exact_for_a_held_force_in_any_steps(stiffness):
    ends = []
    for steps in (1, 7):
        mass = MASS.instance()
        mass["mass"], mass["stiffness"], mass["force.y"] = 2.0, stiffness, 50.0
        mass["position0.y"], mass["velocity0.y"] = 0.01, -1.0
        mass.initialise()
        for number in range(steps):
            mass.step(number * 0.021 / steps, 0.021 / steps)
        ends.append((mass["position.y"], mass["velocity.y"], mass["energy.work"]))
        assert abs(mass["energy.residual"]) < 1e-12 * mass["energy.start"]
    assert ends[0] == pytest.approx(ends[1], rel=1e-11)
    found = integrated(
        lambda _time, s: [s[1], (50.0 - stiffness * s[0]) / 2.0], [0.01, -1.0], [0.0, 0.021]
    )
    assert ends[0][:2] == pytest.approx(found[:, -1], rel=1e-9)


@pytest.mark.parametrize(("ratio", "force"), [(0.0, 0.0), (1.0, -200.0), (0.5, -100.0)])
def test_a_spring_pulls_with_its_ratio_and_pushes_in_full(ratio, force):
    spring = SPRING.instance()
    spring["stiffness"], spring["tension_ratio"] = 1e4, ratio
    spring["lower.position.y"], spring["upper.position.y"] = 0.0, 0.02
    spring.initialise()
    assert spring["upper.force.y"] == force
    spring["upper.position.y"] = -0.02
    spring.step(0.0, 1e-3)
    assert spring["upper.force.y"] == -spring["lower.force.y"] == 200.0
    assert spring["energy.elastic"] == pytest.approx(2.0)


def test_a_light_mass_diverges_beyond_its_stable_step_and_not_below():
    for share, is_stable in ((0.99, True), (1.01, False)):
        light = LIGHT.instance()
        light["position0.y"] = 1e-3
        light.initialise()
        step = share * light["stable_step"]
        largest = 0.0
        for number in range(500):
            light.step(number * step, step)
            largest = max(largest, abs(light["position.y"]))
        assert (largest < 0.1) is is_stable


def test_a_ball_that_falls_on_a_resting_table_comes_back_by_e_squared():
    ball = BALL.instance()
    ball.initialise()
    step = 0.7
    ball.step(0.0, step)
    fall = math.sqrt(2.0 * 0.5 / 9.80665)
    assert ball["impacts"] == 1.0
    assert ball["last_impact.time"] == pytest.approx(fall, rel=1e-14)
    away = 0.9 * 9.80665 * fall
    since = step - fall
    assert ball["position.y"] == pytest.approx(away * since - 0.5 * 9.80665 * since**2, rel=1e-12)


def test_a_ball_at_rest_on_the_table_is_refused_in_words():
    ball = BALL.instance()
    ball["position0.y"], ball["restitution"] = 0.0, 0.0
    ball.initialise()
    with pytest.raises(Exception, match="has come to rest on the table"):
        ball.step(0.0, 1e-3)
    table = BALL.instance()
    table["table.acceleration.y"] = -20.0
    table.initialise()
    with pytest.raises(Exception, match="falls faster than the ball"):
        table.step(0.0, 1e-3)
