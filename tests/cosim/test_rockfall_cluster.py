"""``rockshed rockfall --scheduler``: the same bits from the workers of a Dask scheduler, however many and whoever dies."""

import dataclasses
import json
import os
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import psutil
import pytest
from typer.testing import CliRunner

import rockshed
from rockshed.analyses.rockfall import cluster
from rockshed.campaigns import campaign
from rockshed.campaigns.campaign import campaign_of
from rockshed.campaigns.executors import threads
from rockshed.campaigns.kept import KeptTrials
from rockshed.commands.app import app
from rockshed.components.slope_rockfall.records import PASSAGE, ROCK
from rockshed.runs import cluster as connection
from rockshed.runs.cluster import connected
from rockshed.sites.rockfall.preparation import prepare

EXAMPLE = Path(rockshed.__file__).parent / "examples" / "slope.toml"


@pytest.fixture(scope="module")
def client():
    """A scheduler with one worker; tests add to it."""
    with connected("local", 1) as client:
        yield client


@pytest.fixture(scope="module")
def made():
    return campaign_of(prepare(EXAMPLE, trials=5000))


@pytest.fixture(scope="module")
def records(made):
    return campaign.run(made, 1)


@pytest.fixture
def rockshed(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "500")
    return lambda *arguments: CliRunner().invoke(app, [str(a) for a in arguments])


def assert_same(found, expected):
    for name in ("outcomes", "passages", "peaks"):
        np.testing.assert_array_equal(getattr(found, name), getattr(expected, name))


def busiest(client):
    """Process number of the worker that has the most to do."""
    waiting = client.processing()
    return client.run(
        os.getpid, workers=[max(waiting, key=lambda name: len(waiting[name]))]
    ).popitem()[1]


class Killer:
    """A progress display that kills a worker when the first block is there."""

    def __init__(self, client):
        self.client, self.killed = client, None

    def __call__(self, count, total):
        if self.killed is None:
            self.killed = busiest(self.client)
            os.kill(self.killed, signal.SIGKILL)


def test_an_only_worker_that_is_killed_loses_nothing(client, made, records, monkeypatch):
    """Another one is started, and computes again what the dead one has not handed over."""
    monkeypatch.setattr(cluster, "_block_size", lambda given, workers: 200)
    killer = Killer(client)
    assert_same(cluster._run(client, made, killer), records)
    assert killer.killed is not None
    assert not psutil.pid_exists(killer.killed)


@pytest.mark.parametrize("workers", [1, 2, 3, 4])
def test_any_number_of_workers_gives_the_same_bits(client, made, records, monkeypatch, workers):
    monkeypatch.setattr(cluster, "_block_size", lambda given, workers: 300)  # the last is shorter
    client.cluster.scale(workers)
    client.wait_for_workers(workers)
    told = []
    assert_same(
        cluster._run(client, made, lambda count, total: told.append((count, total))), records
    )
    assert len(told) == 17
    assert told[-1] == (5000, 5000)
    few = campaign_of(prepare(EXAMPLE, trials=200))
    assert_same(
        cluster._run(client, few, lambda count, total: None),
        campaign.TrialRecords(records.passages[:200], records.peaks[:200], records.outcomes[:200]),
    )


VARIED = {
    "rock": {
        "mass": {"distribution": "lognormal", "mean": 800.0, "deviation": 350.0, "to": 2000.0},
        "density": 2500.0,
        "shape": "ellipse",
        "elongation": {"distribution": "triangular", "from": 1.0, "mode": 1.2, "to": 2.0},
    },
    "start": {
        "along": [0.5, 9.0],
        "velocity": [{"distribution": "uniform", "from": 0.0, "to": 1.0}, 0.0],
    },
    "limit_speed": {"mean": 12.0, "deviation": 2.0},
    "profile": {"points": [[0, 40, "rock"], [10, 30, "rock"], [10, 20, "floor"], [60, 19]]},
    "material": {"floor": {"like": "soil", "undulation": 0.1}},
    "line": [{"name": "road", "x": 20.0}],
}
"""Blocks of many masses and shapes, from anywhere on the upper slope."""


