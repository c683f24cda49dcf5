"""FMUs for Windows under wine give the bits of those for Linux."""

import os
import shutil
import subprocess
import sys
import zipfile
from importlib.util import find_spec
from pathlib import Path

import pytest
from fmpy import read_model_description

import rockshed
from rockshed.components.catalogue import NAMES

_PLACES = os.pathsep.join((os.environ.get("PATH", ""), "/usr/lib/wine"))  # the latter is Debian's
WINE = shutil.which("wine64", path=_PLACES) or shutil.which("wine", path=_PLACES)
pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(sys.platform != "linux", reason="compares with FMUs for Linux"),
    pytest.mark.skipif(not find_spec("ziglang"), reason="not installed: ziglang"),
    pytest.mark.skipif(not WINE, reason="not installed: wine, which runs FMUs for Windows"),
]
HOST = Path(__file__).parent / "plain_host.c"
STEPS = ("1e-5", "50")
OUT_OF_THE_WAY = {"rock.position.x": 0.6, "rock.position.y": 0.2}
"""Inputs of the sand that it does not refuse."""


def host(folder, target, name):
    """Compile the host for a platform."""
    file = folder / name
    compiler = [sys.executable, "-m", "ziglang", "cc", "-target", target, "-O1", "-w"]
    subprocess.run([*compiler, str(HOST), "-o", str(file)], check=True)
    return file


@pytest.fixture(scope="module")
def hosts(tmp_path_factory):
    folder = tmp_path_factory.mktemp("hosts")
    return {
        "linux64": [str(host(folder, "x86_64-linux-gnu", "host"))],
        "win64": [WINE, str(host(folder, "x86_64-windows-gnu", "host.exe"))],
    }


@pytest.fixture(scope="module")
def prefix(tmp_path_factory):
    """An environment in which wine keeps its files, and says nothing of its own."""
    return os.environ | {"WINEPREFIX": str(tmp_path_factory.mktemp("wine")), "WINEDEBUG": "-all"}


def said(hosts, prefix, platform, folder, model):
    suffix = {"linux64": "so", "win64": "dll"}[platform]
    library = folder / "binaries" / platform / f"{model.coSimulation.modelIdentifier}.{suffix}"
    reals = [v for v in model.modelVariables if v.type == "Real"]
    words = [str(library), model.guid, *STEPS]
    if model.modelName.startswith("SandCushion"):
        for variable in reals:
            if variable.name in OUT_OF_THE_WAY:
                reference = str(variable.valueReference)
                words += ["set", reference, str(OUT_OF_THE_WAY[variable.name])]
    words += ["get", *(str(variable.valueReference) for variable in reals)]
    command = [*hosts[platform], *words]
    done = subprocess.run(command, capture_output=True, text=True, env=prefix, timeout=300)
    assert done.returncode == 0, done.stdout[-500:] + done.stderr[-500:]
    return done.stdout.split()


@pytest.mark.parametrize("name", NAMES)
def test_an_fmu_for_windows_gives_the_bits_of_that_for_linux(hosts, prefix, tmp_path, name):
    platforms = ("linux64", "win64")
    file = rockshed.build_fmu(name, folder=tmp_path, runtime="native", platforms=platforms)
    model = read_model_description(str(file), validate=False)
    with zipfile.ZipFile(file) as archive:
        archive.extractall(tmp_path / "fmu")
    on_linux, on_windows = (
        said(hosts, prefix, platform, tmp_path / "fmu", model) for platform in ("linux64", "win64")
    )
    assert len(on_linux) > 20
    assert on_windows == on_linux
