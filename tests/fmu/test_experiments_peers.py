"""From the manifest alone, experiments of our FMUs pass in other tools within their tolerances."""

import pytest

from rockshed.components.catalogue import NAMES

from .peers import RUNNER, TOOLS, missing, runner, shares

LEAST = 0.95


def test_the_program_of_the_page_has_forty_lines_at_most():
    assert len([line for line in RUNNER.splitlines() if line.strip()]) <= 40
    assert "rockshed" not in RUNNER


def test_the_program_of_the_page_runs_an_fmu_of_fmi_3(fmi3_fmus):
    outcome = runner()["run_all"](str(fmi3_fmus["SlopeRockfall"]))
    assert len(outcome) >= 7
    assert max(share for share, _ in outcome.values()) <= 1.0


def late(tool, name):
    return (
        [] if (tool, name) in (("fmpy", "FallingRock"), ("ecos", "Hammer")) else [pytest.mark.slow]
    )


@pytest.mark.parametrize(
    ("tool", "name"),
    [
        pytest.param(
            tool,
            name,
            marks=[
                pytest.mark.peers,
                pytest.mark.skipif(bool(missing(tool)), reason=f"not installed: {missing(tool)}"),
                *late(tool, name),
            ],
        )
        for tool in TOOLS
        for name in NAMES
    ],
)
def test_experiments_pass_in_other_tools(tool, name, native_fmus):
    outcome = shares(tool, native_fmus[name])
    bad = {k: v for k, v in outcome.items() if v[0] is None or v[0] > 1.0}
    assert len(bad) <= (1.0 - LEAST) * len(outcome), bad
