"""The FMU of the rock on its slope: the same trajectory whatever the steps, and states that lead back to any moment of it."""

import pytest

from rockshed.components.catalogue import component
from rockshed.fmus.build import Runtime

from .host import DISCARD, ERROR, OK, Host


@pytest.fixture(params=list(Runtime))
def either(request):
    """The FMU with Python inside and the native one."""
    with Host(request.getfixturevalue(f"{request.param}_fmus")["SlopeRockfall"], "rock") as host:
        yield host


@pytest.fixture
def rock(fmus):
    with Host(fmus["SlopeRockfall"], "rock") as host:
        yield host


def trajectory(fmus, step, every):
    """All outputs at every second of three."""
    with Host(fmus["SlopeRockfall"]) as host:
        host.start(seed=2, trial=3)
        rows = []
        for second in range(3):
            host.steps(every, step, first=every * second)
            rows.append(host.outputs())
    return rows


def test_steps_of_any_length_give_the_same_outputs_bit_for_bit(fmus):
    whole = trajectory(fmus, 1.0, 1)
    assert trajectory(fmus, 1e-2, 100) == whole
    assert trajectory(fmus, 1e-4, 10_000) == whole
    assert whole[-1]["impacts"] > 0


def test_the_fmu_is_the_component(fmus, rock):
    instance = component("SlopeRockfall").instance()
    instance["trial"] = 8
    instance.initialise()
    rock.start(trial=8)
    for i in range(10):
        instance.step(float(i), 1.0)
        assert rock.step(float(i), 1.0) == OK
        assert rock["position.y"] == instance["position.y"]


BOX = {
    "receiver.present": True,
    "receiver.left": 60.0,
    "receiver.right": 62.0,
    "receiver.bottom": -100.0,
    "receiver.top": 200.0,
}


@pytest.mark.parametrize("moment", [3, 73, 74, 75, 90])
def test_a_state_leads_back_to_any_moment(rock, moment):
    """Before, at and after the hand-over and in a later flight."""
    rock.start(**BOX)
    rock.steps(moment, 0.1)
    saved, before = rock.state(), rock.outputs()
    rock.steps(15, 0.1, first=moment)
    after = rock.outputs()
    rock.restore(saved)
    assert rock.outputs() == before
    rock.steps(15, 0.1, first=moment)
    assert rock.outputs() == after
    assert after["position.x"] > before["position.x"]


def test_all_that_is_wrong_with_the_profile_is_logged(rock):
    rock.start(**{"end.x[3]": 1.0, "friction[7]": 20.0})
    (text,) = rock.errors()
    assert "cell 3 (end.x[3] = 1 m): its right node must lie to the right" in text
    assert "cell 7 (friction[7] = 20, roughness[7] up to 0.1588, mu tan(phi) = " in text
    assert rock.step(0.0, 0.1) == DISCARD


@pytest.mark.parametrize(
    ("values", "reason"),
    [
        (
            {"end.x[3]": 1.0},
            "cell 3 (end.x[3] = 1 m): its right node must lie to the right of its left node",
        ),
        ({"end.x[3]": 12.001}, "cell 3 (end.x[3] = 12.001 m): it is steeper than 89.9 degrees"),
        (
            {"friction[7]": 20.0},
            "cell 7 (friction[7] = 20, roughness[7] up to 0.1588, mu tan(phi) = 5.87",
        ),
        (
            {"roughness[2]": 1.98},
            "cell 2 (roughness[2] = 1.98, largest 2.0388): roughness with its deviation reaches 2",
        ),
        ({"hardening[4]": 1.2}, "hardening[4] = 1.2: allowed is 0 to 1"),
        ({"position0.y": 90.0}, "the rock starts below the surface: its lowest point is at -"),
        ({"receiver.present": True}, "the receiver is empty"),
        ({"lead_time": 0.1}, "never enters the receiver"),
    ],
)
def test_both_runtimes_refuse_the_same_in_the_same_words(either, values, reason):
    either.start(**values)
    assert reason in " ".join(either.errors())
    assert either.step(0.0, 0.1) in (DISCARD, ERROR)


def test_a_force_outside_the_receiver_is_discarded_with_its_reason(rock):
    rock.start()
    rock["force.x"] = 1.0
    assert rock.step(0.0, 0.1) == DISCARD
    assert "is not handed over: enlarge the receiver" in rock.errors()[0]
