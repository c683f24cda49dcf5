"""The ground at the toe of a rod: Smith's soil and Mogami's plate behind the ports of kinematics and waves."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from rockshed.components.catalogue import component
from rockshed.components.common.component import ComponentError

GROUND = component("ImpulsiveGround")
Z = 23311.0
"""Impedance of the SPT rod (N s/m)."""
RU, QUAKE = 20e3, 2.5e-3
LAWS = ("smith", "mogami")


def toe(port, law, **values):
    made = GROUND.instance()
    made["port"], made["law"] = port, law
    for name, value in {
        "toe.impedance": Z,
        "ultimate_resistance": RU,
        "quake": QUAKE,
        "resistance.start": RU,
        "resistance.end": RU,
        **values,
    }.items():
        made[name] = value
    made.initialise()
    return made


def lead(made, way, speed=1.0, steps=100):
    """Move the toe on by ``way`` (m) with a steady speed; returns the force at the end."""
    start, step = made["settlement"], abs(way) / speed / steps
    for number in range(steps):
        made["toe.position"] = start + way * number / steps
        made["toe.velocity"] = math.copysign(speed, way)
        made.step(0.0, step)
    return made["toe.force"]


def test_smiths_soil_by_hand():
    """Loaded to half the quake, back, to 3 Q, unloaded with the same stiffness, a gap, reloaded where it was left."""
    made = toe("kinematics", "smith")
    assert lead(made, 0.5 * QUAKE) == pytest.approx(0.5 * RU)
    assert lead(made, -0.5 * QUAKE) == pytest.approx(0.0, abs=1e-6)
    assert lead(made, 3.0 * QUAKE) == pytest.approx(RU)
    assert made["energy.plastic"] == pytest.approx(RU * 2.0 * QUAKE)
    assert made["permanent_set"] == pytest.approx(2.0 * QUAKE)
    assert lead(made, -0.25 * QUAKE) == pytest.approx(0.75 * RU)
    assert lead(made, -1.75 * QUAKE) == 0.0
    assert lead(made, 1.0 * QUAKE) == pytest.approx(0.0, abs=1e-6)
    assert lead(made, 0.5 * QUAKE) == pytest.approx(0.5 * RU)
    assert made["permanent_set"] == pytest.approx(2.0 * QUAKE)
    assert abs(made["energy.residual"]) < 1e-9


def test_smiths_damping_multiplies_the_static_resistance():
    made = toe("kinematics", "smith", damping=0.5)
    assert lead(made, 2.0 * QUAKE, speed=3.0) == pytest.approx(RU * 2.5)
    assert made["toe.mean_force"] == pytest.approx(RU * 2.5)
    assert made["energy.damping"] == pytest.approx(
        1.5 * (made["energy.plastic"] + made["energy.elastic"])
    )


def exact_smith(load, damping, end):
    """ds/dt = (c - R)/(Z + J R), R of a fresh spring: by numerical integration, for a load that only rises."""

    def rate(t, y):
        spring = min(RU, RU / QUAKE * y[0])
        return [(load - spring) / (Z + damping * spring)]

    return solve_ivp(rate, (0.0, end), [0.0], rtol=1e-11, atol=1e-15, max_step=end / 500).y[0][-1]


@pytest.mark.parametrize(("damping", "tolerance"), [(0.0, 1e-9), (0.5, 2e-6)])
@pytest.mark.parametrize("load", [12e3, 60e3])
def test_smiths_soil_under_a_wave_against_integration(load, damping, tolerance):
    made = toe("wave", "smith", damping=damping, internal_step=1e-5)
    made["toe.wave"] = load
    for number in range(20):
        made.step(number * 1e-4, 1e-4)
    assert made["settlement"] == pytest.approx(exact_smith(load, damping, 2e-3), rel=tolerance)
    assert made["toe.force"] == pytest.approx(
        load - Z * made.w[made.references["velocity.y"]] * -1.0, rel=1e-9
    )


def exact_plate(load, mass, r0, r1, rise, end):
    at_rest = lambda t, y: y[1]  # noqa: E731
    at_rest.terminal, at_rest.direction = True, -1
    found = solve_ivp(
        lambda t, y: [y[1], (load - Z * y[1] - r0 - (r1 - r0) * min(1.0, t / rise)) / mass],
        (0.0, end),
        [0.0, 0.0],
        events=at_rest,
        rtol=1e-11,
        atol=1e-14,
        max_step=end / 500,
    )
    return found.y[0][-1]


@pytest.mark.parametrize(("r0", "r1"), [(8e3, 8e3), (1e3, 50e3)])
def test_mogamis_plate_under_a_wave_against_integration(r0, r1):
    made = toe(
        "wave",
        "mogami",
        **{"resistance.start": r0, "resistance.end": r1, "resistance.time": 3e-3},
        internal_step=1e-4,
    )
    made["toe.wave"] = 30e3
    for number in range(50):
        made.step(number * 1e-4, 1e-4)
    assert made["settlement"] == pytest.approx(
        exact_plate(30e3, made["virtual_mass"], r0, r1, 3e-3, 5e-3), rel=1e-7
    )
    assert abs(made["energy.residual"]) < 1e-9 * made["energy.work.contact"]


waves = st.lists(st.floats(-80e3, 80e3), min_size=1, max_size=25)


@pytest.mark.parametrize("law", LAWS)
@settings(max_examples=40)
@given(
    loads=waves,
    damping=st.sampled_from([0.0, 0.5, 2.0]),
    stiffer=st.sampled_from([1.0, 1e3, 1e6]),
    internal=st.sampled_from([1e-5, 1e-4]),
)
def test_waves_of_any_kind_keep_the_energy_and_pull_nothing(law, loads, damping, stiffer, internal):
    """The rod gives at least what the ground gets, the books balance, and the ground never pulls."""
    made = toe("wave", law, damping=damping, quake=QUAKE / stiffer, internal_step=internal)
    given_by_rod = scale = 0.0
    for number, load in enumerate(loads):
        made["toe.wave"] = load
        made.step(number * 1e-4, 1e-4)
        mean = made["toe.mean_force"]
        given_by_rod += mean * (load - mean) / Z * 1e-4
        scale += abs(load) ** 2 / Z * 1e-4
        assert mean >= -1e-6
        assert made["toe.force"] >= 0.0
    assert made["energy.work.contact"] <= given_by_rod + 1e-9 * scale
    assert abs(made["energy.residual"]) <= 1e-8 * scale + 1e-12
    assert made["energy.plastic"] >= 0.0
    assert made["energy.damping"] >= -1e-12 * scale


def test_with_waves_a_stiff_toe_gives_the_same_set_at_any_exchange():
    """The load of a short blow: the set under exchanges of 1e-4 and 1e-6 s agree, with a spring 1000 times Z/H and 1e6 times."""
    for stiffness in (1e3 * Z / 1e-4, 1e6 * Z / 1e-4):
        sets = []
        for steps in (1, 100):
            made = toe("wave", "smith", quake=RU / stiffness)
            for number in range(30 * steps):
                made["toe.wave"] = 40e3 if number < 15 * steps else 5e3
                made.step(number * 1e-4 / steps, 1e-4 / steps)
            sets.append(made["permanent_set"])
        assert sets[0] == pytest.approx(20e3 / Z * 15e-4, rel=1e-3)
        assert sets[0] == pytest.approx(sets[1], rel=1e-9)


def held(kappa, steps=400):
    """Largest force of a plain exchange with a rod's end: velocity of the last force, force of the position, step kappa Z/k."""
    made = toe("kinematics", "smith", ultimate_resistance=1e9, quake=1.0, preload=5e8)
    step = kappa * made["step_limit"]
    place, largest = 0.0, 0.0
    for number in range(steps):
        speed = (1e4 - made["toe.force"]) / Z
        made["toe.position"], made["toe.velocity"] = place, 0.0  # held
        made.step(number * step, step)
        place += speed * step
        largest = max(largest, abs(made["toe.force"]))
    return largest


