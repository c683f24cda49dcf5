"""Native FMUs of FMI 3.0: the same bits as those of FMI 2.0, arrays in one call, and what is refused."""

import ctypes
import math
import re
import subprocess
import sys
import zipfile

import pytest
from fmpy import simulate_fmu
from fmpy.fmi3 import FMU3Model, FMU3ScheduledExecution
from fmpy.validation import validate_fmu

from rockshed.components.catalogue import NAMES
from rockshed.fmus.native.fmu import compiler

from .conftest import HERE
from .host import DISCARD, ERROR, OK, WARNING, Host
from .host3 import CALLS, Host3
from .test_native import DRIVE, STEPS
from .test_peers import needs

ALL = [*NAMES, "Probe"]
linux = pytest.mark.skipif(sys.platform != "linux", reason="runs a program of Linux")


@pytest.fixture
def tank(fmi3_fmus):
    with Host3(fmi3_fmus["Probe"], "tank") as host:
        yield host


# ------------------------------------------------------------------ the same component


@pytest.mark.parametrize("name", ALL)
def test_fmpy_finds_nothing_to_say(fmi3_fmus, name):
    assert validate_fmu(str(fmi3_fmus[name])) == []


@pytest.mark.parametrize("name", ALL)
def test_outputs_and_state_have_the_same_bits_as_with_fmi_2(native_fmus, fmi3_fmus, name):
    with Host(native_fmus[name]) as one, Host3(fmi3_fmus[name]) as other:
        step = float(one.description.defaultExperiment.stepSize)
        for host in (one, other):
            host.start(**dict([DRIVE[name]])).steps(STEPS, step)
        assert other.outputs() == one.outputs()
        assert other.state() == one.state()
        assert one.messages == other.messages == []


@pytest.mark.parametrize("name", ALL)
def test_fmpy_simulates_it_with_the_same_bits_as_that_of_fmi_2(native_fmus, fmi3_fmus, name):
    with Host(native_fmus[name]) as host:
        step = float(host.description.defaultExperiment.stepSize)
        scalars = [
            v.name
            for v in host.variables.values()
            if v.causality == "output" and "[" not in v.name and v.type == "Real"
        ]
    one, other = (
        simulate_fmu(
            str(fmus[name]),
            stop_time=STEPS * step,
            step_size=step,
            output_interval=step,
            output=scalars,
        )
        for fmus in (native_fmus, fmi3_fmus)
    )
    assert len(one) == STEPS + 1
    assert one.tolist() == other.tolist()


@pytest.mark.parametrize("name", ALL)
def test_start_values_really_hold(fmi3_fmus, name):
    kinds = {"Float64": float, "Boolean": lambda text: text == "true"}
    with Host3(fmi3_fmus[name]) as host:
        started = {
            n: [kinds.get(v.type, int)(text) for text in v.start.split()]
            for n, v in host.variables.items()
            if v.start is not None
        }
        assert {n: host.array(n) for n in started} == started
        host.start()
        assert {n: host.array(n) for n in started} == started
        assert not host.errors()


def test_a_state_goes_from_one_version_to_the_other_and_to_another_instance(
    native_fmus, fmi3_fmus, tank
):
    with Host(native_fmus["Probe"]) as one, Host3(fmi3_fmus["Probe"]) as other:
        one.start(inflow=1.0).steps(3, 0.1)
        tank.restore(one.state())
        for host in (one, tank):
            host.steps(3, 0.1, first=3)
        assert tank.state() == one.state()
        other.restore(tank.state())
        assert other.outputs() == tank.outputs()
        assert other["time"] == pytest.approx(0.6)
        one.restore(other.state())
        assert one.step(0.6, 0.1) == OK


@pytest.mark.parametrize("name", ALL)
def test_rollback_is_exact(fmi3_fmus, name):
    with Host3(fmi3_fmus[name]) as host:
        step = float(host.description.defaultExperiment.stepSize)
        host.start(**dict([DRIVE[name]])).steps(5, step)
        saved, before = host.state(), host.outputs()
        host.steps(5, step, first=5)
        expected = host.outputs(), host.state()
        host.restore(saved)
        assert host.outputs() == before != expected[0]
        host.steps(5, step, first=5)
        assert (host.outputs(), host.state()) == expected


# ------------------------------------------------------------------ values


