"""The laboratory impact as a co-simulation of FMUs against one monolithic program of the same physics."""

import numpy as np
import pytest

import rockshed
from rockshed.bench.monolithic import Monolith, from_system
from rockshed.cases.sonoda1993 import lab_system
from rockshed.cases.sonoda1993 import tests as laboratory_tests
from rockshed.components.sand_cushion import COMPONENT as SAND
from rockshed.components.sand_cushion.declarations import ROW
from rockshed.core.errors import InputRefused, RunFailed
from rockshed.core.results.reading import StoredRun, read_run
from rockshed.core.run import simulate
from rockshed.core.system.other_values import with_values
from rockshed.core.system.system import SystemSpec
from rockshed.fmus.build import build_if_needed
from rockshed.metrics import names
from rockshed.metrics.headlines import headlines
from rockshed.metrics.values import integral
from tests.cosim.mocks import called_back

END = 0.02
IMPACT_ENERGY = 0.5 * 4.0 * 8.0**2


@pytest.fixture(scope="module")
def fmus() -> dict[str, str]:
    names = {"rock": "FallingRock", "sand": "SandCushion", "beam": "RBSMBeam"}
    return {key: str(build_if_needed(name)) for key, name in names.items()}


def system(fmus: dict[str, str], coupling: str = "paper") -> SystemSpec:
    return lab_system(fmus, laboratory_tests()[4], coupling).model_copy(
        update={"stop_time": END, "state_interval": END}
    )


@pytest.fixture(scope="module")
def paper(fmus, tmp_path_factory) -> StoredRun:
    return simulate(system(fmus), tmp_path_factory.mktemp("paper") / "run")


@pytest.fixture(scope="module")
def monolith(fmus) -> Monolith:
    program = from_system(system(fmus), END)
    program.run()
    return program


def final_sand(run: StoredRun):
    """The sand as the FMU's last serialized state has it."""
    *_, (time, content) = run.states("sand")
    assert time == pytest.approx(END, abs=1e-12)
    instance = SAND.instance()
    begin = content.index(b"rockshed")
    instance.from_bytes(content[begin : begin + len(instance.to_bytes())])
    return instance


def test_positions_equal_the_monolithic_program_bit_for_bit(paper, monolith):
    for axis in ("x", "y"):
        assert paper.series[f"rock.position.{axis}"][-1] == monolith.rock[f"position.{axis}"]
        beam = [paper.series[f"beam.position.{axis}[{i + 1}]"][-1] for i in range(24)]
        np.testing.assert_array_equal(beam, monolith.beam[f"position.{axis}"])
    discs = slice(0, ROW * 370)
    np.testing.assert_array_equal(
        final_sand(paper).state("body")[discs], monolith.sand.state("body")[discs]
    )


def test_the_run_is_no_trivial_one(paper):
    """The rock has come to a depth of several centimetres and the beam has bent."""
    assert paper.metrics["sand_penetration_maximum"].value > 0.05
    assert paper.metrics["beam_midspan_deflection_maximum"].value > 1e-4


def test_impulse_conserving_exchange_is_as_good_at_ten_times_the_step(fmus, monolith, tmp_path):
    run = simulate(system(fmus, "impulse"), tmp_path / "run")
    peak = monolith.column("transmitted_force").max()
    assert run.metrics["sand_transmitted_force_maximum"].value == pytest.approx(peak, rel=0.01)
    assert abs(run.metrics["coupling_sand_rock_energy"].value) < 0.0005 * IMPACT_ENERGY
    assert abs(run.metrics["coupling_sand_beam_energy"].value) < 0.0005 * IMPACT_ENERGY
    work = monolith.column("work_on_rock").sum()
    assert run.metrics["coupling_sand_rock_work_taker"].value == pytest.approx(
        work, abs=0.005 * IMPACT_ENERGY
    )


def test_jacobi_with_held_inputs_shows_its_error_in_the_ledger(fmus, tmp_path):
    """About 1.9 % of the impact energy by the digest of the paper, whose sand had another stiffness."""
    run = simulate(system(fmus, "jacobi"), tmp_path / "run")
    assert (
        0.012 * IMPACT_ENERGY
        < run.metrics["coupling_sand_rock_energy"].value
        < 0.025 * IMPACT_ENERGY
    )
    assert any("sand_rock" in warning for warning in run.provenance["warnings"])


