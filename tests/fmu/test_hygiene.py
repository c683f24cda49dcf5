"""Every FMU, of both runtimes and both versions of FMI, brings what a stranger has to know of it."""

import re
import zipfile

import pytest
from lxml import etree

from rockshed.components.catalogue import NAMES, component
from rockshed.fmus.build import Fmi, fmu_files
from rockshed.fmus.description.documentation import DIAGRAM, EXPERIMENTS_PAGE
from rockshed.fmus.description.fmi3 import TERMINALS
from rockshed.fmus.description.legal import LICENSE, NEEDED
from rockshed.fmus.experiments.files import MANIFEST
from rockshed.fmus.native.fmu import PLATFORMS, compiler, files_of_one_stamp, own_platform
from rockshed.fmus.parts import DESCRIPTION

EVENTS = {"SlopeRockfall"}
"""Components that go from event to event."""
SEGMENTS = {"PileRod"}
"""Components whose internal step follows from their parameters."""
KINDS = {
    "python": lambda made, sizes: fmu_files(made, sizes),
    "native": lambda made, sizes: files_of_one_stamp(made, sizes, [], Fmi.TWO),
    "native-fmi3": lambda made, sizes: files_of_one_stamp(made, sizes, [], Fmi.THREE),
}


@pytest.fixture(params=[(name, kind) for name in NAMES for kind in KINDS], ids="-".join)
def files(request):
    name, kind = request.param
    made = component(name)
    return name, kind, KINDS[kind](made, made.with_sizes())


def test_an_fmu_has_license_diagram_experiments_tolerance_and_internal_step(files):
    name, kind, content = files
    assert content[LICENSE].startswith(b"MIT License")
    assert content[DIAGRAM].startswith(b"\x89PNG")
    assert b'<img src="diagram.png"' in content["documentation/index.html"]
    assert content[MANIFEST]
    assert content[EXPERIMENTS_PAGE]
    description = etree.fromstring(content[DESCRIPTION])
    assert 0.0 < float(description.find("DefaultExperiment").get("tolerance")) < 1.0
    step = description.find("CoSimulation").get("fixedInternalStepSize")
    # FMI 2.0 has no such attribute
    assert (step is not None) == (kind == "native-fmi3" and name not in EVENTS | SEGMENTS)
    assert kind != "native-fmi3" or b"<Terminal " in content[TERMINALS]
    assert kind != "python" or b"Python >=3.11" in content[NEEDED]


@pytest.mark.parametrize("version", ["native_fmus", "fmi3_fmus"])
def test_a_native_fmu_says_which_processor_and_c_library_it_needs(request, version):
    with zipfile.ZipFile(request.getfixturevalue(version)["FallingRock"]) as archive:
        needed = archive.read(NEEDED).decode()
        libraries = [name for name in archive.namelist() if name.startswith("binaries/")]
    for library in libraries:
        (line,) = (line for line in needed.splitlines() if line.startswith(f"{library}: "))
        assert f"processor {PLATFORMS[own_platform()].processor} or later" in line
        if library.endswith(".so"):
            asked = re.search(r"glibc (\d+)\.(\d+) or later", line)
            assert asked, line
            is_zig = "ziglang" in " ".join(compiler(own_platform()))
            assert not is_zig or tuple(map(int, asked.groups())) <= (2, 28)