def test_several_variables_are_moved_in_one_call(tank):
    tank.start()
    references = [tank.variables[name].valueReference for name in ("extra", "inflow")]
    tank.fmu.setFloat64(references, [1.0, 2.0, 3.0, 4.0])
    assert tank.fmu.getFloat64(references, 4) == [1.0, 2.0, 3.0, 4.0]
    assert tank.fmu.getFloat64(references[::-1], 4) == [4.0, 1.0, 2.0, 3.0]
    bounded = [
        *references,
        tank.variables["valve"].valueReference,
        tank.variables["time"].valueReference,
    ]
    assert tank.fmu.getFloat64(bounded, 6) == [1.0, 2.0, 3.0, 4.0, 1.0, 0.0]
    tank.fmu.setFloat64(bounded[:3], [5.0, 6.0, 7.0, 8.0, 0.5])
    assert tank.fmu.getFloat64(bounded[:3], 5) == [5.0, 6.0, 7.0, 8.0, 0.5]
    assert tank.fmu.getFloat64([], 0) == []
    assert tank.messages == []


def test_every_type_is_set_and_acts(tank):
    tank.start(leak=1, counting=False, first_count=7, inflow=2.0, valve=0.5, **{"level0[2]": 4.0})
    assert (tank["leak"], tank["counting"], tank["first_count"], tank["tanks"]) == (1, False, 7, 3)
    tank.steps(10, 0.1)
    assert tank["level[2]"] == pytest.approx(
        4.0 + 1.0 * 1.0, rel=1e-14
    )  # no leak: level0 + valve * inflow * time
    assert tank["count"] == 7.0
    assert tank["time"] == pytest.approx(1.0, rel=1e-14)


def test_outputs_in_initialization_mode_follow_parameters_and_inputs(tank):
    tank.fmu.enterInitializationMode()
    assert (tank["level[1]"], tank["flow"], tank["initialisations"]) == (0.0, 0.0, 1.0)
    tank["level0[1]"] = 2.5
    assert (tank["level[1]"], tank["initialisations"]) == (2.5, 2.0)
    tank["inflow"] = 3.0
    assert (tank["flow"], tank["initialisations"]) == (3.0, 2.0)
    tank.fmu.exitInitializationMode()
    tank["inflow"] = 1.0
    assert tank["flow"] == 3.0  # between steps outputs do not follow inputs
    assert tank.step(0.0, 0.1) == OK
    assert tank["flow"] == 1.0


# ------------------------------------------------------------------ what is refused


def reference(tank, name):
    return tank.variables[name].valueReference


VALUES = {
    "not a number": (
        lambda t: t.set_array("inflow", [math.nan]),
        r"at t = 0 s: inflow = nan: must be a finite number \(rise of",
    ),
    "not finite in an array": (
        lambda t: t.set_array("extra", [0.0, math.inf, 0.0]),
        r"extra\[2\] = inf: must be a finite number",
    ),
    "out of range": (lambda t: t.set_array("valve", [2.0]), "valve = 2: allowed is 0 to 1 "),
    "an output": (
        lambda t: t.set_array("level", [0.0] * 3),
        r"level\[1\] = 0 is refused: it is an output",
    ),
    "a fixed parameter": (
        lambda t: t.set_array("limit", [5.0]),
        "limit = 5 is refused: a parameter is fixed after the init",
    ),
    "a size": (
        lambda t: t.set_array("tanks", [4]),
        "tanks is refused: it is fixed when the FMU is built",
    ),
    "the time": (lambda t: t.set_array("time", [4.0]), "time is refused: it is set by the steps"),
    "too few values": (
        lambda t: t.set_array("extra", [0.0, 1.0]),
        r"extra\[3\] takes 3 values, and 2 are passed",
    ),
    "too many values of several": (
        lambda t: t.fmu.setFloat64([reference(t, "inflow"), reference(t, "extra")], [0.0] * 5),
        r"inflow, extra\[3\] take 4 values, and 5 are passed",
    ),
    "no room for all": (
        lambda t: t.fmu.getFloat64([reference(t, "level")], 2),
        r"level\[3\] takes 3 values, and 2 are passed",
    ),
    "an element of an array": (
        lambda t: t.fmu.getFloat64([reference(t, "extra") + 1]),
        r"is extra\[2\]: an array is read and set as a whole, by the reference ",
    ),
    "an unknown reference": (lambda t: t.fmu.getFloat64([9999]), "value reference 9999 is unknown"),
    "an unknown reference to set": (
        lambda t: t.fmu.setFloat64([9999], [0.0]),
        "value reference 9999 is unknown",
    ),
    "another type": (
        lambda t: t.fmu.getInt32([reference(t, "level")], 3),
        "level.* is of type Float64, not Int32: use the call",
    ),
    "an enumeration as Int32": (
        lambda t: t.fmu.setInt32([reference(t, "leak")], [1]),
        r"leak is of type Enumeration \(Int64\), not Int32",
    ),
    "a type it has not": (
        lambda t: t.fmu.getFloat32([reference(t, "inflow")]),
        "inflow is of type Float64, not Float32",
    ),
    "a string": (
        lambda t: t.fmu.getString([9999]),
        "value reference 9999: this FMU has no variable of type String",
    ),
}


