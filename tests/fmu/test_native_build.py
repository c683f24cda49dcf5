"""Building native FMUs: what may be in them, for which platforms, and what happens when a compiler or a kernel does not fit."""

import dataclasses
import hashlib
import importlib.util
import os
import re
import shutil
import struct
import subprocess
import sys
import time
import zipfile
from pathlib import Path

import psutil
import pytest
from typer.testing import CliRunner

from rockshed.commands.app import app
from rockshed.components.catalogue import NAMES, component
from rockshed.fmus import kept_code
from rockshed.fmus.build import (
    BuildError,
    Fmi,
    Runtime,
    build_component,
    build_if_needed,
    file_name,
    folder_name,
    native_is_fresh,
)
from rockshed.fmus.native import fmu as native_fmu
from rockshed.fmus.native.fmu import CPU, compiler, model_header, native_files
from rockshed.platforms import Platform, platforms_of

from .host import Host

ZIG = importlib.util.find_spec("ziglang") is not None
needs_zig = pytest.mark.skipif(not ZIG, reason="not installed: ziglang (extra 'native')")
linux = pytest.mark.skipif(sys.platform != "linux", reason="looks at a library of Linux")

C_LIBRARY = set(
    re.findall(
        r"\w+",
        """
    acos asin atan atan2 bcmp erfc exp expm1 floor log log1p pow sin sincos sqrt
    calloc cos fabs free malloc memcmp memcpy memmove memset nextafter pthread_create pthread_join snprintf
    strcmp strcpy strlen strtol tan vsnprintf
    __cxa_finalize __gmon_start__ _ITM_deregisterTMCloneTable _ITM_registerTMCloneTable __stack_chk_fail
    __memcpy_chk __snprintf_chk __strcpy_chk __vsnprintf_chk""",
    )
)
MACOS_ONLY = {"__stack_chk_guard", "dyld_stub_binder", "__bzero", "bzero", "__sincos_stret"}
"""What its C library has besides: on ARM bzero for __bzero; the last is its sincos."""
FUNCTIONS = {
    Fmi.TWO: set(
        re.findall(
            r"\w+",
            """
    fmi2GetTypesPlatform fmi2GetVersion fmi2SetDebugLogging fmi2Instantiate fmi2FreeInstance fmi2SetupExperiment
    fmi2EnterInitializationMode fmi2ExitInitializationMode fmi2Terminate fmi2Reset fmi2GetReal fmi2GetInteger fmi2GetBoolean
    fmi2GetString fmi2SetReal fmi2SetInteger fmi2SetBoolean fmi2SetString fmi2GetFMUstate fmi2SetFMUstate fmi2FreeFMUstate
    fmi2SerializedFMUstateSize fmi2SerializeFMUstate fmi2DeSerializeFMUstate fmi2GetDirectionalDerivative
    fmi2SetRealInputDerivatives fmi2GetRealOutputDerivatives fmi2DoStep fmi2CancelStep fmi2GetStatus fmi2GetRealStatus
    fmi2GetIntegerStatus fmi2GetBooleanStatus fmi2GetStringStatus""",
        )
    ),
    Fmi.THREE: set(
        re.findall(
            r"\w+",
            """
    fmi3GetVersion fmi3SetDebugLogging fmi3InstantiateModelExchange fmi3InstantiateCoSimulation
    fmi3InstantiateScheduledExecution fmi3FreeInstance fmi3EnterInitializationMode fmi3ExitInitializationMode
    fmi3EnterEventMode fmi3Terminate fmi3Reset fmi3GetFloat32 fmi3GetFloat64 fmi3GetInt8 fmi3GetUInt8 fmi3GetInt16
    fmi3GetUInt16 fmi3GetInt32 fmi3GetUInt32 fmi3GetInt64 fmi3GetUInt64 fmi3GetBoolean fmi3GetString fmi3GetBinary
    fmi3GetClock fmi3SetFloat32 fmi3SetFloat64 fmi3SetInt8 fmi3SetUInt8 fmi3SetInt16 fmi3SetUInt16 fmi3SetInt32
    fmi3SetUInt32 fmi3SetInt64 fmi3SetUInt64 fmi3SetBoolean fmi3SetString fmi3SetBinary fmi3SetClock
    fmi3GetNumberOfVariableDependencies fmi3GetVariableDependencies fmi3GetFMUState fmi3SetFMUState fmi3FreeFMUState
    fmi3SerializedFMUStateSize fmi3SerializeFMUState fmi3DeserializeFMUState fmi3GetDirectionalDerivative
    fmi3GetAdjointDerivative fmi3EnterConfigurationMode fmi3ExitConfigurationMode fmi3GetIntervalDecimal
    fmi3GetIntervalFraction fmi3GetShiftDecimal fmi3GetShiftFraction fmi3SetIntervalDecimal fmi3SetIntervalFraction
    fmi3SetShiftDecimal fmi3SetShiftFraction fmi3EvaluateDiscreteStates fmi3UpdateDiscreteStates
    fmi3EnterContinuousTimeMode fmi3CompletedIntegratorStep fmi3SetTime fmi3SetContinuousStates
    fmi3GetContinuousStateDerivatives fmi3GetEventIndicators fmi3GetContinuousStates fmi3GetNominalsOfContinuousStates
    fmi3GetNumberOfEventIndicators fmi3GetNumberOfContinuousStates fmi3EnterStepMode fmi3GetOutputDerivatives fmi3DoStep
    fmi3ActivateModelPartition""",
        )
    ),
}
"""All functions of FMI 2.0 for co-simulation and of FMI 3.0, as the standards list them."""
ALSO_IN_FMI_3 = {"strspn"}
"""Functions of the C library that only the shim of FMI 3.0 needs."""


