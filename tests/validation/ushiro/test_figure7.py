"""What the paper reads from its figure 7, against the curves."""

import math

import pytest

from rockshed.papers.reproduction import reproduce, studies
from rockshed.papers.study import Outcomes
from rockshed.papers.ushiro.figure7 import BASE, SPEEDS, STUDY, TREATMENTS, VARIATIONS


@pytest.fixture(scope="module")
def rows():
    return {(row.model, row.quantity): row for row in STUDY.rows(Outcomes({}))}


@pytest.mark.parametrize("model", TREATMENTS)
def test_all_its_claims_hold_but_the_one_on_epsilon(rows, model):
    verdicts = {quantity: row.verdict for (name, quantity), row in rows.items() if name == model}
    assert len(verdicts) == 6
    assert [quantity for quantity, found in verdicts.items() if found != "holds"] == [
        "ε is about e at v1 ≈ 0"
    ]


def test_without_gravity_slow_impacts_have_the_root_of_epsilon(rows):
    assert rows["none", "ε is about e at v1 ≈ 0"].computed == pytest.approx(
        math.sqrt(0.6), rel=1e-3
    )
    assert rows["printed", "ε is about e at v1 ≈ 0"].computed == 0.0


def test_a_curve_against_a_sample_integrated_by_hand():
    """k = q_d / 0.1 m, no gravity: m v^2 / 2 = q_d A (d - 0.1 m (1 - exp(-10 d))) for d = 0.1 m, whence v; then e of (27)."""
    mass, area = 2600.0 * 4.0 / 3.0 * math.pi / 8.0, math.pi / 16.0
    work = 3e6 * area * 0.1 * math.exp(-1.0)
    force = 3e6 * area * (1.0 - math.exp(-1.0))
    speed = math.sqrt(2.0 * work / mass)
    released = 0.6 * force**2 / (2.0 * 30e6 * area)
    assert BASE.restitution(speed, TREATMENTS["none"]) == pytest.approx(
        math.sqrt(released / work), rel=1e-12
    )


def test_reproduction_writes_the_figure(tmp_path):
    assert [study.name for study in studies("ushiro")] == ["figure7"]
    made = reproduce("ushiro", tmp_path, workers=1)
    assert (tmp_path / "figures" / "figure7.png").stat().st_size > 20_000
    assert len(made.content["studies"][0]["rows"]) == 18
    assert not made.content["runs"]


def test_every_variation_is_about_one_quantity():
    assert len(SPEEDS) > 100
    for _, variants in VARIATIONS.values():
        assert len({impact for _, impact in variants}) == 3
