"""Native FMUs: the same bits as the FMUs with Python, in any host. test_slave.py and test_state.py are for both."""

import ctypes
import subprocess
import sys
import zipfile

import numpy as np
import pytest
from fmpy import read_model_description
from fmpy.fmi2 import fmi2ModelExchange
from fmpy.validation import validate_fmu

from rockshed.cases.sonoda1993 import lab_system
from rockshed.cases.sonoda1993 import tests as laboratory_tests
from rockshed.components.catalogue import NAMES
from rockshed.components.sand_cushion.declarations import PART
from rockshed.core.run import simulate
from rockshed.fmus.build import Runtime, build, build_if_needed
from rockshed.fmus.native.fmu import compiler

from .conftest import HERE
from .host import ERROR, OK, Host

DRIVE = {
    "RBSMBeam": ("force.y[2]", -1e3),
    "FallingRock": ("force.x", 3.0),
    "SandCushion": ("rock.velocity.y", -1.0),
    "Probe": ("inflow", 0.5),
    "SlopeRockfall": ("force.x", 0.0),
    "Hammer": ("head.wave", 1e3),
    "PileRod": ("head.force", 1e4),
    "ImpulsiveGround": ("force.y", -5e3),
}
"""An input of each component, and a value that makes it move."""
STEPS = 20

linux = pytest.mark.skipif(sys.platform != "linux", reason="looks at a library of Linux")


def described(file):
    with zipfile.ZipFile(file) as archive:
        return archive.read("modelDescription.xml").decode().splitlines()


@pytest.mark.parametrize("name", [*NAMES, "Probe"])
def test_fmpy_finds_nothing_to_say(native_fmus, name):
    assert validate_fmu(str(native_fmus[name])) == []


@pytest.mark.parametrize("name", [*NAMES, "Probe"])
def test_the_description_differs_in_guid_tool_and_the_need_of_one(python_fmus, native_fmus, name):
    pairs = list(zip(described(python_fmus[name]), described(native_fmus[name]), strict=True))
    different = [(one, other) for one, other in pairs if one != other]
    assert len(different) == 2
    assert all("guid=" in line and "generationTool=" in line for line in different[0])
    assert (
        different[1][0].replace('needsExecutionTool="true"', 'needsExecutionTool="false"')
        == different[1][1]
    )


@pytest.mark.parametrize("name", [*NAMES, "Probe"])
def test_outputs_and_state_have_the_same_bits_as_with_python(python_fmus, native_fmus, name):
    with Host(python_fmus[name]) as one, Host(native_fmus[name]) as other:
        step = float(one.description.defaultExperiment.stepSize)
        for host in (one, other):
            host.start(**dict([DRIVE[name]])).steps(STEPS, step)
        assert other.outputs() == one.outputs()
        assert other.state() == one.state()


@pytest.mark.slow
def test_threads_change_no_bit(native_fmus, tmp_path):
    """Of a cushion that is large enough to be divided, and in motion."""
    file, outputs = build("SandCushion", {"discs": 2 * PART}, tmp_path, Runtime.NATIVE), []
    for threads in (1, 2):
        with Host(file) as host:
            host.start(
                **{
                    "box.width": 2.0,
                    "box.left": 0.0,
                    "base": 1,
                    "lattice_shift": 0.02,
                    "settling.time": 1e-3,
                    "rock.position.x": 1.0,
                    "rock.position.y": 50.0,
                    "threads": threads,
                }
            ).steps(10, 1e-4)
            outputs.append(host.outputs())
    assert outputs[0]["energy.sliding"] > 0.0
    assert outputs[0].pop("threads") != outputs[1].pop("threads")
    assert outputs[0] == outputs[1]


def test_a_state_goes_from_one_runtime_to_the_other(python_fmus, native_fmus):
    with Host(python_fmus["Probe"]) as one, Host(native_fmus["Probe"]) as other:
        one.start(inflow=1.0).steps(3, 0.1)
        other.restore(one.state())
        other.steps(3, 0.1, first=3)
        one.steps(3, 0.1, first=3)
        assert other.state() == one.state()
        one.restore(other.state())
        assert one.step(0.6, 0.1) == OK


@pytest.fixture(scope="module")
def impacts(native_fmus, tmp_path_factory):
    """The first 10 ms of the laboratory impact by runtime, exchange every 0.01 ms."""

    def run(runtime):
        names = {"rock": "FallingRock", "sand": "SandCushion", "beam": "RBSMBeam"}
        files = {
            key: str(
                build_if_needed(
                    name, destination=tmp_path_factory.getbasetemp() / runtime, runtime=runtime
                )
            )
            for key, name in names.items()
        }
        system = lab_system(files, laboratory_tests()[4], "paper")
        return simulate(
            system.model_copy(
                update={"stop_time": 0.01, "output_interval": None, "state_interval": 1e-3}
            ),
            tmp_path_factory.mktemp(runtime) / "run",
        )

    return run(Runtime.PYTHON), run(Runtime.NATIVE)


def test_the_laboratory_impact_has_the_same_bits(impacts):
    one, other = impacts
    assert one.series["time"].size == 1001
    assert one.metrics["sand_transmitted_force_maximum"].value > 1000.0
    assert one.metrics["beam_midspan_deflection_maximum"].value > 1e-5
    for name, values in one.series.items():
        np.testing.assert_array_equal(other.series[name], values, err_msg=name)