@pytest.fixture
def no_cache(monkeypatch, tmp_path):
    """Objects that are compiled in a test are not kept, and none are found."""
    monkeypatch.setattr(kept_code, "cache_directory", lambda: None)


# ------------------------------------------------------------------ symbols


def text_at(content, place):
    return content[place : content.index(b"\0", place)].decode()


def elf_symbols(content):
    """(needed from outside, offered) of a shared object of Linux, by its dynamic symbol table."""
    (sections_at,) = struct.unpack_from("<Q", content, 0x28)
    size, number = struct.unpack_from("<HH", content, 0x3A)
    sections = [
        struct.unpack_from("<IIQQQQIIQQ", content, sections_at + i * size) for i in range(number)
    ]
    table = next(s for s in sections if s[1] == 11)  # SHT_DYNSYM
    names = sections[table[6]][4]
    symbols = [
        struct.unpack_from("<IBBHQQ", content, table[4] + i) for i in range(24, table[5], 24)
    ]
    found = [(text_at(content, names + s[0]), s[3] != 0) for s in symbols]
    return {name for name, is_here in found if not is_here}, {
        name for name, is_here in found if is_here
    }


def dll_exports(content):
    """Names that a library of Windows offers, by its export directory."""
    (header,) = struct.unpack_from("<I", content, 0x3C)
    assert content[header : header + 4] == b"PE\0\0"
    (number,) = struct.unpack_from("<H", content, header + 6)
    (optional,) = struct.unpack_from("<H", content, header + 20)
    assert struct.unpack_from("<H", content, header + 4)[0] == 0x8664
    rows = [
        struct.unpack_from("<8sIIII", content, header + 24 + optional + 40 * i)
        for i in range(number)
    ]

    def place(address):
        return next(
            raw + address - start
            for _, size, start, _, raw in rows
            if start <= address < start + size
        )

    directory = place(struct.unpack_from("<I", content, header + 24 + 112)[0])
    count, _, names = struct.unpack_from("<III", content, directory + 24)
    return {
        text_at(content, place(struct.unpack_from("<I", content, place(names) + 4 * i)[0]))
        for i in range(count)
    }


X86_64, ARM64 = 0x01000007, 0x0100000C
"""Processors of libraries of macOS."""
CODE_SIGNATURE = 0x1D
"""Load command without which macOS loads no library on Apple silicon."""


