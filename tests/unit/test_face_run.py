"""``rockshed.simulate`` and the run that it gives: that of ``rockshed run``, by names."""

import gc
import json

import pytest
from typer.testing import CliRunner

import rockshed
from rockshed.commands.app import app


@pytest.fixture(scope="module")
def run():
    return rockshed.simulate(rockshed.case("lab-impact", in_process=True, stop_time=0.004))


def test_it_is_the_run_of_the_command(tmp_path, monkeypatch):
    """Metrics, references, warnings, rows and files; a rock that comes down to the base is warned of."""
    monkeypatch.chdir(tmp_path)
    values = {"sand.modulus": 3e5}
    options = {"coupling": "impulse", "stop_time": 0.03}
    system = rockshed.case("lab-impact", in_process=True, values=values, **options)
    here = rockshed.simulate(system, "here")
    said = CliRunner().invoke(
        app,
        [
            "run",
            "lab-impact",
            "--in-process",
            "--set",
            "sand.modulus=3e5",
            "--coupling",
            "impulse",
            "--stop-time",
            "0.03",
            "--no-figures",
            "--json",
            "--output-dir",
            "there",
        ],
    )
    content = json.loads(said.stdout)
    there = rockshed.read_run("there")
    timed = {"wall_time_of_the_exchanges"}
    assert set(here.metrics) == set(there.metrics)
    assert {n: m for n, m in here.metrics.items() if n not in timed} == {
        n: m for n, m in there.metrics.items() if n not in timed
    }
    assert here.metrics["peak_transmitted_force"].references["paper"].note
    assert here.warnings == there.warnings == content["warnings"] != []
    assert here.caption == there.caption == content["caption"]
    assert all((here[name].values == there[name].values).all() for name in here)
    files = [{path.name for path in run.folder.iterdir()} for run in (here, there)]
    assert files[0] == files[1]
    read = rockshed.read_run("here")
    assert read.metrics == here.metrics


def test_variables_have_units_and_what_is_missing_is_answered_with_the_nearest(run):
    force = run["sand.rock.force.y"]
    assert (force.unit, len(force)) == ("N", run.time.size)
    for missing, near in (("rock.positon.x", "rock.position.x"), ("sand", "sand.")):
        with pytest.raises(KeyError, match=near):
            run[missing]
    with pytest.raises(KeyError, match="peak_transmitted_force"):
        run.metrics["peak transmited force"]


def test_any_variables_are_drawn_in_a_panel_for_each_unit(run):
    figure = run.plot(
        "rock.force.y" if "rock.force.y" in run else "sand.rock.force.y", "beam.energy.*"
    )
    labels = [axes.get_ylabel() for axes in figure.axes]
    assert labels == ["force (N)", "energy (J)"]
    assert figure.axes[-1].get_xlabel() == "time (ms)"
    named = [text.get_text() for text in figure.axes[1].get_legend().get_texts()]
    assert "beam.energy.elastic" in named
    assert "lab-impact: Sonoda" in figure.get_supxlabel()
    assert not any(text.get_parse_math() for text in figure.axes[0].get_legend().get_texts())
    with pytest.raises(KeyError, match="did you mean"):
        run.plot("rock.velocity.q")


def test_a_plot_of_a_whole_array_has_a_colour_for_each_element_and_room_for_its_legend(
    run, tmp_path
):
    figure = run.plot("beam.moment[*]")
    figure.savefig(tmp_path / "moment.png")  # lays it out
    (axes,) = figure.axes
    colours = [tuple(line.get_color()) for line in axes.get_lines()]
    assert len(set(colours)) == len(colours) == 24
    inches = figure.get_size_inches()[0] * axes.get_position().width
    assert inches > 4.0


def test_a_series_is_calculated_with(run):
    height = run["rock.position.y"]
    assert (2.0 * height - height == height.values).all()
    assert height.max() == height.values.max() >= height.min()
    with pytest.raises(rockshed.InputRefused, match="no variable to draw"):
        run.plot()


def test_pictures_are_files_by_name(run, tmp_path):
    drawn = run.figures(tmp_path / "drawn")
    assert {"forces", "energy"} <= set(drawn)
    assert all(file.read_bytes().startswith(b"\x89PNG") for file in drawn.values())


def test_a_run_shows_itself_in_a_line(run):
    assert repr(run).startswith("<Run lab-impact: complete, 0.004 s in 41 rows of ")
    assert "peak transmitted force" in run._repr_html_()
    assert "peak transmitted force" in repr(run.table())
    assert run.status == "complete"


