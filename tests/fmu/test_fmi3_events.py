"""Early return: a step ends where the component meets an event, and what follows is the same to the last bit."""

from itertools import pairwise

import pytest
from fmpy import simulate_fmu

from rockshed.core.run import simulate
from rockshed.core.system.reading import system_from

from .host3 import Host3

BOX = {
    "receiver.present": True,
    "receiver.left": 60.0,
    "receiver.right": 62.0,
    "receiver.bottom": -100.0,
    "receiver.top": 200.0,
}
STEP, STEPS = 0.5, 30
PICOSECOND = 1e-12


def walk(host, on_event=lambda _: None, steps=STEPS, start=0.0):
    """Outputs at every communication point, and the times at which steps ended early, each of which goes on to its end."""
    rows, stops = [], []
    for i in range(steps):
        time, end = start + i * STEP, start + (i + 1) * STEP
        while time < end:
            assert host.step(time, end - time) == 0, host.messages
            event_handling, terminate, early, reached = host.told
            assert not event_handling
            assert not terminate
            assert early == (reached < end - 1e-9)
            assert reached == host["time"]
            if early:
                assert reached > time
                stops.append(reached)
                on_event(host)
            time = reached if early else end
        rows.append(host.outputs())
    return rows, stops


@pytest.fixture(scope="module")
def descent(fmi3_fmus):
    """Rows without early return, rows and stops with it, and what is seen at each stop."""
    seen = []
    with (
        Host3(fmi3_fmus["SlopeRockfall"]) as plain,
        Host3(fmi3_fmus["SlopeRockfall"], early_return=True) as stopping,
    ):
        rows, none = walk(plain.start(**BOX))
        assert none == []
        stopped_rows, stops = walk(stopping.start(**BOX), lambda host: seen.append(host.outputs()))
    return rows, stopped_rows, stops, seen


def test_the_trajectory_is_the_same_bit_for_bit(descent):
    rows, stopped_rows, stops, _ = descent
    assert stopped_rows == rows
    assert rows[-1]["impacts"] > 5
    assert rows[-1]["handovers"] == 1
    assert len(stops) > 5


def test_every_impact_is_met(descent):
    rows, _, stops, seen = descent
    impacts = [row["impacts"] for row in seen]
    met = sum(after > before for before, after in zip([0, *impacts], impacts))
    assert met == rows[-1]["impacts"] == impacts[-1]
    assert stops == sorted(set(stops))


def test_every_stop_changes_the_motion_or_the_ground(descent):
    _, _, _, seen = descent
    for before, after in pairwise(seen):
        assert any(
            after[name] != before[name] for name in ("impacts", "mode", "cell", "handovers")
        ), (before, after)


def test_a_stop_is_where_the_component_said_and_has_the_event_behind_it(descent):
    _, _, stops, seen = descent
    assert all(outputs["next_event.time"] > stop for stop, outputs in zip(stops, seen))
    assert all(
        outputs["next_event.time"] >= following for following, outputs in zip(stops[1:], seen)
    )


def test_the_hand_over_is_met_at_its_time(descent):
    _, _, stops, seen = descent
    (stop,) = [
        stop
        for stop, before, after in zip(stops[1:], seen, seen[1:])
        if after["received"] and not before["received"]
    ]
    after = seen[stops.index(stop)]
    assert 0.0 <= stop - after["handover.time"] <= 1.01 * PICOSECOND
    assert after["position.x"] == pytest.approx(60.0, abs=1e-9)


def test_another_start_time_shifts_the_stops(fmi3_fmus, descent):
    with Host3(fmi3_fmus["SlopeRockfall"], early_return=True) as host:
        _, stops = walk(host.start(time=64.0, **BOX), steps=10, start=64.0)
    expected = [stop for stop in descent[2] if stop < 10 * STEP]
    assert len(expected) > 3
    assert stops == pytest.approx([64.0 + stop for stop in expected], abs=0.1 * PICOSECOND)


def test_there_is_no_early_return_under_a_force_of_which_the_component_does_not_know_how_long_it_acts(
    fmi3_fmus,
):
    def push(host):
        if host["received"]:
            host["force.x"] = -10.0

    with Host3(fmi3_fmus["SlopeRockfall"], early_return=True) as host:
        host.start(**BOX)
        received = None
        for i in range(100):
            if received is None:
                time, end = i * STEP, (i + 1) * STEP
                while time < end and not host["received"]:
                    assert host.step(time, end - time) == 0
                    time = host.told[3]
                received = time if host["received"] else None
        host["force.x"] = -10.0
        assert (
            host["next_event.time"] < received + 0.5
        )  # it would leave the receiver, if no force acted
        assert host.step(received, 0.01) == 0
        assert host.told == (False, False, False, received + 0.01)


def test_other_components_never_return_early(fmi3_fmus):
    with Host3(fmi3_fmus["FallingRock"], early_return=True) as host:
        host.start().steps(3, 1e-3)
        assert host.told == (False, False, False, pytest.approx(3e-3))


def test_fmpy_records_the_events(fmi3_fmus):
    options = {
        "stop_time": 5.0,
        "step_size": 1.0,
        "output_interval": 1.0,
        "output": ["position.x", "position.y"],
    }
    file = str(fmi3_fmus["SlopeRockfall"])
    plain, stopping = (
        simulate_fmu(file, **options),
        simulate_fmu(file, early_return_allowed=True, **options),
    )
    assert len(stopping) > len(plain) == 6
    at = dict(zip(stopping["time"], stopping[["position.x", "position.y"]].tolist()))
    assert [at[time] for time in plain["time"]] == plain[["position.x", "position.y"]].tolist()


def test_early_returns_of_a_rock_on_its_slope_change_no_bit(native_fmus, fmi3_fmus, tmp_path):
    """Every impact lies inside of a step of half a second."""
    two, three = (
        simulate(
            system_from(
                {
                    "name": "slope",
                    "exchange_step": 0.5,
                    "stop_time": 10.0,
                    "components": {"rock": {"fmu": str(fmus["SlopeRockfall"])}},
                }
            ),
            tmp_path / name,
        )
        for name, fmus in (("two", native_fmus), ("three", fmi3_fmus))
    )
    assert all(two.series[n].tobytes() == three.series[n].tobytes() for n in two.series)
    impacts = two.series["rock.impacts"][-1]
    assert three.provenance["early_returns"]["rock"] >= impacts > 3
