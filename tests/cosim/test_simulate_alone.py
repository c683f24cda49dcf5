"""One FMU alone, with its inputs from a table: in a run as any other."""

import json

import fmpy
import numpy as np
import pytest
from typer.testing import CliRunner

import rockshed
from rockshed.commands.app import app
from rockshed.core.errors import InputRefused

TABLE = "time,speed,level,enabled\n0,0,1,true\n0.2,2,5,true\n0.2,4,6,false\n0.4,4,6,true\n"


@pytest.fixture
def table(tmp_path):
    file = tmp_path / "in.csv"
    file.write_text(TABLE)
    return file


def test_real_inputs_are_interpolated_and_others_held_at_the_begin_of_each_step(foreign, table):
    system = rockshed.alone(foreign, table, step_size=0.05, start_values={"damping": 3.0})
    run = rockshed.simulate(system)
    assert run.time[-1] == pytest.approx(0.4)  # the end of the table
    begin = run.time[:-1]
    jumped = begin > 0.2 - 1e-9
    speed = np.where(jumped, 4.0, 10.0 * begin)
    force = np.where(jumped, 0.0, -3.0 * speed)  # it is off after the jump
    np.testing.assert_allclose(run["Stranger.force"][1:], force, atol=1e-12)
    np.testing.assert_array_equal(run["Stranger.next_level"][1:], np.where(jumped, 7, 2))
    np.testing.assert_allclose(run["input.speed"][:-1], speed, atol=1e-12)


def test_the_results_are_those_of_fmpy(foreign):
    rows = [(0.0, 0.1), (0.3, 0.7), (0.35, -0.2)]
    table = {"time": [t for t, _ in rows], "speed": [v for _, v in rows]}
    run = rockshed.simulate(rockshed.alone(foreign, table, stop_time=0.4, step_size=0.01))
    signals = np.array(rows, dtype=[("time", float), ("speed", float)])
    options = {"stop_time": 0.4, "step_size": 0.01, "output_interval": 0.01}
    theirs = fmpy.simulate_fmu(str(foreign), input=signals, output=["force"], **options)
    np.testing.assert_allclose(run["Stranger.force"], theirs["force"], rtol=1e-12)


def test_variables_and_rows_can_be_chosen(foreign, table):
    system = rockshed.alone(
        foreign,
        table,
        step_size=0.05,
        output_interval=0.1,
        stop_time=0.3,
        output_variables=["force", "local*"],
    )
    run = rockshed.simulate(system)
    assert list(run) == ["time", "Stranger.force", "Stranger.local_time"]
    np.testing.assert_allclose(run.time, [0.0, 0.1, 0.2, 0.3])


def test_everything_that_is_wrong_is_said_at_once(foreign, tmp_path):
    file = tmp_path / "in.csv"
    file.write_text("time,sped,force,damping\n0,1,1,1\n")
    with pytest.raises(InputRefused) as refused:
        rockshed.alone(foreign, file, start_values={"dampin": 1.0}, output_variables=["x?"])
    said = [str(problem) for problem in refused.value.problems]
    for fault in (
        "sped: is no variable of the FMU; did you mean speed?",
        "force: is no input of the FMU, but of the causality output",
        "damping: is no input of the FMU, but of the causality parameter",
        "start_values dampin: is no variable of the FMU; did you mean damping?",
        "output_variables x?: is no variable of the FMU",
    ):
        assert any(fault in text for text in said), (fault, said)


def test_without_an_end_the_run_is_refused(foreign):
    with pytest.raises(InputRefused, match="give stop_time"):
        rockshed.alone(foreign)


@pytest.mark.parametrize(
    ("table", "what"),
    [
        ({"speed": [1.0]}, "has no times"),
        ({"time": [0.0, 1.0], "speed": [1.0]}, "has 1 values for 2 times"),
        ({"time": [1.0, 0.0], "speed": [1.0, 1.0]}, "goes backwards"),
        ({"time": [0.0], "speed": [float("nan")]}, "no finite numbers"),
    ],
)
def test_columns_that_make_no_table_are_refused(foreign, table, what):
    with pytest.raises(InputRefused, match=what):
        rockshed.alone(foreign, table)


def test_the_command_leaves_a_run_that_is_read_and_plotted(foreign, table, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    words = ["simulate", str(foreign), "--input", str(table), "--step-size", "0.05", "--json", "-q"]
    done = CliRunner().invoke(app, [*words, "--start-values", "damping=1", "--no-figures"])
    assert done.exit_code == 0, done.output
    run = rockshed.read_run(json.loads(done.stdout)["folder"])
    assert run["Stranger.force"][2] == pytest.approx(-0.5)
    run.plot("Stranger.force", "input.speed")


def test_the_command_refuses_in_the_words_of_its_options(foreign):
    done = CliRunner().invoke(app, ["simulate", str(foreign)])
    assert done.exit_code == 2
    assert "--stop-time" in done.output
