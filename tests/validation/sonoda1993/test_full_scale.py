"""Full scale in Sonoda et al. (1993), sec. 4 (3): a rock of 1 tf on a rigid base and on girders, by the ready-made cases."""

import math
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest

from rockshed.cases.full_scale import (
    LAYER,
    ROCK_MASS,
    ROCK_RADIUS,
    impacts,
)
from rockshed.cases.registry import case
from rockshed.core.errors import InputRefused
from rockshed.core.run import simulate
from rockshed.metrics import names
from rockshed.metrics.cushion import still_in_contact, still_sinking
from rockshed.metrics.headlines import headlines
from rockshed.papers.sonoda1993 import full_scale
from rockshed.runs.job import Request, prepare

RIGID = ("rigid-base-pit", "rigid-base-river", "rigid-base-crushed")
GIRDERS = ("girders-8", "girders-10", "girders-12")


@cache
def run(name, coupling="paper", values=(), in_process=True, model=None, options=()):
    """A case, run; its files are gone."""
    request = Request(
        name,
        dict(values),
        coupling=coupling,
        options=dict(options),
        in_process=in_process,
        model=model,
    )
    job = prepare(request)
    with TemporaryDirectory() as folder:
        return simulate(job.system, Path(folder) / "run", sources=job.sources)


def figure(done, name):
    """A headline figure of a run."""
    return next(figure.value for figure in headlines(done) if figure.name == name)


@pytest.mark.parametrize("name", RIGID)
def test_transmitted_force_is_about_twice_that_on_the_rock(name):
    """The paper's main result, with settled maxima. Measured 2.14, 2.02, 2.03."""
    assert figure(run(name), names.SETTLED_RATIO) == pytest.approx(2.0, abs=0.2)


@pytest.mark.parametrize("name", RIGID + GIRDERS)
def test_energy_balances_without_a_warning_and_the_rock_comes_back(name):
    """Largest error within the run 0.04 to 0.08 percent of the impact energy."""
    done = run(name)
    assert figure(done, names.RESIDUAL_SHARE) < 0.01
    assert done.provenance["warnings"] == []
    assert not still_sinking(done)
    assert not still_in_contact(done)
    assert figure(done, names.CLEARANCE) > 0.1


def test_stiffer_sand_gives_more_force_and_less_penetration():
    penetrations = [figure(run(name), names.PENETRATION) for name in RIGID]
    forces = [figure(run(name), names.SETTLED_TRANSMITTED) for name in RIGID]
    assert penetrations == sorted(penetrations, reverse=True)
    assert forces == sorted(forces)


def test_exchanging_less_often_changes_nothing():
    """Impulse-conserving exchange against the paper's scheme, four times as often on a rigid base
    and eight times on girders."""
    for name in ("rigid-base-crushed", "girders-8"):
        for what in (names.SETTLED_TRANSMITTED, names.SETTLED_ROCK, names.PENETRATION):
            assert figure(run(name, "impulse"), what) == pytest.approx(
                figure(run(name), what), rel=0.005
            )
        made = run(name, "impulse").series["coupling.sand_rock.energy"][-1]
        assert abs(made) < 1e-4 * figure(run(name), names.IMPACT_ENERGY)


def test_elastic_sand_puts_far_too_much_energy_into_the_girders():
    """Table 6 measures 5.6, 6.9, 7.6 percent by (7). Calibrated sand: 32, 39, 37 percent by (7), and 44, 58, 62 by (5), (6)."""
    for name, share, from_strain in zip(GIRDERS, (0.438, 0.582, 0.618), (0.322, 0.387, 0.373)):
        assert figure(run(name), names.BEAM_SHARE) == pytest.approx(share, abs=0.02)
        assert figure(run(name), names.BEAM_SHARE_FROM_STRAIN) == pytest.approx(
            from_strain, abs=0.04
        )
        known = case(name).references({}).known
        assert figure(run(name), names.BEAM_SHARE) > 4.0 * known[names.BEAM_SHARE].paper.value
        assert (
            figure(run(name), names.BEAM_SHARE_FROM_STRAIN)
            > 4.0 * known[names.BEAM_SHARE_FROM_STRAIN].experiment.value
        )


def system(name, **values):
    return prepare(Request(name, values, in_process=True)).system


@pytest.mark.parametrize("coupling", [pytest.param("paper", marks=pytest.mark.slow), "impulse"])
def test_energy_of_girders_drifts_by_less_than_a_fifth_of_a_percent_in_a_second(coupling):
    """Calibrated sand, at each coupling that is offered. Measured 0.07 to 0.10 percent with the
    paper's exchange for 8 to 12 m, and 0.10 to 0.15 with the longer one.

    The books of all three, and what their interfaces made.
    """
    done = run("girders-12", coupling, options=(("stop_time", 1.0),))
    books = [name for name in done.series if name.endswith("energy.residual")]
    made = [
        name for name in done.series if name.startswith("coupling.") and name.endswith(".energy")
    ]
    assert len(books) == 3
    assert len(made) == 2
    drift = sum(done.series[name] for name in books + made)
    assert abs(drift).max() < 0.002 * figure(done, names.IMPACT_ENERGY)