def test_varied_rocks_have_the_same_bits_on_any_number_of_threads_and_workers(client, monkeypatch):
    monkeypatch.setattr(cluster, "_block_size", lambda campaign, workers: 170)
    given = campaign_of(prepare(VARIED, trials=700))
    expected = campaign.run(given, 1)
    assert len(np.unique(given.rocks.sample(0, 700)[:, ROCK.mass])) == 700
    assert expected.passages[:, 0, PASSAGE.count].any()
    assert_same(campaign.run(given, 2), expected)
    for workers in (1, 2):
        client.cluster.scale(workers)
        client.wait_for_workers(workers)
        assert_same(cluster._run(client, given, lambda count, total: None), expected)


def test_one_of_several_workers_that_is_killed_loses_nothing(client, monkeypatch):
    monkeypatch.setattr(cluster, "_block_size", lambda given, workers: 1000)
    given = campaign_of(prepare(EXAMPLE, trials=30_000))
    killer = Killer(client)
    assert_same(cluster._run(client, given, killer), campaign.run(given, 1))
    assert not psutil.pid_exists(killer.killed)


def test_trials_outlive_a_scheduler_and_are_not_computed_again(
    client, made, records, monkeypatch, tmp_path
):
    kept = KeptTrials(tmp_path / "trials")
    given, left = cluster._result, iter(range(3))
    monkeypatch.setattr(cluster, "_block_size", lambda campaign, workers: 1000)

    def until_it_dies(block):
        if next(left, None) is None:
            raise campaign.CampaignFailed(connection.GONE)
        return given(block)

    monkeypatch.setattr(cluster, "_result", until_it_dies)
    words = "the scheduler or its last worker is gone; trials that have ended are kept: run it"
    with pytest.raises(campaign.CampaignFailed, match=words):
        cluster._run(client, made, lambda count, total: None, kept)
    monkeypatch.setattr(cluster, "_result", given)
    told, again = [], KeptTrials(tmp_path / "trials")
    found = cluster._run(client, made, lambda count, total: told.append(count), again)
    assert_same(found, records)
    assert (told, again.found) == ([3000, 4000, 5000], 3000)
    again.clear()
    assert not kept.folder.exists()


def test_kept_trials_of_another_campaign_or_that_are_damaged_are_computed_again(
    made, records, tmp_path
):
    kept = KeptTrials(tmp_path / "trials")
    for first, number in ((0, 300), (2000, 500), (300, 400)):
        kept.add(made, records, first, number)
    kept.write(made, records)
    beginning, later = sorted(kept.folder.iterdir())
    for other, number in (
        (made, 1200),
        (dataclasses.replace(made, trials=200), 200),
        (dataclasses.replace(made, trials=2100), 800),
        (dataclasses.replace(made, seed=2), 0),
        (dataclasses.replace(made, right=made.right - 1.0), 0),
    ):
        empty = campaign.empty_records(other, other.trials)
        found = kept.find(other, empty)
        assert found.sum() == number
        expected = records.outcomes[: other.trials][found]
        np.testing.assert_array_equal(empty.outcomes[found], expected)
    beginning.write_bytes(beginning.read_bytes()[:-100])
    assert kept.find(made, campaign.empty_records(made, 5000)).sum() == 500
    (kept.folder / "mine.txt").write_text("mine")
    later.with_name(f".{later.stem}.0123abcd.npz").touch()  # killed while it was written
    kept.clear()
    assert [file.name for file in kept.folder.iterdir()] == ["mine.txt"]


def test_a_campaign_without_room_for_kept_trials_keeps_none_and_goes_on(
    made, records, tmp_path, monkeypatch
):
    kept, written = KeptTrials(tmp_path / "trials"), []

    def full(stream, **rows):
        written.append(rows)
        if len(written) > 1:
            raise OSError(28, "No space left on device")
        savez(stream, **rows)

    savez = np.savez
    monkeypatch.setattr(np, "savez", full)
    monkeypatch.setattr("rockshed.kept_parts.INTERVAL", 0.0)
    with threads(2, kept) as executor:
        assert_same(executor.run(made, lambda count, total: None), records)
    assert len(written) == 2
    assert not kept.folder.exists()


