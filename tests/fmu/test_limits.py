"""What pythonfmu's binary makes impossible, as listed in fmus/README.md: when one of these fails, the list is out of date."""

import ctypes
import os
import re
import subprocess
import sys

import pytest
from fmpy.fmi2 import fmi2Boolean, fmi2ModelExchange

from .conftest import ROOT
from .host import DISCARD, OK, Host


@pytest.fixture
def tank(fmus):
    with Host(fmus["Probe"], "tank") as host:
        yield host


def test_a_wrong_guid_is_accepted(fmus):
    with Host(fmus["Probe"], guid="{00000000-0000-0000-0000-000000000000}") as host:
        host.start().steps(1, 0.1)


def test_the_wrong_fmu_type_is_accepted(tank):
    other = tank.fmu.dll.fmi2Instantiate(
        b"other",
        fmi2ModelExchange,
        b"",
        (tank.folder / "resources").as_uri().encode(),
        ctypes.byref(tank._callbacks),
        0,
        0,
    )
    assert other
    tank.fmu.dll.fmi2FreeInstance(ctypes.c_void_p(other))


def test_a_refused_call_returns_ok_and_the_next_step_tells(tank):
    references = (ctypes.c_uint * 1)(999)
    values = (ctypes.c_double * 1)(1.0)
    tank.start()
    assert (
        tank.fmu.dll.fmi2SetReal(tank.fmu.component, references, ctypes.c_size_t(1), values) == OK
    )
    assert (
        tank.fmu.dll.fmi2GetReal(tank.fmu.component, references, ctypes.c_size_t(1), values) == OK
    )
    assert tank.fmu.dll.fmi2EnterInitializationMode(tank.fmu.component) == OK
    assert len(tank.errors()) == 3
    assert tank.step(0.0, 0.1) == DISCARD


def test_the_status_terminated_stays_after_a_refused_step(tank):
    tank.start()
    terminated = fmi2Boolean()
    for time, status, expected in ((0.0, OK, 0), (0.3, DISCARD, 1), (0.1, OK, 1)):
        assert tank.step(time, 0.1) == status
        tank.fmu.dll.fmi2GetBooleanStatus(tank.fmu.component, 3, ctypes.byref(terminated))
        assert terminated.value == expected


def test_selecting_all_messages_by_category_selects_none(tank):
    tank.fmu.setDebugLogging(True, ["logAll"])
    tank.start()
    assert tank.step(0.3, 0.1) == DISCARD
    assert tank.messages == []
    tank.fmu.setDebugLogging(True, ["logStatusError"])
    assert tank.step(0.3, 0.1) == DISCARD
    assert len(tank.messages) == 1


@pytest.mark.skipif(sys.platform != "linux", reason="looks at the end of a crashed process")
def test_a_path_with_a_special_character_ends_the_process(fmus, tmp_path):
    script = "import sys; from tests.fmu.host import Host; Host(sys.argv[1], folder=sys.argv[2])"
    done = subprocess.run(
        [sys.executable, "-c", script, fmus["Probe"], tmp_path / "ü"],
        cwd=ROOT,
        capture_output=True,
        timeout=60,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        check=False,
    )
    assert done.returncode < 0


@pytest.mark.skipif(sys.platform != "linux", reason="looks at a shared object")
def test_a_host_without_python_cannot_load_the_binary(tank):
    (library,) = (tank.folder / "binaries" / "linux64").glob("*.so")
    content = library.read_bytes()
    assert b"_Py_NoneStruct" in content  # needed from the host
    assert not re.search(rb"libpython[0-9]", content)  # and not brought along


INTERRUPTED = """
import signal, sys
from tests.fmu.host import Host
signal.signal(signal.SIGALRM, signal.default_int_handler)
host = Host(sys.argv[1]).start()
signal.setitimer(signal.ITIMER_REAL, 0.1)
print(host.step(0.0, 5.0), host.messages)  # 5e5 internal steps of all discs
host.fmu.reset()
host.start().steps(3, 1e-5)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="needs signals")
def test_an_interrupt_during_a_step_stops_the_slave_and_not_the_host(fmus, python):
    text = python(INTERRUPTED, fmus["SandCushion"])
    assert text.startswith(f"{DISCARD} ")
    assert "probe (SandCushion): interrupted" in text
