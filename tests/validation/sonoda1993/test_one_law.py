"""One contact law for all tests against what was measured: single packings within what single packings scatter."""

import pytest

from rockshed.cases import full_scale, sonoda1993
from rockshed.components.common.units import cm, kgf
from rockshed.core.run import simulate
from rockshed.metrics import names
from rockshed.metrics.headlines import headlines
from rockshed.runs.job import Request, prepare


@pytest.fixture(scope="module")
def figures(tmp_path_factory):
    """Headlines of a case with the one law, by name."""

    def computed(case, **options):
        job = prepare(
            Request(case, coupling="impulse", options=options, model="one-law", in_process=True)
        )
        run = simulate(
            job.system, tmp_path_factory.mktemp(case) / "run", sources=job.sources, facts=job.facts
        )
        return {figure.name: figure.value for figure in headlines(run)}

    return computed


def test_peak_force_and_energy_of_test_4(figures):
    """Mean over packings: within 3 percent of the measured force; one packing scatters by 12 percent."""
    found, test = figures("lab-impact", stop_time=0.03), sonoda1993.tests()[4]
    assert found[names.PEAK_TRANSMITTED] == pytest.approx(test.peak_force, rel=0.2)
    assert found[names.BEAM_ENERGY_FROM_STRAIN] == pytest.approx(sonoda1993.BEAM_ENERGY[4], rel=0.5)
    assert abs(found[names.RESIDUAL_SHARE]) < 0.002


@pytest.mark.slow
def test_static_spring_constant_of_test_4(figures):
    assert figures("static-test")[names.STATIC_STIFFNESS] == pytest.approx(39.1 * kgf / cm, rel=0.4)


@pytest.mark.parametrize("span", [8, 12])
@pytest.mark.slow
def test_energy_in_the_girders(figures, span):
    """Table 6: 5.6 and 7.6 percent; elastic lattices give 33 to 40."""
    name = f"girders-{span}"
    known = full_scale.known_of(full_scale.impacts()[name])[names.BEAM_SHARE_FROM_STRAIN].experiment
    assert figures(name, stop_time=0.16)[names.BEAM_SHARE_FROM_STRAIN] == pytest.approx(
        known.value, rel=0.4
    )
