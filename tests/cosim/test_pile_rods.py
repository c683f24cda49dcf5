"""Penetration tests over the length of the rod: energy, N for 60 %, customary factors."""

import math

import pytest

import rockshed
from rockshed.core.errors import InputRefused

SITE = {
    "segments": 40,
    "time": 0.12,
    "hammer": {"mass": 63.5, "drop": 0.75, "efficiency": 0.75},
    "rod": [{"length": 8.0, "area": 5.8e-4, "modulus": 2.0578304e11, "density": 7850.0}],
    "toe": {"resistance": 12e3},
    "spt": {"lengths": [2.0, 4.0, 8.0, 16.0]},
}


@pytest.fixture(scope="module")
def result():
    return rockshed.pile(SITE)


def test_all_blows_of_the_ram_counted_short_rods_take_as_much_energy_as_long_ones(result):
    ratios = [rod.energy_ratio for rod in result.rods]
    assert min(ratios) > 0.97 * max(ratios)
    assert ratios[0] == pytest.approx(0.77, abs=0.02)


def test_the_first_wave_alone_gives_short_rods_less(result):
    ratios = [rod.first_wave_ratio for rod in result.rods]
    assert ratios == sorted(ratios)
    mass = 2.0 * 5.8e-4 * 7850.0
    assert ratios[0] == pytest.approx(0.75 * (1.0 - math.exp(-4.0 * mass / 63.5)))


def test_the_first_wave_is_the_work_until_the_wave_is_back():
    """On an endless rod the head gets it until 2 L/c; the toe does not matter before."""
    (blow,) = rockshed.pile(
        {**{k: v for k, v in SITE.items() if k != "spt"}, "gravity": 0.0, "segments": 400}
    ).blows
    travel = 8.0 / 5120.0
    time = blow.traces["time"]
    first = time < 2.0 * travel
    impedance = 5.8e-4 * 7850.0 * 5120.0
    force = blow.traces["head.contact_force"][first]
    work = float((force * blow.traces["head.zv"][first]).sum() / impedance * (time[1] - time[0]))
    expected = 0.75 * (1.0 - math.exp(-4.0 * 8.0 * 5.8e-4 * 7850.0 / 63.5))
    assert work / (63.5 * 9.80665 * 0.75) == pytest.approx(expected, rel=0.02)


def test_n_for_sixty_percent_is_n_times_the_energy(result):
    for rod in result.rods:
        assert rod.corrected == pytest.approx(0.3 / rod.blow.set * rod.energy_ratio / 0.6)
    assert result.metrics["rod_4_count_60"].value == pytest.approx(result.rods[1].corrected)
    assert [rod.customary for rod in result.rods] == [0.75, 0.75, 0.95, 1.0]


def test_table_picture_and_answer_are_there(result):
    table = result.tables()[-1]
    assert [row["rod (m)"] for row in table] == ["2", "4", "8", "16"]
    assert "the customary factor is 0.75" in table.notes[0]
    assert "rods" in result.figures()


def test_rods_of_several_sections_and_soil_along_the_shaft_are_refused_at_once():
    shaft = [{"from": 1.0, "to": 3.0, "resistance": 1e3}]
    with pytest.raises(InputRefused) as refusal:
        rockshed.pile({**SITE, "rod": SITE["rod"] * 2, "shaft": shaft})
    told = " ".join(map(str, refusal.value.problems))
    assert "has 2 sections" in told
    assert "other soil along its shaft" in told
