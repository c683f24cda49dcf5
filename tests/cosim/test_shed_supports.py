"""Sheds of a project on supports that give way: rest, weights, stiffness, energy."""

import numpy as np
import pytest

import rockshed
from rockshed.components.common.units import kN, standard_gravity
from rockshed.metrics.energy import impact_energy, system_residual
from rockshed.runs.projects import TEMPLATES
from rockshed.sites.shed.geometry import line_mass
from rockshed.sites.shed.preparation import prepare

EXAMPLES = TEMPLATES["pile"].parent
SMALL = {
    "rock": {"mass": "400 kg", "drop_height": "8 m"},
    "cushion": {"thickness": "50 cm"},
    "roof": {"section": "H-200x200x8x12", "span": "3 m", "spacing": "1 m"},
    "numerics": {"disc_radius": "3.1 cm", "stop_time": 0.06, "output_interval": "0.2 ms"},
}
ELASTIC = {"kind": "elastic", "stiffness": "20 kN/mm"}
PILES = {"kind": "piles", "file": str(EXAMPLES / "pile.toml")}


def run(folder, project, **changes):
    """Run a project in this process."""
    return rockshed.simulate(rockshed.shed(project, in_process=True, **changes), folder)


def weight(project, **changes):
    """Weight of roof and sand (N)."""
    found = prepare({**project, **changes}).layout
    mass = line_mass(found.cushion, found.roof, found.girders) * found.roof.span
    return standard_gravity * mass, found


@pytest.fixture(scope="module")
def elastic(tmp_path_factory):
    return run(tmp_path_factory.mktemp("elastic") / "run", SMALL, supports=ELASTIC)


@pytest.fixture(scope="module")
def hinged(tmp_path_factory):
    return run(tmp_path_factory.mktemp("hinged") / "run", SMALL)


@pytest.fixture(scope="module")
def on_piles(tmp_path_factory):
    return run(tmp_path_factory.mktemp("piles") / "run", SMALL, supports=PILES)


def reactions(done):
    return -np.array([done.series[f"beam.support.force.y[{side}]"] for side in (1, 2)])


def test_at_rest_the_springs_carry_roof_and_sand_and_give_by_it(elastic):
    total, found = weight(SMALL, supports=ELASTIC)
    at_rest = elastic.series["time"] < 0.003
    assert reactions(elastic).sum(axis=0)[at_rest] == pytest.approx(total, rel=0.01)
    stiffness = found.girders * 20e3 * kN
    settlement = np.array([elastic.series[f"beam.support.settlement[{i}]"] for i in (1, 2)])
    assert settlement[:, 0] == pytest.approx(0.5 * total / stiffness, rel=0.01)
    assert settlement * stiffness == pytest.approx(reactions(elastic), rel=1e-9)


def test_springs_take_a_part_of_the_deflection_and_no_energy_is_made(elastic, hinged):
    deepest = elastic.series["beam.midspan.deflection"].max()
    assert deepest > 1.05 * hinged.series["beam.midspan.deflection"].max()
    assert (reactions(elastic) >= 0.0).all()
    for done in (elastic, hinged):
        assert np.abs(system_residual(done)).max() < 5e-3 * impact_energy(done)


@pytest.mark.slow
def test_at_rest_the_toes_carry_roof_sand_and_piles(on_piles):
    total, found = weight(SMALL, supports=PILES)
    for side in ("left", "right"):
        resistance = on_piles.series[f"ground_{side}.resistance"]
        assert resistance[0] == pytest.approx(0.5 * total + found.rod.weight, rel=0.01)
        early = on_piles.series["time"] < 0.002
        assert np.abs(on_piles.series[f"ground_{side}.settlement"][early]).max() < 1e-5


@pytest.mark.slow
def test_piles_are_pressed_by_the_impact_and_no_energy_is_made(on_piles):
    energy = impact_energy(on_piles)
    assert np.abs(system_residual(on_piles)).max() < 2e-3 * energy
    before = on_piles.series["time"] < 0.002
    for side in ("left", "right"):
        head = np.abs(on_piles.series[f"rod_{side}.head.contact_force"])
        assert head.max() > 20.0 * head[before].max()


@pytest.mark.slow
@pytest.mark.parametrize(
    "supports", [{"kind": "elastic", "stiffness": "60 kN/mm"}, PILES], ids=["elastic", "piles"]
)
def test_the_shed_of_the_trial_on_supports_that_give_way_yields_less(tmp_path, supports):
    """Against hinges; the whole impact, energy closed to 0.1 %."""
    example = EXAMPLES / "trial-shed.toml"
    soft, rigid = run(tmp_path / "soft", example, supports=supports), run(tmp_path / "r", example)
    assert np.abs(system_residual(soft)).max() < 1e-3 * impact_energy(soft)
    work = [float(done.series["beam.energy.plastic"][-1]) for done in (soft, rigid)]
    assert 0.5 * work[1] < work[0] < work[1]
