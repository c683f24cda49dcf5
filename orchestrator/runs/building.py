"""FMUs of components: built where they are missing or out of date, and in which sizes."""

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from rockshed.components.catalogue import NAMES, component
from rockshed.components.common.cache import has_kernels
from rockshed.components.common.component import Component, ComponentError
from rockshed.fmus.places import Fmi, Runtime, fmu_file, folder_name, native_is_fresh

from ..cases.registry import Case
from ..core.errors import InputRefused, Problem
from ..core.system.names import nearest
from ..platforms import this_machine
from .request import AUTO
from .subsystem import component_of, is_whole, whole_sizes

BOTH = "both"
"""In the place of a runtime: every one."""

Note = Callable[[str], None]
"""Called with a line for the user on what is being done."""


def silent(text: str) -> None:
    """Tell nobody: the default of every ``note``.

    Parameters
    ----------
    text : str
        A line.
    """


def own_sizes(chosen: Case, others: Mapping[str, int]) -> dict[str, dict[str, int]]:
    """Return the sizes of all components of a case.

    Parameters
    ----------
    chosen : Case
        The case.
    others : mapping of str to int
        By ``component.size``: sizes that are other than the case's, of a model of the sand.

    Returns
    -------
    dict of str to dict of str to int
        By component and size.
    """
    sizes = {
        name: dict(component(model).with_sizes(chosen.sizes.get(name)))
        for name, model in chosen.models.items()
    }
    for name, number in others.items():
        owner, _, size = name.partition(".")
        sizes[owner][size] = number
    return sizes


def case_sizes(
    chosen: Case, numbers: Mapping[str, int], problems: list[Problem]
) -> dict[str, dict[str, int]]:
    """Return the sizes of all components of a case, with what is asked for in them.

    Parameters
    ----------
    chosen : Case
        The case.
    numbers : mapping of str to int
        By ``component.size``.
    problems : list of Problem
        Sizes that do not exist, are no whole numbers or out of range are appended.

    Returns
    -------
    dict of str to dict of str to int
        By component and size.
    """
    sizes = own_sizes(chosen, {})
    known = [f"{owner}.{size}" for owner, its in sizes.items() for size in its]
    for name, value in _with_one_size(chosen, numbers, problems).items():
        owner, _, size = name.partition(".")
        if name not in known:
            problems.append(_no_size(f"sizes {name}", chosen.models, name, known))
        elif not is_whole(value):
            problems.append(_not_whole(name, value))
        else:
            sizes[owner][size] = int(value)
    for owner, model in chosen.models.items():
        problems += range_problems(f"sizes of {owner}", model, sizes[owner])
    return sizes


def _no_size(where: str, models: Mapping[str, str], name: str, known: Sequence[str]) -> Problem:
    """Refuse a size that a component of a case does not have; it may be a variable of it."""
    owner, _, key = name.partition(".")
    if owner in models and key in {v.name for v in component(models[owner]).layout.variables}:
        return Problem(where, f"{key} is no size, but a variable", f"give {name} with values=...")
    return Problem(where, "there is no such size", nearest(name, known))


def _not_whole(name: str, value: object) -> Problem:
    return Problem(f"sizes {name}", f"{value!r} is no whole number", "give a whole number")


def _with_one_size(
    chosen: Case, numbers: Mapping[str, int], problems: list[Problem]
) -> dict[str, int]:
    """Return the sizes that are asked for, and those that are one number with them."""
    given = {name: value for name, value in numbers.items() if name in chosen.one_size}
    if len(set(given.values())) > 1:
        problems.append(
            Problem(
                "sizes",
                f"{', '.join(f'{n} = {v}' for n, v in given.items())}, and they are one number",
                "give one of them",
            )
        )
    return {
        **numbers,
        **dict.fromkeys(chosen.one_size if given else (), next(iter(given.values()), 0)),
    }


def range_problems(where: str, model: str, sizes: Mapping[str, int]) -> list[Problem]:
    """Return the sizes of a component that are out of range.

    Parameters
    ----------
    where : str
        Place of the sizes, for messages.
    model : str
        Name of the component in the catalogue.
    sizes : mapping of str to int
        By name of the size.

    Returns
    -------
    list of Problem
        Empty if all are in range.
    """
    try:
        component(model).with_sizes(sizes)
    except ComponentError as error:
        return [Problem(where, text, "choose a number in this range") for text in error.problems]
    return []