@pytest.mark.parametrize("what", VALUES)
def test_a_wrong_value_is_refused_with_its_name(tank, what):
    act, text = VALUES[what]
    tank.start(inflow=0.25)
    before = tank.outputs()
    act(tank)
    assert tank.fmu.status == ERROR
    (told,) = tank.errors()
    assert told.startswith("tank (Probe): ")
    assert re.search(text, told), told
    assert tank.outputs() == before
    assert tank.step(0.0, 0.1) == ERROR
    assert "reset the slave or restore an earlier state" in tank.errors()[1]
    tank.fmu.reset()
    tank.start().steps(1, 0.1)


ORDER = {
    "a step before the initialisation": (
        lambda t: t.step(0.0, 0.1),
        "the slave is not initialised: enter and exit the init",
    ),
    "an end of the initialisation that never began": (
        lambda t: t.fmu.exitInitializationMode(),
        "cannot exit the init",
    ),
    "a second initialisation": (
        lambda t: (t.start(), t.fmu.enterInitializationMode()),
        "the slave is initialised already",
    ),
    "a step in initialization mode": (
        lambda t: (t.fmu.enterInitializationMode(), t.step(0.0, 0.1)),
        "exit it first",
    ),
    "an end before the start": (
        lambda t: t.start(time=1.0, stop=0.5),
        "stop time = 0.5 s: the start must be a finite number",
    ),
    "termination before the start": (
        lambda t: t.fmu.terminate(),
        "cannot terminate: the slave is not initialised",
    ),
    "a value after the end": (
        lambda t: (t.start(), t.fmu.terminate(), t.set_array("inflow", [1.0])),
        "cannot set a variable",
    ),
    "a step after the end": (
        lambda t: (t.start(), t.fmu.terminate(), t.step(0.0, 0.1)),
        "the slave is terminated",
    ),
    "event mode": (
        lambda t: (t.start(), t.fmu.enterEventMode()),
        "fmi3EnterEventMode: this FMU has no event mode",
    ),
    "a configuration": (
        lambda t: t.fmu.enterConfigurationMode(),
        "its sizes are fixed when the FMU is built",
    ),
    "directional derivatives": (
        lambda t: (t.start(), t.fmu.getDirectionalDerivative([1], [0], [1.0])),
        "no directional deriv",
    ),
    "output derivatives": (
        lambda t: (t.start(), t.fmu.getOutputDerivatives([1], [1])),
        "no derivatives of its outputs",
    ),
    "dependencies of elements": (
        lambda t: t.fmu.fmi3GetNumberOfVariableDependencies(
            t.fmu.component, 0, ctypes.byref(ctypes.c_size_t())
        ),
        "the dependencies stand in model",
    ),
    "no state at all": (lambda t: t.fmu.setFMUState(ctypes.c_void_p()), "no serialized state"),
}


@pytest.mark.parametrize("what", ORDER)
def test_a_call_at_the_wrong_time_is_refused(tank, what):
    act, text = ORDER[what]
    act(tank)
    assert tank.fmu.status == ERROR
    assert any(text in told for told in tank.errors())
    tank.fmu.reset()
    tank.start().steps(1, 0.1)


@pytest.mark.parametrize(
    ("time", "step", "text"),
    [
        (0.2, -0.1, "its length must be a positive number"),
        (0.2, 0.0, "must be a"),
        (0.2, math.nan, "must be a"),
        (0.3, 0.1, "the slave is at t = 0.2 s; steps follow one another"),
        (0.2, 0.9, "it passes the stop time 1 s"),
    ],
)
def test_after_a_bad_step_the_right_one_may_follow(tank, time, step, text):
    tank.start(stop=1.0).steps(2, 0.1)
    assert tank.step(time, step) == ERROR
    assert text in tank.errors()[0]
    assert tank.step(0.2, 0.1) == OK
    assert tank.told == (False, False, False, pytest.approx(0.3))


