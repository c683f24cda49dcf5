"""The process that watches over another one: ends, signals and crashes reach whom they should."""

import os
import pty
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="signals tell who sent them")

PROGRAM = """
import os, signal, sys, time
from pathlib import Path
from rockshed.core import supervisor

def report(ending):
    print("reported", ending.facts.get("folder"), ending.reason, flush=True)
    return 1

def work():
    interruptions = []
    signal.signal(signal.SIGINT, lambda *_: interruptions.append(1))
    print(os.getpid(), os.getppid(), flush=True)
    WORK

command = [sys.executable, *sys.argv]
WAY
supervisor.supervised(work, command, report)
"""
SPAWNED = "supervisor._forked = lambda work, report: supervisor._spawned(command, report)"
CRASH = "supervisor.announce(folder='/tmp/run'); os.kill(os.getpid(), signal.SIGSEGV)"
WAIT = """
    for _ in range(200):
        time.sleep(0.05)
        if interruptions:
            time.sleep(0.3)
            print("interrupted", len(interruptions), flush=True)
            sys.exit(130)
"""


def start(folder, work, way="", **rest):
    """Start the program; return its process and the first line of the child."""
    (folder / "program.py").write_text(PROGRAM.replace("WORK", work.strip()).replace("WAY", way))
    process = subprocess.Popen(
        [sys.executable, "program.py"],
        cwd=folder,
        text=True,
        **{"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, **rest},
    )
    return process


def child_of(process):
    return int(process.stdout.readline().split()[0])


def is_there(pid):
    """Whether a process has not ended; one that has, but that nobody has asked for, counts as gone."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False


@pytest.mark.parametrize("way", ["", SPAWNED], ids=["forked", "spawned"])
@pytest.mark.parametrize("code", [0, 2])
def test_the_exit_code_is_that_of_the_child(tmp_path, code, way):
    process = start(tmp_path, f"sys.exit({code})", way)
    child, parent = map(int, process.communicate(timeout=30)[0].split())
    assert process.returncode == code
    assert (child != process.pid, parent) == (True, process.pid)


@pytest.mark.parametrize("way", ["", SPAWNED], ids=["forked", "spawned"])
def test_a_crash_is_reported_with_folder_and_signal(tmp_path, way):
    process = start(tmp_path, CRASH, way)
    said = process.communicate(timeout=30)[0].splitlines()
    assert (process.returncode, said[1:]) == (1, ["reported /tmp/run SIGSEGV"])


def test_a_crash_before_the_folder_is_known_is_reported_too(tmp_path):
    process = start(tmp_path, "os.kill(os.getpid(), signal.SIGKILL)")
    assert process.communicate(timeout=30)[0].splitlines()[1:] == ["reported None SIGKILL"]


def test_an_interruption_of_the_parent_alone_reaches_the_child(tmp_path):
    process = start(tmp_path, WAIT)
    child_of(process)
    process.send_signal(signal.SIGINT)
    assert process.communicate(timeout=30)[0] == "interrupted 1\n"
    assert process.returncode == 130


def test_a_child_that_hears_no_interruption_is_ended_after_a_while(tmp_path):
    """As in a kernel that prepares a large layer of sand."""
    process = start(tmp_path, "time.sleep(600)", "supervisor._AFTER_FIRST = 0.5")
    child = child_of(process)
    process.send_signal(signal.SIGINT)
    said = process.communicate(timeout=60)[0]
    assert said == "reported None did not return when the run was interrupted\n"
    assert not is_there(child)


def test_a_child_that_has_heard_an_interruption_has_its_time(tmp_path):
    told = "supervisor.tell(supervisor._HEARD); time.sleep(2); sys.exit(130)"
    process = start(tmp_path, told, "supervisor._AFTER_FIRST = 0.1")
    child_of(process)
    process.send_signal(signal.SIGINT)
    assert process.communicate(timeout=60)[0] == ""
    assert process.returncode == 130


def test_ctrl_c_at_a_terminal_reaches_the_child_once(tmp_path):
    master, terminal = pty.openpty()
    process = start(
        tmp_path,
        WAIT,
        stdin=terminal,
        preexec_fn=lambda: (os.setsid(), __import__("fcntl").ioctl(0, 0x540E, 0)),  # TIOCSCTTY
    )
    child_of(process)
    os.write(master, b"\x03")
    assert process.communicate(timeout=30)[0] == "interrupted 1\n"
    assert process.returncode == 130
    os.close(terminal)
    os.close(master)


def test_who_is_asked_to_terminate_ends_with_the_child(tmp_path):
    process = start(tmp_path, WAIT)
    child = child_of(process)
    process.terminate()
    process.communicate(timeout=30)
    assert process.returncode == -signal.SIGTERM
    assert not is_there(child)


def test_a_killed_parent_takes_the_child_along(tmp_path):
    process = start(tmp_path, WAIT)
    child = child_of(process)
    process.kill()
    process.wait()
    until = time.monotonic() + 10.0
    while is_there(child) and time.monotonic() < until:
        time.sleep(0.05)
    assert not is_there(child)
    process.communicate(timeout=30)
