"""Ram, anvil, helmet and two cushions: against an independent integration, and the conservation laws."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from rockshed.components.common.component import ComponentError

from ..rods import HAMMER, ROD, named

IMPEDANCE = 4e5
"""Of a rod that never answers: its wave stays 0 (N s/m)."""
RAM, HELMET, STIFF, SOFT = 4000.0, 900.0, 1.5e9, 4e8


def struck(steps=2000, step=5e-6, **parameters):
    """Step a hammer on a rod without an end, and return it with its mean forces on the head."""
    settings = {
        "mass": RAM,
        "drop_height": 1.0,
        "weight": False,
        "cushion__stiffness": STIFF,
        "head__impedance": IMPEDANCE,
        "internal_step": step,
        **parameters,
    }
    hammer = named(HAMMER.instance(), settings)
    hammer.initialise()
    force = []
    for number in range(steps):
        hammer.step(number * step, step)
        force.append(hammer["force"])
    return hammer, np.array(force)


def test_ram_and_helmet_on_two_cushions_move_as_two_masses_on_springs_and_a_dashpot():
    step, steps = 2e-6, 2000
    hammer, force = struck(steps, step, helmet__mass=HELMET, pile_cushion__stiffness=SOFT)

    def rates(time, state):
        ram, helmet, head, ram_speed, helmet_speed = state
        upper = max(0.0, STIFF * (ram - helmet))
        lower = max(0.0, SOFT * (helmet - head))
        return (
            *(ram_speed, helmet_speed, lower / IMPEDANCE),
            *(-upper / RAM, (upper - lower) / HELMET),
        )

    start = [0.0, 0.0, 0.0, hammer["impact_velocity"], 0.0]
    times = step * (np.arange(steps) + 0.5)
    exact = solve_ivp(rates, (0.0, steps * step), start, t_eval=times, rtol=1e-10, atol=1e-12)
    expected = np.maximum(0.0, SOFT * (exact.y[1] - exact.y[2]))
    np.testing.assert_allclose(force, expected, atol=2e-4 * expected.max(), rtol=0)


def test_a_rigid_helmet_stays_on_the_head_and_moves_as_the_law_of_its_end_says():
    step = 2e-6
    hammer, force = struck(1500, step, helmet__mass=HELMET)

    def rates(time, state):
        ram, helmet, ram_speed, helmet_speed = state
        upper = max(0.0, STIFF * (ram - helmet))
        return (
            *(ram_speed, helmet_speed),
            *(-upper / RAM, (upper - IMPEDANCE * helmet_speed) / HELMET),
        )

    start = [0.0, 0.0, hammer["impact_velocity"], 0.0]
    times = step * (np.arange(1500) + 0.5)
    exact = solve_ivp(rates, (0.0, 1500 * step), start, t_eval=times, rtol=1e-10, atol=1e-12)
    expected = IMPEDANCE * exact.y[3]
    assert expected.min() > 0.0  # they have not parted yet
    np.testing.assert_allclose(force, expected, atol=2e-4 * expected.max(), rtol=0)


@settings(max_examples=30)
@given(
    ram=st.floats(50.0, 2e4),
    helmet=st.floats(50.0, 5e3),
    anvil=st.sampled_from([0.0, 300.0, 2000.0]),
    second=st.sampled_from([0.0, 1e8, 1e10]),
    restitution=st.floats(0.2, 1.0),
    gas=st.sampled_from([0.0, 4e5]),
)
def test_no_blow_gains_energy_and_the_account_closes(ram, helmet, anvil, second, restitution, gas):
    hammer, _ = struck(
        1500,
        2e-5,
        mass=ram,
        weight=True,
        helmet__mass=helmet,
        anvil__mass=anvil,
        pile_cushion__stiffness=second,
        pile_cushion__restitution=restitution,
        cushion__restitution=restitution,
        gas__force=gas,
    )
    start = hammer["energy.start"]
    assert abs(hammer["energy.residual"]) < 1e-9 * start
    assert hammer["energy.cushion_loss"] > -1e-9 * start
    assert hammer["energy.contact"] > -1e-7 * start
    if gas == 0.0:
        assert hammer["energy.supplied"] == 0.0


def test_momentum_goes_into_the_rod_and_nowhere_else():
    hammer, force = struck(4000, helmet__mass=HELMET, pile_cushion__stiffness=SOFT)
    left = RAM * hammer["velocity"] + HELMET * hammer["helmet.velocity"]
    begun = RAM * hammer["impact_velocity"]
    assert left + force.sum() * 5e-6 == pytest.approx(begun, rel=1e-10)


def test_gas_holds_its_force_on_the_ram_and_then_loses_it_evenly():
    """Ram and anvil would part; the gas presses on both until it is over."""
    hammer, _ = struck(
        0, mass=500.0, anvil__mass=50.0, gas__force=5e5, gas__hold=3e-3, gas__end=5e-3
    )
    speed = [hammer["velocity"]]
    for number in range(1400):
        hammer.step(number * 5e-6, 5e-6)
        speed.append(hammer["velocity"])
    at = 5e-6 * (np.arange(1400) + 0.5)
    on_ram = -500.0 * np.diff(speed) / 5e-6
    held = (at > 2e-3) & (at < 3e-3)
    np.testing.assert_allclose(on_ram[held], 5e5, rtol=1e-6)
    falling = (at > 3.1e-3) & (at < 4.9e-3)
    np.testing.assert_allclose(on_ram[falling], 5e5 * (5e-3 - at[falling]) / 2e-3, rtol=1e-6)
    np.testing.assert_allclose(on_ram[at > 5.1e-3], 0.0, atol=1e-3)
    assert hammer["energy.supplied"] > 0.0


def test_a_softer_second_cushion_spares_the_pile_and_a_helmet_alone_raises_the_force():
    _, bare = struck()
    _, capped = struck(helmet__mass=HELMET)
    _, soft = struck(helmet__mass=HELMET, pile_cushion__stiffness=0.3 * SOFT)
    assert soft.max() < 0.9 * bare.max() < 0.9 * capped.max()


@pytest.mark.parametrize(
    ("parameters", "words"),
    [
        ({"helmet__mass": 100.0, "port": "kinematics"}, "need the wave of the rod"),
        ({"helmet__mass": 100.0, "cushion__stiffness": 0.0}, "need a cushion below the ram"),
        ({"pile_cushion__stiffness": 1e8}, "needs a helmet"),
        ({"gas__force": 1e5, "gas__end": 1e-3}, "before it has lost its force"),
        ({"helmet__mass": 1e-3, "step": 5e-5}, "too light for the step"),
    ],
)
def test_a_train_that_cannot_stand_is_refused(parameters, words):
    with pytest.raises(ComponentError, match=words):
        struck(5, **parameters)


def test_a_second_blow_finds_the_train_as_new():
    hammer, force = struck(
        4000, 5e-6, helmet__mass=HELMET, pile_cushion__stiffness=SOFT, blow__interval=10e-3
    )
    assert hammer["blows"] == 2
    first, second = force[:1000], force[2000:3000]
    np.testing.assert_allclose(second, first, atol=1e-6 * first.max())
    assert abs(hammer["energy.residual"]) < 1e-9 * hammer["energy.start"]


def test_the_rod_takes_what_the_train_gives():
    """With the rod of the wave port, the works on both sides of the head add to nothing."""
    rod = named(ROD.instance(segments=50), {"head__port": "waves", "exchange": "sequential"})
    rod.initialise()
    step = rod["time_step"]
    hammer = named(
        HAMMER.instance(),
        {
            "mass": 63.5,
            "cushion__stiffness": 1e8,
            "helmet__mass": 20.0,
            "pile_cushion__stiffness": 2e7,
            "head__impedance": rod["head.impedance"],
            "internal_step": step,
        },
    )
    hammer.initialise()
    for number in range(500):
        hammer["head.wave"] = rod["head.wave"]
        hammer.step(number * step, step)
        rod["head.force"] = hammer["force"]
        rod.step(number * step, step)
    both = hammer["energy.work.head"] + rod["energy.work.head"]
    assert abs(both) < 1e-9 * hammer["energy.start"]