def dylib_symbols(content, processor=X86_64):
    """(needed from outside, offered) of a library of macOS, by its symbol table."""
    magic, cpu, _, _, number, _ = struct.unpack_from("<IIIIII", content)
    assert (magic, cpu) == (0xFEEDFACF, processor)
    at, found, commands = 32, [], set()
    for _ in range(number):
        command, length = struct.unpack_from("<II", content, at)
        commands.add(command)
        if command == 2:  # LC_SYMTAB
            table, count, names, _ = struct.unpack_from("<IIII", content, at + 8)
            rows = [struct.unpack_from("<IBBHQ", content, table + 16 * i) for i in range(count)]
            found = [
                (text_at(content, names + row[0]).removeprefix("_"), row[1])
                for row in rows
                if row[1] & 1
            ]
        at += length
    assert processor == X86_64 or CODE_SIGNATURE in commands
    return {name for name, kind in found if not kind & 14}, {
        name for name, kind in found if kind & 14
    }


def library(file, platform, suffix):
    with zipfile.ZipFile(file) as archive:
        (name,) = (n for n in archive.namelist() if n.startswith(f"binaries/{platform}/"))
        assert name.endswith(suffix)
        return archive.read(name)


@linux
@pytest.mark.parametrize("name", [*NAMES, "Probe"])
def test_a_library_offers_fmi_and_needs_the_c_library_only(native_fmus, fmi3_fmus, name):
    in_fmi2, in_fmi3 = (
        library(native_fmus[name], "linux64", ".so"),
        library(fmi3_fmus[name], "x86_64-linux", ".so"),
    )
    assert [elf_symbols(content)[1] for content in (in_fmi2, in_fmi3)] == [
        FUNCTIONS[Fmi.TWO],
        FUNCTIONS[Fmi.THREE],
    ]
    assert elf_symbols(in_fmi2)[0] - C_LIBRARY == set()
    assert elf_symbols(in_fmi3)[0] - C_LIBRARY - ALSO_IN_FMI_3 == set()
    for content in (in_fmi2, in_fmi3):
        assert b"python" not in content.lower().replace(b"runs in python", b"")


FOLDERS = {
    "x86_64-linux": ("linux64", ".so"),
    "x86_64-windows": ("win64", ".dll"),
    "x86_64-darwin": ("darwin64", ".dylib"),
    "aarch64-linux": ("aarch64-linux", ".so"),
    "aarch64-darwin": ("aarch64-darwin", ".dylib"),
}
"""Folder of a platform in FMI 2.0, and suffix of its libraries; in FMI 3.0 its name is the folder."""
OF_THE_LOADER = {"_mh_dylib_header", "__dso_handle"}


@pytest.mark.slow
@needs_zig
@pytest.mark.parametrize("fmi", list(Fmi))
def test_one_command_builds_all_components_for_all_platforms(monkeypatch, tmp_path, fmi):
    monkeypatch.delenv("CC", raising=False)
    words = ["--runtime", "native", "--fmi", str(int(fmi)), "--platform", "all"]
    done = CliRunner().invoke(app, ["build", *words, "--output-dir", str(tmp_path)])
    assert done.exit_code == 0, done.stderr
    for name in NAMES:
        with zipfile.ZipFile(tmp_path / folder_name(Runtime.NATIVE, fmi) / f"{name}.fmu") as fmu:
            paths = [path for path in fmu.namelist() if path.startswith("binaries/")]
            libraries = {path: fmu.read(path) for path in paths}
        for platform, (in_fmi2, suffix) in FOLDERS.items():
            folder = in_fmi2 if fmi is Fmi.TWO else platform
            library = libraries.pop(f"binaries/{folder}/{name}{suffix}")
            assert platforms_of(library) == {platform}
            assert_offers_fmi(library, platform, fmi)
        assert not libraries


def assert_offers_fmi(library, platform, fmi):
    """A library offers the functions of FMI and nothing else, and needs its C library alone."""
    if platform.endswith("windows"):
        assert dll_exports(library) == FUNCTIONS[fmi]
        return
    if platform.endswith("linux"):
        assert newest_c_library(library) <= (2, 17)
        needed, offered = elf_symbols(library)
        others = set()
    else:
        kind = ARM64 if platform.startswith("aarch64") else X86_64
        needed, offered = dylib_symbols(library, kind)
        others = MACOS_ONLY
    assert offered - OF_THE_LOADER == FUNCTIONS[fmi]
    assert needed - C_LIBRARY - ALSO_IN_FMI_3 <= others