def residual(run: StoredRun) -> float:
    """Largest error of the energy balance of the whole system, as a share of the impact energy: what the components miss
    themselves, and the work that one side of an interface counts and the other does not."""
    names = [f"{name}.energy.residual" for name in ("rock", "sand", "beam")]
    names += [
        "rock.energy.work.contact",
        "sand.energy.work.rock",
        "beam.energy.work.contact",
        "sand.energy.work.beam",
    ]
    return float(np.abs(sum(run.series[name] for name in names)).max()) / IMPACT_ENERGY


def test_energy_residual_is_small_and_halves_with_the_step(fmus, paper, tmp_path):
    half = with_values(
        system(fmus),
        {"sand.internal_step": 5e-6, "rock.internal_step": 5e-6, "beam.internal_step": 5e-7},
    )
    finer = simulate(half.model_copy(update={"exchange_step": 5e-6}), tmp_path / "run")
    assert residual(paper) < 0.006
    assert residual(finer) < 0.6 * residual(paper)


def test_a_single_step_for_sand_and_beam_is_refused_with_both_numbers(fmus, tmp_path):
    coarse = with_values(system(fmus), {"beam.internal_step": 1e-5})
    with pytest.raises(InputRefused, match=r"1e-05.*6\.\d+e-06"):
        simulate(coarse, tmp_path / "run")
    assert not (tmp_path / "run").exists()


def test_a_single_step_diverges_within_a_millisecond_when_it_is_allowed(fmus, tmp_path):
    coarse = with_values(system(fmus), {"beam.internal_step": 1e-5})
    with pytest.raises(
        RunFailed,
        match=r"beam at t = .*diverged.*internal_step is 1e-05 s and the largest stable one 6",
    ):
        simulate(coarse, tmp_path / "run", allow_unstable=True)
    run = read_run(tmp_path / "run")
    assert run.status == "failed"
    assert run.series["time"][-1] <= 1e-3
    assert "beam" in run.provenance["error"]


def test_calls_through_python_give_the_same_bits(fmus, paper, tmp_path):
    laboratory = system(fmus)
    back = simulate(laboratory, tmp_path / "run", sources=called_back(laboratory))
    for name, values in paper.series.items():
        np.testing.assert_array_equal(values, back.series[name], err_msg=name)


def test_headline_impulses_do_not_depend_on_the_rows(fmus, paper, tmp_path):
    """Two rows say as much as two hundred: the momentum that the rock has lost, against gravity too. The force has not ended,
    and half an exchange step of it is what may be missing."""
    coarse = simulate(
        system(fmus, "impulse").model_copy(update={"output_interval": END}), tmp_path / "run"
    )
    assert coarse.series["time"].size == 2
    for run, tolerance in ((paper, 3e-4), (coarse, 3e-3)):
        change = run.series["rock.velocity.y"][-1] - run.series["rock.velocity.y"][0]
        gravity = run.provenance["components"]["rock"]["parameters"]["gravity"]["value"]
        found = {figure.name: figure.value for figure in headlines(run)}
        assert found[names.IMPULSE_ROCK] == pytest.approx(
            4.0 * (change + gravity * END), rel=tolerance
        )
    fine = integral(paper, "sand.transmitted_force")
    assert integral(coarse, "sand.transmitted_force") == pytest.approx(fine, rel=0.02)


def test_the_least_distance_of_rock_and_base_needs_no_recorded_beam(tmp_path):
    """The beam is in its place whatever of it is recorded: layer less depth, but for its own way."""
    options = {"in_process": True, "coupling": "impulse", "stop_time": 0.012}
    plain = rockshed.simulate(rockshed.case("lab-impact", **options))
    bare = rockshed.simulate(rockshed.case("lab-impact", **options, record=["sand.*", "rock.*"]))
    name = "least_distance_of_rock_and_base"
    assert not any(column.startswith("beam.position") for column in bare)
    assert bare.metrics[name].value == plain.metrics[name].value
    depth = plain.metrics["penetration"].value
    sag = np.abs(plain["beam.midspan.deflection"].values).max()
    assert plain.metrics[name].value == pytest.approx(0.1 - depth, abs=sag + 1e-4)
    assert 0.0 < sag < 2e-3