@dataclass(frozen=True)
class CaseFmus:
    """The FMUs of a case.

    Attributes
    ----------
    files : mapping of str to str
        By component of the system.
    runtime, reason : str
        Their runtime, and why it was chosen.
    """

    files: Mapping[str, str]
    runtime: str
    reason: str


def case_fmus(
    chosen: Case, sizes: Mapping[str, Mapping[str, int]], note: Note, wanted: str = AUTO
) -> CaseFmus:
    """Return the FMUs of a case; those that are missing or out of date are built.

    Parameters
    ----------
    chosen : Case
        The case.
    sizes : mapping of str to mapping of str to int
        Sizes by component.
    note : callable
        Called with a line for each FMU that is built.
    wanted : str
        A runtime, or ``auto``: native if all of these FMUs are there and up to date, or if those
        with Python have no binary for this machine; else Python.

    Returns
    -------
    CaseFmus
        Files, runtime and reason.

    Raises
    ------
    InputRefused
        They cannot be compiled or written.
    """
    stale = _stale(chosen, sizes)
    runtime, reason = (
        _best_runtime(chosen, sizes, stale) if wanted == AUTO else (Runtime(wanted), "as asked for")
    )
    files = {}
    for name, model in chosen.models.items():
        file = fmu_file(component(model), sizes[name], runtime)
        if runtime is not Runtime.NATIVE or name in stale:
            _build_if_needed(name, model, sizes[name], runtime, file, note)
        files[name] = str(file)
    return CaseFmus(files, runtime.value, reason)


FmusOf = Callable[[Case, Mapping[str, Mapping[str, int]], Note, str], CaseFmus]
"""Functions with the parameters of :func:`case_fmus`."""


def each_once() -> FmusOf:
    """Return :func:`case_fmus` for a batch of runs, which looks at every FMU once.

    To look whether an FMU is up to date takes as long as to make it: of a thousand runs with the
    same components and sizes the first one pays for all.
    """
    found: dict[object, CaseFmus] = {}

    def fmus_of(
        chosen: Case, sizes: Mapping[str, Mapping[str, int]], note: Note, wanted: str = AUTO
    ) -> CaseFmus:
        components = [(name, model, *sizes[name].items()) for name, model in chosen.models.items()]
        key = (tuple(components), wanted)
        if key not in found:
            found[key] = case_fmus(chosen, sizes, note, wanted)
        return found[key]

    return fmus_of


def _build_if_needed(
    name: str, model: str, sizes: Mapping[str, int], runtime: Runtime, file: Path, note: Note
) -> None:
    from rockshed.fmus.build import BuildError, build_if_needed

    before = _changed_at(file)
    try:
        build_if_needed(model, sizes, runtime=runtime)
    except BuildError as error:
        raise InputRefused([Problem(name, str(error))]) from error
    if _changed_at(file) != before:
        note(f"built {file}")


def _stale(chosen: Case, sizes: Mapping[str, Mapping[str, int]]) -> list[str]:
    """Return the components of which there is no native FMU that is up to date."""
    return [
        name
        for name, model in chosen.models.items()
        if not native_is_fresh(component(model), sizes[name])
    ]


def _best_runtime(
    chosen: Case, sizes: Mapping[str, Mapping[str, int]], stale: Sequence[str]
) -> tuple[Runtime, str]:
    if not stale:
        return Runtime.NATIVE, "they are up to date"
    from rockshed.fmus.build import runs_with_python_here  # with what builds: half a second

    if not runs_with_python_here():
        why = f"those with Python inside have no binary for {this_machine().in_fmi3}"
        return Runtime.NATIVE, why
    there = [
        name
        for name in stale
        if fmu_file(component(chosen.models[name]), sizes[name], Runtime.NATIVE).is_file()
    ]
    why = f"native {' and '.join(there)} out of date" if there else "there are no native ones"
    return Runtime.PYTHON, f'{why}; runtime="native" makes them'


def _changed_at(file: Path) -> int:
    return file.stat().st_mtime_ns if file.is_file() else 0