@needs_zig
@linux
def test_zig_builds_what_runs_here(monkeypatch, probe, tmp_path):
    monkeypatch.setattr(native_fmu.shutil, "which", lambda _: None)
    monkeypatch.delenv("CC", raising=False)
    with Host(build_component(probe, destination=tmp_path, runtime=Runtime.NATIVE)) as host:
        host.start(inflow=1.0).steps(3, 0.1)
        assert not host.messages


def newest_c_library(library):
    """The newest version of the C library that a library for Linux asks for."""
    asked = re.findall(rb"GLIBC_([0-9.]+)\0", library)
    return max(tuple(map(int, version.split(b"."))) for version in asked)


@needs_zig
@linux
def test_a_library_for_linux_runs_with_the_c_library_of_2012(monkeypatch, probe, tmp_path):
    monkeypatch.delenv("CC", raising=False)
    file = build_component(probe, destination=tmp_path, runtime=Runtime.NATIVE)
    with zipfile.ZipFile(file) as archive:
        library = archive.read("binaries/linux64/Probe.so")
    assert newest_c_library(library) <= (2, 17)


# ------------------------------------------------------------------ the shim


@pytest.mark.parametrize("shim", ["shim_fmi2.c", "shim_fmi3.c"])
def test_the_shim_compiles_without_a_warning(native_fmus, probe, tmp_path, shim):
    (tmp_path / "model.h").write_bytes(model_header(probe, probe.with_sizes(), "{0}", CPU))
    command = [
        *compiler("linux64"),
        "-std=gnu11",
        "-Wall",
        "-Wextra",
        "-Wno-unused-parameter",
        "-Werror",
        "-c",
        "-I",
        tmp_path,
        "-o",
        tmp_path / "shim.o",
        str(Path(native_fmu.__file__).with_name(shim)),
    ]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.stderr == ""
    assert done.returncode == 0


@linux
def test_a_processor_without_the_instructions_is_told_so(native_fmus, monkeypatch, probe, tmp_path):
    monkeypatch.setattr(
        native_fmu, "CPU", dataclasses.replace(CPU, leaf_1=CPU.leaf_1 | 1 << 16)
    )  # a reserved bit: set nowhere
    file = build_component(probe, destination=tmp_path, runtime=Runtime.NATIVE)
    with pytest.raises(Exception, match="Failed to instantiate"):
        Host(file, "tank")
    assert "tank (Probe): this processor lacks instructions of x86-64-v3" in Host.last.errors()[0]


# ------------------------------------------------------------------ files


BUILD = (
    "import hashlib, sys; from rockshed.fmus.build import Runtime, build\n"
    "print(hashlib.sha256(build(sys.argv[1], destination=sys.argv[2], runtime=Runtime.NATIVE).read_bytes()).hexdigest())"
)


def test_builds_are_equal_byte_for_byte_with_an_empty_cache_too(native_fmus, python, tmp_path):
    expected = hashlib.sha256(native_fmus["FallingRock"].read_bytes()).hexdigest()
    for settings in (
        {},
        {"ROCKSHED_CACHE_DIR": str(tmp_path / "cache"), "PYTHONHASHSEED": "1", "TZ": "Asia/Tokyo"},
    ):
        assert (
            python(BUILD, "FallingRock", tmp_path / f"dist{len(settings)}", **settings).strip()
            == expected
        )


