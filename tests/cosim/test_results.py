"""The files of a run, and what happens to them when something goes wrong."""

import csv
import json
import math
import subprocess
import sys

import h5py
import numpy as np
import pyarrow.parquet
import pytest
from fmpy.util import read_csv

from rockshed.core.errors import InputRefused
from rockshed.core.results.metric import Metric
from rockshed.core.results.own_files import add_files
from rockshed.core.results.reading import add_metrics, read_run
from rockshed.core.results.run_folder import Column, RunFolder, running_folder
from rockshed.core.run import simulate
from tests.cosim.mocks import Mock, mass, out, spring, wired

LINKS = ["spring.end1.force -> mass.force", "mass.position -> spring.end1.position"]


@pytest.fixture
def result(tmp_path):
    system, sources = wired(
        {"spring": spring(4.0), "mass": mass(1.0, position=1.0)},
        LINKS,
        exchange_step=0.01,
        output_interval=0.1,
        state_interval=0.25,
        components={"mass": {"record_states": True, "parameters": {"mass": 2.0}}},
    )
    return simulate(system, tmp_path / "deep" / "run", sources=sources, facts={"case": "test"})


def test_the_folder_holds_these_files_and_nothing_else(result):
    assert sorted(path.name for path in result.folder.iterdir()) == [
        "columns.csv",
        "run.json",
        "states.h5",
        "summary.json",
        "timeseries.csv",
        "timeseries.parquet",
    ]
    assert [path.name for path in result.folder.parent.iterdir()] == ["run"]


def test_all_forms_of_the_time_series_agree_and_carry_units(result):
    table = pyarrow.parquet.read_table(result.folder / "timeseries.parquet")
    rows = read_csv(result.folder / "timeseries.csv")
    names = ["time", "spring.end1.force", "mass.position", "mass.velocity"]
    assert table.column_names == list(rows.dtype.names) == list(result.series) == names
    for name in names:
        assert table[name].to_pylist() == rows[name].tolist() == result.series[name].tolist()
    assert result.series["time"].tolist() == [n / 10 for n in range(11)]
    units = {"time": "s", "spring.end1.force": "N", "mass.position": "m", "mass.velocity": "m/s"}
    assert {f.name: f.metadata[b"unit"].decode() for f in table.schema} == units
    with (result.folder / "columns.csv").open() as file:
        assert {row["name"]: row["unit"] for row in csv.DictReader(file)} == units
    assert {column.name: column.unit for column in result.columns} == units


def test_states_are_in_the_file_with_their_times(result):
    frames = list(result.states("mass"))
    assert [time for time, _ in frames] == [0.0, 0.25, 0.5, 0.75, 1.0]
    with h5py.File(result.folder / "states.h5") as file:
        assert file["mass/time"].attrs["unit"] == "s"
        assert file["mass/state/3"][:].tobytes() == frames[3][1]
    assert list(result.states("spring")) == []


def test_the_provenance_tells_what_was_run(result):
    told = json.loads((result.folder / "run.json").read_text())
    assert (told["status"], told["error"], told["case"]) == ("complete", None, "test")
    assert told["components"]["mass"]["parameters"]["mass"] == {"value": 2.0, "unit": "kg"}
    assert told["components"]["mass"]["parameters"]["position0"] == {"value": 1.0, "unit": "m"}
    first = told["system"]["connections"][0]
    assert (first["source"], first["target"]) == ("spring.end1.force", "mass.force")
    assert first["factor"] is first["offset"] is None
    assert {"python", "rockshed", "numpy", "numba", "fmpy", "pythonfmu"} <= set(told["versions"])
    assert told["started"] < told["ended"]
    assert set(told["wall_time"]) == {"preparation", "exchanges", "recording"}


def test_figures_can_be_added_and_replaced(result):
    add_metrics(result.folder, [Metric("mine", 1.5, "kN"), Metric("exchanges", 7)])
    again = read_run(result.folder)
    assert (
        again.metrics["mine"].value,
        again.metrics["mine"].unit,
        again.metrics["exchanges"].value,
    ) == (1.5, "kN", 7)
    assert list(again.metrics).count("exchanges") == 1
    assert len(json.loads((result.folder / "summary.json").read_text())) == len(again.metrics)