def test_the_recorded_states_of_the_sand_have_the_same_bits(impacts):
    one, other = (list(run.states("sand")) for run in impacts)
    assert len(one) == 11
    assert one == other


# ------------------------------------------------------------------ policing beyond what the FMUs with Python can do


def test_a_wrong_guid_and_the_wrong_type_are_refused_with_both_guids(native_fmus):
    with Host(native_fmus["Probe"]) as host:
        with pytest.raises(Exception, match="Failed to instantiate"):
            Host(native_fmus["Probe"], guid="{00000000-0000-0000-0000-000000000000}", logging=False)
        (text,) = Host.last.errors()
        assert (
            "the GUID is {00000000-0000-0000-0000-000000000000}, and this FMU has "
            + host.description.guid
            in text
        )
        assert not host.fmu.dll.fmi2Instantiate(
            b"other",
            fmi2ModelExchange,
            host.description.guid.encode(),
            b"",
            ctypes.byref(host._callbacks),
            0,
            0,
        )
        assert "model exchange is asked for" in host.errors()[0]


def test_a_refused_call_returns_the_error_itself(native_fmus):
    with Host(native_fmus["Probe"], "tank") as host:
        host.start()
        host["inflow"] = float("nan")
        assert host.fmu.status == ERROR
        assert "tank (Probe): at t = 0 s: inflow = nan" in host.errors()[0]
        assert host["inflow"] == 0.0


def test_more_reasons_than_a_message_can_hold_are_cut(native_fmus):
    with Host(native_fmus["SandCushion"], "a long name " * 50) as host:
        host.start()
        inputs = [v.valueReference for v in host.variables.values() if v.causality == "input"]
        host.fmu.setReal(inputs * 2, [float("nan")] * 2 * len(inputs))
        (text,) = host.errors()
        assert "rock.position.x = nan" in text
        assert text.endswith(" ...")


def test_a_wrong_parameter_fails_the_end_of_the_initialization_mode(native_fmus):
    with Host(native_fmus["Probe"]) as host:
        host["limit"] = 1000.0
        assert host.fmu.status == OK
        host.start()
        assert host.fmu.status == ERROR
        host.fmu.reset()
        host.start().steps(1, 0.1)


def test_a_state_that_is_none_is_refused(native_fmus):
    with Host(native_fmus["Probe"]) as host:
        host.start()
        for state in (
            ctypes.c_void_p(),
            ctypes.cast(ctypes.create_string_buffer(64), ctypes.c_void_p),
        ):
            host.fmu.setFMUstate(state)
            assert host.fmu.status == ERROR
            host.fmu.reset()
            host.fmu.status = OK
        assert all("no serialized state" in text for text in host.errors())


def test_messages_can_be_chosen_by_category(native_fmus):
    with Host(native_fmus["Probe"], logging=False) as host:
        host.start()
        counts = []
        for categories in (["logStatusWarning"], ["logStatusError"], ["logAll"], []):
            host.fmu.setDebugLogging(True, categories)
            host.step(5.0, 0.1)
            counts.append(len(host.messages))
        assert counts == [0, 1, 2, 3]


def test_what_it_cannot_do_is_refused_with_a_word(native_fmus):
    with Host(native_fmus["Probe"]) as host:
        host.start()
        component, one = host.fmu.component, ctypes.c_size_t(1)
        references, values = (ctypes.c_uint * 1)(0), (ctypes.c_double * 1)(0.0)
        orders = (ctypes.c_int * 1)(1)
        assert (
            host.fmu.dll.fmi2SetRealInputDerivatives(component, references, one, orders, values)
            == ERROR
        )
        assert (
            host.fmu.dll.fmi2GetRealOutputDerivatives(component, references, one, orders, values)
            == ERROR
        )
        assert (
            host.fmu.dll.fmi2GetDirectionalDerivative(
                component, references, one, references, one, values, values
            )
            == ERROR
        )
        assert host.fmu.dll.fmi2CancelStep(component) == ERROR
        assert len(host.errors()) == 4


# ------------------------------------------------------------------ hosts without Python


@pytest.fixture(scope="session")
def c_host(tmp_path_factory):
    """A program in C that runs an FMU's library."""
    program = tmp_path_factory.mktemp("host") / "host"
    subprocess.run(
        [*compiler("linux64"), "-o", str(program), str(HERE / "host.c"), "-ldl"],
        check=True,
        capture_output=True,
    )
    return program


@linux
@pytest.mark.parametrize("name", [*NAMES, "Probe"])
def test_a_c_program_without_python_gets_the_same_bits(
    python_fmus, native_fmus, c_host, tmp_path, name
):
    port, value = DRIVE[name]
    with Host(python_fmus[name]) as host:
        step = float(host.description.defaultExperiment.stepSize)
        host.start(**{port: value}).steps(STEPS, step)
        reals = [v for v in host.variables.values() if v.type == "Real"]
        expected = [host[v.name] for v in reals]
        references = [str(v.valueReference) for v in reals]
        input_reference = str(host.variables[port].valueReference)
    guid = read_model_description(str(native_fmus[name])).guid
    with zipfile.ZipFile(native_fmus[name]) as archive:
        library = archive.extract(f"binaries/linux64/{name}.so", tmp_path)
    done = subprocess.run(
        [c_host, library, guid, repr(step), str(STEPS), input_reference, repr(value), *references],
        env={},
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert [float.fromhex(line) for line in done.stdout.split()] == expected