def test_the_published_limit_of_the_plain_port_is_where_held_values_become_unstable():
    assert toe("kinematics", "smith")["step_limit"] == pytest.approx(Z / (RU / QUAKE))
    assert held(0.95) < 5e4
    assert held(1.1) > 1e6
    assert toe("wave", "smith")["step_limit"] == 1e6
    with_plate = toe("settlement", "mogami")
    assert with_plate["step_limit"] == pytest.approx(with_plate["virtual_mass"] / Z)


def test_a_plate_struck_through_a_spring_keeps_its_energy_to_first_order():
    residuals = []
    for internal in (2e-5, 1e-5, 5e-6):
        made = toe("kinematics", "mogami", internal_step=internal, **{"contact.stiffness": 1e7})
        for number in range(200):
            t = number * 1e-4
            made["toe.position"], made["toe.velocity"] = (
                4e-3 * math.sin(300 * t),
                1.2 * math.cos(300 * t),
            )
            made.step(t, 1e-4)
        residuals.append(abs(made["energy.residual"]) / made["energy.work.contact"])
    assert residuals[0] < 0.03
    assert residuals[0] > residuals[1] > residuals[2]


def test_a_plate_on_smiths_soil_rings_with_its_natural_frequency_and_keeps_its_energy():
    """Under its preload, struck by an impulse too weak to yield it."""
    made = toe("settlement", "smith", preload=0.5 * RU, impulse0=5.0, internal_step=1e-5)
    omega = math.sqrt(RU / QUAKE / made["virtual_mass"])
    times, places = np.arange(1, 301) * 1e-4, []
    for time in times:
        made.step(time - 1e-4, 1e-4)
        places.append(made["settlement"])
    assert np.allclose(
        places, 5.0 / made["virtual_mass"] / omega * np.sin(omega * times), atol=2e-7
    )
    assert abs(made["energy.residual"]) < 1e-9
    assert made["permanent_set"] == pytest.approx(0.0, abs=1e-15)