@pytest.mark.parametrize(
    ("trials", "workers", "size"),
    [(1_000_000, 2, 20_000), (10_000, 2, 1000), (100_000, 4, 3125), (50, 4, 1000)],
)
def test_tasks_are_neither_too_small_nor_too_few(made, trials, workers, size):
    assert cluster._block_size(dataclasses.replace(made, trials=trials), workers) == size


def test_tasks_with_large_records_have_few_trials(made):
    many = dataclasses.replace(made, trials=1_000_000, stations=np.linspace(0.0, 140.0, 20_000))
    assert 200 < cluster._block_size(many, 2) < 300


def test_workers_with_another_version_are_refused(client, made, monkeypatch):
    monkeypatch.setattr(cluster, "source_stamp", lambda component: "another")
    with pytest.raises(
        campaign.CampaignFailed, match="another version of rockshed: install the same"
    ):
        cluster._run(client, made, lambda count, total: None)


@pytest.fixture
def certificates(client, tmp_path_factory):
    """Options of the command that name the client's own certificates."""
    security, folder = client.security, tmp_path_factory.mktemp("tls")
    files = {
        "--tls-ca": security.tls_ca_file,
        "--tls-cert": security.tls_client_cert,
        "--tls-key": security.tls_client_key,
    }
    for option, content in files.items():
        (folder / option).write_text(content)
    return [word for option in files for word in (option, folder / option)]


def test_the_command_takes_a_running_scheduler(client, rockshed, certificates):
    address = client.scheduler.address
    result = rockshed(
        "rockfall",
        EXAMPLE,
        "--trials",
        6000,
        "--no-figures",
        "--scheduler",
        address,
        *certificates,
    )
    assert result.exit_code == 0, result.output
    assert "trials: 6000 of 6000" in result.stderr
    facts = json.loads(Path("results/slope/run.json").read_text())
    assert (facts["scheduler"], facts["workers"]) == (address, len(client.nthreads()))
    on_threads = rockshed(
        "rockfall", EXAMPLE, "--trials", 6000, "--no-figures", "--output-dir", "threads"
    )
    assert on_threads.exit_code == 0
    assert (
        Path("threads/trials.parquet").read_bytes()
        == Path("results/slope/trials.parquet").read_bytes()
    )
    assert (
        Path("threads/envelopes.csv").read_bytes()
        == Path("results/slope/envelopes.csv").read_bytes()
    )


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--scheduler", "locl"], "--scheduler locl: is no address"),
        (
            ["--scheduler", "tcp://localhost:8786", "--workers", "2"],
            "a running scheduler has its own workers",
        ),
        (["--scheduler", "carrier-pigeon://loft"], "unknown address scheme 'carrier-pigeon'"),
    ],
)
def test_addresses_that_are_none_are_refused(rockshed, options, words):
    result = rockshed("rockfall", EXAMPLE, *options)
    assert result.exit_code == 2
    assert words in " ".join(result.stderr.split())
    assert not list(Path().iterdir())


def test_an_unreachable_scheduler_is_refused_within_seconds(rockshed, monkeypatch):
    monkeypatch.setattr(connection, "CONNECT_TIMEOUT", 0.5)
    with socket.socket() as unused:
        unused.bind(("127.0.0.1", 0))
        address = f"tcp://127.0.0.1:{unused.getsockname()[1]}"
        result = rockshed("rockfall", EXAMPLE, "--trials", 100, "--scheduler", address)
    assert result.exit_code == 2
    assert f"--scheduler {address}: no scheduler answers there within 0.5 s" in " ".join(
        result.stderr.split()
    )
    assert not list(Path().iterdir())