def test_a_variable_of_a_run_has_its_unit_and_behaves_as_its_values(result):
    position = result["mass.position"]
    assert (position.name, position.unit, len(position)) == ("mass.position", "m", 11)
    assert position.values is result.series["mass.position"]
    assert position.time is result.time
    assert np.max(position) == position.values.max()
    assert position[-1] == list(position)[-1] == np.asarray(position)[-1]
    assert np.asarray(position, np.float32).dtype == np.float32
    assert repr(position).startswith("<mass.position (m): 11 values, t = 0 to 1 s, ")
    assert list(result) == list(result.series)
    assert "mass.position" in result


def test_a_name_that_a_run_has_not_is_a_key_error_with_the_nearest_ones(result):
    with pytest.raises(KeyError, match=r"no variable 'mass.positon'; did you mean mass.position"):
        result["mass.positon"]
    with pytest.raises(KeyError, match=r"no metric 'exchange'; did you mean exchanges"):
        result.metrics["exchange"]


def test_a_run_says_in_short_what_it_is(result):
    assert repr(result) == (
        f"<Run test: complete, 1 s in 11 rows of 3 variables, in {result.folder}>"
    )
    assert "simulated_time" in repr(result.metrics)
    assert "simulated_time" in result._repr_html_()
    assert (result.status, result.error, result.warnings) == ("complete", None, [])


def test_the_time_series_as_a_table_carry_units(result):
    table = result.to_arrow()
    assert table.column_names == list(result)
    assert table.schema.field("mass.position").metadata[b"unit"] == b"m"
    pytest.importorskip("pandas")
    frame = result.to_pandas()
    assert frame.index.name == "time"
    assert frame["mass.position"].to_numpy().tolist() == result.series["mass.position"].tolist()
    assert frame.attrs["units"]["mass.position"] == "m"


def test_what_other_programs_add_to_a_summary_is_passed_over(result):
    path = result.folder / "summary.json"
    path.write_text(
        json.dumps(
            [
                {
                    "name": "theirs",
                    "value": 2.0,
                    "unit": "m",
                    "checked": True,
                    "references": {"paper": {"value": 4.0, "deviation": -0.5, "page": 7}},
                }
            ]
        )
    )
    theirs = read_run(result.folder).metrics["theirs"]
    assert (
        theirs.value,
        theirs.references["paper"].value,
        theirs.references["paper"].deviation,
    ) == (2.0, 4.0, -0.5)


def test_integers_and_inputs_can_be_recorded(tmp_path):
    count = Mock([out("n", kind="Integer"), out("x")], lambda v, t, h: v.update(n=v["n"] + 1))
    system, sources = wired({"a": count, "m": mass()}, [], record=["a.n", "m.mass", "m.force"])
    result = simulate(system, tmp_path / "run", sources=sources)
    assert result.series["a.n"].tolist() == list(range(11))
    assert list(result.series) == ["time", "a.n", "m.mass", "m.force"]


# ---------------------------------------------------------------------- the folder


def writing(folder):
    opened = RunFolder(folder)
    opened.__enter__()
    opened.begin([Column("x", "m")], {"name": "n"})
    return opened


def test_a_finished_run_is_replaced_as_a_whole(result, tmp_path):
    before = result.series["mass.position"]
    drawn = result.folder / "figures" / "old.png"
    drawn.parent.mkdir()
    drawn.write_text("old")
    add_files(result.folder, [drawn])
    with RunFolder(result.folder) as folder:
        folder.begin([Column("x", "m")], {"name": "n"})
        folder.rows(np.array([0.0]), np.array([[1.0]]))
        assert read_run(result.folder).series["mass.position"].tolist() == before.tolist()
        folder.finish("complete", [])
    assert list(read_run(result.folder).series) == ["time", "x"]
    assert not drawn.parent.exists()
    assert [path.name for path in result.folder.parent.iterdir()] == ["run"]


def test_a_refused_run_leaves_the_earlier_one_alone(result):
    refusing = Mock([out("x")], start=lambda v: (3, "no"))
    system, sources = wired({"a": refusing}, [])
    with pytest.raises(InputRefused):
        simulate(system, result.folder, sources=sources)
    assert read_run(result.folder).status == "complete"
    assert [path.name for path in result.folder.parent.iterdir()] == ["run"]


