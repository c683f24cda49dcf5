"""A failed run is drawn until it runs away: no outlier rules its axes."""

from dataclasses import replace

import numpy as np
import pytest

from rockshed.metrics import caption
from rockshed.metrics.divergence import RUNAWAY, until_divergence
from rockshed.metrics.values import extreme
from tests.unit.test_headlines import made_up


def failed(energy):
    run = made_up(**{"rock.energy.kinetic": energy})
    return replace(run, provenance={**run.provenance, "status": "failed", "error": "beam"})


def test_a_failed_run_is_cut_where_its_energy_is_a_multiple_of_that_at_the_start():
    energy = np.concatenate([np.full(300, 100.0), 100.0 * 10.0 ** np.arange(101.0)])
    run = failed(energy)
    shown = until_divergence(run)
    assert shown.time.size == 301
    assert shown.series["rock.energy.kinetic"].max() <= RUNAWAY * energy[0]
    assert all(values.size == 301 for values in shown.series.values())


@pytest.mark.parametrize("last", [np.nan, np.inf, 1e300])
def test_a_row_that_is_no_number_is_not_drawn(last):
    energy = np.full(401, 100.0)
    energy[-1] = last
    assert until_divergence(failed(energy)).time.size == 400


def test_a_failed_run_that_has_not_run_away_is_drawn_as_it_is():
    run = failed(np.linspace(100.0, 0.0, 401))
    assert until_divergence(run) is run


def test_a_complete_run_is_drawn_as_it_is():
    run = made_up()
    assert until_divergence(run) is run


def test_the_caption_says_that_rows_are_left_out_and_the_peak_is_that_of_the_others():
    energy = np.full(401, 100.0)
    energy[200:] = 1e6
    run = failed(energy)
    shown = until_divergence(run)
    assert caption.caption(shown)[-1].startswith("drawn until t = 9.95 ms")
    assert extreme(shown, "rock.energy.kinetic")[0] == 100.0
    assert caption.caption(run)[-1].startswith("sequential master")