@dataclass(frozen=True)
class Export:
    """The kind of FMUs that are built.

    Attributes
    ----------
    runtime : str, optional
        ``python``, ``native`` or ``both``; by default Python, with FMI 3 native.
    platforms : sequence of str
        Of native FMUs, ``linux64`` for instance; by default this machine's.
    fmi : int
        Version of FMI, 2 or 3.
    """

    runtime: str | None = None
    platforms: Sequence[str] = ()
    fmi: int = 2

    @property
    def chosen_runtime(self) -> str:
        """The runtime, also where none is named."""
        return self.runtime or ("python" if self.fmi == 2 else "native")


def build_all(
    names: Sequence[str],
    sizes: Mapping[str, int],
    folder: Path | None = None,
    export: Export = Export(),
    problems: Sequence[Problem] = (),
) -> list[Path]:
    """Build the FMUs of components; if one of them cannot be made, none is written.

    Parameters
    ----------
    names : sequence of str
        Names of components; empty for all of the catalogue.
    sizes : mapping of str to int
        By name of the size; one goes to those of the components that have it.
    folder : Path, optional
        The FMUs go into its folders ``python``, ``native`` and ``native-fmi3``; by default into
        the folder of built FMUs.
    export : Export
        Runtime, platforms, version of FMI.
    problems : sequence of Problem
        Problems that the caller has with the request, refused together with those seen here.

    Returns
    -------
    list of Path
        The FMU files.

    Raises
    ------
    InputRefused
        Unknown components, sizes, runtimes, versions or platforms, sizes out of range, a compiler
        that fails, a folder that cannot be written.
    """
    chosen = list(dict.fromkeys(names or NAMES))
    found = [
        *problems,
        *(
            Problem(name, "there is no such component", nearest(name, NAMES))
            for name in chosen
            if name not in NAMES
        ),
        *_export_problems(export),
    ]
    if not found:
        found += _size_problems(chosen, sizes)
    if found:
        raise InputRefused(found)
    runtime = export.chosen_runtime
    runtimes = list(Runtime) if runtime == BOTH else [Runtime(runtime)]
    places = {
        each: folder / folder_name(each, Fmi(export.fmi)) if folder else None for each in runtimes
    }
    return _build([component(name) for name in chosen], sizes, places, export)


def _build(
    components: Sequence[Component],
    sizes: Mapping[str, int],
    places: Mapping[Runtime, Path | None],
    export: Export,
) -> list[Path]:
    """Make the content of all FMUs, then write them into the folder of their runtime.

    Raises
    ------
    InputRefused
        A compiler that fails, a folder that cannot be written.
    """
    from rockshed.fmus.build import BuildError, fmu_content, store

    fmi = Fmi(export.fmi)
    made = []
    files = []
    try:
        for runtime in places:
            for built in components:
                its_sizes = built.with_sizes({s: n for s, n in sizes.items() if s in built.sizes})
                content = fmu_content(built, its_sizes, runtime, export.platforms, fmi)
                made.append((runtime, built, its_sizes, content))
        for runtime, built, its_sizes, content in made:
            files.append(store(built, its_sizes, content, places[runtime], runtime, fmi=fmi))
    except BuildError as error:
        raise InputRefused([Problem("build", str(error))]) from error
    return files


