"""Build FMUs: frozen sources, pythonfmu's binaries, model description and documentation in one file.

The sources go in under names that contain a hash of their content, so that FMUs which share a Python interpreter cannot confuse
their modules (see :mod:`fmus.isolation`). The same content gives the same file, byte for byte.
"""

import hashlib
import io
import os
import re
import tempfile
import uuid
import zipfile
from collections.abc import Iterator, Mapping
from importlib.metadata import distribution
from pathlib import Path

import pythonfmu
from filelock import FileLock

import components
from components.catalogue import component as catalogued
from components.component import Component

from .description import model_description
from .documentation import index_html
from .script import SCRIPT

FOLDER_VARIABLE = "ROCKSHED_FMU_DIR"
"""Environment variable that moves the folder of built FMUs, by default ``fmus/dist``."""

_HERE = Path(__file__).parent
_COMPONENTS = Path(components.__file__).parent
_PYTHONFMU = Path(pythonfmu.__file__).parent
_PYTHONFMU_PARTS = ("_version.py", "default_experiment.py", "enums.py", "fmi2slave.py", "logmsg.py", "variables.py")
_SLAVE_PARTS = ("foundations.py", "interpreter.py", "isolation.py", "python_fmu.py")
_NOT_FROZEN = {".md", ".png", ".svg", ".pyc"}

Files = dict[str, bytes]
"""Content of files by their path, which has forward slashes."""


class BuildError(Exception):
    """An FMU cannot be built or stored; the message says why and what to do."""


def build(name: str, sizes: Mapping[str, int] | None = None, destination: Path | None = None) -> Path:
    """Build the FMU of a component of the catalogue; return its file.

    sizes: numbers that differ from the defaults, ``{"elements": 48}``; they then are part of the file's name.
    destination: folder, by default that of :func:`fmu_folder`.

    Raises:
        KeyError: no component has this name.
        ComponentError: a size that the component has not, or that is out of range.
        BuildError: the folder cannot be written.
    """
    return build_component(catalogued(name), sizes, destination)


def build_if_needed(name: str, sizes: Mapping[str, int] | None = None, destination: Path | None = None) -> Path:
    """Like :func:`build`, but leave a file alone that is what would be built."""
    return build_component(catalogued(name), sizes, destination, keep=True)


def build_component(component: Component, sizes: Mapping[str, int] | None = None, destination: Path | None = None,
                    keep: bool = False) -> Path:
    """Build the FMU of any component; ``keep`` leaves a file alone that is what would be built."""
    chosen = component.with_sizes(sizes)
    content = _archive(fmu_files(component, chosen))
    file = (fmu_folder() if destination is None else Path(destination)) / file_name(component, chosen)
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        with FileLock(file.parent / ".lock"):
            if not (keep and file.is_file() and file.read_bytes() == content):
                _replace(file, content)
    except OSError as error:
        remedy = (f"name a folder that can be written in the environment variable {FOLDER_VARIABLE}" if destination is None
                  else "name another folder")
        raise BuildError(f"{component.name}: cannot write {file}: {error.strerror or error}; {remedy}") from error
    return file


def fmu_folder() -> Path:
    """Folder of built FMUs."""
    return Path(os.environ.get(FOLDER_VARIABLE) or _HERE / "dist")


def file_name(component: Component, sizes: Mapping[str, int]) -> str:
    """``Name.fmu`` with default sizes, otherwise all sizes are named: ``SandCushion-discs360-elements24.fmu``."""
    suffix = "" if dict(sizes) == component.with_sizes() else "".join(f"-{name}{value}" for name, value in sizes.items())
    return f"{component.name}{suffix}.fmu"


def fmu_files(component: Component, sizes: Mapping[str, int]) -> Files:
    """Everything that goes into an FMU. Its GUID and the name of its script are a hash over all the rest."""
    library = _library_files(component)
    library_name = f"rockshed_{_digest(library)[:16]}_lib"
    files = {f"resources/{library_name}/{path}": content for path, content in library.items()}
    files |= dict(_binaries(component))
    files["documentation/index.html"] = index_html(component, sizes).encode()
    files["documentation/licenses/pythonfmu.txt"] = _pythonfmu_license()
    icon = component.folder / "icon.png"
    if icon.is_file():
        files["model.png"] = icon.read_bytes()
    digest = _digest(files | _stamped_files(component, sizes, library_name, "0" * 64))
    return files | _stamped_files(component, sizes, library_name, digest)


def _stamped_files(component: Component, sizes: Mapping[str, int], library: str, digest: str) -> Files:
    module = f"rockshed_{digest[:16]}"
    script = SCRIPT.substitute(
        name=component.name, library=library, package=component.folder.name, sizes=repr(dict(sizes)))
    return {
        "modelDescription.xml": model_description(component, sizes, f"{{{uuid.UUID(digest[:32])}}}"),
        "resources/slavemodule.txt": module.encode(),
        f"resources/{module}.py": script.encode(),
    }


def _library_files(component: Component) -> Files:
    """The package that runs inside the FMU: slave, component with what the components share, and parts of pythonfmu."""
    paths = {f"components/{path.name}": path for path in _COMPONENTS.glob("*.py") if path.name != "catalogue.py"}
    paths |= {f"components/{path.relative_to(component.folder.parent).as_posix()}": path
              for path in component.folder.rglob("*") if path.is_file() and path.suffix not in _NOT_FROZEN}
    paths |= {f"pythonfmu/{name}": _PYTHONFMU / name for name in _PYTHONFMU_PARTS}
    paths |= {name: _HERE / name for name in _SLAVE_PARTS}
    files = {name: path.read_bytes() for name, path in paths.items()}
    files["foundations.py"] = re.sub(rb"^from (components|pythonfmu)\.", rb"from .\1.", files["foundations.py"], flags=re.MULTILINE)
    return files | {"__init__.py": b"", "pythonfmu/__init__.py": b""}


def _binaries(component: Component) -> Iterator[tuple[str, bytes]]:
    for path in sorted((_PYTHONFMU / "resources" / "binaries").glob("*/*")):
        yield f"binaries/{path.parent.name}/{component.name}{path.suffix}", path.read_bytes()


def _pythonfmu_license() -> bytes:
    """Its text has to accompany every copy."""
    texts = [file.read_binary() for file in distribution("pythonfmu").files or () if file.name == "LICENSE"]
    return b"\n".join(texts)


def _digest(files: Files) -> str:
    digest = hashlib.sha256()
    for path, content in sorted(files.items()):
        digest.update(f"{path}\0{len(content)}\0".encode() + content)
    return digest.hexdigest()


def _archive(files: Files) -> bytes:
    """A zip archive that depends on nothing but the files: fixed order, dates and permissions.

    Nothing is compressed, because the result would depend on the version of zlib.
    """
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_STORED) as archive:
        for path in sorted(files):
            entry = zipfile.ZipInfo(path)
            entry.create_system = 3  # Unix, also when built on Windows
            entry.external_attr = 0o100644 << 16
            archive.writestr(entry, files[path])
    return buffer.getvalue()


def _replace(file: Path, content: bytes) -> None:
    """Write a file as a whole or not at all."""
    handle, temporary = tempfile.mkstemp(prefix=f".{file.name}.", dir=file.parent)
    try:
        with os.fdopen(handle, "wb") as stream:
            stream.write(content)
        os.chmod(temporary, 0o644)
        os.replace(temporary, file)
    except BaseException:
        Path(temporary).unlink(missing_ok=True)
        raise
