"""The digest of Uto et al. (about 1974): every claim with what was found of it."""

import json

import pytest

from rockshed.papers.reproduction import reproduce, studies
from rockshed.papers.uto1974.struck_rod import alpha, kappa


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    folder = tmp_path_factory.mktemp("uto") / "out"
    return reproduce("uto1974", folder, workers=1), folder


def row(made, beginning):
    rows = [
        row for part in made[0].parts for row in part.rows if row.quantity.startswith(beginning)
    ]
    assert len(rows) == 1, [r.quantity for r in rows]
    return rows[0]


VERDICTS = {
    "a step smaller than dx/c oscillates": ("holds", 0.26, 0.01),
    "ten segments and dt/5: the toe moves": ("holds", 0.25, 0.01),
    "ten segments and dt/5: hammer and rod separate": ("holds", 1.26, 0.02),
    "k2 = k1 behaves like a fixed toe": ("holds", 0.0, 1e-9),
    "fig. 10: the reflection is five times": ("holds", 5.0, 0.01),
    "largest k2/k1 that is stable": ("found", 2.0, 0.03),
    "total energy with 10 segments": ("holds", 22.0, 0.5),
    "total energy with 100 segments": ("does not", 1.8, 0.05),
    "modified Smith: energy in the ground": ("holds", 1.0, 0.01),
    "modified Smith: ripples": ("holds", 0.1, 0.05),
    "modified Smith: diverges for alpha < 0": ("holds", None, None),
    "the displacement scheme has a fundamental defect": ("does not", None, None),
    "zeroed tension is wrong": ("does not", 1.0, 1e-3),
    "R_u = k2 Q": ("holds", 100.0, 1e-9),
    "k2 = (1 - alpha)/(1 + alpha) k1, (8) and (9)": ("does not", 2.0, 0.05),
    "table 1: energy of a blow": ("holds", 4762.5, 1e-9),
}


@pytest.mark.parametrize("beginning", VERDICTS)
def test_a_claim_has_its_verdict_and_its_number(made, beginning):
    found, expected = row(made, beginning), VERDICTS[beginning]
    assert found.verdict == expected[0]
    if expected[1] is not None:
        assert found.computed == pytest.approx(expected[1], abs=expected[2])


def test_the_measured_rod_has_its_times_and_says_what_is_assumed(made):
    assert row(made, "fig. 7: the front passes").computed == pytest.approx(2.58 / 5.12, abs=0.005)
    assert row(made, "fig. 7: it comes back").computed == pytest.approx(
        (2.58 + 2.0 * 31.36) / 5.12, abs=0.005
    )
    assert row(made, "fig. 7: largest stress").computed == pytest.approx(
        7850 * 5120 * (2 * 9.80665 * 0.75) ** 0.5 / 1e6, rel=0.002
    )
    assert "assumed" in row(made, "fig. 7: ultimate resistance").note


def test_files_of_the_reproduction(made):
    figures = {file.stem for file in (made[1] / "figures").iterdir()}
    assert figures == {
        "figure6",
        "figure7",
        "figure8",
        "figure10",
        "figure11",
        "figure13",
        "resistance",
    }
    assert [
        study["name"]
        for study in json.loads((made[1] / "reproduction.json").read_text())["studies"]
    ] == ["claims", "figure6", "figure7", "figure8", "figures10-11", "figure13"]
    assert len(studies("uto1974")) == 6


def test_reflection_and_ratio_of_impedances_are_inverse_to_each_other():
    assert [kappa(value) for value in (-2.0 / 3.0, -1.0 / 3.0, 0.0, 0.5)] == pytest.approx(
        [5.0, 2.0, 1.0, 1.0 / 3.0]
    )
    assert alpha(kappa(0.3)) == pytest.approx(0.3)
