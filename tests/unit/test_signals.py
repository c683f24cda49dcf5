"""Inputs over time from a table: interpolated, held, with jumps."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rockshed.core.errors import InputRefused
from rockshed.runs.signals import Signals, read_signals

NUMBERS = st.floats(-1e6, 1e6, allow_nan=False)
ROWS = st.lists(st.tuples(st.integers(0, 50), NUMBERS), min_size=1, max_size=12)


def signals(rows):
    rows = sorted(rows, key=lambda row: row[0])
    return Signals(np.array([0.1 * t for t, _ in rows]), {"x": np.array([x for _, x in rows])})


@given(ROWS, st.booleans())
def test_at_the_time_of_a_row_the_value_is_that_of_the_last_row_of_this_time(rows, held):
    made = signals(rows)
    for time in made.time:
        expected = made.columns["x"][made.time == time][-1]
        assert made.at(float(time), "x", held) == pytest.approx(expected, abs=1e-9)


@given(ROWS, st.floats(-1.0, 6.0))
def test_between_rows_a_value_is_between_theirs_and_a_held_one_is_one_of_them(rows, time):
    made = signals(rows)
    values = made.columns["x"]
    assert values.min() - 1e-6 <= made.at(time, "x", held=False) <= values.max() + 1e-6
    assert made.at(time, "x", held=True) in values


def test_a_line_between_two_rows_is_met_and_a_jump_is_one():
    made = Signals(np.array([0.0, 1.0, 1.0, 2.0]), {"x": np.array([0.0, 4.0, 10.0, 10.0])})
    assert [made.at(t, "x", held=False) for t in (-1, 0.25, 0.5, 1.0, 1.5, 9)] == [
        0,
        1,
        2,
        10,
        10,
        10,
    ]
    assert [made.at(t, "x", held=True) for t in (0.5, 1.0)] == [0, 10]


def test_a_time_that_is_computed_with_rounding_reaches_its_row():
    made = Signals(np.array([0.0, 0.3]), {"x": np.array([0.0, 1.0])})
    assert made.at(0.1 + 0.2, "x", held=True) == 1.0
    assert made.at(3 * 0.1 - 1e-16, "x", held=True) == 1.0


@pytest.mark.parametrize(
    ("text", "faults"),
    [
        ("time,x\n", ["has no row of values"]),
        ("t,x\n0,1\n", ["the first column is 't', not time"]),
        ("time,x,x\n0,1,2\n", ["x has two columns"]),
        ("time,x\n0,a\n1\n", ["line 2, column 3: 'a' is no finite number", "line 3: has 1 field"]),
        ("time,x\n1,2\n0,2\n", ["line 3, column 1: the time 0 s comes after 1 s"]),
        ("time,x\n0,nan\n", ["'nan' is no finite number"]),
    ],
)
def test_what_is_wrong_with_a_table_is_said_with_its_place(tmp_path, text, faults):
    file = tmp_path / "in.csv"
    file.write_text(text)
    with pytest.raises(InputRefused) as refused:
        read_signals(file)
    assert len(refused.value.problems) == len(faults)
    for problem, fault in zip(refused.value.problems, faults, strict=True):
        assert fault in str(problem)


def test_booleans_may_be_words(tmp_path):
    file = tmp_path / "in.csv"
    file.write_text("time,on\n0,false\n1,True\n")
    assert read_signals(file).columns["on"].tolist() == [0.0, 1.0]
