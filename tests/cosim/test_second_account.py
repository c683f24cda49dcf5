"""What another account of the computer can reach: no port, and no file that is executed."""

import os
import socket
import ssl
import subprocess
import sys
import tempfile
import time
from contextlib import suppress
from pathlib import Path

import psutil
import pytest

import rockshed
from rockshed.components.catalogue import component
from rockshed.fmus.build import BuildError, Runtime, build
from rockshed.fmus.places import FOLDER_VARIABLE, native_is_fresh
from rockshed.temporary import ALIVE, TemporaryFolder, sweep

NOBODY = 65534
"""Number of an account that owns nothing."""
PLANTED = "planted"
"""Name of the files that it makes where it can."""
SLOPE = Path(rockshed.__file__).parent / "examples" / "slope.toml"

pytestmark = pytest.mark.skipif(
    sys.platform != "linux" or os.geteuid() != 0, reason="only root can act as another account"
)


def as_nobody(act) -> list[str]:
    """Do something as another account, in a process of its own; return what it succeeded in."""
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            os.setgroups([])
            os.setresgid(NOBODY, NOBODY, NOBODY)
            os.setresuid(NOBODY, NOBODY, NOBODY)
            os.write(writing, "\n".join(act()).encode())
        finally:
            os._exit(0)
    os.close(writing)
    with os.fdopen(reading) as stream:
        done = stream.read().splitlines()
    os.waitpid(child, 0)
    return done


def changed(folders) -> list[str]:
    """Try to change everything below some folders; return the ways that were open."""
    done = []
    for folder in folders:
        for place, _, files in os.walk(folder):
            attempts = {
                "make a file in": lambda place=place: open(f"{place}/{PLANTED}", "w").close()
            }
            attempts |= {"take away": lambda place=place: os.rename(place, f"{place}-away")}
            for file in set(files) - {PLANTED}:
                path = os.path.join(place, file)
                attempts[f"write {file} in"] = lambda path=path: open(path, "r+b").close()
                attempts[f"remove {file} in"] = lambda path=path: os.unlink(path)
            for what, attempt in attempts.items():
                with suppress(OSError):
                    attempt()
                    done.append(f"{what} {place}")
    return done


def command(words, place, is_at_home=False):
    """Start a command in a folder of its own, with a umask that forbids nobody anything."""
    environment = os.environ | {"TMPDIR": str(place / "tmp")}
    if is_at_home:
        environment = {k: v for k, v in environment.items() if not k.startswith("ROCKSHED_")}
        environment |= {"HOME": str(place / "home"), "XDG_CACHE_HOME": "", "XDG_DATA_HOME": ""}
    return subprocess.Popen(
        [sys.executable, "-P", "-m", "rockshed", *words],
        cwd=place / "work",
        env=environment,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        umask=0,
    )


@pytest.fixture
def place(tmp_path):
    """Folders as other accounts see them: a home that all can read, a shared temporary folder."""
    shared = Path(tempfile.gettempdir())
    ours = [folder for folder in tmp_path.parents if shared in folder.parents]
    for folder in (tmp_path, *ours):
        folder.chmod(0o755)
    for name, mode in {"home": 0o755, "work": 0o755, "tmp": 0o1777}.items():
        (tmp_path / name).mkdir()
        (tmp_path / name).chmod(mode)
    return tmp_path


@pytest.mark.slow
def test_nobody_else_can_change_what_is_kept_built_or_unpacked(place):
    """The exchange loop, FMUs, kernels: while a command runs, and behind it."""
    done = []
    for words in (["build", "FallingRock", "--runtime", "both"], ["list"]):
        process = command(words, place, is_at_home=True)
        while process.poll() is None:
            done += as_nobody(lambda: changed([place / "home", place / "tmp"]))
            time.sleep(0.2)
        assert process.returncode == 0
    done += as_nobody(lambda: changed([place / "home"]))
    mine = {f"make a file in {place / 'tmp'}"}  # a shared folder is for that
    assert set(done) <= mine
    assert list((place / "home").rglob("*.fmu"))
    assert list((place / "home").rglob("*.nbc"))