def test_folders_made_for_a_refused_run_are_removed(tmp_path):
    system, sources = wired({"a": Mock([out("x")], start=lambda v: (3, "no"))}, [])
    with pytest.raises(InputRefused):
        simulate(system, tmp_path / "new" / "newer" / "run", sources=sources)
    assert list(tmp_path.iterdir()) == []


def test_a_folder_of_something_else_is_not_overwritten(tmp_path):
    (tmp_path / "thesis.tex").write_text("important")
    with (
        pytest.raises(
            InputRefused,
            match="is no folder of a run, and would be overwritten; choose another folder",
        ),
        RunFolder(tmp_path),
    ):
        pass
    assert (tmp_path / "thesis.tex").read_text() == "important"


def test_a_folder_that_cannot_be_written_is_refused_before_anything_is_computed(tmp_path):
    (tmp_path / "file").write_text("")
    counted = Mock([out("x")])
    system, sources = wired({"a": counted}, [])
    with pytest.raises(InputRefused, match="cannot be written"):
        simulate(system, tmp_path / "file" / "run", sources=sources)
    assert counted.calls == []


def test_two_runs_into_one_folder(tmp_path):
    first = writing(tmp_path / "run")
    with (
        pytest.raises(
            InputRefused,
            match="another run is writing there; wait for its end or choose another folder",
        ),
        RunFolder(tmp_path / "run"),
    ):
        pass
    first.rows(np.array([0.0]), np.array([[1.0]]))
    first.finish("complete", [])
    first.__exit__(None, None, None)
    assert read_run(tmp_path / "run").series["x"].tolist() == [1.0]
    with RunFolder(tmp_path / "run"):
        pass


def test_two_processes_into_one_folder(tmp_path):
    first = writing(tmp_path / "run")
    script = "import sys, pathlib, rockshed.core.results.run_folder as r; r.RunFolder(pathlib.Path(sys.argv[1])).__enter__()"
    second = subprocess.run(
        [sys.executable, "-c", script, str(tmp_path / "run")],
        capture_output=True,
        text=True,
        check=False,
    )
    assert "another run is writing there" in second.stderr
    first.__exit__(None, None, None)


def test_a_stream_that_was_cut_off_is_read_up_to_the_cut(tmp_path):
    first = writing(tmp_path / "run")
    for n in range(0, 1100, 100):
        numbers = np.arange(n, n + 100.0)
        first.rows(0.1 * numbers, numbers[:, None])
    stream = running_folder(tmp_path / "run") / "timeseries.arrows"
    stream.write_bytes(stream.read_bytes()[:-100])
    kept = read_run(tmp_path / "run")
    assert kept.status == "running"
    assert kept.series["x"].tolist() == list(range(1000))
    assert {column.name: column.unit for column in kept.columns} == {"time": "s", "x": "m"}
    first.__exit__(None, None, None)


def test_a_stream_whose_rows_do_not_fit_the_columns_is_refused(tmp_path):
    first = writing(tmp_path / "run")
    first.rows(np.array([0.0]), np.array([[1.0]]))
    with (running_folder(tmp_path / "run") / "columns.csv").open("a") as file:
        file.write("y,m,of another run\n")
    with pytest.raises(InputRefused, match="not rows of 3 columns"):
        read_run(tmp_path / "run")
    first.__exit__(None, None, None)


@pytest.mark.parametrize("value", [0.25, math.nan, math.inf])
def test_rows_whose_time_goes_back_or_is_none_are_refused(result, value):
    file = result.folder / "timeseries.parquet"
    table = pyarrow.parquet.read_table(file)
    time = table["time"].to_pylist()
    time[5] = value
    changed = table.set_column(0, table.schema.field("time"), pyarrow.array(time))
    pyarrow.parquet.write_table(changed, file)
    with pytest.raises(InputRefused, match=r"time goes from .* in row [56]"):
        read_run(result.folder)


def test_no_run_at_all(tmp_path):
    with pytest.raises(InputRefused, match=r"is no folder of a run: there is no run\.json"):
        read_run(tmp_path / "nothing")
