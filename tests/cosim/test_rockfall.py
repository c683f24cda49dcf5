"""``rockshed rockfall`` as a user meets it, and the campaign behind it."""

import json
import re
import signal
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import numpy as np
import pyarrow.parquet
import pytest
from PIL import Image
from typer.testing import CliRunner

import rockshed
from rockshed.animations.formats import animation_format
from rockshed.campaigns import campaign
from rockshed.campaigns.campaign import campaign_of
from rockshed.campaigns.passages import line_passages
from rockshed.campaigns.replay import replay
from rockshed.commands.app import app
from rockshed.components.slope_rockfall.records import OUTCOME, PASSAGE
from rockshed.core.errors import InputRefused
from rockshed.core.results.reading import read_run
from rockshed.sites.rockfall.preparation import prepare

EXAMPLE = Path(rockshed.__file__).parent / "examples" / "slope.toml"


@pytest.fixture
def rockshed(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "500")
    return lambda *arguments: CliRunner().invoke(app, [str(a) for a in arguments])


@pytest.fixture(scope="module")
def slope():
    return prepare(EXAMPLE, trials=5000)


@pytest.fixture(scope="module")
def trials(slope):
    return campaign_of(slope)


@pytest.fixture(scope="module")
def records(trials):
    return campaign.run(trials, 1)


# --- the campaign ---


def test_the_first_200_of_5000_trials_are_a_run_of_200_for_any_number_of_threads(trials, records):
    few = campaign_of(prepare(EXAMPLE, trials=200))
    for workers, given, first in (
        (1, few, 200),
        (2, few, 200),
        (2, trials, 5000),
        (3, trials, 5000),
    ):
        found = campaign.run(given, workers)
        for name in ("outcomes", "passages", "peaks"):
            np.testing.assert_array_equal(getattr(found, name), getattr(records, name)[:first])


def test_a_replay_ends_where_the_campaign_has_it_and_passes_its_lines_there(slope, trials, records):
    for number in (3, 41):
        shown = replay(slope, trials, number, 0.01)
        assert (shown.x[-1], shown.y[-1]) == pytest.approx(
            tuple(records.outcomes[number, [OUTCOME.x, OUTCOME.y]]), abs=1e-9
        )
        assert shown.time[-1] == records.outcomes[number, OUTCOME.time]
        at = records.passages[number, 1, PASSAGE.time]
        assert np.interp(at, shown.time, shown.x) == pytest.approx(90.0, abs=1e-2)
        assert np.interp(at, shown.time, shown.speed) == pytest.approx(
            records.passages[number, 1, PASSAGE.speed], rel=0.02
        )


def test_a_barrier_stops_breaks_or_is_overtopped(trials, records):
    fence = line_passages(trials, records)[3]
    assert fence.count == sum(fence.barrier.values()) == 5000
    assert np.sum(fence.values["energy"] <= 300e3) == fence.barrier["stopped"]


def test_a_strong_barrier_that_is_low_is_overtopped_only(tmp_path):
    (tmp_path / "low.toml").write_text(
        EXAMPLE.read_text().replace("height = 3.0", "height = 1.3").replace("300e3", "1e9")
    )
    low = campaign_of(prepare(tmp_path / "low.toml", trials=1000))
    fence = line_passages(low, campaign.run(low, 1))[3]
    assert fence.barrier["broken_through"] == 0
    assert fence.barrier["overtopped"] > 200 < fence.barrier["stopped"]


# --- the command ---


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    folder = tmp_path_factory.mktemp("rockfall") / "out"
    result = CliRunner().invoke(
        app,
        ["rockfall", str(EXAMPLE), "--preset", "paper", "--output-dir", str(folder)],
        env={"COLUMNS": "500"},
    )
    assert result.exit_code == 0, result.output
    return folder, result


