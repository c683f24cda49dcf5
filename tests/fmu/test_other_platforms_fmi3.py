"""FMUs of FMI 3.0 for Windows under wine, and for 64-bit ARM under qemu, have the bits of those for Linux on x86-64."""

import os
import subprocess
import zipfile
from math import prod

import pytest
from fmpy import read_model_description

import rockshed
from docs.tables.platforms import OUT_OF_THE_WAY, stamp
from rockshed.components.catalogue import NAMES

from .test_other_platforms import (
    ARM,
    HOST,
    QEMU,
    TIMES,
    WINE,
    host,
    needs_qemu,
    needs_wine,
    pytestmark,  # noqa: F401 (of this module, too)
)

LIBRARIES = {
    "linux64": ("x86_64-linux", ".so"),
    "win64": ("x86_64-windows", ".dll"),
    "aarch64-linux": ("aarch64-linux", ".so"),
}


@pytest.fixture(scope="module")
def commands(tmp_path_factory):
    """Commands that run the host for a platform, and their environment."""
    folder = tmp_path_factory.mktemp("hosts")
    source = HOST.with_name("plain_host3.c")
    found = {"linux64": [host(folder, "x86_64-linux-gnu", "host", source)]}
    if WINE:
        found["win64"] = [WINE, host(folder, "x86_64-windows-gnu", "host.exe", source)]
    if QEMU:
        program = host(folder, "aarch64-linux-gnu", "host-arm", source)
        found["aarch64-linux"] = [QEMU, "-L", ARM, program]
    return found


def words(model):
    """What the host is told: values of inputs, and all numbers that it reads."""
    reals = [
        v for v in model.modelVariables if v.type == "Float64" and v.causality != "independent"
    ]
    told = []
    for variable in reals:
        if model.modelName.startswith("SandCushion") and variable.name in OUT_OF_THE_WAY:
            reference = str(variable.valueReference)
            told += ["set", reference, str(OUT_OF_THE_WAY[variable.name])]
    told.append("get")
    for variable in reals:
        length = prod(int(dimension.start) for dimension in variable.dimensions)
        told += [str(variable.valueReference), str(length)]
    return told


@pytest.mark.parametrize(
    "platform",
    [pytest.param("win64", marks=needs_wine), pytest.param("aarch64-linux", marks=needs_qemu)],
)
@pytest.mark.parametrize("name", NAMES)
def test_an_fmu_of_fmi_3_for_another_platform_gives_the_bits_of_that_for_linux(
    commands, tmp_path, tmp_path_factory, name, platform, record_property
):
    record_property("stamp", stamp(name))
    prefix = tmp_path_factory.getbasetemp() / "wine"
    made = {"folder": tmp_path, "runtime": "native", "fmi": 3}
    file = rockshed.build_fmu(name, platforms=("linux64", platform), **made)
    model = read_model_description(str(file), validate=False)
    with zipfile.ZipFile(file) as archive:
        archive.extractall(tmp_path / "fmu")
    said = {}
    for each in ("linux64", platform):
        folder, suffix = LIBRARIES[each]
        library = tmp_path / "fmu" / "binaries" / folder / f"{name}{suffix}"
        done = subprocess.run(
            [*map(str, commands[each]), str(library), model.guid, *TIMES, *words(model)],
            capture_output=True,
            text=True,
            timeout=300,
            check=False,
            env=os.environ | {"WINEPREFIX": str(prefix), "WINEDEBUG": "-all"},
        )
        assert done.returncode == 0, done.stdout[-500:] + done.stderr[-500:]
        said[each] = done.stdout.split()
    assert len(said["linux64"]) > 20
    assert said[platform] == said["linux64"]
