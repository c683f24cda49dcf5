"""The case ``slope-to-cushion``: the rock of the campaign's 95th percentile hits the full-scale cushion of a shed, as FMUs."""

import os

import numpy as np
import pytest

from rockshed.campaigns import campaign
from rockshed.cases import slope_to_cushion as case
from rockshed.components.slope_rockfall.records import PASSAGE
from rockshed.core.run import simulate
from rockshed.metrics.comparison import table, warnings
from rockshed.metrics.energy import impact_energy, system_residual
from rockshed.metrics.percentiles import percentile
from rockshed.pictures import draw_all
from rockshed.runs.job import Request, prepare
from rockshed.sites.rockfall.preparation import prepare as prepare_site


@pytest.fixture(scope="module")
def landed():
    """Passages of the search line over the cushion in the site's own campaign."""
    trials = campaign.campaign_of(prepare_site(case.SITE))
    line = list(trials.names).index(case.LINE)
    return campaign.run(trials, 2).passages[:, line]


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """The case until the rock has left the sand."""
    os.environ["ROCKSHED_FMU_DIR"] = str(tmp_path_factory.mktemp("dist"))
    try:
        job = prepare(Request("slope-to-cushion", runtime="python", options={"stop_time": 0.2}))
        return simulate(job.system, tmp_path_factory.mktemp("slope") / "run", facts=job.facts)
    finally:
        del os.environ["ROCKSHED_FMU_DIR"]


def test_the_trial_is_that_of_the_percentile(landed):
    energies = np.where(landed[:, PASSAGE.count] > 0.0, landed[:, PASSAGE.kinetic], np.nan)
    wanted = percentile(np.sort(energies[np.isfinite(energies)]), case.SHARE).value
    assert list(np.flatnonzero(energies == wanted)) == [case.TRIAL]


def test_the_rock_is_handed_over_as_the_campaign_has_it(run, landed):
    """Where it passes the search line, which is the receiver's upper side, and with the energy of the percentile."""
    passed, at = landed[case.TRIAL], case.LEAD_TIME
    for name, value in (
        ("position.x", passed[PASSAGE.x]),
        ("position.y", passed[PASSAGE.y]),
        ("angular_velocity", passed[PASSAGE.omega]),
        ("energy.kinetic", passed[PASSAGE.kinetic]),
    ):
        found = np.interp(at, run.series["time"], run.series[f"rock.{name}"])
        assert found == pytest.approx(value, rel=2e-3)
    assert run.series["rock.handover.time"][-1] == pytest.approx(at, abs=1e-9)
    assert run.series["rock.velocity.x"][0] > 5.0
    assert impact_energy(run) == pytest.approx(passed[PASSAGE.kinetic], rel=2e-3)


def test_it_hits_and_bounces(run):
    force, speed = run.series["sand.rock.force.y"], run.series["rock.velocity.y"]
    assert force.max() > 2e5
    assert force[-1] == 0.0
    assert speed[-1] > 1.0 > -8.0 > speed.min()
    assert run.series["sand.rock.force.x"].min() < -2e4  # the sand brakes it along the roof too
    assert run.metrics["beam_midspan_deflection_maximum"].value > 0.05


def test_the_books_of_energy_close(run):
    energy = impact_energy(run)
    residual = system_residual(run)
    assert np.abs(residual).max() < 0.005 * energy
    for bond in ("sand_rock", "sand_beam"):
        assert abs(run.metrics[f"coupling_{bond}_energy"].value) < 0.005 * energy
    told = warnings(
        run
    )  # the rock is the 95th percentile's, and a girder of 1993 is no match for it
    assert [message.split(":")[0] for message in told] == ["stress past yield"]


@pytest.mark.slow
def test_it_has_its_table_and_pictures(run, tmp_path):
    rows = {row["quantity"]: (row["computed"], row["unit"]) for row in table(run, {})}
    value, unit = rows["impact energy E0"]
    assert (float(value), unit) == (pytest.approx(129.0, rel=0.02), "kJ")
    told = []
    drawn = draw_all(run, tmp_path, told.append, told.append)
    assert {file.stem for file in drawn} == {
        "overview",
        "sand",
        "forces",
        "pressure",
        "penetration",
        "beam",
        "moment",
        "shear",
        "energy",
    }
    assert told == []


@pytest.mark.slow
def test_afterwards_it_goes_on_down_the_slope(tmp_path):
    """Off the roof and over its wall to the ground below; with the impulse-conserving coupling, four times as fast."""
    job = prepare(
        Request(
            "slope-to-cushion",
            coupling="impulse",
            in_process=True,
            options={"stop_time": 2.4, "state_interval": 1.2, "output_interval": 2e-3},
        )
    )
    run = simulate(job.system, tmp_path / "run", sources=job.sources, facts=job.facts)
    assert run.series["rock.position.x"][-1] > 11.0
    assert run.series["rock.position.y"][-1] < 0.0
    assert run.series["rock.impacts"][-1] > run.series["rock.impacts"][0]
    assert run.series["rock.height"].min() > -1.0
    assert np.abs(system_residual(run)).max() < 0.01 * impact_energy(run)