@pytest.mark.parametrize("name", GIRDERS)
def test_girders_start_bent_under_the_sand_and_at_rest(name):
    """6.5 t of sand; the beam's energy before the rock comes is 165 to 680 J, and less than 1 mJ of it is motion."""
    done = run(name)
    weight = done.provenance["components"]["beam"]["parameters"]["cushion.weight"]["value"]
    assert done.series["sand.transmitted_force"][0] == pytest.approx(weight, rel=1e-3)
    assert done.series["beam.energy.kinetic"][1] < 1e-3
    static, peak = done.series["beam.energy.elastic"][0], done.series["beam.energy.elastic"].max()
    assert static > 100.0
    assert figure(done, names.BEAM_ENERGY) == pytest.approx(peak - static, rel=1e-3)


def test_weight_of_the_cushion_follows_from_the_sand_unless_it_is_given():
    def weight(**values):
        return system("girders-8", **values).components["beam"].parameters["cushion.weight"]

    plain = weight()
    assert plain == pytest.approx(270 * 1800.0 * math.pi * 0.05**2 * 1.7 * 9.80665)
    assert weight(**{"sand.density": 3600, "sand.thickness": 0.85}) == pytest.approx(plain)
    assert weight(**{"sand.packing": "random", "sand.disc.spread": 0.3}) == pytest.approx(
        1.03 * plain
    )
    assert weight(**{"sand.density": 3600, "beam.cushion.weight": 1000}) == 1000.0
    with pytest.raises(InputRefused, match=r"sand\.density: 'heavy': must be a number"):
        system("girders-8", **{"sand.density": "heavy"})


def test_masses_of_deck_and_box_lower_the_girders_energy_and_leave_the_comparison():
    """Assumed 200 kg/m and 2 t, of which the paper says nothing."""
    heavy = run("girders-8", "impulse", (("beam.deck.mass", 200), ("beam.box.mass", 2000)))
    assert figure(heavy, names.BEAM_SHARE_FROM_STRAIN) < 0.95 * figure(
        run("girders-8", "impulse"), names.BEAM_SHARE_FROM_STRAIN
    )
    found = case("girders-8").references({"beam.deck.mass": 200, "beam.box.mass": 2000})
    assert found == case("girders-8").references({})
    assert case("girders-8").references({"beam.density": 8000}).known == {}


@pytest.mark.slow
def test_literal_model_puts_as_much_into_the_girders():
    """Measured 50 percent by (5), (6) at 8 m, ratio 1.02."""
    done = run("girders-8", model="literal")
    assert figure(done, names.BEAM_SHARE) == pytest.approx(0.504, abs=0.03)
    assert figure(done, names.SETTLED_RATIO) == pytest.approx(1.02, abs=0.1)


def test_fmus_give_what_the_components_give_in_process():
    one, other = run("girders-8"), run("girders-8", in_process=False)
    for column in ("sand.transmitted_force", "rock.position.y", "beam.energy.elastic"):
        assert (one.series[column] == other.series[column]).all()
    assert other.provenance["warnings"] == []


def test_cushions_have_the_papers_number_of_discs():
    discs = {name: impact.discs for name, impact in impacts().items()}
    assert discs == {**dict.fromkeys(RIGID, 360), **dict.fromkeys(GIRDERS, 270)}


def packed(name, number=0):
    """One of the random packs with rolling resistance of the studies."""
    model = next(model for model in full_scale.MODELS if model.name == "random pack, rolling")
    values = full_scale.impacts(name, model, False, 0.15)[number].request.values
    return run(name, "impulse", tuple(values.items()))


@pytest.mark.parametrize("name", ["girders-8", "girders-12", "rigid-base-crushed"])
def test_a_random_pack_is_at_rest_and_the_rock_meets_it_with_its_speed(name):
    done = packed(name)
    assert done.series["sand.unbalanced_force_ratio"][0] <= 1e-6
    surface, height = done.series["sand.surface_height"][0], done.series["rock.position.y"]
    assert height[0] - ROCK_RADIUS > surface
    before = height - ROCK_RADIUS > surface + 0.05
    energy = done.series["rock.energy.kinetic"] + ROCK_MASS * 9.80665 * (
        height - LAYER - ROCK_RADIUS
    )
    assert before[1:5].all()
    assert energy[before] == pytest.approx(0.5 * ROCK_MASS * 14.0**2, rel=1e-4)
    assert done.provenance["warnings"] == []


@pytest.mark.slow
@pytest.mark.parametrize(("name", "measured"), [("girders-8", 0.056), ("girders-12", 0.076)])
def test_discs_that_turn_with_resistance_bring_table_6_near(name, measured):
    """Measured 5.6 and 7.6 percent by (7); the mean of six packs is 6.9 and 8.3, single ones are
    4.7 to 9.0 and 6.2 to 11.8. Calibrated sand: 32 and 37."""
    shares = [figure(packed(name, i), names.BEAM_ENERGY_FROM_STRAIN) / 98e3 for i in range(6)]
    assert sum(shares) / 6 == pytest.approx(measured, rel=0.35)
