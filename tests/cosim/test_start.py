"""A run of native FMUs imports nothing that it does not use: numba and the like take longer than the run."""

import os
import subprocess
import sys

import pytest

from rockshed.fmus.build import BuildError
from rockshed.fmus.native.fmu import compiler, own_platform

RUN = """
import sys
from rockshed.commands.app import app
sys.argv = ["rockshed", "run", "lab-impact", "--stop-time", "0.001", "--no-figures",
            "--output-dir", sys.argv[1]]
try:
    app(prog_name="rockshed")
except SystemExit as end:
    assert not end.code, end.code
print(*sorted(name for name in sys.modules if "." not in name))
"""
SLOW = {"numba", "scipy", "matplotlib", "dask", "pandas"}


def python(script, *arguments, **environment):
    done = subprocess.run(
        [sys.executable, "-c", script, *map(str, arguments)],
        env=os.environ | environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done


def test_a_run_of_native_fmus_needs_no_numba(tmp_path):
    try:
        compiler(own_platform())
    except BuildError as error:
        pytest.skip(str(error))
    folder = {"ROCKSHED_FMU_DIR": str(tmp_path / "dist")}
    script = RUN.replace('"--stop-time"', '"--runtime", "native", "--stop-time"')
    first = python(script, tmp_path / "a", **folder)  # builds what is missing, and says so
    assert f"built {tmp_path / 'dist' / 'native' / 'SandCushion.fmu'}" in first.stderr
    second = python(RUN, tmp_path / "b", **folder)
    assert "native FMUs (they are up to date)" in second.stderr
    assert not SLOW & set(second.stdout.splitlines()[-1].split())


def test_declarations_are_read_without_numba():
    done = python("""
import sys
from rockshed.components.catalogue import NAMES, component
made = [component(name) for name in NAMES]
assert len(made[0].instance().w) > 10 and made[1].documentation()
print("numba" in sys.modules, "llvmlite.binding" in sys.modules)
made[0].instance().initialise()
print("numba" in sys.modules)
""")
    assert done.stdout.split() == ["False", "False", "True"]
