"""Runs that several files look at."""

import pytest

import rockshed


@pytest.fixture(scope="session")
def short_impact(tmp_path_factory):
    """Four milliseconds of the laboratory impact, with nine states; nobody changes it."""
    system = rockshed.case("lab-impact", in_process=True, stop_time=0.004, state_interval=0.0005)
    return rockshed.simulate(system, tmp_path_factory.mktemp("runs") / "run")