def build_fmu(
    name: str | Component,
    sizes: Mapping[str, int] | None = None,
    folder: str | Path | None = None,
    *,
    runtime: str | None = None,
    platforms: Sequence[str] = (),
    fmi: int = 2,
) -> Path:
    """Build the FMU of a component, always anew.

    Parameters
    ----------
    name : str or Component
        Name of a component of the catalogue, or a component of one's own.
    sizes : mapping of str to int, optional
        Sizes that differ from the defaults; the name of the file then has them.
    folder : str or Path, optional
        The FMU goes into its folder ``python``, ``native`` or ``native-fmi3``, as those of
        ``rockshed build`` do, so that none takes the place of another kind; by default into the
        folder of built FMUs.
    runtime : str, optional
        ``python``: with Python inside, for x86-64 under Linux and Windows; ``native``: needs no
        Python. By default Python, with FMI 3 native.
    platforms : sequence of str
        Of native FMUs, ``linux64``, ``win64``, ``darwin64``, ``aarch64-linux``,
        ``aarch64-darwin``, or ``all`` of these; ``wasm``, a component for WebAssembly, with FMI 3;
        by default this machine's.
    fmi : int
        Version of FMI, 2 or 3; that of 3 is for native FMUs only.

    Returns
    -------
    Path
        The FMU file.

    Raises
    ------
    UnknownName
        The catalogue has no component of this name.
    InputRefused
        Sizes out of range, a runtime, version or platform that does not exist, a compiler that
        fails, a folder that cannot be written.

    Examples
    --------
    >>> import rockshed, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     rockshed.build_fmu("FallingRock", folder=folder).relative_to(folder).as_posix()
    'python/FallingRock.fmu'
    """
    export = Export(runtime, platforms, fmi)
    built = component_of(name)
    problems = [] if runtime != BOTH else [Problem("runtime", "one at a time", "name one")]
    problems += _export_problems(export)
    chosen: dict[str, int] = {}
    try:
        whole_sizes(built, sizes)
        chosen = {name: int(number) for name, number in (sizes or {}).items()}
    except ComponentError as error:
        problems += [Problem(f"{built.name}: sizes", text) for text in error.problems]
    if problems:
        raise InputRefused(problems)
    runtime_folder = folder_name(Runtime(export.chosen_runtime), Fmi(export.fmi))
    place = Path(folder) / runtime_folder if folder is not None else None
    (file,) = _build([built], chosen, {Runtime(export.chosen_runtime): place}, export)
    return file


def _export_problems(export: Export) -> list[Problem]:
    from rockshed.fmus.build import ONLY_FMI3, ONLY_NATIVE
    from rockshed.fmus.ls_wasm import PLATFORM as WASM
    from rockshed.fmus.native.fmu import ALL_PLATFORMS, PLATFORMS

    known = [*PLATFORMS, ALL_PLATFORMS, WASM]
    runtime = export.chosen_runtime
    problems = [
        Problem(f"platforms {name}", "there is no such platform", nearest(name, known))
        for name in export.platforms
        if name not in known
    ]
    if runtime not in (*Runtime, BOTH):
        choice = f"choose one of {', '.join(Runtime)}, {BOTH}"
        problems.append(Problem("runtime", f"{runtime!r} is unknown", choice))
    elif export.platforms and runtime == Runtime.PYTHON:
        reason = "is for native FMUs; those with Python inside always are for linux64 and win64"
        problems.append(Problem("platforms", reason, 'add runtime="native"'))
    if WASM in export.platforms and export.fmi == Fmi.TWO:
        problems.append(Problem(f"platforms {WASM}", ONLY_FMI3, "add fmi=3"))
    if export.fmi not in list(Fmi):
        reason = "there is no such version of FMI here"
        problems.append(Problem(f"fmi {export.fmi}", reason, "choose 2 or 3"))
    elif export.fmi == Fmi.THREE and runtime != Runtime.NATIVE:
        problems.append(Problem(f"runtime {runtime}", ONLY_NATIVE, 'add runtime="native"'))
    return problems


def _other(size: str, known: Collection[str], names: Sequence[str]) -> str:
    """Say what may have been meant by a size that no component has."""
    variables = {v.name for name in names for v in component(name).layout.variables}
    if size in variables:
        return "it is a variable, and gets its value when a run begins (`rockshed run`)"
    return nearest(size, known)


def _size_problems(names: Sequence[str], sizes: Mapping[str, int]) -> list[Problem]:
    known = {size for name in names for size in component(name).sizes}
    have = "have" if len(names) > 1 else "has"
    problems = [
        Problem(
            f"sizes {size}",
            f"{' and '.join(names)} {have} no such size",
            _other(size, known, names),
        )
        for size in sizes
        if size not in known
    ]
    problems += [_not_whole(name, value) for name, value in sizes.items() if not is_whole(value)]
    if problems:
        return problems
    for name in names:
        its_sizes = {s: n for s, n in sizes.items() if s in component(name).sizes}
        problems += range_problems(f"sizes of {name}", name, its_sizes)
    return problems


def is_cold(names: Iterable[str]) -> bool:
    """Tell whether kernels have never been compiled and kept on this machine.

    Parameters
    ----------
    names : iterable of str
        Names of components in the catalogue.

    Returns
    -------
    bool
        Whether those of any of them have not.
    """
    return not all(has_kernels(component(name).folder) for name in names)
