"""Platforms of FMUs: their names in both versions of FMI, and which binary a machine can load.

FMI 2.0.5 has names of its own for x86 processors, and takes the platform tuples of FMI 3.0 (its
section 2.5.1.4.1) for all others. On ARM, tools that know only the former put their code into the
folder of x86-64 (OpenModelica) and look for it there (fmpy 0.3.32): such a binary is taken if the
processor in its header is this machine's.
"""

import platform as machine
import struct
import sys
from collections.abc import Callable, Collection
from dataclasses import dataclass

LONGEST_HEAD = 4096
"""Bytes of a library in which its processor stands."""
_SAME_PROCESSOR = {
    "amd64": "x86_64",
    "arm64": "aarch64",
    "i386": "x86",
    "i686": "x86",
    "x86pc": "x86",
}
_SUFFIXES = {"linux": ".so", "windows": ".dll", "darwin": ".dylib"}


@dataclass(frozen=True)
class Platform:
    """A platform.

    Parameters
    ----------
    in_fmi3 : str
        Its platform tuple, which is its name in FMI 3.0.
    in_fmi2 : str
        Its name in FMI 2.0.
    customary : str
        Name under which older tools look for it in FMI 2.0, and put it; empty if there is none.
    """

    in_fmi3: str
    in_fmi2: str
    customary: str = ""

    @property
    def suffix(self) -> str:
        """End of the file names of its libraries, with its dot."""
        return _SUFFIXES.get(self.in_fmi3.rpartition("-")[2], ".so")

    def folders(self, fmi: int) -> tuple[str, ...]:
        """Return the folders of ``binaries`` in which its libraries are, the best one first.

        Parameters
        ----------
        fmi : int
            Version of FMI, 2 or 3.
        """
        if fmi != 2:
            return (self.in_fmi3,)
        return tuple(filter(None, (self.in_fmi2, self.customary)))

    def library(self, identifier: str, fmi: int) -> str:
        """Return the path of its library inside an FMU.

        Parameters
        ----------
        identifier : str
            Model identifier.
        fmi : int
            Version of FMI.
        """
        return f"binaries/{self.folders(fmi)[0]}/{identifier}{self.suffix}"


PLATFORMS = {
    each.in_fmi3: each
    for each in (
        Platform("x86_64-linux", "linux64"),
        Platform("x86_64-windows", "win64"),
        Platform("x86_64-darwin", "darwin64"),
        Platform("aarch64-linux", "aarch64-linux", "linux64"),
        Platform("aarch64-windows", "aarch64-windows", "win64"),
        Platform("aarch64-darwin", "aarch64-darwin", "darwin64"),
        Platform("x86-linux", "linux32"),
        Platform("x86-windows", "win32"),
    )
}
"""Known platforms by their platform tuples."""


def this_machine() -> Platform:
    """Return the platform of this process."""
    processor = machine.machine().lower()
    processor = _SAME_PROCESSOR.get(processor, processor)
    if processor == "x86_64" and sys.maxsize < 2**32:
        processor = "x86"
    name = f"{processor}-{machine.system().lower()}"
    return PLATFORMS.get(name, Platform(name, name))


class NoBinaryError(Exception):
    """An FMU has no binary for a machine.

    Attributes
    ----------
    remedy : str
        Something to do about it.
    """

    def __init__(self, what: str, remedy: str) -> None:
        self.remedy = remedy
        super().__init__(what)


def binary(identifier: str, fmi: int, names: Collection[str], head: Callable[[str], bytes]) -> str:
    """Return the path of the library in an FMU that this machine can load.

    Parameters
    ----------
    identifier : str
        Model identifier of the FMU.
    fmi : int
        Its version of FMI, 2 or 3.
    names : collection of str
        All files in it.
    head : callable
        Returns the first bytes of one of them, :data:`LONGEST_HEAD` at most.

    Raises
    ------
    NoBinaryError
        There is none; which ones there are.
    """
    here = this_machine()
    remarks = {}
    for folder in here.folders(fmi):
        path = f"binaries/{folder}/{identifier}{here.suffix}"
        if path not in names:
            remarks[folder] = f" (without {identifier}{here.suffix})"
            continue
        made_for = platforms_of(head(path))
        if not made_for or here.in_fmi3 in made_for:
            return path
        remarks[folder] = f" (code for {', '.join(sorted(made_for))})"
    listed = ", ".join(f"{name}{remarks.get(name, '')}" for name in platforms_in(names)) or "none"
    wanted = here.folders(fmi)[0]
    raise NoBinaryError(
        f"has no binary for this machine ({wanted}); it has {listed}",
        f"export it for {wanted}, as {here.library(identifier, fmi)}",
    )


def platforms_in(names: Collection[str]) -> list[str]:
    """Return the names of the platforms for which an FMU has files.

    Parameters
    ----------
    names : collection of str
        All files in it.

    Examples
    --------
    >>> platforms_in({"modelDescription.xml", "binaries/win64/Other.dll"})
    ['win64']
    """
    parts = [name.split("/") for name in names if name.startswith("binaries/")]
    return sorted({part[1] for part in parts if len(part) > 2 and part[-1]})


# --- headers of libraries

_PROCESSORS_ELF = {62: "x86_64", 183: "aarch64", 3: "x86"}
"""By e_machine of ELF."""
_PROCESSORS_PE = {0x8664: "x86_64", 0xAA64: "aarch64", 0x14C: "x86"}
"""By Machine of the COFF header of PE."""
_PROCESSORS_MACHO = {0x01000007: "x86_64", 0x0100000C: "aarch64", 7: "x86"}
"""By cputype of Mach-O."""
_MOST_ARCHITECTURES = 30
"""Processors of a universal binary that are looked at; a class file of Java begins as one does."""


def platforms_of(head: bytes) -> frozenset[str]:
    r"""Return the platform tuples that a library is made for; empty if they cannot be told.

    Parameters
    ----------
    head : bytes
        Its first bytes.

    Examples
    --------
    >>> sorted(platforms_of(b"\x7fELF\x02\x01" + bytes(12) + b"\xb7\x00"))
    ['aarch64-linux']
    """
    for system, codes, known in (
        ("linux", _elf(head), _PROCESSORS_ELF),
        ("windows", _pe(head), _PROCESSORS_PE),
        ("darwin", _mach_o(head), _PROCESSORS_MACHO),
    ):
        if codes:
            return frozenset(
                f"{known.get(code, f'processor {code:#x}')}-{system}" for code in codes
            )
    return frozenset()


def _elf(head: bytes) -> list[int]:
    if head[:4] != b"\x7fELF" or len(head) < 20:
        return []
    return [int.from_bytes(head[18:20], "big" if head[5] == 2 else "little")]


def _pe(head: bytes) -> list[int]:
    if head[:2] != b"MZ" or len(head) < 64:
        return []
    (at,) = struct.unpack_from("<I", head, 60)
    is_whole = head[at : at + 4] == b"PE\0\0" and len(head) >= at + 6
    return [struct.unpack_from("<H", head, at + 4)[0]] if is_whole else []


def _mach_o(head: bytes) -> list[int]:
    if len(head) < 8:
        return []
    magic, second = struct.unpack_from(">II", head)
    if magic in (0xCFFAEDFE, 0xCEFAEDFE):  # of one processor, little-endian
        return [struct.unpack_from("<I", head, 4)[0]]
    size = {0xCAFEBABE: 20, 0xCAFEBABF: 32}.get(magic)
    if size is None or second > _MOST_ARCHITECTURES or len(head) < 8 + second * size:
        return []
    return [struct.unpack_from(">I", head, 8 + place * size)[0] for place in range(second)]