@pytest.mark.parametrize("port", ["settlement", "kinematics", "wave"])
@pytest.mark.parametrize("law", LAWS)
def test_nothing_moves_under_the_preload_alone(port, law):
    made = toe(port, law, preload=0.7 * RU)
    for number in range(20):
        made.step(number * 1e-4, 1e-4)
    still = [made[name] for name in ("settlement", "permanent_set", "toe.force", "velocity.y")]
    assert still == pytest.approx([0.0] * 4, abs=1e-15)
    assert made["resistance"] == pytest.approx(0.7 * RU)
    assert abs(made["energy.residual"]) < 1e-12


# --- refusals ---


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"plate.radius": 0.2}, "does not fit into the box"),
        ({"plate.mass": 0.0, "soil.density": 0.0}, "no mass"),
        ({"resistance.start": 0.0, "resistance.end": 0.0}, "nothing stops the plate"),
        ({"resistance.start": -1.0}, "resistance.start = -1 N: allowed is 0 N or more"),
        ({"quake": 0.0}, "quake = 0 m"),
        ({"ultimate_resistance": 0.0}, "ultimate_resistance = 0 N"),
        ({"plate.radius": math.nan}, "must be a finite number"),
        ({"preload": 10.0}, "more than the ground bears"),
        ({"toe.impedance": -1.0}, "toe.impedance = -1"),
    ],
)
def test_refused(values, words):
    made = GROUND.instance()
    for name, value in values.items():
        made[name] = value
    with pytest.raises(ComponentError, match=words):
        made.initialise()


def test_all_reasons_at_once():
    made = GROUND.instance()
    made["plate.radius"], made["preload"], made["plate.mass"], made["soil.depth"] = (
        1.0,
        1e6,
        0.0,
        0.0,
    )
    assert len(made.problems()) == 3


def test_waves_need_an_impedance():
    with pytest.raises(ComponentError, match="positive impedance"):
        toe("wave", "smith", **{"toe.impedance": 0.0})


def test_a_load_that_is_no_number_stops_it():
    made = GROUND.instance()
    made.initialise()
    made["force.y"] = math.nan
    with pytest.raises(ComponentError, match="reduce the exchange step"):
        made.step(0.0, 1e-5)
