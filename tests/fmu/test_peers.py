"""The FMUs in other tools, as fmus/README.md tells how: its code is run as it stands there, each tool in a process of its own."""

import json
import re
from importlib.metadata import PackageNotFoundError, distribution
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from fmpy import read_model_description

from rockshed import fmus as package
from rockshed.cases.sonoda1993 import lab_system
from rockshed.cases.sonoda1993 import tests as laboratory_tests
from rockshed.components.falling_rock import COMPONENT as ROCK
from rockshed.components.sand_cushion import COMPONENT as SAND
from rockshed.core.run import simulate

README = (Path(package.__file__).parent / "README.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```python\n(.*?)^```$", README, re.DOTALL | re.MULTILINE)


def block(word):
    """The one piece of the README's code in which a word occurs."""
    (code,) = (code for code in BLOCKS if word in code)
    return code


COMMON = block("CONNECTIONS = ")
SYSTEM: dict = {}
exec(COMMON, SYSTEM)
STEP, STEPS = SYSTEM["STEP"], SYSTEM["STEPS"]


def needs(*packages):
    """Mark of a test that needs other tools' packages."""

    def is_missing(name):
        try:
            distribution(name)
        except PackageNotFoundError:
            return True
        return False

    missing = [name for name in packages if is_missing(name)]
    return lambda test: pytest.mark.peers(
        pytest.mark.skipif(bool(missing), reason=f"not installed: {', '.join(missing)}")(test)
    )


@pytest.fixture(scope="session")
def folder(fmus):
    """Where the FMUs are."""
    return fmus["FallingRock"].parent


@pytest.fixture(scope="session")
def outputs(folder):
    """All outputs of the three FMUs."""
    return [
        (name, variable.name)
        for name, file in SYSTEM["FMUS"].items()
        for variable in read_model_description(folder / file).modelVariables
        if variable.causality == "output"
    ]


@pytest.fixture
def run(python, folder, outputs, tmp_path):
    """Run a piece of the README's code after its common one; return the series of all outputs, not only of those it watches."""

    def series(code):
        result = tmp_path / "series.json"
        script = "\n".join(
            [
                f"import os; os.chdir({str(folder)!r})",
                COMMON,
                f"WATCH = {outputs!r}",
                code,
                f"import json; json.dump([list(series[port]) for port in WATCH], open({str(result)!r}, 'w'))",
            ]
        )
        python(script, timeout=100, TMPDIR=str(tmp_path))
        return dict(zip(outputs, np.array(json.loads(result.read_text()))))

    return series


@pytest.fixture(scope="session")
def ours(folder, outputs, tmp_path_factory):
    """Our own Jacobi run: the laboratory with the README's start values."""
    files = {name: str(folder / file) for name, file in SYSTEM["FMUS"].items()}
    laboratory = lab_system(files, laboratory_tests()[4], "jacobi")
    start = {
        name: {port: value for (owner, port), value in SYSTEM["START"].items() if owner == name}
        for name in files
    }
    system = laboratory.model_copy(
        update={
            "components": {
                name: spec.model_copy(update={"parameters": start[name]})
                for name, spec in laboratory.components.items()
            },
            "shared": {},
            "exchange_step": STEP,
            "stop_time": STEP * STEPS,
            "output_interval": STEP,
        }
    )
    result = simulate(system, tmp_path_factory.mktemp("ours") / "run").series
    return {port: result[".".join(port)] for port in outputs}


def assert_the_same_bits(ours, theirs, first=0):
    """``first``: the row of ours with which theirs begin."""
    assert len(ours) > 250
    for port, values in ours.items():
        np.testing.assert_array_equal(theirs[port], values[first:], err_msg=".".join(port))


def test_the_run_is_no_trivial_one(ours):
    """The rock is five centimetres deep in the sand and turns, the beam has bent and carries thirty times what it did at rest."""
    assert ours["sand", "penetration"][-1] > 0.05
    assert abs(ours["rock", "angular_velocity"][-1]) > 0.1
    assert ours["sand", "transmitted_force"][-1] > 30 * ours["sand", "transmitted_force"][0]
    assert ours["beam", "midspan.deflection"].max() > 3e-4
    assert np.ptp(ours["beam", "angle[7]"]) > 1e-4


def test_fmpy_gives_our_jacobi_result(run, ours):
    assert_the_same_bits(ours, run(block("import FMU2Slave")))


@needs("ecospy", "tbb")
def test_ecos_gives_our_jacobi_result(run, ours):
    assert_the_same_bits(ours, run(block("import EcosSimulation")))


@needs("libcosimpy")
def test_libcosim_gives_our_jacobi_result(run, ours):
    """Its steps differ from ours in the last bit; the components take them for the multiple of their own step that they are."""
    assert_the_same_bits(ours, run(block("import CosimExecution")), first=1)


@pytest.fixture(scope="session")
def alone(folder, python, tmp_path_factory):
    """What the README's code for single FMUs computes, by name."""
    temporary = tmp_path_factory.mktemp("alone")
    file = temporary / "results.npz"
    python(
        f"import os; os.chdir({str(folder)!r})\n{block('import simulate_fmu')}\nnp.savez({str(file)!r}, fall=fall, press=press)",
        TMPDIR=str(temporary),
    )
    return np.load(file)


def test_simulate_fmu_runs_the_rock_alone(alone):
    """Free fall, with the closed form of an integration that changes the velocity first."""
    t, dt, g = alone["fall"]["time"], 1e-5, ROCK.instance()["gravity"]
    assert t.size == 101
    assert alone["fall"]["velocity.y"] == pytest.approx(-8.0 - g * t, rel=1e-11)
    assert alone["fall"]["position.y"] == pytest.approx(
        10.0 - 8.0 * t - 0.5 * g * t * (t + dt), rel=1e-12
    )


def test_the_readmes_first_lines_for_fmpy_print_why_a_value_is_refused(folder, python, tmp_path):
    readme = (Path(package.__file__).parents[1] / "README.md").read_text(encoding="utf-8")
    (code,) = (
        code
        for code in re.findall(r"^```python\n(.*?)^```$", readme, re.DOTALL | re.MULTILINE)
        if "fmpy" in code
    )
    code = code.replace("fmus/dist/python", str(folder))
    fell = "print(len(result), result['velocity.y'][-1] < -8.9)"
    assert python(f"{code}\n{fell}", TMPDIR=str(tmp_path)).split() == ["101", "True"]
    assert "mass = -4 kg: allowed is 1e-06 kg or more" in python(
        code.replace("1000.0", "-4.0"), TMPDIR=str(tmp_path)
    )


def test_simulate_fmu_runs_the_sand_alone(alone):
    """The same bits as the component itself with the inputs and steps that fmpy has set."""
    press = alone["press"]
    sand = SAND.instance()
    sand["rock.position.x"], sand["rock.position.y"], sand["rock.velocity.y"] = (
        0.6,
        press["rock.position.y"][0],
        -1.0,
    )
    sand.initialise()
    for before, after in pairwise(press):
        sand["rock.position.y"] = after["rock.position.y"]
        sand.step(before["time"], after["time"] - before["time"])
        for name in ("rock.force.y", "transmitted_force", "penetration", "energy.work.rock"):
            assert after[name] == sand[name], (after["time"], name)
    assert press.size == 201
    assert press["rock.force.y"][-1] > 500.0
