"""FMUs for the tests, each built once in a session."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from rockshed.components.catalogue import NAMES, component_in
from rockshed.fmus.build import BuildError, Fmi, Runtime, build, build_component
from rockshed.fmus.native.fmu import compiler, own_platform

HERE = Path(__file__).parent
ROOT = HERE.parent.parent


@pytest.fixture(scope="session")
def probe():
    """The component that has one of everything, from a folder of its own."""
    return component_in(HERE / "extra" / "probe")


def built(runtime, probe, folder, fmi=Fmi.TWO):
    """Files of the FMUs by name."""
    return {name: build(name, destination=folder, runtime=runtime, fmi=fmi) for name in NAMES} | {
        "Probe": build_component(probe, destination=folder, runtime=runtime, fmi=fmi)
    }


@pytest.fixture(scope="session")
def python_fmus(probe, tmp_path_factory):
    """FMUs with Python inside by name."""
    return built(Runtime.PYTHON, probe, tmp_path_factory.mktemp("fmu dist"))


@pytest.fixture(scope="session")
def native_fmus(probe, tmp_path_factory):
    """Native FMUs by name."""
    try:
        compiler(own_platform())
    except BuildError as error:
        pytest.skip(str(error))
    return built(Runtime.NATIVE, probe, tmp_path_factory.mktemp("native dist"))


@pytest.fixture(scope="session")
def fmi3_fmus(native_fmus, probe, tmp_path_factory):
    """Native FMUs of FMI 3.0 by name. The object code is that of the native ones of FMI 2.0."""
    return built(Runtime.NATIVE, probe, tmp_path_factory.mktemp("fmi3 dist"), Fmi.THREE)


@pytest.fixture(scope="session")
def fmus(python_fmus):
    """Files of the FMUs by name; a module that tests both runtimes has a fixture of its own with this name."""
    return python_fmus


@pytest.fixture(scope="session")
def python():
    """Run a script in a process of its own; return what it printed. It must end by itself, without error."""

    def run(script, *arguments, timeout=120, **environment):
        done = subprocess.run(
            [sys.executable, "-c", script, *map(str, arguments)],
            cwd=ROOT,
            timeout=timeout,
            text=True,
            env=os.environ | {"PYTHONPATH": str(ROOT)} | environment,
            capture_output=True,
        )
        assert done.returncode == 0, f"{done.returncode}\n{done.stdout}\n{done.stderr}"
        return done.stdout

    return run
