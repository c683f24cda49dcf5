"""Outputs of a campaign: motion at the lines, trials of the percentiles, trajectories, unfinished trials."""

import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import rockshed
from rockshed.analyses.rockfall import pictures
from rockshed.analyses.rockfall.result import RockfallResult
from rockshed.analyses.saved import saved_result
from rockshed.campaigns.statistics import fitting
from rockshed.components.slope_rockfall.records import OUTCOME, PASSAGE, UNFINISHED
from rockshed.core.errors import InputRefused

SLOPE = Path(rockshed.__file__).parent / "examples" / "slope.toml"


@pytest.fixture(scope="module")
def campaign(tmp_path_factory):
    folder = tmp_path_factory.mktemp("campaign") / "slope"
    return rockshed.rockfall(SLOPE, trials=60, trajectories=20, folder=folder, pictures=False)


def test_every_line_has_place_velocity_and_spin_of_each_trial(campaign):
    table = campaign.to_arrow()
    for name in ("x", "y", "velocity.x", "velocity.y", "angular_velocity"):
        assert f"road.{name}" in table.column_names
    vx, vy, speed = (
        table[f"upper slope.{name}"].to_numpy() for name in ("velocity.x", "velocity.y", "speed")
    )
    np.testing.assert_allclose(np.hypot(vx, vy), speed, rtol=1e-12)
    assert np.all(vx > 0.0)


def test_the_trial_of_a_percentile_has_its_value(campaign):
    number = campaign.metrics["line_upper_slope_energy_p90_trial"].value
    value = campaign.metrics["line_upper_slope_energy_p90"].value
    assert campaign.records.passages[number, 0, PASSAGE.kinetic] == value


def test_trajectories_lead_from_event_to_event_to_the_end_of_the_trial(campaign):
    import pyarrow.parquet

    rows = pyarrow.parquet.read_table(campaign.folder / "trajectories.parquet").to_pandas()
    assert sorted(rows["trial"].unique()) == list(range(20))
    for number, path in rows.groupby("trial"):
        span = np.diff(path["time"])
        assert np.all(span >= 0.0)
        for axis in "xy":
            x, v, a = (
                path[f"{kind}.{axis}"].to_numpy()[:-1]
                for kind in ("position", "velocity", "acceleration")
            )
            there = x + span * (v + 0.5 * span * a)
            np.testing.assert_allclose(there, path[f"position.{axis}"].to_numpy()[1:], atol=1e-6)
        end = campaign.records.outcomes[number]
        assert path["position.x"].iloc[-1] == pytest.approx(end[OUTCOME.x], abs=1e-9)
        assert path["time"].iloc[-1] == pytest.approx(end[OUTCOME.time], abs=1e-9)


def test_as_many_trajectories_as_there_are_trials_can_be_had(campaign):
    assert len(set(campaign.to_trajectories()["trial"].to_pylist())) == 60
    with pytest.raises(InputRefused, match="neither all nor a number"):
        rockshed.rockfall(SLOPE, trials=5, trajectories=6)


def test_a_stored_trial_replays_without_a_new_campaign(campaign):
    stored = saved_result(campaign.folder)
    assert isinstance(stored, RockfallResult)
    again, first = stored.replay(17), campaign.replay(17)
    np.testing.assert_array_equal(again.x, first.x)
    np.testing.assert_array_equal(again.energy, first.energy)


def test_a_curve_is_drawn_only_of_a_distribution_that_no_test_rejects():
    chance = np.random.default_rng(1)
    rejected = sum(fitting(chance.normal(5.0, 1.0, 300)) != "normal" for _ in range(200))
    assert 0 < rejected < 24  # 5 % of 200, and two and a half deviations more
    assert fitting(np.exp(np.random.default_rng(0).normal(1.0, 0.8, 500))) == "lognormal"
    assert fitting(chance.uniform(0.0, 1.0, 500)) == ""
    assert fitting(np.full(100, 3.0)) == ""
    assert fitting(np.array([1.0, 2.0])) == ""


def test_trials_that_are_not_finished_are_told_and_shown_where_they_are(campaign):
    outcomes = campaign.records.outcomes.copy()
    outcomes[:3, OUTCOME.end], outcomes[:3, OUTCOME.x] = UNFINISHED, 33.0
    made = RockfallResult(
        campaign.slope, campaign.campaign, replace(campaign.records, outcomes=outcomes), 1.0, {}
    )
    (warning,) = made.warnings
    assert warning.startswith("3 of 60 trials are not finished")
    labels = [
        text.get_text()
        for text in pictures.drawings(made)["ends"]().axes[1].get_legend().get_texts()
    ]
    assert "not finished: where they were: 3" in labels


def test_percentiles_that_the_sample_does_not_bear_are_told(campaign):
    told = [note for note in campaign.notes if "do not bear a percentile" in note]
    assert any(
        note.startswith("upper slope: 60 rocks pass") and "of 95 %, 99 %:" in note for note in told
    )
    assert all("from 72 rocks on" in note for note in told if "of 95 %, 99 %:" in note)
    (line,) = [line for line in campaign.lines if line.name == "upper slope"]
    assert [found.share for found in line.percentiles("energy")] == [0.5, 0.9]
    assert "line.upper slope.energy.p95" not in campaign.metrics
    assert np.isnan(campaign.envelopes["energy"]["p95"]).all()


def test_results_without_the_velocity_at_the_lines_can_still_be_read(campaign, tmp_path):
    import pyarrow.parquet

    folder = tmp_path / "older"
    shutil.copytree(campaign.folder, folder)
    table = pyarrow.parquet.read_table(folder / "trials.parquet")
    kept = [name for name in table.column_names if ".velocity." not in name]
    pyarrow.parquet.write_table(table.select(kept), folder / "trials.parquet")
    stored = saved_result(folder)
    assert np.isnan(stored.records.passages[:, :, PASSAGE.vx]).all()
    assert stored.ends == campaign.ends