def test_a_campaign_leaves_its_files_and_shows_its_table(finished):
    folder, result = finished
    assert {file.name for file in folder.iterdir()} == {
        "run.json",
        "summary.json",
        "trials.parquet",
        "envelopes.parquet",
        "envelopes.csv",
        "figures",
    }
    assert {"envelopes.png", "lines.png", "ends.png"} == {
        file.name for file in (folder / "figures").iterdir()
    }
    assert "lower slope  200 of 200 rocks pass" in result.stdout
    assert re.search(r"energy +kJ +\d+ +[\d.]+ +\d+ \[\d+, \d+\]", result.stdout)
    facts = json.loads((folder / "run.json").read_text())
    assert facts["status"] == "complete"
    assert facts["materials"]["rock"]["source"]["strength"]


def test_the_table_of_trials_has_units_and_agrees_with_the_summary(finished):
    folder, _ = finished
    table = pyarrow.parquet.read_table(folder / "trials.parquet")
    assert table.num_rows == 200
    units = {field.name: field.metadata[b"unit"].decode() for field in table.schema}
    assert (units["road.energy"], units["road.height"], units["time"], units["limit_speed"]) == (
        "J",
        "m",
        "s",
        "m/s",
    )
    energies = np.sort(table["road.energy"].drop_null().to_numpy())
    summary = {
        entry["name"]: entry["value"] for entry in json.loads((folder / "summary.json").read_text())
    }
    ends = table["end"].to_pylist()
    assert summary["line.road.passing"] == len(energies) == ends.count("beyond the right end")
    assert np.mean(energies <= summary["line.road.energy.p90"]) == pytest.approx(0.9, abs=0.01)
    assert (
        summary["line.road.energy.p90.low"]
        < summary["line.road.energy.p90"]
        < summary["line.road.energy.p90.high"]
    )
    assert "line.road.energy.p99" not in summary  # 200 trials do not bear it
    assert summary["barrier.fence.stopped"] == table["barrier"].to_pylist().count("fence") > 0


def test_envelopes_lie_in_order(finished):
    table = pyarrow.parquet.read_table(finished[0] / "envelopes.parquet")
    for name in ("height", "speed", "energy"):
        columns = [table[f"{name}.{which}"].to_numpy() for which in ("p50", "p90", "p95", "max")]
        assert np.isfinite(columns[-1]).sum() > 190
        for lower, upper in pairwise(columns):
            here = np.isfinite(lower)
            assert here.sum() > 100
            assert np.all(lower[here] <= upper[here])
        assert np.isnan(table[f"{name}.p99"].to_numpy()).all()  # 200 rocks do not bear it


def test_json_is_one_document_and_quiet_says_nothing(rockshed):
    result = rockshed("rockfall", EXAMPLE, "--trials", 50, "--no-figures", "--json", "--quiet")
    content = json.loads(result.stdout)
    assert (result.exit_code, result.stderr, content["status"], content["pictures"]) == (
        0,
        "",
        "complete",
        [],
    )
    trials = {"id": "trials", "name": "trials", "value": 50, "unit": "1"}
    assert trials in content["metrics"]
    assert Path("results/slope/run.json").is_file()


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--preset", "papper"], "did you mean paper?"),
        (["--preset", "paper", "--trials", "5"], "give one of them"),
        (["--replay", "200", "--trials", "200"], "choose one from 0 to 199"),
        (["--replay", "1", "--animation", "avi"], "mp4, gif"),
    ],
)
def test_options_that_make_no_sense_are_refused_and_leave_nothing(rockshed, options, words):
    result = rockshed("rockfall", EXAMPLE, *options)
    assert result.exit_code == 2
    assert words in " ".join(result.stderr.split())
    assert not list(Path().iterdir())


def test_a_folder_with_something_else_is_not_touched(rockshed):
    Path("mine").mkdir()
    Path("mine/letter").write_text("dear")
    result = rockshed("rockfall", EXAMPLE, "--trials", 50, "--output-dir", "mine")
    assert result.exit_code == 2
    assert [file.name for file in Path("mine").iterdir()] == ["letter"]


