"""Studies and campaigns that are killed go on with ``rockshed resume``: the bits of those in one go, or a refusal."""

import json
import os
import random
import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest
from typer.testing import CliRunner

import rockshed
from rockshed.analyses.asked import finished_trials, remembering
from rockshed.analyses.rockfall.arguments import CampaignArguments, campaign_arguments_from
from rockshed.analyses.study.arguments import StudyArguments, arguments_from
from rockshed.analyses.study.factors import Interval, Levels, RandomValue
from rockshed.commands.app import app
from rockshed.core.errors import InputRefused
from rockshed.runs.cluster import Certificates
from rockshed.runs.health import leftover_table
from rockshed.runs.kept import ASKED, FINISHED
from rockshed.runs.request import Request
from rockshed.sites.rockfall.preparation import prepare

pytestmark = pytest.mark.usefixtures("own_fmus")

SLOPE = Path(rockshed.__file__).parent / "examples" / "slope.toml"
MOMENTS = int(os.environ.get("ROCKSHED_ENDING_MOMENTS", "2"))
"""Moments at which a study and a campaign are killed by the slow test; the full test has 10."""
_STUDY = """
import sys
import rockshed

if __name__ == "__main__":
    vary = {"rock.velocity0.y": [-4.0, -6.0, -8.0], "sand.modulus": [2e6, 4e6]}
    rockshed.study("lab-impact", vary, options={"stop_time": 0.002}, workers=2, folder=sys.argv[1],
                   progress=lambda *told: print(*told, flush=True))
"""
_CAMPAIGN = """
import sys
import rockshed
from rockshed import kept_parts

kept_parts.INTERVAL = 0.01
if __name__ == "__main__":
    rockshed.rockfall("slope.toml", trials=60_000, workers=2, folder=sys.argv[1],
                      scheduler=sys.argv[2] if sys.argv[2:] else None,
                      progress=lambda *told: print(*told, flush=True))
"""
SCRIPTS = {"study": _STUDY, "rockfall": _CAMPAIGN}
STAGES = {"study": "runs", "rockfall": "trials"}
"""Beginning of the lines that tell how far it is."""
RESULTS = {
    "study": ("runs.parquet", "runs.csv", "designs.csv", "sensitivity.csv"),
    "rockfall": ("trials.parquet", "envelopes.csv", "envelopes.parquet", "summary.json"),
}
"""Files that have to be the same to the bit."""


def started(kind, place, folder, *more):
    """The script of a study or campaign, in a process of its own."""
    place.mkdir(exist_ok=True)
    shutil.copy(SLOPE, place)
    (place / "script.py").write_text(SCRIPTS[kind])
    return subprocess.Popen(
        [sys.executable, "-P", "script.py", folder, *more],
        cwd=place,
        stdout=subprocess.PIPE,
        text=True,
    )


def counts(process, kind):
    """Numbers of pieces that have ended, and of all, as they are told."""
    for line in process.stdout:
        words = line.split()
        if words[0] == STAGES[kind]:
            yield int(words[1]), int(words[2])


@pytest.fixture(scope="module", params=SCRIPTS)
def in_one_go(own_fmus, request, tmp_path_factory):
    """Kind and folder of an analysis in one go, and the time (s) from its first count to its end."""
    kind, place = request.param, tmp_path_factory.mktemp("whole") / "work"
    process = started(kind, place, "whole")
    next(counts(process, kind))
    began = time.monotonic()
    process.communicate(timeout=300)
    assert process.returncode == 0
    return kind, place / "whole", time.monotonic() - began


def bits(folder, kind):
    return {name: (folder / name).read_bytes() for name in RESULTS[kind]}


def commanded(*words):
    return CliRunner().invoke(app, [str(word) for word in words])


def killed_and_resumed(kind, place, whole, wait, *more):
    """Kill an analysis, let it go on, and compare; tell whether it had ended before."""
    process = started(kind, place, "out", *more)
    wait(process)
    process.kill()
    process.communicate(timeout=60)
    if (place / "out" / "run.json").is_file():
        return False
    done = commanded("resume", place / "out", "--no-figures")
    assert done.exit_code == 0, done.output
    assert f"a {kind} goes on" in done.stderr
    assert bits(place / "out", kind) == bits(whole, kind)
    left = {path.name for path in place.iterdir()}
    assert left == {"out", "script.py", "slope.toml"}
    assert not (place / "out" / FINISHED).exists()
    return True


def after_a_part(kind):
    """A function that waits until a part of an analysis has ended."""

    def wait(process):
        assert next(done for done, total in counts(process, kind) if done > 0)

    return wait


def test_what_is_killed_goes_on_with_the_bits_of_one_in_one_go(in_one_go, tmp_path):
    kind, whole, _ = in_one_go
    assert killed_and_resumed(kind, tmp_path / "work", whole, after_a_part(kind))


