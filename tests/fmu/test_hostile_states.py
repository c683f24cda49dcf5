"""States, values and calls that mean harm: refused in words, never memory of others, never a result that is none."""

import os
import re
import shutil
import struct
import subprocess
import sys
import zlib

import numpy as np
import pytest

from rockshed.components.catalogue import NAMES, component
from rockshed.components.common.component import ComponentError
from rockshed.fmus.native.fmu import library_sources, own_platform, stamp
from rockshed.fmus.parts import Fmi, Runtime

from .conftest import HERE
from .host import DISCARD, OK, Host

SEAL, CLOCK, HEADER = 12, 12, 48
SANITIZERS = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all")
CALLS = int(os.environ.get("ROCKSHED_FUZZ_CALLS", "50000"))
"""Calls of the long test."""
STEPS = {"SlopeRockfall": 1e-2}
"""Ordinary steps (s) where 1e-5 s is none."""
SMALL = {"SandCushion": {"discs": 30}}
"""Sizes with which a thing is quickly computed; of the sand, that settles at every start."""


@pytest.fixture(params=list(Runtime))
def fmus(request):
    return request.getfixturevalue(f"{request.param}_fmus")


def repaired(content: bytes) -> bytes:
    """The state with the checksum that its content has."""
    return content[:8] + struct.pack("<I", zlib.crc32(content[SEAL:])) + content[SEAL:]


def changed(content: bytes, at: int, form: str, value) -> bytes:
    hostile = bytearray(content)
    struct.pack_into(form, hostile, at, value)
    return repaired(bytes(hostile))


def places(host, name):
    """Where w, x and k begin in a serialized state."""
    instance = component(name).instance()
    w = SEAL + CLOCK + HEADER
    return w, w + 8 * instance.w.size, w + 8 * (instance.w.size + instance.x.size)


def refusal(host, content):
    """The error that a state leads to."""
    host.messages.clear()
    host.restore(content)
    assert host.errors(), "the state is accepted"
    return host.errors()[0]


@pytest.mark.parametrize("name", ["FallingRock", "RBSMBeam"])
def test_a_state_with_a_repaired_checksum_and_one_hostile_field_is_refused(fmus, name):
    with Host(fmus[name]) as host:
        host.start().steps(3, 1e-5)
        good = host.state()
        w, x, k = places(host, name)
        host.restore(good)
        assert not host.errors()
        for phase in (0, 6, 2**31):
            assert "its phase is" in refusal(host, changed(good, SEAL, "<I", phase))
        assert "its time is nan" in refusal(host, changed(good, SEAL + 4, "<d", np.nan))
        assert "not finite" in refusal(host, changed(good, w, "<d", np.inf))
        if k > x:
            assert "not finite" in refusal(host, changed(good, x, "<d", np.nan))
        if k < len(good):
            assert "its table of arrays" in refusal(host, changed(good, k, "<q", 1 << 40))
        host.fmu.reset()
        host.messages.clear()
        host.restore(good)
        assert not host.errors()
        host.steps(1, 1e-5, first=3)


def test_a_state_whose_parameter_is_out_of_range_is_refused(fmus):
    with Host(fmus["FallingRock"]) as host:
        host.start().steps(1, 1e-5)
        place = SEAL + CLOCK + HEADER + 8 * host.variables["mass"].valueReference
        assert "mass = -1 kg: allowed is" in refusal(host, changed(host.state(), place, "<d", -1.0))


def test_python_refuses_the_same_states(tmp_path):
    """Readers of states.h5 take states without an FMU."""
    sand = component("SandCushion").instance(discs=30)
    sand.initialise()
    for array in ("row", "pair", "edge_partner", "part"):
        good = sand.to_bytes()
        state = sand.state(array)
        before = state[0]
        state[0] = -1
        hostile = sand.to_bytes()
        state[0] = before
        with pytest.raises(ComponentError, match=f"an index in {array} is out of its range"):
            sand.from_bytes(hostile)
        assert sand.to_bytes() == good


# --- values


LARGE = [("Hammer", "head.impedance", 1e200), ("PileRod", "head.force", 1e155)]


@pytest.mark.parametrize(("name", "variable", "value"), LARGE)
def test_a_step_whose_outputs_are_not_finite_is_discarded_with_a_message(
    fmus, name, variable, value
):
    with Host(fmus[name]) as host:
        host.start()
        host[variable] = value
        time, status = 0.0, OK
        for _ in range(50):
            status = host.step(time, 1e-5)
            if status != OK:
                break
            assert np.isfinite([v for v in host.outputs().values() if v is not None]).all()
            time += 1e-5
        assert status == DISCARD
        assert "finite number" in host.errors()[0]


PLACES = {"rock.position.x": 0.025, "rock.position.y": -0.025}


