"""A rock from one's own slope onto one's own shed: hand-over to the bit, files, picture, report."""

import numpy as np
import pytest
from typer.testing import CliRunner

import rockshed
from rockshed.analyses.saved import saved_result
from rockshed.campaigns.keeping import ROOF
from rockshed.campaigns.replay import set_rock_of
from rockshed.cases.below_slope import LEAD_TIME
from rockshed.cases.shed import CAMPAIGN, prepared
from rockshed.commands.app import app
from rockshed.components.slope_rockfall.kernel import on_grid
from rockshed.components.slope_rockfall.records import ARRIVAL
from rockshed.core.results.own_files import own_files
from rockshed.metrics.energy import impact_energy, system_residual
from rockshed.metrics.slope import slope_table
from rockshed.pictures import pictures_of
from tests.slopes_and_sheds import written

COARSE = {"numerics": {"disc_radius": 0.1, "elements": 15}}
"""Few discs: what is tested is not the sand."""
_ON_THE_WAY = {
    **dict.fromkeys(("position.x", "position.y"), True),
    **dict.fromkeys(("velocity.x", "velocity.y", "angular_velocity", "energy.kinetic"), False),
}
"""Outputs of the rock, and whether they count from the origin of the shed."""


@pytest.fixture(scope="module")
def project(tmp_path_factory):
    """The project's file; it has few discs."""
    return written(tmp_path_factory.mktemp("gully"), project=COARSE)


@pytest.fixture(scope="module")
def run(project, tmp_path_factory):
    """The first 40 ms."""
    system = rockshed.shed(
        project, in_process=True, options={"stop_time": 0.04, "output_interval": 2e-4}
    )
    return rockshed.simulate(system, tmp_path_factory.mktemp("runs") / "gallery")


def differences_until_the_roof(run, origin):
    """Return by how much the rock of a run is elsewhere than in its campaign, until handed over."""
    instance = origin.slope.instance.component.instance(**origin.slope.instance.sizes)
    instance.w[:] = origin.campaign.w
    set_rock_of(origin.campaign, origin.trial, instance)
    instance["trial"] = origin.trial
    instance.initialise()
    begun = on_grid(origin.arrived[origin.trial, ARRIVAL.time] - LEAD_TIME)
    roof = run.provenance["slope"]["roof"]
    now, found = 0.0, []
    for row in range(int(np.argmax(run["rock.received"] > 0.0))):
        instance.step(now, begun + run.time[row] - now)
        now = begun + run.time[row]
        for name, is_shifted in _ON_THE_WAY.items():
            origin_of_shed = roof[name[-1]] if is_shifted else 0.0
            found.append(run[f"rock.{name}"][row] - (instance[name] - origin_of_shed))
    return np.array(found)


def test_the_rock_has_the_bits_of_its_campaign_until_the_roof(run, project):
    found = differences_until_the_roof(run, prepared(project).slope.origin)
    assert len(found) >= 6 * 10
    assert (found == 0.0).all()


def test_it_is_handed_over_and_strikes_when_and_where_the_campaign_has_it(run, project):
    found = prepared(project).layout
    assert run["rock.handover.time"][-1] == pytest.approx(found.arrival.lead, abs=1e-9)
    struck = np.flatnonzero(run["sand.rock.force.y"])[0]
    assert run.time[struck] == pytest.approx(
        found.arrival.delay, abs=8e-3
    )  # single discs stand out
    assert run["rock.position.x"][struck] == pytest.approx(found.rock.place, abs=0.1)
    assert run["sand.rock.force.y"].max() > 1e5
    assert run.provenance["sizes"]["rock"]["cells"] == 7


def test_the_books_of_energy_close(run):
    assert np.abs(system_residual(run)).max() < 0.01 * impact_energy(run)


def test_the_campaign_is_kept_as_one_that_was_run_by_itself(run, project):
    kept = saved_result(run.folder / CAMPAIGN)
    alone = rockshed.rockfall(project.parent / "gully.toml")
    assert kept.ends == alone.ends
    assert (kept.records.outcomes[:, 1:3] == alone.records.outcomes[:, 1:3]).all()
    assert (run.folder / CAMPAIGN / ROOF).is_file()
    drawings = kept.pictures_module().drawings
    assert drawings(kept).keys() == drawings(alone).keys()


@pytest.mark.slow
def test_pictures_of_the_campaign_belong_to_the_run_around_it(run):
    """A later run in the same folder replaces them with the rest."""
    done = CliRunner().invoke(app, ["plot", str(run.folder / CAMPAIGN), "--quiet"])
    assert done.exit_code == 0
    pictures = sorted((run.folder / CAMPAIGN / "figures").iterdir())
    assert pictures
    owned = own_files(run.folder)
    assert {file.relative_to(run.folder).as_posix() for file in pictures} <= owned


def test_campaign_and_choice_are_told_and_drawn(run, project, tmp_path):
    told = run.provenance["slope"]
    strikes = prepared(project).slope.origin.strikes
    assert told["low"] <= told["value"] <= told["high"]
    assert told["strikes"] == len(strikes.number)
    (words,) = (text for text in run.notes if "95 %" in text and "strike the cushion" in text)
    assert f"trial {told['trial']}" in words
    assert f"trial {told['trial']}" in run.caption[0]
    (picture,) = (each for each in pictures_of(run) if each.name == "slope")
    picture.draw(tmp_path / "slope.png")
    assert (tmp_path / "slope.png").stat().st_size > 10_000
    table = {row[0]: row[1] for row in slope_table(run).rows}
    assert table["site file"] == "gully.toml"
    assert table["rocks that strike the cushion"] == str(len(strikes.number))


@pytest.mark.slow
def test_a_study_varies_the_choice(project):
    found = rockshed.study(
        project,
        {"slope.percentile": [50.0, 90.0]},
        options={"stop_time": 0.02},
        workers=1,
    )
    energies = [run.metrics["impact_energy"] for run in found.records.runs]
    assert energies[0] < energies[1]


@pytest.mark.slow
@pytest.mark.parametrize("runtime", ["native", "python"])
def test_with_fmus_the_rock_has_the_same_bits_and_comes_to_a_stop(project, runtime, tmp_path):
    done = rockshed.simulate(rockshed.shed(project, runtime=runtime), tmp_path / "run")
    found = differences_until_the_roof(done, prepared(project).slope.origin)
    assert len(found) > 0
    assert (found == 0.0).all()
    assert np.abs(system_residual(done)).max() < 0.01 * impact_energy(done)
    assert not any("before the rock" in text for text in done.warnings)
    (page,) = rockshed.report(done, tmp_path / "report.html")
    for text in ("rocks that strike the cushion", "gully.toml", "a disc of the campaign"):
        assert text in page.read_text(encoding="utf-8")