def test_a_native_fmu_that_is_up_to_date_is_left_alone_and_any_other_is_replaced(
    native_fmus, tmp_path, monkeypatch
):
    rock = component("FallingRock")
    assert not native_is_fresh(rock, {}, tmp_path)
    file = build_if_needed("FallingRock", destination=tmp_path, runtime=Runtime.NATIVE)
    assert native_is_fresh(rock, {}, tmp_path)
    stamp = file.stat().st_mtime_ns
    assert (
        build_if_needed("FallingRock", destination=tmp_path, runtime=Runtime.NATIVE)
        .stat()
        .st_mtime_ns
        == stamp
    )
    with monkeypatch.context() as context:
        context.setattr(native_fmu, "CPU", dataclasses.replace(CPU, leaf_1=CPU.leaf_1 | 1))
        context.setattr(native_fmu, "_versions", lambda *packages: ["another numba"])
        assert not native_is_fresh(rock, {}, tmp_path)
    file.write_bytes(file.read_bytes()[:-100])
    assert not native_is_fresh(rock, {}, tmp_path)
    assert (
        build_if_needed("FallingRock", destination=tmp_path, runtime=Runtime.NATIVE).read_bytes()
        == native_fmus["FallingRock"].read_bytes()
    )


def test_the_files_of_both_runtimes_lie_apart(native_fmus, monkeypatch, tmp_path):
    monkeypatch.setenv("ROCKSHED_FMU_DIR", str(tmp_path))
    files = [build_if_needed("FallingRock", runtime=runtime) for runtime in Runtime]
    files.append(build_if_needed("FallingRock", runtime=Runtime.NATIVE, fmi=Fmi.THREE))
    assert files == [
        tmp_path / f"{folder}/FallingRock.fmu" for folder in ("python", "native", "native-fmi3")
    ]
    assert native_is_fresh(component("FallingRock"), {}, fmi=Fmi.THREE)
    assert not native_is_fresh(component("FallingRock"), {}, files[1].parent, Fmi.THREE)


def test_fmi_3_with_python_inside_is_refused(tmp_path):
    with pytest.raises(
        BuildError, match=r"FallingRock: FMUs with Python inside are for FMI 2.0 only"
    ):
        build_component(component("FallingRock"), destination=tmp_path, fmi=Fmi.THREE)
    assert list(tmp_path.iterdir()) == []


def test_both_versions_have_the_same_object_code(native_fmus, fmi3_fmus, monkeypatch):
    def compile_anew(*_):
        raise AssertionError("the kernels are compiled again")

    monkeypatch.setattr(native_fmu, "_compile", compile_anew)
    for fmi, fmus in ((Fmi.TWO, native_fmus), (Fmi.THREE, fmi3_fmus)):
        files = native_files(component("FallingRock"), {}, fmi=fmi)
        with zipfile.ZipFile(fmus["FallingRock"]) as archive:
            assert {name: archive.read(name) for name in archive.namelist()} == files


# ------------------------------------------------------------------ compilers that are missing or fail


def test_without_a_compiler_the_way_out_is_named(monkeypatch, tmp_path):
    monkeypatch.setattr(native_fmu.shutil, "which", lambda _: None)
    monkeypatch.setattr(native_fmu, "find_spec", lambda _: None)
    monkeypatch.delenv("CC", raising=False)
    with pytest.raises(
        BuildError, match=r"no compiler for \w+ was found .*pip install ziglang.*runtime=\"python\""
    ):
        build_component(component("FallingRock"), destination=tmp_path, runtime=Runtime.NATIVE)
    assert not list(tmp_path.iterdir())


def test_other_platforms_need_zig(monkeypatch):
    monkeypatch.setattr(native_fmu, "find_spec", lambda _: None)
    with pytest.raises(
        BuildError, match=r"no compiler for win64 was found \(Python package ziglang\)"
    ):
        native_files(component("FallingRock"), {}, ("win64",))


def test_a_processor_of_another_kind_is_refused(monkeypatch):
    riscv = Platform("riscv64-linux", "riscv64-linux")
    monkeypatch.setattr(native_fmu, "this_machine", lambda: riscv)
    with pytest.raises(BuildError, match=r"made for x86-64 processors.*this is riscv64-linux"):
        native_files(component("FallingRock"), {})