def test_built_fmus_are_not_taken_from_where_others_can_write(tmp_path, monkeypatch):
    """A planted FMU with the right GUID would be run."""
    monkeypatch.setenv(FOLDER_VARIABLE, str(tmp_path / "fmus"))
    declared = component("FallingRock")
    build("FallingRock", runtime=Runtime.NATIVE)
    assert native_is_fresh(declared, declared.with_sizes())
    (tmp_path / "fmus").chmod(0o777)
    assert not native_is_fresh(declared, declared.with_sizes())
    with pytest.raises(BuildError, match=f"can be written by others: set {FOLDER_VARIABLE}"):
        build("FallingRock", runtime=Runtime.NATIVE)


def test_what_others_lay_into_the_temporary_folder_is_neither_used_nor_followed(place, monkeypatch):
    monkeypatch.setattr("tempfile.gettempdir", lambda: str(place / "tmp"))
    mine = place / "home" / "mine"
    mine.mkdir()
    (mine / ALIVE).touch()

    def plant() -> list[str]:
        for prefix in ("rockshed_", "rockshed-dask-"):
            os.mkdir(place / "tmp" / f"{prefix}planted")
            open(place / "tmp" / f"{prefix}planted" / ALIVE, "w").close()
        os.symlink(mine, place / "tmp" / "rockshed_link")
        return ["planted"]

    assert as_nobody(plant) == ["planted"]
    planted = sorted((place / "tmp").iterdir())
    assert sweep() == []
    with TemporaryFolder(place=place / "tmp") as folder:
        assert folder not in planted
        assert folder.stat().st_mode & 0o777 == 0o700
    assert sorted((place / "tmp").iterdir()) == planted
    assert (mine / ALIVE).exists()


def ports(process: psutil.Process) -> list[tuple[str, int]]:
    """Addresses at which a process and its children listen."""
    found = []
    for member in (process, *process.children(recursive=True)):
        with suppress(psutil.Error):
            listening = member.net_connections("inet")
            found += [tuple(c.laddr) for c in listening if c.status == psutil.CONN_LISTEN]
    return found


def answers(addresses) -> list[str]:
    """Talk to ports as a stranger: TLS without a certificate, Dask and HTTP in plain words."""
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    context.check_hostname, context.verify_mode = False, ssl.CERT_NONE
    told = []
    for address in addresses:
        with (
            suppress(OSError),
            socket.create_connection(address, 2) as plain,
            context.wrap_socket(plain) as secret,
        ):
            secret.settimeout(2)
            secret.sendall(b"GET / HTTP/1.0\r\n\r\n")
            told += [f"{address} without a certificate: {secret.recv(40)}"]
        for page in ("/", "/status", "/info/main/workers.html", "/api/v1/retire_workers", "/json/"):
            with suppress(OSError), socket.create_connection(address, 2) as plain:
                plain.settimeout(2)
                plain.sendall(f"GET {page} HTTP/1.0\r\n\r\n".encode())
                answer = plain.recv(40)
                told += [f"{address}{page}: {answer}"] if answer and b" 404 " not in answer else []
    return told


@pytest.mark.slow
def test_no_port_of_a_campaign_on_dask_answers_another_account(place):
    words = ["rockfall", str(SLOPE), "--trials", "600000", "--scheduler", "local"]
    process = command([*words, "--workers", "1", "--no-figures"], place)
    found = set()
    try:
        deadline = time.monotonic() + 240
        while len(found) < 4 and process.poll() is None and time.monotonic() < deadline:
            found = set(ports(psutil.Process(process.pid)))
            time.sleep(0.5)
        assert len(found) >= 4, "scheduler, its pages, nanny and worker"
        assert {address for address, _ in found} == {"127.0.0.1"}
        assert as_nobody(lambda: answers(found)) == []
    finally:
        process.terminate()
        process.wait(60)


@pytest.mark.slow
@pytest.mark.parametrize("words", ["run lab-impact --stop-time 0.01", "build Hammer", "doctor"])
def test_no_other_command_listens(place, words):
    process = command(words.split(), place)
    seen = []
    while process.poll() is None:
        seen += ports(psutil.Process(process.pid))
        time.sleep(0.1)
    assert process.returncode == 0
    assert seen == []
