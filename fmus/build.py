"""Build FMUs.

Those with Python hold frozen sources, pythonfmu's binaries, model description and documentation.
The sources go in under names that contain a hash of their content, so that FMUs which share a
Python interpreter cannot confuse their modules (see :mod:`rockshed.fmus.python.isolation`). The
same content gives the same file, byte for byte. Native ones: :mod:`rockshed.fmus.native.fmu`.
"""

import uuid
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path

import pythonfmu
from filelock import FileLock

from rockshed.components.catalogue import component as catalogued
from rockshed.components.common.component import Component
from rockshed.components.common.kept import folder_problem, make_private
from rockshed.files import write_file
from rockshed.platforms import LONGEST_HEAD, platforms_of, this_machine

from .description.documentation import documentation
from .description.fmi2 import model_description
from .description.legal import license_files, license_text, needed_by_python
from .experiments.files import experiment_files
from .ls_wasm import PLATFORM as WASM
from .native.fmu import files_of_one_stamp, library_files, native_files
from .parts import (
    DESCRIPTION,
    BuildError,
    Files,
    Fmi,
    Runtime,
    archive,
    component_sources,
    digest,
    picture,
)
from .places import FOLDER_VARIABLE, file_name, fmu_file, fmu_folder, folder_name, native_is_fresh
from .python.freezing import foreign_imports, with_imports_moved
from .python.script import SCRIPT

__all__ = [
    "FOLDER_VARIABLE",
    "BuildError",
    "Fmi",
    "Runtime",
    "build",
    "build_component",
    "build_if_needed",
    "file_name",
    "fmu_content",
    "fmu_files",
    "fmu_folder",
    "folder_name",
    "native_is_fresh",
    "runs_with_python_here",
    "store",
]

ONLY_NATIVE = (
    "FMUs with Python inside are for FMI 2.0 only, as pythonfmu makes them; for FMI 3.0 there are "
    "native ones"
)
ONLY_FMI3 = "a component for WebAssembly is for FMI 3.0, as FMI-LS-WASM has it"

_HERE = Path(__file__).parent
_PYTHONFMU = Path(pythonfmu.__file__).parent
_PYTHONFMU_PARTS = (
    "_version.py",
    "default_experiment.py",
    "enums.py",
    "fmi2slave.py",
    "logmsg.py",
    "variables.py",
)
_SLAVE_PARTS = ("conduct.py", "foundations.py", "interpreter.py", "isolation.py", "slave.py")


def build(
    name: str,
    sizes: Mapping[str, int] | None = None,
    destination: Path | None = None,
    runtime: Runtime = Runtime.PYTHON,
    fmi: Fmi = Fmi.TWO,
) -> Path:
    """Build the FMU of a component of the catalogue.

    Parameters
    ----------
    name : str
        Name of the component.
    sizes : mapping of str to int, optional
        Numbers that differ from the defaults, ``{"elements": 48}``; they then are part of the
        file's name.
    destination : Path, optional
        Folder; by default that of :func:`fmu_folder`.
    runtime : Runtime
        With Python or native.
    fmi : Fmi
        Version of FMI.

    Returns
    -------
    Path
        Its file.

    Raises
    ------
    KeyError
        No component has this name.
    ComponentError
        A size that the component has not, or that is out of range.
    BuildError
        The folder cannot be written, or a native FMU cannot be compiled.
    """
    return build_component(catalogued(name), sizes, destination, runtime=runtime, fmi=fmi)


def build_if_needed(
    name: str,
    sizes: Mapping[str, int] | None = None,
    destination: Path | None = None,
    runtime: Runtime = Runtime.PYTHON,
    fmi: Fmi = Fmi.TWO,
) -> Path:
    """Build as :func:`build` does, but leave a file alone that is what would be built.

    Parameters, result and errors are those of :func:`build`.
    """
    return build_component(
        catalogued(name), sizes, destination, keep=True, runtime=runtime, fmi=fmi
    )


