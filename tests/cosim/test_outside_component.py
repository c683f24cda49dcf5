"""A component from a folder of its own takes part in everything by its declarations: nothing else is touched for it."""

from pathlib import Path

import pytest

import rockshed
from rockshed.components.catalogue import component_in
from rockshed.fmus.build import BuildError
from rockshed.fmus.native.fmu import compiler, own_platform
from rockshed.metrics.energy import system_residual
from rockshed.pictures.energy import layers

FOLDER = Path(__file__).parent / "outside" / "spring_buffer"
SIDES = ("left", "right")


@pytest.fixture(scope="module")
def buffer():
    return component_in(FOLDER)


def shed(kinds):
    """The impact of the laboratory, its beam on two buffers."""
    system = rockshed.case("lab-impact", in_process=True, stop_time=0.01)
    names = [f"buffer_{side}" for side in SIDES]
    for number, (name, kind) in enumerate(zip(names, kinds, strict=True), 1):
        system = system.add(name, kind)
        system = system.connect(
            f"beam.support.mean_force.y[{number}] -> {name}.force.y",
            f"{name}.position.y -> beam.support.position.y[{number}]",
            f"{name}.velocity.y -> beam.support.velocity.y[{number}]",
        )
        system = system.bond(
            name,
            f"beam.support.mean_force.y[{number}]",
            f"{name}.position.y",
            work=f"beam.support.work[{number}]",
        )
    return system


@pytest.fixture(scope="module")
def run(buffer):
    return rockshed.simulate(shed([buffer, buffer]))


def test_its_declared_figures_are_metrics_of_each_instance(run):
    for side in SIDES:
        compression = run.metrics[f"buffer_{side}_largest_compression"]
        assert compression.value == run.series[f"buffer_{side}.compression"].max() > 1e-5
        assert compression.unit == "m"
    assert run.metrics["peak_transmitted_force"].value > 1e3


def test_they_are_rows_of_the_table_in_the_unit_that_is_declared(run):
    rows = {row["quantity"]: row for row in run.table()}
    row = rows["buffer_left: largest compression"]
    millimetres = 1e3 * run.metrics["buffer_left_largest_compression"].value
    assert (row["unit"], row["computed"]) == ("mm", f"{millimetres:.3f}")


def test_its_energies_close_the_balance_of_the_system(run):
    lost = run.series["buffer_left.energy.damping"][-1]
    given = run.series["buffer_left.energy.work.contact"][-1]
    assert given > lost > 1e-3
    assert abs(run.series["buffer_left.energy.residual"]).max() < 1e-9 * given
    alone = rockshed.simulate(rockshed.case("lab-impact", in_process=True, stop_time=0.01))
    impact = run.metrics["impact_energy"].value
    residual = abs(system_residual(run)).max()
    assert residual < abs(system_residual(alone)).max() + 1e-3 * impact
    assert [text for text in run.warnings if not text.startswith("the run ends at 10 ms")] == []


def test_its_energies_are_layers_under_their_label(run):
    labels = [layer.label for layer in layers(run)]
    assert "buffers, kinetic and elastic" in labels


@pytest.mark.slow
def test_it_has_a_picture_of_its_own(run, tmp_path):
    pictures = run.figures(tmp_path)
    assert pictures["buffers"].stat().st_size > 10_000


@pytest.mark.slow
def test_fmus_of_it_give_the_same_results(run, buffer, tmp_path):
    files = [rockshed.build_fmu(buffer, folder=tmp_path)]
    try:
        compiler(own_platform())
        files.append(rockshed.build_fmu(buffer, folder=tmp_path, runtime="native"))
    except BuildError:
        files.append(files[0])
    exported = rockshed.simulate(shed(files))
    for name in run:
        assert (exported.series[name] == run.series[name]).all(), name
    assert exported.metrics["buffer_right_largest_compression"].unit == "m"
    assert exported.figures(tmp_path)["buffers"].is_file()