@pytest.mark.parametrize("everything", [True, False], ids=["all inputs 0", "on a beam disc"])
def test_sand_never_answers_ok_with_a_value_that_is_not_finite(fmus, everything):
    with Host(fmus["SandCushion"]) as host:
        host.start()
        inputs = [n for n, v in host.variables.items() if v.causality == "input"]
        for name, value in (dict.fromkeys(inputs, 0.0) if everything else PLACES).items():
            host[name] = value
        status = host.step(0.0, 1e-5)
        finite = np.isfinite([host[name] for name in ("rock.force.y", "energy.residual")]).all()
        assert status in (OK, DISCARD)
        assert finite or (status == DISCARD and "finite number" in host.errors()[0])


def test_sand_takes_inputs_of_zero_in_the_initialisation_and_their_values_before_the_first_step(
    fmus,
):
    """So that containers, which pass their buffers of zeros on, can begin."""
    with Host(fmus["SandCushion"]) as host, Host(fmus["SandCushion"]) as usual:
        inputs = [n for n, v in host.variables.items() if v.causality == "input"]
        starts = {name: host[name] for name in inputs}
        host.start(**dict.fromkeys(inputs, 0.0))
        assert not host.errors()
        late = [text for status, _, text in host.messages if status == DISCARD]
        assert "first step is refused" in late[0]
        saved = host.state()
        assert host.step(0.0, 1e-5) == DISCARD
        assert "must follow each other" in host.errors()[0]
        host.restore(saved)
        for name, value in starts.items():
            host[name] = value
        host.steps(1, 1e-5)
        usual.start().steps(1, 1e-5)
        assert host.outputs() == usual.outputs()


def test_a_step_of_more_internal_steps_than_one_can_wait_for_is_refused(fmus):
    with Host(fmus["RBSMBeam"]) as host:
        host.start(internal_step=1e-12)
        assert host.step(0.0, 1e-3) == DISCARD
        assert "more than 10,000,000 internal steps" in host.errors()[0]


# --- names


LONG = """
import sys
from tests.fmu.host import Host
with Host(sys.argv[1], name="n" * 70_000) as host:
    host["mass"] = -1.0
    host.fmu.setupExperiment(startTime=0.0)
    host.fmu.enterInitializationMode()
    host["position.y"]
    assert any("not valid yet" in text for _, _, text in host.messages)
"""


def test_a_name_of_70000_letters_overflows_nothing(native_fmus, python):
    python(LONG, native_fmus["FallingRock"])


# --- under sanitizers


def fuzzer(name, fmi, folder):
    """Build the program of fuzz.h for a component and a version of FMI."""
    compiler = shutil.which("gcc")
    if sys.platform != "linux" or compiler is None:
        pytest.skip("needs gcc under Linux")
    platform = own_platform()
    made = component(name)
    sizes = made.with_sizes(SMALL.get(name))
    token = stamp(made, sizes, fmi)
    for file, content in library_sources(made, sizes, [platform], token, fmi)[platform].items():
        (folder / file).write_bytes(content)
    folders = [f"-I{folder}", f"-I{HERE}"]
    command = [compiler, "-std=gnu11", "-O1", "-g", *SANITIZERS, "-ffp-contract=off", *folders]
    program = folder / "fuzz"
    files = [HERE / f"fuzz_fmi{fmi}.c", folder / "kernels.o", "-lm", "-pthread"]
    done = subprocess.run([*command, "-o", program, *files], capture_output=True, text=True)
    if "cannot find" in done.stderr:
        pytest.skip("gcc has no sanitizers here")
    assert done.returncode == 0, done.stderr
    return program


def told(program, what, count, step):
    """Run the program; return the numbers that it tells at its end."""
    done = subprocess.run(
        [program, what, "1", str(count), str(step)], capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout + done.stderr[-4000:]
    return [int(number) for number in re.findall(r"\d+", done.stdout)]


def attack(name, fmi, folder, states, calls):
    """Hand hostile states to a component, then call it, legally and illegally."""
    program, step = fuzzer(name, fmi, folder), STEPS.get(name, 1e-5)
    tried, taken = told(program, "states", states, step)
    assert tried == states
    assert 0.2 * states < taken < 0.9 * states, "nearly all states are refused, or taken"
    called, taken, starts, steps = told(program, "calls", calls, step)
    assert called >= calls
    assert 0.3 * calls < taken < 0.9 * calls, "nearly all calls are legal, or illegal"
    assert steps > 0.1 * calls
    assert starts > 0.005 * calls


@pytest.mark.parametrize(
    ("name", "fmi"), [("FallingRock", Fmi.TWO), ("PileRod", Fmi.TWO), ("Hammer", Fmi.THREE)]
)
def test_hostile_states_and_calls_touch_no_memory_of_others(native_fmus, name, fmi, tmp_path):
    attack(name, fmi, tmp_path, states=2_000, calls=20_000)


@pytest.mark.slow
@pytest.mark.parametrize("fmi", list(Fmi))
@pytest.mark.parametrize("name", NAMES)
def test_20000_hostile_states_and_many_calls_touch_no_memory_of_others(
    native_fmus, name, fmi, tmp_path
):
    long = "ROCKSHED_FUZZ_CALLS" in os.environ
    if name == "SandCushion" and not long:
        pytest.skip("the steps of the sand take long: set ROCKSHED_FUZZ_CALLS")
    attack(name, fmi, tmp_path, states=20_000, calls=CALLS)