def test_a_scheduler_without_workers_is_refused(client, rockshed, certificates, monkeypatch):
    monkeypatch.setattr(connection, "CONNECT_TIMEOUT", 0.5)
    client.cluster.scale(0)
    while client.nthreads():
        time.sleep(0.05)
    address = client.scheduler.address
    result = rockshed("rockfall", EXAMPLE, "--trials", 100, "--scheduler", address, *certificates)
    assert result.exit_code == 2
    assert "the scheduler has no workers" in result.stderr


@pytest.mark.parametrize("scheme", ["tcp", "tls"])
def test_nobody_without_the_certificate_runs_code_on_a_local_scheduler(client, tmp_path, scheme):
    """Neither on the scheduler nor on a worker, whose ports any account of the machine reaches."""
    from distributed import Client, Security

    client.cluster.scale(1)
    client.wait_for_workers(1)
    stranger = Security.temporary() if scheme == "tls" else None
    addresses = [client.scheduler.address, *client.nthreads()]
    assert all(address.startswith("tls://127.0.0.1:") for address in addresses)
    for address in addresses:
        with pytest.raises((OSError, TimeoutError)):
            Client(address.replace("tls", scheme), security=stranger, timeout=1)


def test_a_cluster_with_certificates_asks_for_all_of_them(rockshed):
    result = rockshed("rockfall", EXAMPLE, "--scheduler", "tls://localhost:8786")
    assert result.exit_code == 2
    assert "needs certificates" in result.stderr
    result = rockshed("rockfall", EXAMPLE, "--scheduler", "tls://localhost:1", "--tls-ca", "x")
    assert result.exit_code == 2
    assert "--tls-key: is missing" in " ".join(result.stderr.split())
    assert not list(Path().iterdir())


def test_workers_end_with_a_campaign_that_is_killed(tmp_path):
    run = subprocess.Popen(
        [
            *(sys.executable, "-m", "rockshed.commands.app", "rockfall", str(EXAMPLE)),
            *("--trials", "400000", "--scheduler", "local", "--workers", "2"),
            *("--output-dir", str(tmp_path / "out")),
        ],
        stderr=subprocess.PIPE,
        stdout=subprocess.DEVNULL,
        text=True,
    )
    assert run.stderr is not None
    assert any("trials: " in line for line in run.stderr)
    started = psutil.Process(run.pid).children(recursive=True)
    assert started
    run.kill()
    run.wait(timeout=60)
    run.stderr.close()
    _, left = psutil.wait_procs(started, timeout=30)
    assert not [process for process in left if process.status() != psutil.STATUS_ZOMBIE]


def test_without_dask_it_says_what_to_install(rockshed, monkeypatch):
    monkeypatch.setattr(connection, "find_spec", lambda name: None)
    assert (
        'pip install "rockshed[cluster]"'
        in rockshed("rockfall", EXAMPLE, "--scheduler", "local").stderr
    )


@pytest.mark.skipif(
    sys.platform == "win32", reason="a terminal's Ctrl-C is a signal to a group of processes"
)
def test_ctrl_c_in_a_terminal_ends_all_processes_and_leaves_what_has_ended(tmp_path):
    command = [
        sys.executable,
        "-m",
        "rockshed.commands.app",
        "rockfall",
        str(EXAMPLE),
        "--trials",
        "400000",
        "--scheduler",
        "local",
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
        start_new_session=True,
    )
    assert run.stderr is not None
    assert any("trials: " in line for line in run.stderr)
    started = psutil.Process(run.pid).children(recursive=True)
    assert started
    os.killpg(run.pid, signal.SIGINT)
    _, rest = run.communicate(timeout=120)
    assert run.returncode == 130
    assert "goes on from what has ended" in rest.strip().splitlines()[-1]
    psutil.wait_procs(started, timeout=10)
    assert not [p for p in started if p.is_running() and p.status() != psutil.STATUS_ZOMBIE]
    assert [place.name for place in tmp_path.iterdir()] == [".out-finished-trials"]
