"""FMUs for the tests, each built once in a session."""

import importlib
import os
import subprocess
import sys
from pathlib import Path

import pytest

import components
from components.catalogue import NAMES
from fmus.build import build, build_component

HERE = Path(__file__).parent
ROOT = HERE.parent.parent


@pytest.fixture(scope="session")
def probe():
    """The component that has one of everything, imported as if it lay among the others."""
    components.__path__.append(str(HERE / "extra"))
    yield importlib.import_module("components.probe").COMPONENT
    components.__path__.remove(str(HERE / "extra"))


@pytest.fixture(scope="session")
def fmus(probe, tmp_path_factory):
    """Files of the FMUs by name."""
    folder = tmp_path_factory.mktemp("fmu dist")
    return {name: build(name, destination=folder) for name in NAMES} | {"Probe": build_component(probe, destination=folder)}


@pytest.fixture(scope="session")
def python():
    """Run a script in a process of its own; return what it printed. It must end by itself, without error."""
    def run(script, *arguments, timeout=120, **environment):
        done = subprocess.run([sys.executable, "-c", script, *map(str, arguments)], cwd=ROOT, timeout=timeout, text=True,
                              env=os.environ | {"PYTHONPATH": str(ROOT)} | environment, capture_output=True)
        assert done.returncode == 0, f"{done.returncode}\n{done.stdout}\n{done.stderr}"
        return done.stdout
    return run
