"""What the studies of Mogami and Tamura find."""

import pytest

from rockshed.papers.mogami1973 import fits, mass, settlement
from rockshed.papers.reproduction import reproduce, studies
from rockshed.papers.study import Outcomes


def rows(study):
    return {row.quantity: row for row in study.STUDY.rows(Outcomes({}))}


def test_the_number_before_the_radius_squared_is_twelve():
    row = rows(mass)["number before r² in (1)"]
    assert row.computed == pytest.approx(12.0, rel=1e-9)
    assert row.verdict == "does not"


def test_body_and_plate_count_beside_the_sand():
    """60.91 kg of sand, 1.57 kg of steel, and 4.65 to 20.40 kg that fell."""
    found = rows(mass)
    assert found["mass of (1), plate of 100 cm²"].computed == pytest.approx(77.18, abs=0.01)
    excess = [row.computed for name, row in found.items() if name.startswith("v0 and")]
    assert [round(value, 1) for value in excess] == [4.2, 7.2, 9.7, 11.9]


def test_the_exact_settlement_is_between_two_and_four_thirds_of_the_printed_one():
    found = rows(settlement)
    assert found["settlement by (1) and (2) / by (7), R0 = 0"].computed == pytest.approx(4.0 / 3.0)
    assert found["settlement by (1) and (2) / by (7), R1 = 0"].computed == pytest.approx(2.0 / 3.0)
    assert found["settlement by (1) and (2) / by (7), R0 = R1"].verdict == "holds"
    assert found["component in time / exact integral - 1, largest of 96 tests"].computed < 1e-10


def test_the_fits_contradict_the_model():
    found = rows(fits)
    assert found["slope of (12), largest / smallest plate"].computed < 0.8
    assert found["slope of (12), largest / smallest plate"].verdict == "does not"
    assert fits.slope_of_model(400.0) > 1.5 * fits.slope_of_model(100.0)
    implied = found["mass that (11) and (12) imply, smallest plate"]
    assert implied.paper == pytest.approx(22.14, abs=0.01)  # K slope/2, by a pocket calculator
    assert implied.verdict == "does not"
    assert found["settlement of (12) in (7) / that of (11), 96 tests"].verdict == "does not"
    assert found["fig. 3: R0, plate of 100 cm²"].computed == pytest.approx(
        0.5366, rel=1e-3
    )  # by a pocket calculator


@pytest.mark.slow
def test_reproduction_draws_its_figures(tmp_path):
    assert [study.name for study in studies("mogami1973")] == ["mass", "settlement", "fits"]
    reproduce("mogami1973", tmp_path, workers=1)
    assert {file.name for file in (tmp_path / "figures").iterdir()} == {
        "mass.png",
        "blow.png",
        "figure3.png",
        "coefficient.png",
    }