def test_a_campaign_is_no_run_and_plot_draws_it_all_the_same(rockshed, finished):
    with pytest.raises(InputRefused, match="holds the results of rockfall, which have no time"):
        read_run(finished[0])
    result = rockshed("plot", finished[0], "--output-dir", "drawn")
    assert result.exit_code == 0, result.output
    assert {file.name for file in Path("drawn").iterdir()} >= {"envelopes.png", "ends.png"}


def test_ctrl_c_leaves_trials_to_go_on_from_and_nothing_else(tmp_path):
    command = [
        sys.executable,
        "-m",
        "rockshed.commands.app",
        "rockfall",
        str(EXAMPLE),
        "--trials",
        "1000000",
        "--workers",
        "1",
        "--output-dir",
        str(tmp_path / "out"),
    ]
    run = subprocess.Popen(
        command,
        stderr=subprocess.PIPE,
        stdout=subprocess.DEVNULL,
        text=True,
    )
    assert run.stderr is not None
    assert any("trials: " in line for line in run.stderr)
    run.send_signal(signal.SIGINT)
    told = " ".join(run.stderr.read().split())
    assert run.wait(120) == 130
    assert [path.name for path in tmp_path.iterdir()] == [".out-finished-trials"]
    assert f"`rockshed resume {tmp_path / 'out'}` goes on from what has ended" in told


def test_without_further_packages_there_are_gif_files(rockshed, monkeypatch):
    for name in ("imageio", "imageio_ffmpeg"):
        monkeypatch.setitem(sys.modules, name, None)
    assert animation_format(None) == "gif"
    shown = film(rockshed, None)
    assert "rockshed[movie]" in shown.stderr
    assert Path("results/slope/figures/trial-1.gif").is_file()
    assert (
        "rockshed[movie]"
        in rockshed("rockfall", EXAMPLE, "--replay", 1, "--animation", "mp4").stderr
    )


def film(rockshed, kind):
    """The first metres of a trial as animation."""
    Path("short.toml").write_text(
        EXAMPLE.read_text().replace("[profile] ", "[profile]\nend = 2.5 ").split("[[line]]")[0]
    )
    chosen = ["--animation", kind] if kind else []
    result = rockshed(
        "rockfall", "short.toml", "--trials", 20, "--no-figures", "--replay", 1, *chosen
    )
    assert result.exit_code == 0, result.stderr
    return result


def test_a_gif_has_a_frame_for_each_instant_in_real_time(rockshed):
    film(rockshed, "gif")
    short = prepare(Path("short.toml"), trials=20)
    shown = replay(short, campaign_of(short), 1, 1.0 / 25.0)
    assert (shown.end, shown.x[-1]) == ("beyond the right end", pytest.approx(2.5))
    with Image.open("results/slope/figures/trial-1.gif") as opened:
        assert opened.n_frames in (
            len(shown.time) + 1,
            len(shown.time),
        )  # equal frames, as those of the end, become one
        lengths = []
        for i in range(opened.n_frames):
            opened.seek(i)
            lengths.append(opened.info["duration"])
    assert lengths[1] == 40
    assert sum(lengths) == 40 * (len(shown.time) + 25)


def test_an_mp4_has_all_its_frames(rockshed):
    imageio = pytest.importorskip("imageio")
    pytest.importorskip("imageio_ffmpeg")
    film(rockshed, "mp4")
    short = prepare(Path("short.toml"), trials=20)
    shown = replay(short, campaign_of(short), 1, 1.0 / 25.0)
    with imageio.get_reader("results/slope/figures/trial-1.mp4") as opened:
        assert opened.get_meta_data()["fps"] == 25
        pictures = [np.asarray(picture, float) for picture in opened]
    assert len(pictures) == len(shown.time) + 25
    assert np.abs(pictures[0] - pictures[10]).max() > 50  # something moves
