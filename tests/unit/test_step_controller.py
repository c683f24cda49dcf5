"""The controller of exchange steps, which doubles and halves."""

from hypothesis import given
from hypothesis import strategies as st

from rockshed.core.masters.controller import StepController

errors = st.floats(0.0, 1e6)


@given(
    course=st.lists(st.tuples(errors, st.booleans()), max_size=20),
    room=st.integers(1, 5000),
    levels=st.integers(0, 10),
)
def test_a_step_is_a_power_of_two_that_fits_into_room_and_longest(course, room, levels):
    controller = StepController(1 << levels, 2)
    for error, is_kept in course:
        step = controller.step(room)
        assert step & (step - 1) == 0
        assert 1 <= step <= min(room, 1 << levels)
        (controller.accept if is_kept else controller.reject)(step, error)


@given(power=st.integers(2, 4))
def test_without_error_each_step_is_twice_the_one_before(power):
    controller = StepController(64, power)
    for expected in (1, 2, 4, 8, 16, 32, 64, 64):
        assert controller.step(1000) == expected
        controller.accept(expected, 0.0)


@given(error=st.floats(1.0, 1e6), before=errors)
def test_an_error_above_the_tolerance_makes_the_next_step_shorter(error, before):
    controller = StepController(64, 2)
    controller.recall([64.0, max(before, 1e-10) if before < error else error])
    controller.reject(64, error)
    assert controller.step(1000) < 64


def test_a_step_that_a_row_has_shortened_does_not_make_the_next_ones_shorter():
    controller = StepController(64, 2)
    controller.recall([64.0, 1e-10])
    assert controller.step(room=4) == 4
    controller.accept(4, 0.0)
    assert controller.step(1000) == 64
