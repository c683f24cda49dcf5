"""Each test opens with a diagram: time runs to the right in ticks, one line a component.

``i`` it takes its inputs, ``===`` it is stepped over this time, ``o`` it shows its outputs. The number before an ``i`` or ``o``
counts the operations of the exchange.
"""

import pytest

from rockshed.core.system.schedule import Action, Operation, fits, make_schedule, nearest_steps

SET, STEP, GET = Action.SET, Action.STEP, Action.GET


def _told(schedule):
    """Each exchange in short: ``i a`` inputs of a, ``a 0+4`` a step of a from 0 by 4, ``o a`` outputs of a."""

    def word(o):
        return {
            SET: f"i {o.component}",
            GET: f"o {o.component}",
            STEP: f"{o.component} {o.begin}+{o.length}",
        }[o.action]

    return [[word(o) for o in exchange] for exchange in schedule.operations]


def test_sequential():
    """
    tick  0                 10
    sand  |1i======2=======3o|
    rock  |            4i==5==6o|    the rock takes what the sand has reached at 10
    """
    assert _told(make_schedule(["sand", "rock"], {"sand": 10, "rock": 10}, 10, "sequential")) == [
        ["i sand", "sand 0+10", "o sand", "i rock", "rock 0+10", "o rock"]
    ]


def test_sequential_in_the_other_order():
    """
    tick  0                 10
    rock  |1i======2=======3o|
    sand  |            4i==5==6o|
    """
    assert _told(make_schedule(["rock", "sand"], {"sand": 10, "rock": 10}, 10, "sequential")) == [
        ["i rock", "rock 0+10", "o rock", "i sand", "sand 0+10", "o sand"]
    ]


def test_jacobi():
    """
    tick  0                 10
    sand  |1i=====3========5o|
    rock  |2i=====4========6o|       both take the values of tick 0
    """
    assert _told(make_schedule(["sand", "rock"], {"sand": 10, "rock": 10}, 10, "jacobi")) == [
        ["i sand", "i rock", "sand 0+10", "rock 0+10", "o sand", "o rock"]
    ]


def test_a_fast_component_is_stepped_several_times_with_the_inputs_held():
    """
    tick  0    2    4    6
    sand  |1i=====2=====3o|
    beam  |4i=5=|=6==|=7==8o|
    """
    assert _told(make_schedule(["sand", "beam"], {"sand": 6, "beam": 2}, 6, "sequential")) == [
        ["i sand", "sand 0+6", "o sand", "i beam", "beam 0+2", "beam 2+2", "beam 4+2", "o beam"]
    ]


def test_a_slow_component_holds_its_inputs_and_shows_its_outputs_when_the_others_are_there():
    """
    tick   0           10          20
    slow   |1i...............1==2==o|     stepped in the second exchange, from 0 to 20
    quick  |2i==3==4o|3i==4==5o|           at 10 it still has the slow one's outputs of 0
    """
    assert _told(make_schedule(["slow", "quick"], {"slow": 20, "quick": 10}, 10, "sequential")) == [
        ["i slow", "i quick", "quick 0+10", "o quick"],
        ["slow 0+20", "o slow", "i quick", "quick 10+10", "o quick"],
    ]


def test_a_slow_component_under_jacobi():
    """
    tick   0           10          20
    slow   |1i...............1==...3o|
    quick  |2i==3==4o|.....2i=2==..4o|
    """
    assert _told(make_schedule(["slow", "quick"], {"slow": 20, "quick": 10}, 10, "jacobi")) == [
        ["i slow", "i quick", "quick 0+10", "o quick"],
        ["i quick", "slow 0+20", "quick 10+10", "o slow", "o quick"],
    ]


def test_three_rates_repeat_after_their_common_period():
    """
    tick   0    4    8    12   16   20   24
    two    |i........o|i........o|i........o|
    three  |i.............o|i.............o|
    fast   |i==o|i==o|i==o|i==o|i==o|i==o|        two steps of 2 each
    """
    schedule = make_schedule(
        ["two", "three", "fast"], {"two": 8, "three": 12, "fast": 2}, 4, "sequential"
    )
    assert schedule.period == 6
    told = _told(schedule)
    assert [[word for word in exchange if word.startswith("two ")] for exchange in told] == [
        [],
        ["two 0+8"],
        [],
        ["two 8+8"],
        [],
        ["two 16+8"],
    ]
    assert [[word for word in exchange if word.startswith("three ")] for exchange in told] == [
        [],
        [],
        ["three 0+12"],
        [],
        [],
        ["three 12+12"],
    ]
    assert told[4] == ["i two", "i fast", "fast 16+2", "fast 18+2", "o fast"]


@pytest.mark.parametrize("scheme", ["sequential", "jacobi"])
def test_every_component_covers_the_whole_period_without_gap_or_overlap(scheme):
    steps = {"a": 3, "b": 12, "c": 18, "d": 6}
    schedule = make_schedule(list(steps), steps, 6, scheme)
    for name, step in steps.items():
        taken = [
            o
            for exchange in schedule.operations
            for o in exchange
            if o.component == name and o.action is STEP
        ]
        assert [o.begin for o in taken] == list(range(0, schedule.period * 6, step))
        assert {o.length for o in taken} == {step}


def test_an_operation_says_what_it_is():
    assert make_schedule(["a"], {"a": 1}, 1, "jacobi").operations == (
        (Operation(SET, "a"), Operation(STEP, "a", 0, 1), Operation(GET, "a")),
    )


def test_steps_that_fit_and_the_nearest_that_do():
    assert [step for step in range(1, 25) if fits(step, 12)] == [1, 2, 3, 4, 6, 12, 24]
    assert nearest_steps(5, 12) == [4, 6]
    assert nearest_steps(30, 12) == [24, 36]
    assert nearest_steps(3_000_000, 10_000_000) == [2_500_000, 5_000_000]