@linux
def test_a_compiler_that_fails_shows_its_message_and_leaves_the_old_file(
    native_fmus, monkeypatch, tmp_path
):
    file = shutil.copy(native_fmus["FallingRock"], tmp_path)
    before = native_fmus["FallingRock"].read_bytes()
    monkeypatch.setenv("CC", "cc -include nothing.h")
    with pytest.raises(
        BuildError,
        match=r"(?s)FallingRock: the compiler failed for linux64.*nothing.h: No such file",
    ):
        build_component(component("FallingRock"), destination=tmp_path, runtime=Runtime.NATIVE)
    monkeypatch.setenv("CC", str(tmp_path / "no such compiler").replace(" ", "_"))
    with pytest.raises(BuildError, match=r"no_such_compiler cannot be run: No such file"):
        build_component(component("FallingRock"), destination=tmp_path, runtime=Runtime.NATIVE)
    assert os.listdir(tmp_path) == ["FallingRock.fmu"]
    assert Path(file).read_bytes() == before


SLOW_COMPILER = """#!/bin/sh
exec sleep 60
"""
BUILD_BY_THE_FACE = (
    "import sys, rockshed; rockshed.build_fmu('FallingRock', folder=sys.argv[1], runtime='native')"
)


@linux
@pytest.mark.parametrize("what", ["the C compiler", "the compiler of the kernels"])
def test_a_compiler_ends_with_the_build_that_is_killed(native_fmus, tmp_path, what):
    settings = {"ROCKSHED_CACHE_DIR": str(tmp_path / "cache"), "TMPDIR": str(tmp_path)}
    if what == "the C compiler":
        assert native_fmus["FallingRock"]  # its kernels are kept
        (tmp_path / "cc").write_text(SLOW_COMPILER)
        (tmp_path / "cc").chmod(0o755)
        settings = {"CC": str(tmp_path / "cc"), "TMPDIR": str(tmp_path)}
    building = psutil.Popen(
        [sys.executable, "-c", BUILD_BY_THE_FACE, tmp_path / "dist"], env=os.environ | settings
    )
    deadline = time.monotonic() + 60.0
    while not (children := building.children()) and time.monotonic() < deadline:
        time.sleep(0.05)
    building.kill()
    building.wait()
    assert children
    _, living = psutil.wait_procs(children, timeout=10)
    for child in living:
        child.kill()
    assert not living


# ------------------------------------------------------------------ kernels that need more than the C library


BAD_KERNELS = {
    "a product of arrays": ("import numpy as np", "    w[V.flow] = np.dot(w, w)", "numba_xxdot"),
    "an allocation": (
        "import numpy as np",
        "    w[V.flow] = np.zeros(int(w[V.limit]))[0]",
        "No implementation of function",
    ),
}


@pytest.mark.parametrize("what", BAD_KERNELS)
def test_a_kernel_that_needs_python_is_refused_with_its_line(
    native_fmus, no_cache, probe, tmp_path, what
):
    head, line, symbol = BAD_KERNELS[what]
    folder = tmp_path / "bad_probe"
    shutil.copytree(probe.folder, folder, ignore=shutil.ignore_patterns("__pycache__"))
    source = (folder / "kernel.py").read_text()
    begin, end = source.split("@kernel\ndef step(t, h, w, x, k):\n")
    text = f"{head}\n{begin}@kernel\ndef step(t, h, w, x, k):\n{line}\n{end}".replace(
        '"""\n\nfrom', '"""\nfrom', 1
    )
    (folder / "kernel.py").write_text(text)
    number = text.splitlines().index(line) + 1
    with pytest.raises(BuildError) as refusal:
        build_component(
            dataclasses.replace(probe, folder=folder),
            destination=tmp_path / "dist",
            runtime=Runtime.NATIVE,
        )
    message = str(refusal.value)
    assert re.match(r"Probe: its kernels need more than the C library", message)
    assert symbol in message
    assert f"{folder / 'kernel.py'}, line {number}, in step (" in message
    assert 'runtime="python"' in message
    assert not (tmp_path / "dist").exists()


def test_another_size_has_a_name_of_its_own(native_fmus, probe, tmp_path):
    file = build_component(probe, {"tanks": 5}, tmp_path, runtime=Runtime.NATIVE)
    assert file.name == file_name(probe, {"tanks": 5}) == "Probe-tanks5.fmu"
    with Host(file) as host:
        host.start(inflow=1.0).steps(2, 0.1)
        assert host["tanks"] == 5
        assert host["level[5]"] > host["level[1]"]