@pytest.mark.slow
def test_a_kill_at_random_moments_gives_the_bits_of_one_in_one_go_every_time(in_one_go, tmp_path):
    kind, whole, lasts = in_one_go
    chance = random.Random(2026)
    resumed = 0
    for attempt in range(4 * MOMENTS):  # some end before their moment comes
        moment = chance.uniform(0.0, lasts)

        def wait(process, moment=moment):
            next(counts(process, kind))
            time.sleep(moment)

        resumed += killed_and_resumed(kind, tmp_path / f"work-{attempt}", whole, wait)
        if resumed == MOMENTS:
            break
    assert resumed == MOMENTS


@pytest.mark.slow
def test_a_campaign_on_dask_that_is_killed_goes_on_from_what_has_ended(tmp_path):
    pytest.importorskip("distributed")
    process = started("rockfall", tmp_path / "whole", "out")
    process.communicate(timeout=300)
    whole = tmp_path / "whole" / "out"
    assert killed_and_resumed(
        "rockfall", tmp_path / "work", whole, after_a_part("rockfall"), "local"
    )


def begun(place, kind="rockfall", files=(), **arguments):
    """A folder of results in which an analysis has begun and was killed."""
    with pytest.raises(ZeroDivisionError), remembering(place, kind, arguments, files):
        raise ZeroDivisionError


def test_a_file_that_has_changed_since_is_refused_and_nothing_is_lost(tmp_path):
    site = tmp_path / "slope.toml"
    shutil.copy(SLOPE, site)
    place = finished_trials(tmp_path / "out")
    asked = CampaignArguments(site, trials=100)
    begun(place, files=[site], **asked.as_data(prepare(site)))
    site.write_text(site.read_text() + "\n# more\n")
    assert any(str(place) in row for row in leftover_table(tmp_path).rows)
    told = commanded("resume", tmp_path / "out")
    assert told.exit_code == 2
    assert "has changed since" in " ".join(told.stderr.split())
    assert (place / ASKED).is_file()
    shutil.copy(SLOPE, site)
    assert rockshed.resume(tmp_path / "out").campaign.trials == 100
    assert not place.exists()


def test_a_scheduler_that_is_gone_is_refused_and_nothing_is_lost(tmp_path):
    place = finished_trials(tmp_path / "out")
    asked = CampaignArguments(SLOPE, trials=100, scheduler="tcp://127.0.0.1:9")
    begun(place, files=[SLOPE], **asked.as_data(prepare(SLOPE)))
    with pytest.raises(InputRefused, match="scheduler"):
        rockshed.resume(tmp_path / "out")
    assert (place / ASKED).is_file()


@pytest.mark.parametrize(
    "content",
    [
        {"kind": "study", "files": {}, "arguments": {"vary": 3}},
        {"kind": "moon", "files": {}, "arguments": {}},
        {"kind": "study", "files": {"\0": 1}, "arguments": {}},
        {"kind": "rockfall", "files": {}, "arguments": {"site": None, "certificates": 2}},
        {"kind": "rockfall", "files": {}, "arguments": None},
    ],
)
def test_arguments_that_somebody_has_damaged_are_refused_in_words(content, tmp_path):
    place = tmp_path / "out" / FINISHED
    place.mkdir(parents=True)
    (place / ASKED).write_text(json.dumps(content))
    told = commanded("resume", tmp_path / "out")
    assert told.exit_code == 2, told.output
    assert "Traceback" not in told.output


def test_two_processes_at_one_work_are_refused(tmp_path):
    def carried_out():
        with remembering(tmp_path / "place", "study", {}):
            return True

    with (
        remembering(tmp_path / "place", "study", {}),
        pytest.raises(InputRefused, match="another process is at this work"),
    ):
        carried_out()
    assert carried_out()
    assert not (tmp_path / "place").exists()


def test_what_is_refused_leaves_no_folder_behind(tmp_path):
    with pytest.raises(InputRefused), remembering(tmp_path / "new" / "place", "study", {}):
        raise InputRefused([])
    assert not (tmp_path / "new").exists()


def test_arguments_come_back_as_they_were():
    vary = {
        "rock.velocity0.y": Levels((-4.0, "5 m/s")),
        "sand.modulus": Interval(2e6, "4 MPa", 3),
        "rock.mass": RandomValue("normal", ("1 t", 30.0)),
    }
    held = Certificates("/a.pem", "/c.pem", "/k.pem")
    asked = StudyArguments(
        Request("lab-impact", {"sand.seed": 2}, options={"stop_time": 0.01}),
        *(vary, "lhs", 64, 3, 7, ("peak_rock_force",), (50.0, 95.0), 2, "tls://h:1", held, True),
    )
    again = arguments_from(json.loads(json.dumps(asked.as_data())))
    assert json.dumps(again.as_data()) == json.dumps(asked.as_data())
    assert (again.request, again.vary, again.certificates) == (asked.request, vary, held)
    campaign = CampaignArguments(SLOPE, 10, 3, 2, "local", None, (1, 2), "all", "gif", True)
    data = json.loads(json.dumps(campaign.as_data(prepare(SLOPE))))
    assert campaign_arguments_from(data).as_data(prepare(SLOPE)) == data
