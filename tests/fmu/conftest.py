"""FMUs for the tests, each built once in a session."""

import os
import subprocess
import sys
from collections.abc import Mapping
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


class Built(Mapping):
    """Files of FMUs by the names of their components; each is built when it is asked for first."""

    def __init__(self, runtime, probe, folder, fmi=Fmi.TWO):
        self._probe = probe
        self._options = {"destination": folder, "runtime": runtime, "fmi": fmi}
        self._files = {}

    def __getitem__(self, name):
        if name not in self._files:
            is_probe = name == self._probe.name
            make, what = (build_component, self._probe) if is_probe else (build, name)
            self._files[name] = make(what, **self._options)
        return self._files[name]

    def __iter__(self):
        return iter((*NAMES, self._probe.name))

    def __len__(self):
        return len(NAMES) + 1


@pytest.fixture(scope="session")
def python_fmus(probe, tmp_path_factory):
    """FMUs with Python inside by name."""
    return Built(Runtime.PYTHON, probe, tmp_path_factory.mktemp("fmu dist"))


@pytest.fixture(scope="session")
def native_fmus(probe, tmp_path_factory):
    """Native FMUs by name."""
    try:
        compiler(own_platform())
    except BuildError as error:
        pytest.skip(str(error))
    return Built(Runtime.NATIVE, probe, tmp_path_factory.mktemp("native dist"))


@pytest.fixture(scope="session")
def fmi3_fmus(native_fmus, probe, tmp_path_factory):
    """Native FMUs of FMI 3.0 by name. The object code is that of the native ones of FMI 2.0."""
    return Built(Runtime.NATIVE, probe, tmp_path_factory.mktemp("fmi3 dist"), Fmi.THREE)


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
