"""Spring constants with units, and measured curves that are read or refused by line and column."""

import numpy as np
import pytest

from rockshed.analyses.calibration.curve_file import read_curve
from rockshed.analyses.calibration.measurement import of_stiffness, stiffness_from
from rockshed.analyses.calibration.run import measurements_of
from rockshed.components.common.units import kgf
from rockshed.core.errors import InputRefused


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("39.1kgf/cm", 39.1 * kgf / 0.01),
        ("39.1 kgf/cm", 39.1 * kgf / 0.01),
        ("38.3 kN/m", 38300.0),
        ("1e3N/mm", 1e6),
        ("0.5 kN/cm", 5e4),
    ],
)
def test_a_spring_constant_carries_its_unit(text, value):
    assert stiffness_from(text) == pytest.approx(value)
    assert float(of_stiffness(value, text).load[0]) == pytest.approx(0.04 * value)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("39.1", "no unit"),
        ("39.1 kgf", "no spring constant"),
        ("stiff", "no spring constant"),
        ("39,1 kgf/cm", "no spring constant"),
        ("3 lbf/inch", "the unit lbf/inch"),
        ("0 N/m", "not above zero"),
        ("-4 kN/m", "not above zero"),
    ],
)
def test_other_spring_constants_are_refused(text, reason):
    with pytest.raises(InputRefused, match=reason):
        stiffness_from(text)


@pytest.fixture
def curve(tmp_path):
    """Write a file of these lines and read it."""

    def read(*lines):
        file = tmp_path / "curve.csv"
        file.write_text("\n".join(lines))
        return read_curve(file)

    return read


@pytest.mark.parametrize(
    "head",
    ["penetration (cm),load (kgf)", " Penetration [cm] , load_kgf", "penetration_cm,load kgf"],
)
def test_a_curve_is_read_in_its_units(curve, head):
    found = curve("# a comment", head, "", "0, 0", "2,80", "4.0,155.5")
    assert list(found.depth) == [0.0, 0.02, 0.04]
    assert list(found.load / kgf) == pytest.approx([0.0, 80.0, 155.5])


def test_columns_may_stand_in_any_order(curve):
    found = curve("load (kN),penetration (mm)", "0.1,1", "0.2,2", "0.3,3")
    assert found.load == pytest.approx(np.array([100.0, 200.0, 300.0]))
    assert found.depth == pytest.approx(np.array([0.001, 0.002, 0.003]))


HEAD = "penetration (cm),load (kgf)"


@pytest.mark.parametrize(
    ("lines", "reason"),
    [
        ((), "is empty"),
        (("1,2", "2,3", "3,4"), "line 1, column 1: '1' is not penetration or load"),
        (("penetration,load (kgf)",), "line 1, column 1: 'penetration' has no known unit"),
        (("penetration (inch),load (kgf)",), "column 1: 'penetration .inch.' has no known unit"),
        (("penetration (cm),penetration (mm)",), "each once"),
        ((HEAD, "1,10"), "has 1 point"),
        ((HEAD, "1,10", "2,x", "3,30"), r"line 3, column 2 .load.: 'x' is no finite number"),
        ((HEAD, "1,10", "nan,20", "3,30"), r"line 3, column 1 .penetration.: 'nan'"),
        ((HEAD, "1,10", "2;20", "3,30"), "line 3: has 1 field instead of 2"),
        (
            (HEAD, "1,10", "3,30", "2,20"),
            "line 4, column penetration: 2 cm does not lie below the 3 cm of line 3",
        ),
        ((HEAD, "-1,10", "1,20", "2,30"), "line 2, column penetration: -1 cm"),
        ((HEAD, "1,10", "2,20", "9,30"), "line 4, column penetration: 9 cm: allowed is 0 to 8 cm"),
        ((HEAD, "1,10", "2,-5", "3,30"), "line 3, column load: .* is negative"),
        ((HEAD, "1,0", "2,0", "3,0"), "no load above zero"),
    ],
)
def test_bad_files_are_refused_by_line_and_column(curve, lines, reason):
    with pytest.raises(InputRefused, match=reason):
        curve(*lines)


def test_all_problems_are_told_at_once(curve):
    with pytest.raises(InputRefused) as refusal:
        curve(HEAD, "a,b", "1", "2,c")
    assert len(refusal.value.problems) == 4


def test_a_file_that_is_not_there_is_refused(tmp_path):
    with pytest.raises(InputRefused, match="cannot be read"):
        read_curve(tmp_path / "none.csv")


def test_a_spring_constant_with_its_unit_is_taken_by_the_library():
    (measured,) = measurements_of("39.1 kgf/cm")
    assert measured.stiffness == pytest.approx(39.1 * 9.80665 / 0.01)
    assert measured.name == "k = 39.1 kgf/cm"


def test_a_spring_constant_without_a_unit_is_refused_and_not_taken_for_a_file():
    with pytest.raises(InputRefused, match=r"measurement.*'39.1' has no unit.*kgf/cm"):
        measurements_of("39.1")


def test_a_file_whose_name_begins_with_a_number_is_a_file(tmp_path):
    file = tmp_path / "39.1 kgf.csv"
    file.write_text("penetration (cm),load (kgf)\n1,20\n2,40\n4,80\n")
    (measured,) = measurements_of(str(file))
    assert measured.stiffness == pytest.approx(20 * 9.80665 / 0.01)