def test_a_step_that_the_component_cannot_do_is_an_error_with_its_reason(tank):
    tank.start(inflow=9.0, leak=1)
    saved = tank.state()
    tank.steps(2, 0.5)
    assert tank.step(1.0, 0.5) == ERROR != DISCARD  # discard would mean that nothing has changed
    assert "at t = 1 s a tank overflows above the level 10 m" in tank.errors()[0]
    tank.restore(saved)
    assert tank.step(0.0, 0.1) == OK


def test_a_wrong_start_is_refused_with_all_its_reasons_when_the_initialization_mode_ends(tank):
    tank.start(limit=1000.0, valve=-1.0, inflow=math.nan, leak=3, first_count=-1)
    (text,) = tank.errors()
    for part in (
        "limit = 1000 m: allowed is 0.1 to 100 m",
        "valve = -1",
        "inflow = nan",
        "leak = 3",
        "first_count = -1",
    ):
        assert part in text


@pytest.mark.parametrize(
    "damage",
    [
        lambda s: s[:-1],
        lambda s: b"",
        lambda s: s[:100] + bytes([s[100] ^ 1]) + s[101:],
        lambda s: s + b"0",
    ],
)
def test_a_damaged_state_is_refused(tank, damage):
    tank.start()
    tank.restore(damage(tank.state()))
    assert tank.fmu.status == ERROR
    assert "no serialized state of a rockshed FMU, or it is damaged" in tank.errors()[0]


def test_a_state_of_another_component_is_refused(fmi3_fmus, tank):
    with Host3(fmi3_fmus["FallingRock"]) as rock:
        tank.start()
        tank.restore(rock.start().state())
        assert "no serialized state of this component with these sizes" in tank.errors()[0]


INSTANCES = {
    "another token": ({"token": "{0}"}, "the instantiation token is {0}, and this FMU has {"),
    "event mode": (
        {"eventModeUsed": True},
        "event mode is asked for, and this FMU has none (hasEventMode = false)",
    ),
    "intermediate values": (
        {"requiredIntermediateVariables": [1, 2]},
        "intermediate values of 2 variables are asked for",
    ),
    "no name": ({"name": " "}, "the instance has no name"),
}


@pytest.mark.parametrize("what", INSTANCES)
def test_there_is_no_instance_with(fmi3_fmus, what):
    options, text = INSTANCES[what]
    with pytest.raises(Exception, match="Failed to instantiate"):
        Host3(fmi3_fmus["Probe"], **{"logging": False, **options})
    (told,) = Host3.last.errors()
    assert text in told


@pytest.mark.parametrize(
    ("kind", "asked"),
    [(FMU3Model, "model exchange"), (FMU3ScheduledExecution, "scheduled execution")],
)
def test_an_instance_of_another_kind_is_refused_with_a_word(tank, kind, asked):
    told = []
    other = kind(
        guid=tank.description.guid,
        unzipDirectory=tank.folder,
        instanceName="other",
        modelIdentifier="Probe",
    )
    with pytest.raises(Exception, match="Failed to instantiate"):
        other.instantiate(
            logMessage=lambda _environment, status, _category, text: told.append(
                (status, text.decode())
            )
        )
    assert told == [
        (ERROR, f"other (Probe): {asked} is asked for, and this FMU is for co-simulation")
    ]


def test_a_null_instance_is_an_error(tank):
    assert tank.fmu.dll.fmi3Reset(None) == ERROR
    assert tank.fmu.dll.fmi3GetFloat64(None, None, 0, None, 0) == ERROR
    tank.fmu.dll.fmi3FreeInstance(None)


# ------------------------------------------------------------------ messages


def test_messages_are_chosen_by_category(fmi3_fmus):
    with Host3(fmi3_fmus["Probe"], logging=False) as host:
        host.start()
        counts = []
        for on, categories in (
            (True, ["logStatusWarning"]),
            (True, ["logStatusError"]),
            (False, ["logStatusError"]),
            (True, []),
            (False, []),
        ):
            host.fmu.setDebugLogging(on, categories)
            host.step(5.0, 0.1)
            counts.append(len(host.messages))
        assert counts == [0, 1, 1, 2, 2]
        host.fmu.setDebugLogging(True, ["logStatusWarning", "logAll"])
        assert host.messages[-1][:2] == (WARNING, "logStatusWarning")
        assert "log category logAll is unknown" in host.messages[-1][2]
        assert host.step(0.0, 0.1) == OK