def build_component(
    component: Component,
    sizes: Mapping[str, int] | None = None,
    destination: Path | None = None,
    keep: bool = False,
    runtime: Runtime = Runtime.PYTHON,
    fmi: Fmi = Fmi.TWO,
) -> Path:
    """Build the FMU of any component.

    Parameters
    ----------
    component : Component
        The component.
    sizes : mapping of str to int, optional
        Numbers that differ from the defaults.
    destination : Path, optional
        Folder; by default that of :func:`fmu_folder`.
    keep : bool
        Whether to leave a file alone that is what would be built.
    runtime : Runtime
        With Python or native.
    fmi : Fmi
        Version of FMI.

    Returns
    -------
    Path
        Its file.

    Raises
    ------
    ComponentError
        A size that the component has not, or that is out of range.
    BuildError
        The folder cannot be written, or a native FMU cannot be compiled.
    """
    chosen = component.with_sizes(sizes)
    if keep and runtime is Runtime.NATIVE and native_is_fresh(component, chosen, destination, fmi):
        return fmu_file(component, chosen, runtime, destination, fmi)
    return store(
        component,
        chosen,
        fmu_content(component, chosen, runtime, fmi=fmi),
        destination,
        runtime,
        keep,
        fmi,
    )


def fmu_content(
    component: Component,
    sizes: Mapping[str, int],
    runtime: Runtime = Runtime.PYTHON,
    platforms: Sequence[str] = (),
    fmi: Fmi = Fmi.TWO,
) -> bytes:
    """Return the FMU as bytes.

    Parameters
    ----------
    component : Component
        The component.
    sizes : mapping of str to int
        All its sizes.
    runtime : Runtime
        With Python or native.
    platforms : sequence of str
        Of a native one; by default this machine's. ``wasm`` is a component for WebAssembly, beside
        those of other platforms that are named, or alone.
    fmi : Fmi
        Version of FMI.

    Returns
    -------
    bytes
        Content of the file.

    Raises
    ------
    BuildError
        A native FMU cannot be compiled, or FMI 3 is asked for with Python, or WebAssembly with
        FMI 2.
    """
    if runtime is Runtime.NATIVE:
        return archive(_native_files(component, sizes, platforms, fmi))
    if fmi is not Fmi.TWO:
        raise BuildError(f"{component.name}: {ONLY_NATIVE}")
    return archive(fmu_files(component, sizes))


def _native_files(
    component: Component, sizes: Mapping[str, int], platforms: Sequence[str], fmi: Fmi
) -> Files:
    """Return the files of a native FMU, with a component for WebAssembly if it is asked for."""
    if WASM not in platforms:
        return native_files(component, sizes, platforms, fmi)
    from .ls_wasm.binary import component_files

    if fmi is not Fmi.THREE:
        raise BuildError(f"{component.name}: {ONLY_FMI3}")
    parts = [partial(component_files, component, sizes)]
    if others := [name for name in platforms if name != WASM]:
        parts.append(partial(library_files, component, sizes, others, fmi=fmi))
    return files_of_one_stamp(component, sizes, parts, fmi)


def store(
    component: Component,
    sizes: Mapping[str, int],
    content: bytes,
    destination: Path | None = None,
    runtime: Runtime = Runtime.PYTHON,
    keep: bool = False,
    fmi: Fmi = Fmi.TWO,
) -> Path:
    """Write an FMU to its place, as a whole or not at all.

    Parameters
    ----------
    component : Component
        The component.
    sizes : mapping of str to int
        All its sizes.
    content : bytes
        Content of the file.
    destination : Path, optional
        Folder; by default that of :func:`fmu_folder`.
    runtime : Runtime
        With Python or native.
    keep : bool
        Whether to leave a file alone that has this content.
    fmi : Fmi
        Version of FMI.

    Returns
    -------
    Path
        Its file.

    Raises
    ------
    BuildError
        The folder cannot be written, or by default, others can write there too.
    """
    file = fmu_file(component, sizes, runtime, destination, fmi)
    try:
        if destination is None:
            _make_own(component, file.parent)
        file.parent.mkdir(parents=True, exist_ok=True)
        with FileLock(file.parent / ".lock"):
            if not (keep and file.is_file() and file.read_bytes() == content):
                write_file(file, content)
    except OSError as error:
        remedy = (
            f"name a folder that can be written in the environment variable {FOLDER_VARIABLE}"
            if destination is None
            else "name another folder"
        )
        raise BuildError(
            f"{component.name}: cannot write {file}: {error.strerror or error}; {remedy}"
        ) from error
    return file


