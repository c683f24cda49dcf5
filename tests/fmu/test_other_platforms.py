"""FMUs for Windows under wine, and for 64-bit ARM under qemu, give the bits of those for Linux on x86-64."""

import os
import shutil
import struct
import subprocess
import sys
import zipfile
from importlib.util import find_spec
from pathlib import Path

import pytest
from fmpy import read_model_description

import rockshed
from docs.tables.platforms import EXCHANGES, IMPACT, OUT_OF_THE_WAY, STEP, STEPS, stamp
from rockshed.components.catalogue import NAMES
from rockshed.core.run import simulate, sources_of
from rockshed.core.system.planning import make_plan

_PLACES = os.pathsep.join((os.environ.get("PATH", ""), "/usr/lib/wine"))  # the latter is Debian's
WINE = shutil.which("wine64", path=_PLACES) or shutil.which("wine", path=_PLACES)
QEMU = shutil.which("qemu-aarch64")
ARM = Path("/usr/aarch64-linux-gnu")
"""C library for programs of ARM: libc6-arm64-cross of Debian."""
needs_wine = pytest.mark.skipif(not WINE, reason="not installed: wine, which runs FMUs for Windows")
needs_qemu = pytest.mark.skipif(
    not (QEMU and (ARM / "lib").is_dir()),
    reason="not installed: qemu-user and libc6-arm64-cross, which run FMUs for ARM",
)
pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(sys.platform != "linux", reason="compares with FMUs for Linux"),
    pytest.mark.skipif(not find_spec("ziglang"), reason="not installed: ziglang"),
]
HOST = Path(__file__).parent / "plain_host.c"
COUPLED_HOST = HOST.with_name("coupled_host.c")
TIMES = (repr(STEP), str(STEPS))
"""Words of a host."""


def host(folder, target, name, source=HOST):
    """Compile a host for a platform."""
    file = folder / name
    compiler = [sys.executable, "-m", "ziglang", "cc", "-target", target, "-O1", "-w"]
    subprocess.run([*compiler, str(source), "-o", str(file)], check=True)
    return file


@pytest.fixture(scope="module")
def hosts(tmp_path_factory):
    """Commands that run the host for a platform."""
    folder = tmp_path_factory.mktemp("hosts")
    found = {"linux64": [str(host(folder, "x86_64-linux-gnu", "host"))]}
    if WINE:
        found["win64"] = [WINE, str(host(folder, "x86_64-windows-gnu", "host.exe"))]
    if QEMU:
        program = host(folder, "aarch64-linux-gnu", "host-arm")
        found["aarch64-linux"] = [QEMU, "-L", str(ARM), str(program)]
    return found


@pytest.fixture(scope="module")
def prefix(tmp_path_factory):
    """An environment in which wine keeps its files, and says nothing of its own."""
    return os.environ | {"WINEPREFIX": str(tmp_path_factory.mktemp("wine")), "WINEDEBUG": "-all"}


def said(hosts, prefix, platform, folder, model):
    suffix = "dll" if platform == "win64" else "so"
    library = folder / "binaries" / platform / f"{model.coSimulation.modelIdentifier}.{suffix}"
    reals = [v for v in model.modelVariables if v.type == "Real"]
    words = [str(library), model.guid, *TIMES]
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


@pytest.mark.parametrize(
    "platform",
    [
        pytest.param("win64", marks=needs_wine),
        pytest.param("aarch64-linux", marks=needs_qemu),
    ],
)
@pytest.mark.parametrize("name", NAMES)
def test_an_fmu_for_another_platform_gives_the_bits_of_that_for_linux(
    hosts, prefix, tmp_path, name, platform, record_property
):
    record_property("stamp", stamp(name))
    platforms = ("linux64", platform)
    file = rockshed.build_fmu(name, folder=tmp_path, runtime="native", platforms=platforms)
    model = read_model_description(str(file), validate=False)
    with zipfile.ZipFile(file) as archive:
        archive.extractall(tmp_path / "fmu")
    here, there = (said(hosts, prefix, one, tmp_path / "fmu", model) for one in platforms)
    assert len(here) > 20
    assert there == here


MODELS = {"rock": "FallingRock", "sand": "SandCushion", "beam": "RBSMBeam"}


@pytest.fixture(scope="module")
def impact(tmp_path_factory):
    """The laboratory impact with FMUs for both processors: plan, and where they are unpacked."""
    folder = tmp_path_factory.mktemp("impact")
    spec = rockshed.case("lab-impact", in_process=True).spec
    platforms = ("linux64", "aarch64-linux")
    parts = {}
    for name, component in spec.components.items():
        made = {"folder": folder, "runtime": "native", "platforms": platforms}
        file = rockshed.build_fmu(MODELS[name], **made)
        parts[name] = component.model_copy(update={"fmu": str(file)})
        with zipfile.ZipFile(file) as archive:
            archive.extractall(folder / name)
    system = spec.model_copy(update={"components": parts})
    return make_plan(system, sources_of(system)), folder


def order(plan, folder, platform):
    """What the coupled host reads: the plan of a run."""
    number = {name: str(place) for place, name in enumerate(plan.order)}

    def place(end):
        return f"{number[end.component]} {end.port.reference}"

    lines = [
        f"fmu {folder}/{name}/binaries/{platform}/{MODELS[name]}.so {plan.descriptions[name].guid}"
        for name in plan.order
    ]
    for name in plan.order:
        for port, value in plan.starts[name]:
            word = "set" if port.type == "Real" else "choose"
            written = repr(float(value)) if port.type == "Real" else str(int(value))
            lines.append(f"{word} {number[name]} {port.reference} {written}")
    sources = [plan.outputs[int(source)] for source in plan.source]
    lines += [f"wire {place(s)} {place(target)}" for s, target in zip(sources, plan.inputs)]
    return "\n".join([*lines, *(f"get {place(end)}" for end in plan.outputs)])


@needs_qemu
def test_the_laboratory_impact_on_arm_has_the_bits_of_a_run(impact, tmp_path, record_property):
    record_property("stamp", stamp(IMPACT))
    plan, folder = impact
    step = plan.system.exchange_step
    assert step == STEP
    shown = {}
    hosts = {
        "linux64": [host(tmp_path, "x86_64-linux-gnu", "host", COUPLED_HOST)],
        "aarch64-linux": [
            QEMU,
            "-L",
            ARM,
            host(tmp_path, "aarch64-linux-gnu", "arm", COUPLED_HOST),
        ],
    }
    for platform, program in hosts.items():
        done = subprocess.run(
            [*map(str, program), repr(step), str(EXCHANGES)],
            input=order(plan, folder, platform),
            capture_output=True,
            text=True,
            timeout=300,
            check=False,
        )
        assert done.returncode == 0, done.stdout[-500:] + done.stderr[-500:]
        shown[platform] = done.stdout.split()
    assert shown["aarch64-linux"] == shown["linux64"]
    run = simulate(plan.system.model_copy(update={"stop_time": step * EXCHANGES}), tmp_path / "run")
    there = {end.name: bits for end, bits in zip(plan.outputs, shown["aarch64-linux"], strict=True)}
    for name in ("rock.position.y", "rock.velocity.y", "sand.rock.force.y"):
        assert struct.pack(">d", run.series[name][-1]).hex() == there[name]
    assert run.series["sand.rock.force.y"][-1] > 0.0
