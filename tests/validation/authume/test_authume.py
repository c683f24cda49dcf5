"""Boulders in the quarry at Authume: the fit of P1 and the forecast of P2 stay those of docs/forecasts.md."""

import tomllib
from pathlib import Path

import numpy as np
import pytest

import rockshed
from rockshed.components.slope_rockfall.records import OUTCOME

DATA = Path(__file__).parent


@pytest.fixture(scope="module", params=["p1", "p2"])
def ends(request):
    """Name of a profile, and the end points of 3000 trials with the likeliest ground."""
    site = tomllib.loads((DATA / f"{request.param}.toml").read_text())
    site["material"] = tomllib.loads((DATA / "calibrated.toml").read_text())["material"]
    site["profile"]["file"] = str(DATA / site["profile"]["file"])
    if "file" in site["rock"]:
        site["rock"]["file"] = str(DATA / site["rock"]["file"])
    made = rockshed.rockfall(site, trials=3000)
    return request.param, made.records.outcomes[:, OUTCOME.x]


INTERVALS = {
    "p1": {5: (25.3, 35.3), 10: (29.2, 36.4), 50: (37.7, 46.8), 90: (52.1, 58.6)},
    "p2": {5: (19.9, 23.7), 10: (20.4, 26.1), 50: (24.4, 42.1), 90: (26.8, 56.6)},
}
"""Of docs/forecasts.md: percentiles of the end points (m), with 90 % of the posterior."""


def test_the_likeliest_ground_gives_percentiles_within_the_frozen_intervals(ends):
    profile, x = ends
    for share, (low, high) in INTERVALS[profile].items():
        assert low <= np.percentile(x, share) <= high


def test_the_page_has_these_intervals():
    page = (DATA.parents[2] / "docs" / "forecasts.md").read_text(encoding="utf-8")
    for low, high in INTERVALS["p1"].values():
        assert f"[{low}, {high}]" in page
    for low, high in INTERVALS["p2"].values():
        assert f"| {low} to {high} |" in page


def test_the_middle_of_p1_is_where_the_boulders_stopped(ends):
    profile, x = ends
    measured = np.genfromtxt(DATA / "endpoints_P1.csv", delimiter=",", skip_header=1)[:, 0]
    if profile == "p1":
        assert np.percentile(x, 50) == pytest.approx(np.percentile(measured, 50), abs=2.0)
