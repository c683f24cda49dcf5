"""Hand-over: flight into the receiver, motion under forces there, and back to the slope."""

import math

import pytest

from rockshed.components.catalogue import component
from rockshed.components.common.component import ComponentError
from tests.slope_rocks import G, mode, slope

FALLING = component("FallingRock")
BOX = {
    "receiver__present": 1.0,
    "receiver__left": 5.0,
    "receiver__right": 12.0,
    "receiver__bottom": -2.0,
    "receiver__top": 4.0,
}
LEVEL = [(-50, 0), (50, 0)]
STATE = ("position.x", "position.y", "angle", "velocity.x", "velocity.y", "angular_velocity")


def thrown(**values):
    start = {
        "position0__x": 0.0,
        "position0__y": 3.0,
        "velocity0__x": 10.0,
        "velocity0__y": 0.0,
        "mass": 1000.0,
    }
    return slope(LEVEL, **{**start, **BOX, **values})


def test_a_rock_is_handed_over_when_its_centre_enters():
    rock = thrown()
    assert rock["handover.time"] == 1e30
    rock.step(0.0, 0.4)
    assert (mode(rock), rock["received"], rock["next_event.time"]) == (
        "flight",
        0.0,
        pytest.approx(0.5, rel=1e-12),
    )
    rock.step(0.4, 0.2)
    assert (mode(rock), rock["received"], rock["handovers"]) == ("received", 1.0, 1.0)
    assert rock["handover.time"] == pytest.approx(0.5, rel=1e-12)
    assert rock["position.y"] == pytest.approx(3.0 - G * 0.36 / 2, rel=1e-12)


def test_without_force_the_flight_in_the_receiver_is_exact_whatever_the_step():
    """Up and over the floor, which is not there inside the box: it leaves through the side."""
    one, many = thrown(velocity0__y=4.0), thrown(velocity0__y=4.0)
    one.step(0.0, 1.15)
    for i in range(1150):
        many.step(i * 1e-3, 1e-3)
    assert one["received"] == 1.0
    assert [one[name] for name in STATE] == [many[name] for name in STATE]


def test_under_forces_it_moves_like_the_falling_rock_bit_for_bit():
    rock = slope(
        LEVEL,
        position0__x=6.0,
        position0__y=1.0,
        velocity0__x=1.0,
        velocity0__y=-3.0,
        angular_velocity0=2.0,
        mass=7.0,
        radius=0.2,
        receiver__present=1.0,
        receiver__left=0.0,
        receiver__right=20.0,
        receiver__bottom=-5.0,
        receiver__top=20.0,
    )
    other = FALLING.instance()
    for name in (
        "position0.x",
        "position0.y",
        "velocity0.x",
        "velocity0.y",
        "angular_velocity0",
        "mass",
        "radius",
    ):
        other[name] = rock[name]
    other.initialise()
    for i in range(400):
        for body in (rock, other):
            body["force.x"], body["force.y"], body["torque"] = (
                3.0 + i,
                40.0 * math.sin(0.1 * i) + 90.0,
                0.1 * i - 5.0,
            )
            body.step(i * 1e-4, 1e-4)
    assert [rock[name] for name in STATE] == [other[name] for name in STATE]
    for name in ("energy.kinetic", "energy.gravity", "energy.work.contact", "energy.residual"):
        assert rock[name] == pytest.approx(other[name], rel=1e-12, abs=1e-9)


def test_a_rock_hits_bounces_and_rolls_on():
    """A cushion, here a spring with a dashpot under y = 1, throws it back; it flies out of the box and lands on the slope."""
    rock = thrown(friction=0.6, roughness=0.05)
    modes, work, lowest, step = [], 0.0, 1e9, 1e-4
    for i in range(120_000):
        depth = 1.0 - (rock["position.y"] - 0.5)
        touches = rock["received"] == 1.0 and depth > 0.0
        force = max(0.0, 4e5 * depth - 4e3 * rock["velocity.y"]) if touches else 0.0
        before = rock["position.y"]
        rock["force.y"] = force
        rock.step(i * step, step)
        work += force * (rock["position.y"] - before)
        lowest = min(lowest, rock["position.y"])
        if not modes or modes[-1] != mode(rock):
            modes.append(mode(rock))
    assert modes[:3] == ["flight", "received", "flight"]
    assert {"rolling", "rest"} <= set(modes)
    assert lowest < 1.5
    assert rock["position.x"] > 12.0
    assert rock["energy.work.contact"] == pytest.approx(work, rel=1e-3)
    assert abs(rock["energy.residual"]) < 2e-3 * rock["energy.start"]