def test_a_number_sign_is_no_value_reference(fmi3_fmus):
    with Host3(fmi3_fmus["Probe"], "tank #3, 100%") as host:
        host.step(0.0, 0.1)
        assert host.errors()[0].startswith("tank ##3, 100% (Probe): ")


def test_more_reasons_than_a_message_can_hold_are_cut(fmi3_fmus):
    with Host3(fmi3_fmus["SandCushion"], "a long name " * 50) as host:
        host.start()
        inputs = [v for v in host.variables.values() if v.causality == "input"]
        values = sum(host.length(v.name) for v in inputs)
        host.fmu.setFloat64([v.valueReference for v in inputs] * 2, [math.nan] * 2 * values)
        (text,) = host.errors()
        assert "rock.position.x = nan" in text
        assert text.endswith(" ...")


# ------------------------------------------------------------------ other hosts


ECOS = """
import ctypes, sys
from importlib.metadata import files
for file in files("tbb"):
    if file.name == "libtbb.so.12":
        ctypes.CDLL(str(file.locate()))
from ecospy import EcosSimulation, EcosSimulationStructure
with EcosSimulationStructure() as structure:
    structure.add_model("rock", sys.argv[1])
    structure.add_parameter_set("start", {"rock::velocity0.x": 2.0, "rock::force.x": 3.0})
    with EcosSimulation(step_size=1e-3, structure=structure) as simulation:
        assert simulation.init(parameter_set="start")
        for _ in range(20):
            simulation.step()
        print("found:", *(simulation.get_real(f"rock::{name}").hex() for name in sys.argv[2:]))
"""


@needs("ecospy", "tbb")
def test_ecos_runs_it(native_fmus, fmi3_fmus, python, tmp_path):
    names = ["position.x", "position.y", "velocity.x", "velocity.y", "energy.kinetic"]
    with Host(native_fmus["FallingRock"]) as host:
        host.start(**{"velocity0.x": 2.0, "force.x": 3.0}).steps(20, 1e-3)
        expected = [host[name] for name in names]
    printed = python(ECOS, fmi3_fmus["FallingRock"], *names, TMPDIR=str(tmp_path))
    (found,) = re.findall("^found: (.*)$", printed, re.MULTILINE)
    assert [float.fromhex(text) for text in found.split()] == expected


@pytest.fixture(scope="session")
def c_host(tmp_path_factory):
    """A program in C that runs an FMU's library."""
    program = tmp_path_factory.mktemp("host") / "host3"
    subprocess.run(
        [*compiler("linux64"), "-o", str(program), str(HERE / "host3.c"), "-ldl"],
        check=True,
        capture_output=True,
    )
    return program


@linux
@pytest.mark.parametrize("name", ALL)
def test_a_c_program_without_python_gets_the_same_bits(
    native_fmus, fmi3_fmus, c_host, tmp_path, name
):
    port, value = DRIVE[name]
    with Host(native_fmus[name]) as one, Host3(fmi3_fmus[name]) as other:
        step = float(one.description.defaultExperiment.stepSize)
        one.start(**{port: value}).steps(STEPS, step)
        driven = port.partition("[")[0]
        start = [*other.array(driven)]
        start[int(port.partition("[")[2].rstrip("]") or 1) - 1] = value
        reals = [
            v for v in other.variables.values() if CALLS[v.type] == "Float64" and v.name != "time"
        ]
        expected = [
            one[v.name if not v.dimensions else f"{v.name}[{i + 1}]"]
            for v in reals
            for i in range(other.length(v.name))
        ]
        arguments = [[v.valueReference, other.length(v.name)] for v in reals]
        call = [
            other.description.guid,
            repr(step),
            STEPS,
            other.variables[driven].valueReference,
            len(start),
            *map(repr, start),
        ]
    with zipfile.ZipFile(fmi3_fmus[name]) as archive:
        library = archive.extract(f"binaries/x86_64-linux/{name}.so", tmp_path)
    done = subprocess.run(
        [c_host, library, *map(str, call), *(str(n) for pair in arguments for n in pair)],
        env={},
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert [float.fromhex(line) for line in done.stdout.split()] == expected