def _make_own(component: Component, folder: Path) -> None:
    """Make a folder for FMUs that are run later; refuse one in which others can write."""
    make_private(folder)
    if problem := folder_problem(folder):
        remedy = f"set {FOLDER_VARIABLE} to a folder that you alone can write"
        raise BuildError(f"{component.name}: built FMUs are run, and {problem}: {remedy}")


def fmu_files(component: Component, sizes: Mapping[str, int]) -> Files:
    """Return everything that goes into an FMU with Python.

    Its GUID and the name of its script are a hash over all the rest.

    Parameters
    ----------
    component : Component
        The component.
    sizes : mapping of str to int
        All its sizes.

    Returns
    -------
    dict of str to bytes
        Files by their path in the FMU.

    Raises
    ------
    BuildError
        A source imports what an FMU does not hold.
    """
    library = _library_files(component)
    library_name = f"rockshed_{digest(library)[:16]}_lib"
    files = {f"resources/{library_name}/{path}": content for path, content in library.items()}
    files |= (
        dict(_binaries(component))
        | documentation(component, sizes, experiment_files(component, sizes))
        | picture(component, "model.png")
    )
    files |= license_files() | needed_by_python()
    files["documentation/licenses/pythonfmu.txt"] = license_text("pythonfmu")
    stamp = digest(files | _stamped_files(component, sizes, library_name, "0" * 64))
    return files | _stamped_files(component, sizes, library_name, stamp)


def _stamped_files(
    component: Component, sizes: Mapping[str, int], library: str, stamp: str
) -> Files:
    module = f"rockshed_{stamp[:16]}"
    script = SCRIPT.substitute(
        name=component.name, library=library, package=component.folder.name, sizes=repr(dict(sizes))
    )
    return {
        DESCRIPTION: model_description(component, sizes, f"{{{uuid.UUID(stamp[:32])}}}"),
        "resources/slavemodule.txt": module.encode(),
        f"resources/{module}.py": script.encode(),
    }


def _library_files(component: Component) -> Files:
    """Return the package that runs inside the FMU.

    It has the slave, the component with what the components share, and parts of pythonfmu.
    """
    paths = {f"pythonfmu/{name}": _PYTHONFMU / name for name in _PYTHONFMU_PARTS} | {
        name: _HERE / "python" / name for name in _SLAVE_PARTS
    }
    sources = component_sources(component)
    if problems := _import_problems(sources):
        raise BuildError(f"{component.name}: {'; '.join(problems)}")
    files = sources | {name: path.read_bytes() for name, path in paths.items()}
    files = {
        name: with_imports_moved(content, name) if name.endswith(".py") else content
        for name, content in files.items()
    }
    return files | {"__init__.py": b"", "pythonfmu/__init__.py": b""}


def _import_problems(sources: Files) -> list[str]:
    """Return in words why a component's sources cannot run inside an FMU."""
    return [
        f"{path.removeprefix('components/')}, line {found.line}, imports {found.module}, which "
        "an FMU with Python does not hold: a component imports rockshed.components.common and, "
        "relatively, the modules of its own folder"
        for path, content in sources.items()
        if path.endswith(".py") and not path.startswith("components/common/")
        for found in foreign_imports(content, path)
    ]


def _binaries(component: Component) -> Iterator[tuple[str, bytes]]:
    for path in _pythonfmu_binaries():
        yield f"binaries/{path.parent.name}/{component.name}{path.suffix}", path.read_bytes()


def _pythonfmu_binaries() -> list[Path]:
    return sorted((_PYTHONFMU / "resources" / "binaries").glob("*/*"))


def runs_with_python_here() -> bool:
    """Tell whether FMUs with Python have a binary for this machine: pythonfmu brings them."""
    heads = (path.read_bytes()[:LONGEST_HEAD] for path in _pythonfmu_binaries())
    return any(this_machine().in_fmi3 in platforms_of(head) for head in heads)
