"""Which library of an FMU a machine loads, and what is said where there is none."""

import struct

import pytest

from rockshed import platforms
from rockshed.platforms import PLATFORMS, NoBinaryError, Platform, binary, platforms_of

ELF_X86_64 = b"\x7fELF\x02\x01" + bytes(12) + struct.pack("<H", 62)
ELF_ARM = b"\x7fELF\x02\x01" + bytes(12) + struct.pack("<H", 183)
MACH_O_ARM = struct.pack("<II", 0xFEEDFACF, 0x0100000C)
MACH_O_X86_64 = struct.pack("<II", 0xFEEDFACF, 0x01000007)
UNIVERSAL = struct.pack(">II", 0xCAFEBABE, 2) + b"".join(
    struct.pack(">IIIII", kind, 0, 0, 0, 0) for kind in (0x01000007, 0x0100000C)
)


def dll(machine):
    return (
        b"MZ"
        + bytes(58)
        + struct.pack("<I", 128)
        + bytes(64)
        + b"PE\0\0"
        + struct.pack("<H", machine)
    )


@pytest.fixture
def on(monkeypatch):
    """Make this machine another one."""

    def become(name):
        monkeypatch.setattr(
            platforms, "this_machine", lambda: PLATFORMS.get(name, Platform(name, name))
        )

    return become


def taken(fmi, **files):
    """The library that is taken of an FMU with these, by folder; "x" is the model identifier."""
    paths = {
        f"binaries/{folder.replace('__', '-')}/x.{suffix}": content
        for name, content in files.items()
        for folder, _, suffix in [name.rpartition("_")]
    }
    return binary("x", fmi, paths, lambda path: paths[path])


@pytest.mark.parametrize(
    ("content", "made_for"),
    [
        (ELF_X86_64, {"x86_64-linux"}),
        (ELF_ARM, {"aarch64-linux"}),
        (b"\x7fELF\x02\x02" + bytes(12) + struct.pack(">H", 183), {"aarch64-linux"}),
        (b"\x7fELF\x02\x01" + bytes(12) + struct.pack("<H", 243), {"processor 0xf3-linux"}),
        (dll(0x8664), {"x86_64-windows"}),
        (dll(0xAA64), {"aarch64-windows"}),
        (MACH_O_ARM, {"aarch64-darwin"}),
        (MACH_O_X86_64, {"x86_64-darwin"}),
        (UNIVERSAL, {"x86_64-darwin", "aarch64-darwin"}),
        (b"", set()),
        (b"\x7fELF", set()),
        (b"MZ" + bytes(58) + struct.pack("<I", 1 << 31), set()),
        (b"\xca\xfe\xba\xbe\x00\x00\x00\x34", set()),  # a class file of Java
        (UNIVERSAL[:30], set()),
        (b"#!/bin/sh\n", set()),
    ],
)
def test_the_platform_of_a_library_stands_in_its_header(content, made_for):
    assert platforms_of(content) == made_for


@pytest.mark.parametrize(
    ("machine", "fmi", "files", "path"),
    [
        ("x86_64-linux", 2, {"linux64_so": ELF_X86_64}, "linux64/x.so"),
        ("x86_64-linux", 3, {"x86_64__linux_so": ELF_X86_64}, "x86_64-linux/x.so"),
        ("x86_64-windows", 2, {"win64_dll": dll(0x8664)}, "win64/x.dll"),
        ("aarch64-linux", 2, {"linux64_so": ELF_X86_64, "aarch64__linux_so": ELF_ARM}, "aarch64-linux/x.so"),
        ("aarch64-linux", 2, {"linux64_so": ELF_ARM}, "linux64/x.so"),
        ("aarch64-darwin", 2, {"darwin64_dylib": UNIVERSAL}, "darwin64/x.dylib"),
        ("x86_64-darwin", 2, {"darwin64_dylib": UNIVERSAL}, "darwin64/x.dylib"),
        ("aarch64-darwin", 3, {"aarch64__darwin_dylib": MACH_O_ARM}, "aarch64-darwin/x.dylib"),
        ("x86_64-linux", 2, {"linux64_so": b"not a library"}, "linux64/x.so"),  # the loader says why
    ],
)  # fmt: skip
def test_each_machine_takes_the_library_of_its_processor(on, machine, fmi, files, path):
    on(machine)
    assert taken(fmi, **files) == f"binaries/{path}"


@pytest.mark.parametrize(
    ("machine", "fmi", "files", "said"),
    [
        ("aarch64-linux", 2, {"linux64_so": ELF_X86_64, "win64_dll": dll(0x8664)},
         "has no binary for this machine (aarch64-linux); it has linux64 (code for x86_64-linux), win64"),
        ("x86_64-linux", 2, {"linux64_so": ELF_ARM},
         "has no binary for this machine (linux64); it has linux64 (code for aarch64-linux)"),
        ("aarch64-darwin", 2, {"darwin64_dylib": MACH_O_X86_64},
         "has no binary for this machine (aarch64-darwin); it has darwin64 (code for x86_64-darwin)"),
        ("aarch64-linux", 3, {"x86_64__linux_so": ELF_ARM},
         "has no binary for this machine (aarch64-linux); it has x86_64-linux"),
        ("x86_64-linux", 2, {"linux64_dll": dll(0x8664)},
         "has no binary for this machine (linux64); it has linux64 (without x.so)"),
        ("riscv64-linux", 3, {"x86_64__linux_so": ELF_X86_64},
         "has no binary for this machine (riscv64-linux); it has x86_64-linux"),
        ("x86_64-linux", 2, {}, "has no binary for this machine (linux64); it has none"),
    ],
)  # fmt: skip
def test_a_machine_without_a_binary_is_told_which_ones_there_are(on, machine, fmi, files, said):
    on(machine)
    with pytest.raises(NoBinaryError) as refusal:
        taken(fmi, **files)
    assert str(refusal.value) == said
    assert refusal.value.remedy.startswith("export it for ")


@pytest.mark.parametrize(
    ("processor", "system", "bits", "name"),
    [
        ("x86_64", "Linux", 64, "x86_64-linux"),
        ("AMD64", "Windows", 64, "x86_64-windows"),
        ("AMD64", "Windows", 32, "x86-windows"),
        ("ARM64", "Windows", 64, "aarch64-windows"),
        ("arm64", "Darwin", 64, "aarch64-darwin"),
        ("aarch64", "Linux", 64, "aarch64-linux"),
        ("riscv64", "Linux", 64, "riscv64-linux"),
    ],
)
def test_this_machine_is_known_by_its_platform_tuple(monkeypatch, processor, system, bits, name):
    monkeypatch.setattr(platforms.machine, "machine", lambda: processor)
    monkeypatch.setattr(platforms.machine, "system", lambda: system)
    monkeypatch.setattr(platforms.sys, "maxsize", 2 ** (bits - 1) - 1)
    assert platforms.this_machine().in_fmi3 == name
