"""Measured curves beside computed ones: what a file may hold, and the errors in three numbers."""

import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import rockshed
from rockshed.core.results.series import Series
from rockshed.metrics import measured


def series(name, unit, time, values):
    return Series(name, unit, "", np.asarray(time, float), np.asarray(values, float))


def written(folder, text):
    file = folder / "measured.csv"
    file.write_text(text, encoding="utf-8")
    return file


def test_columns_are_read_in_the_unit_of_what_they_stand_beside(tmp_path):
    file = written(tmp_path, "time (ms);force (kN);way [cm]\n0;0;0\n1;2,5;1\n2;1;3\n")
    force, way = measured.read_measured(file, ["m", "N"])
    assert (force.name, force.unit, force.values.tolist()) == ("force", "N", [0.0, 2500.0, 1000.0])
    assert (way.unit, way.values.tolist()) == ("m", pytest.approx([0.0, 0.01, 0.03]))
    assert way.time.tolist() == pytest.approx([0.0, 0.001, 0.002])


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "is empty"),
        ("force (kN)\n1\n2\n3\n", "one column of times"),
        ("time (ms),force\n0,1\n1,2\n2,3\n", "has no unit"),
        ("time (ms),force (kV)\n0,1\n1,2\n2,3\n", "has not the unit of what is drawn"),
        ("time (ms),force (kN)\n0,1\n1,x\n2,3\n", "line 3, column 3: 'x' is no finite number"),
        ("time (ms),force (kN)\n0,1\n1,2,3\n2,3\n", "has 3 fields instead of 2"),
        ("time (ms),force (kN)\n0,1\n2,2\n1,3\n", "line 4: the time 1 is not after 2"),
        ("time (ms),force (kN)\n0,1\n", "has 1 point"),
    ],
)
def test_what_is_wrong_with_a_file_is_told_with_its_place(tmp_path, text, told):
    with pytest.raises(rockshed.InputRefused) as refusal:
        measured.read_measured(written(tmp_path, text), ["N"])
    assert told in str(refusal.value)


@given(st.floats(0.1, 10.0), st.floats(0.2, 0.8))
def test_errors_of_a_triangle_are_those_of_its_height_and_length(height, at):
    """A triangle lasts nine tenths of its base above a tenth of its peak."""
    time = np.union1d(np.linspace(0.0, 1.0, 2001), [at])
    computed = series("c.f", "N", time, height * np.interp(time, [0.0, at, 1.0], [0.0, 1.0, 0.0]))
    curve = measured.MeasuredCurve("f", "N", np.array([0.0, at, 1.0]), np.array([0.0, 1.0, 0.0]))
    (found,) = measured.agreements({"run": [computed]}, [curve])
    peak, impulse, duration = found.deviations
    assert peak.error == pytest.approx(height - 1.0, abs=1e-9)
    assert impulse.error == pytest.approx(height - 1.0, abs=1e-6)
    assert impulse.measured == pytest.approx(0.5, rel=1e-6)
    assert duration.computed == pytest.approx(0.9, abs=2e-3)
    assert duration.error == pytest.approx(0.0, abs=3e-3)


def test_a_column_that_has_the_name_of_a_variable_is_compared_with_that_alone():
    time = [0.0, 1.0]
    variables = [series("a.f", "N", time, [0.0, 1.0]), series("b.f", "N", time, [0.0, 2.0])]
    named = measured.MeasuredCurve("b.f", "N", np.array(time), np.array([0.0, 4.0]))
    other = measured.MeasuredCurve("force", "N", np.array(time), np.array([0.0, 0.0]))
    found = measured.agreements({"run": variables}, [named, other])
    pairs = [(entry.variable, entry.measured) for entry in found]
    assert pairs == [("b.f", "b.f"), ("a.f", "force"), ("b.f", "force")]
    assert found[1].deviations[0].error is None
    assert json.loads(json.dumps(found[0].as_data()))["peak"]["error"] == -0.5