def test_it_may_come_back_into_the_receiver():
    """A box in the air over a hard floor, passed on the way down, up and down again."""
    rock = slope(
        LEVEL,
        position0__x=0.0,
        position0__y=6.0,
        velocity0__x=0.0,
        hardening=0.9,
        strength=1e9,
        stiffness=1e8,
        receiver__present=1.0,
        receiver__left=-1.0,
        receiver__right=1.0,
        receiver__bottom=2.0,
        receiver__top=3.0,
    )
    rock.step(0.0, 1.8)
    assert rock["impacts"] == 1
    assert rock["handovers"] == 2
    assert mode(rock) == "flight"
    assert rock["position.y"] > 3.0


def test_a_force_on_a_rock_that_is_not_handed_over_is_refused():
    rock = thrown()
    rock["force.y"] = 10.0
    with pytest.raises(
        ComponentError, match=r"force \(0, 10\) N.*is not handed over: enlarge the receiver"
    ):
        rock.step(0.0, 0.1)


def test_a_rock_that_leaves_below_the_surface_is_refused():
    rock = thrown(receiver__right=30.0)
    with pytest.raises(ComponentError, match="is below the slope's surface"):
        rock.step(0.0, 5.0)


@pytest.mark.parametrize("force", [math.nan, math.inf])
def test_a_force_that_is_no_number_stops_it(force):
    rock = thrown(position0__x=6.0)
    rock["force.x"] = force
    with pytest.raises(ComponentError, match="reduce the exchange step"):
        rock.step(0.0, 1e-4)


# --- a start shortly before the hand-over ---

ALL = (
    "position.x",
    "position.y",
    "angle",
    "velocity.x",
    "velocity.y",
    "angular_velocity",
    "mode",
    "height",
    "impacts",
    "received",
    "energy.kinetic",
    "energy.impact",
    "energy.roughness",
)
ROUGH = {
    "roughness": 0.1,
    "roughness_deviation": 0.03,
    "tilt_deviation": 0.1,
    "hardening": 0.7,
    "friction": 0.5,
    "tilt__meaning": "absolute",
}


def bouncing(**values):
    """It bounces along the slope before it comes into the box, over a cliff."""
    start = {"position0__x": -20.0, "position0__y": 14.0, "velocity0__x": 6.0, "trial": 3}
    box = {
        "receiver__present": 1.0,
        "receiver__left": 5.0,
        "receiver__right": 12.0,
        "receiver__bottom": -8.0,
        "receiver__top": 8.0,
    }
    return slope([(-50, 20), (5, -2), (6, -12), (50, -12)], **{**start, **box, **ROUGH, **values})


@pytest.mark.parametrize("lead", [0.0, 0.02, 1.7])
def test_with_a_lead_time_it_is_the_same_trial_from_there_on(lead):
    entry, late = bouncing_entry(), bouncing(lead_time=lead)
    begun = math.floor((entry - lead) * 1e12 + 0.5) / 1e12
    again = bouncing()
    again.step(0.0, begun)
    assert [late[name] for name in ALL] == [again[name] for name in ALL]
    assert late["impacts"] > 0
    for i in range(8):
        again.step(begun + 0.25 * i, 0.25)
        late.step(3.0 + 0.25 * i, 0.25)  # the tool's clock may begin at any time
        assert [late[name] for name in ALL] == [again[name] for name in ALL]
    assert late["handover.time"] == pytest.approx(3.0 + lead, abs=1e-9)


def test_a_lead_time_longer_than_the_way_begins_at_the_start():
    rock = bouncing(lead_time=1e3)
    assert (rock["position.x"], rock["impacts"]) == (-20.0, 0.0)
    rock.step(0.0, bouncing_entry() + 0.1)
    assert rock["handover.time"] == bouncing_entry()


def bouncing_entry():
    """When it enters the box, without a lead time (s)."""
    rock, time = bouncing(), 0.0
    while rock["received"] == 0.0 and time < 20.0:
        rock.step(time, 0.01)
        time += 0.01
    assert 2.0 < rock["handover.time"] < 20.0
    return rock["handover.time"]


def test_a_rock_that_never_enters_has_no_lead_time():
    with pytest.raises(
        ComponentError,
        match="trial 3 of seed 1 never enters the receiver, and lead_time counts from there",
    ):
        bouncing(
            lead_time=0.1,
            receiver__left=60.0,
            receiver__right=61.0,
            receiver__top=100.0,
            receiver__bottom=90.0,
        )