def test_results_as_tables(run):
    assert run.to_arrow().column_names[0] == "time"
    pytest.importorskip("pandas")
    assert run.to_pandas()["rock.position.y"].iloc[0] == run["rock.position.y"][0]


def test_results_without_a_folder_go_with_the_run_unless_they_are_saved(tmp_path):
    fall = rockshed.System.new("fall", exchange_step=1e-3, stop_time=0.01)
    run = rockshed.simulate(fall.add("rock", "FallingRock"))
    folder = run.folder
    assert folder.is_dir()
    kept = rockshed.read_run(run.save(tmp_path / "kept"))
    with pytest.raises(rockshed.InputRefused, match="name a new folder"):
        run.save(tmp_path / "kept")
    del run
    gc.collect()
    assert not folder.exists()
    assert kept.status == "complete"


def test_a_refused_system_leaves_nothing(tmp_path):
    with pytest.raises(rockshed.InputRefused, match="allowed is"):
        rockshed.simulate(
            rockshed.case("lab-impact", in_process=True, values={"rock.mass": -4}), tmp_path / "run"
        )
    assert list(tmp_path.iterdir()) == []


def test_a_run_that_fails_tells_why_and_has_what_was_computed():
    unstable = rockshed.case("lab-impact", in_process=True, values={"beam.internal_step": 1e-5})
    with pytest.raises(
        rockshed.RunFailed, match="the beam diverged: a displacement exceeds half the span"
    ) as failure:
        rockshed.simulate(unstable, allow_unstable=True)
    run = failure.value.run
    assert run.status == "failed"
    assert run.time.size
    assert run.error == str(failure.value)


def test_progress_is_told(tmp_path):
    told = []
    fall = rockshed.System.new("fall", exchange_step=1e-3, stop_time=0.01)
    rockshed.simulate(
        fall.add("rock", "FallingRock"), progress=lambda reached, stop: told.append((reached, stop))
    )
    assert told[-1] == (pytest.approx(0.01), pytest.approx(0.01))


def test_a_name_with_a_star_gives_all_variables_that_fit_as_a_table(run):
    moments = run["beam.moment[*]"]
    assert list(moments)[:2] == ["beam.moment[1]", "beam.moment[2]"]
    assert len(moments) == 24
    rows = moments.values_by_row
    assert rows.shape == (run.time.size, 24)
    assert (rows[:, 11] == run["beam.moment[12]"].values).all()
    frame = moments.to_pandas()
    assert frame["beam.moment[12]"].tolist() == run["beam.moment[12]"].values.tolist()
    assert frame.index.name == "time"
    with pytest.raises(KeyError, match="did you mean"):
        run["beam.momnt[*]"]


def test_a_notebook_shows_variables_metrics_systems_and_runs_with_their_values(run):
    force = run["sand.rock.force.y"]._repr_html_()
    assert "<td>sand.rock.force.y</td><td>N</td>" in force
    assert f"<td>{run['sand.rock.force.y'].max():.6g}</td>" in force
    peak = run.metrics["peak_transmitted_force"]
    assert f"<td>{peak}</td>" in peak._repr_html_()
    assert "beam.moment[24]" in run["beam.moment[*]"]._repr_html_()
    assert "peak bending moment" in run._repr_html_()
    system = rockshed.case("lab-impact", in_process=True, values={"beam.damping.mass": 7.5})
    assert "damping.mass = 7.5" in system._repr_html_()
    assert "rock_radius" in system._repr_html_() or "rock_mass" in system._repr_html_()


def test_dir_shows_what_is_public(run):
    assert dir(rockshed) == sorted(rockshed.__all__)
    assert {"plot", "metrics", "to_pandas"} <= set(dir(run))
    assert not any(name.startswith("_") for name in dir(run))


def test_cases_and_components_are_listed_as_tables():
    cases = {row["case"]: row for row in rockshed.list_cases()}
    assert cases["lab-impact"]["other names"] == "lab-impact-4"
    assert len(cases) == 26
    parts = {row["component"]: row for row in rockshed.list_components()}
    assert parts["RBSMBeam"]["sizes"] == "elements = 24, support_count = 2"


def test_the_first_compilation_is_told_once_and_by_name(monkeypatch, caplog):
    from rockshed.components.catalogue import component
    from rockshed.runs import first_compilation

    monkeypatch.setattr(first_compilation, "has_kernels", lambda folder: folder.name == "hammer")
    monkeypatch.setattr(first_compilation, "_told", set())
    asked = [component("RBSMBeam"), component("Hammer")]
    for _ in range(2):
        first_compilation.tell_first_compilation(asked)
    assert [record.getMessage() for record in caplog.records] == [
        "compiling kernels of RBSMBeam, once on this machine (a minute or two)"
    ]
