"""Runs as animations, and in the files of other programs, read back by their readers."""

import json

import numpy as np
import pytest
from PIL import Image
from typer.testing import CliRunner

import rockshed
from rockshed.commands.app import app


@pytest.fixture
def run(short_impact, tmp_path):
    """A copy that may be written into."""
    return rockshed.read_run(short_impact.save(tmp_path / "impact"))


def test_a_csv_file_is_read_by_fmpy(run):
    fmpy_util = pytest.importorskip("fmpy.util")
    (file,) = run.export("csv")
    assert file == run.folder / "export" / "impact.csv"
    table = fmpy_util.read_csv(str(file))
    assert table.dtype.names == tuple(run.series)
    assert (table["rock.position.y"] == run.series["rock.position.y"]).all()


def test_a_mat_file_is_one_of_dymola(run, tmp_path):
    dymat = pytest.importorskip("DyMat")
    (file,) = run.export("mat4", tmp_path / "impact.mat")
    found = dymat.DyMatFile(str(file))
    assert set(found.names()) >= set(run.series) - {"time"}
    assert (found.data("sand.transmitted_force") == run.series["sand.transmitted_force"]).all()
    assert "[N]" in found.description("sand.transmitted_force")
    assert (found.abscissa("rock.position.y", valuesOnly=True) == run.time).all()
    mass = run.provenance["components"]["rock"]["parameters"]["mass"]["value"]
    assert (found.data("rock.mass") == mass).all()


def test_a_mat_file_has_the_six_arrays_of_its_form(run, tmp_path):
    from scipy.io import loadmat

    (file,) = run.export("mat4", tmp_path / "impact.mat")
    content = loadmat(file, chars_as_strings=False)
    arrays = {"Aclass", "name", "description", "dataInfo", "data_1", "data_2"}
    assert arrays == {name for name in content if not name.startswith("_")}
    kind = ["".join(row).strip() for row in content["Aclass"]]
    assert kind == ["Atrajectory", "1.1", "", "binTrans"]
    assert content["name"].shape[1] == content["dataInfo"].shape[1]
    assert content["data_2"].shape == (len(run.series), run.time.size)


def test_states_are_read_as_vtk_with_places_and_forces(run):
    """The rock stands where its component says, and the sand pushes it upwards."""
    meshio = pytest.importorskip("meshio")
    pytest.importorskip("pyevtk")
    collection, *files = run.export("vtk")
    text = collection.read_text()
    states = list(run.states("sand"))
    assert text.count("_grains.vtu") == len(states) == 9
    assert f'timestep="{states[3][0]}"' in text
    grains = meshio.read(collection.with_name("sand_00008_grains.vtu"))
    beam = meshio.read(collection.with_name("sand_00008_beam.vtu"))
    contacts = meshio.read(collection.with_name("sand_00008_contacts.vtu"))
    assert grains.points.shape[0] == grains.point_data["radius"].size == 371
    rock = grains.point_data["is_rock"].ravel() == 1.0
    row = int(np.abs(run.time - states[8][0]).argmin())
    assert grains.points[rock, 1].item() == pytest.approx(
        run.series["rock.position.y"][row], abs=1e-4
    )
    assert grains.point_data["force"][rock, 1].item() > 0.0
    assert beam.points.shape[0] == 24
    assert contacts.cell_data["normal_force"][0].max() > 0.0
    assert len(files) == 3 * len(states)


def test_an_export_replaces_its_own_files_and_no_others(run, tmp_path):
    assert run.export("csv") == rockshed.read_run(run.folder).export("csv")
    mine = tmp_path / "mine.csv"
    mine.write_text("mine")
    with pytest.raises(rockshed.InputRefused, match="is there already and stays"):
        run.export("csv", mine)
    assert mine.read_text() == "mine"
    with pytest.raises(rockshed.InputRefused, match="'xls' is unknown"):
        run.export("xls")


@pytest.mark.slow
def test_an_animation_has_a_frame_for_each_state_and_stands_still_at_its_end(run, tmp_path):
    file = run.animate(tmp_path / "impact.gif")
    with Image.open(file) as movie:
        frames = movie.n_frames
        first = np.asarray(movie.convert("RGB"))
        movie.seek(8)
        last = np.asarray(movie.convert("RGB"))
    assert frames in (9, 9 + 25)  # equal frames at the end may be one
    assert (first != last).any()


def call(*words):
    return CliRunner().invoke(app, [str(word) for word in words])


def test_the_commands_write_the_same(run, tmp_path):
    done = call("export", run.folder, "--format", "csv", "--output", tmp_path / "a.csv")
    assert (done.exit_code, (tmp_path / "a.csv").is_file()) == (0, True)
    told = call("animate", run.folder, "--output", tmp_path / "a.gif")
    assert told.exit_code == 0
    assert "--state-interval 4e-05" in told.stderr
    assert (tmp_path / "a.gif").is_file()


def test_a_run_without_states_says_how_to_record_some(tmp_path):
    system = rockshed.case("lab-impact", in_process=True, stop_time=0.0002)
    bare = rockshed.simulate(system, tmp_path / "bare")
    for name in ("states.h5", "states.arrows"):
        (bare.folder / name).unlink(missing_ok=True)
    with pytest.raises(rockshed.InputRefused, match="state_interval"):
        bare.animate()
    with pytest.raises(rockshed.InputRefused, match="state_interval"):
        bare.export("vtk")


def test_variables_of_runs_are_drawn_with_the_errors_against_a_measured_curve(run, tmp_path):
    table = tmp_path / "measured.csv"
    table.write_text("time (ms),force (kN)\n0,0\n2,0.5\n4,1.5\n")
    variables = ("--variable", "sand.rock.force.y", "--variable", "rock.velocity.*")
    output = ("--csv", table, "--output", tmp_path / "a.png")
    done = call("plot", run.folder, run.folder, *variables, *output, "--json")
    assert done.exit_code == 0, done.output
    content = json.loads(done.stdout)
    assert [entry["variable"] for entry in content["agreements"]] == ["sand.rock.force.y"] * 2
    assert {"peak", "impulse", "duration"} <= set(content["agreements"][0])
    shown = call("plot", run.folder, *variables, "--csv", table)
    assert "Computed and measured" in shown.stdout
    assert (run.folder / "figures" / "variables.png").is_file()
    wrong = call("plot", run.folder, "--variable", "rock.velocety.y")
    assert wrong.exit_code == 2
    assert "rock.velocity.y" in wrong.stderr
    alone = call("plot", run.folder, "--csv", table)
    assert "belongs to --variable" in alone.stderr
