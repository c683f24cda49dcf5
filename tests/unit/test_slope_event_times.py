"""The time of the next event, as the rock on its slope publishes it: a step that ends there has the event behind it."""

from hypothesis import given
from hypothesis import strategies as st

from rockshed.components.slope_rockfall.declarations import NEVER
from rockshed.components.slope_rockfall.kernel import grid_after, on_grid

TIMES = st.floats(0.0, 1000.0)


@given(TIMES)
def test_it_is_the_event_rounded_up_to_a_picosecond(event):
    published = grid_after(event)
    assert event <= published <= event + 2e-12
    assert on_grid(published) == published


@given(TIMES, TIMES)
def test_a_step_that_ends_there_has_the_event_behind_it_whatever_the_rounding_of_the_clock(
    event, start
):
    published = grid_after(event)
    assert on_grid(start + (published - start)) == published >= event


@given(st.floats(1e4, NEVER))
def test_far_times_are_left_alone(event):
    assert grid_after(event) == event
