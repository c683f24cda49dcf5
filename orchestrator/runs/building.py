"""FMUs of our components, built where they are missing or out of date, and the sizes they are built in."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from rockshed.components.catalogue import NAMES, component
from rockshed.components.common.component import ComponentError

from ..cases.registry import Case
from ..core.errors import InputRefused, Problem
from ..core.system.names import nearest
from ..core.system.system import Value

if TYPE_CHECKING:
    from rockshed.fmus.parts import Runtime

AUTO, BOTH = "auto", "both"
"""What may stand in the place of a runtime: the best that is there, or every one."""

Note = Callable[[str], None]
"""Tells the user what is being done."""


def assignments(option: str, texts: Sequence[str], problems: list[Problem]) -> dict[str, Value]:
    """Values by name from ``name=value``, as it is written on the command line. The last of several for one name holds."""
    found: dict[str, Value] = {}
    for text in texts:
        name, equals, value = (part.strip() for part in text.partition("="))
        if not (name and equals and value):
            problems.append(
                Problem(
                    option, f"{text!r} is no assignment", f"write {option} component.name=value"
                )
            )
        else:
            found[name] = _value(value)
    return found


def _value(text: str) -> Value:
    """A number where the text is one; words and truth values stay text until the port says what it takes."""
    for read in (int, float):
        try:
            return read(text)
        except ValueError:
            continue
    return text


def case_sizes(
    chosen: Case, numbers: Mapping[str, Value], problems: list[Problem]
) -> dict[str, dict[str, int]]:
    """The sizes of all components of a case, with what was asked for in them."""
    sizes = {
        name: dict(component(model).with_sizes(chosen.sizes.get(name)))
        for name, model in chosen.models.items()
    }
    known = [f"{owner}.{size}" for owner, its in sizes.items() for size in its]
    asked = _with_one_size(chosen, numbers, problems)
    for name, value in asked.items():
        owner, _, size = name.partition(".")
        if name not in known:
            problems.append(
                Problem(f"--size {name}", "there is no such size", nearest(name, known))
            )
        elif not isinstance(value, int):
            problems.append(
                Problem(f"--size {name}", f"{value!r} is no whole number", "give a whole number")
            )
        else:
            sizes[owner][size] = value
    for owner, model in chosen.models.items():
        problems += range_problems(f"--size, {owner}", model, sizes[owner])
    return sizes


def _with_one_size(
    chosen: Case, numbers: Mapping[str, Value], problems: list[Problem]
) -> dict[str, Value]:
    """The sizes that were asked for, and those that are the same number as one of them."""
    given = {name: value for name, value in numbers.items() if name in chosen.one_size}
    if len(set(given.values())) > 1:
        problems.append(
            Problem(
                "--size",
                f"{', '.join(f'{n} = {v}' for n, v in given.items())}, and they are one number",
                "give one of them",
            )
        )
    return {
        **numbers,
        **dict.fromkeys(chosen.one_size if given else (), next(iter(given.values()), 0)),
    }


def range_problems(where: str, model: str, sizes: Mapping[str, int]) -> list[Problem]:
    """Sizes that are out of range."""
    try:
        component(model).with_sizes(sizes)
    except ComponentError as error:
        return [Problem(where, text, "choose a number in this range") for text in error.problems]
    return []


@dataclass(frozen=True)
class CaseFmus:
    """The FMU files of a case by component, their runtime, and why it was chosen."""

    files: Mapping[str, str]
    runtime: str
    reason: str


def case_fmus(
    chosen: Case, sizes: Mapping[str, Mapping[str, int]], note: Note, wanted: str = AUTO
) -> CaseFmus:
    """The FMUs of a case; those that are missing or out of date are built.

    wanted: a runtime, or AUTO: native if all of these FMUs are there and up to date, otherwise Python.

    Raises:
        InputRefused: they cannot be compiled or written.
    """
    from rockshed.fmus.places import Runtime, fmu_file

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


def _build_if_needed(
    name: str, model: str, sizes: Mapping[str, int], runtime: "Runtime", file: Path, note: Note
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
    """Components of which there is no native FMU that is up to date."""
    from rockshed.fmus.places import native_is_fresh

    return [
        name
        for name, model in chosen.models.items()
        if not native_is_fresh(component(model), sizes[name])
    ]


def _best_runtime(
    chosen: Case, sizes: Mapping[str, Mapping[str, int]], stale: Sequence[str]
) -> "tuple[Runtime, str]":
    from rockshed.fmus.places import Runtime, fmu_file

    if not stale:
        return Runtime.NATIVE, "they are up to date"
    there = [
        name
        for name in stale
        if fmu_file(component(chosen.models[name]), sizes[name], Runtime.NATIVE).is_file()
    ]
    why = f"native {' and '.join(there)} out of date" if there else "there are no native ones"
    return Runtime.PYTHON, f"{why}; --runtime native makes them"


def _changed_at(file: Path) -> int:
    return file.stat().st_mtime_ns if file.is_file() else 0


def build_all(
    names: Sequence[str],
    size_texts: Sequence[str],
    folder: Path | None,
    runtime: str | None = None,
    platforms: Sequence[str] = (),
    fmi: int = 2,
) -> list[Path]:
    """Build the FMUs of these components, or of all; if one of them cannot be made, none is written.

    A size goes to those of the components that have it. folder: the FMUs go into its folders ``python``, ``native`` and
    ``native-fmi3``. fmi: 2 or 3, the version of FMI. runtime: by default Python, with FMI 3 native.

    Raises:
        InputRefused: unknown components, sizes, runtimes, versions or platforms, sizes out of range, a compiler that fails, a
            folder that cannot be written.
    """
    from rockshed.fmus.build import BuildError, Fmi, Runtime, fmu_content, folder_name, store

    runtime = runtime or (Runtime.PYTHON if fmi == Fmi.TWO else Runtime.NATIVE).value
    problems: list[Problem] = []
    sizes = assignments("--size", size_texts, problems)
    chosen = list(dict.fromkeys(names or NAMES))
    problems += [
        Problem(name, "there is no such component", nearest(name, NAMES))
        for name in chosen
        if name not in NAMES
    ]
    problems += _runtime_problems(runtime, platforms, fmi)
    known = [name for name in chosen if name in NAMES]
    if not problems:
        problems += _size_problems(known, sizes)
    if problems:
        raise InputRefused(problems)
    its_sizes = {
        n: component(n).with_sizes({s: int(v) for s, v in sizes.items() if s in component(n).sizes})
        for n in known
    }
    runtimes = list(Runtime) if runtime == BOTH else [Runtime(runtime)]
    try:
        made = [
            (r, n, fmu_content(component(n), its_sizes[n], r, platforms, Fmi(fmi)))
            for r in runtimes
            for n in known
        ]
        return [
            store(
                component(n),
                its_sizes[n],
                content,
                folder / folder_name(r, Fmi(fmi)) if folder else None,
                r,
                fmi=Fmi(fmi),
            )
            for r, n, content in made
        ]
    except BuildError as error:
        raise InputRefused([Problem("build", str(error))]) from error


def _runtime_problems(runtime: str, platforms: Sequence[str], fmi: int) -> list[Problem]:
    from rockshed.fmus.build import ONLY_NATIVE, Fmi
    from rockshed.fmus.native.fmu import PLATFORMS
    from rockshed.fmus.parts import Runtime

    problems = [
        Problem(f"--platform {name}", "there is no such platform", nearest(name, PLATFORMS))
        for name in platforms
        if name not in PLATFORMS
    ]
    if runtime not in (*Runtime, BOTH):
        problems.append(
            Problem(
                "--runtime",
                f"{runtime!r} is unknown",
                f"choose one of {', '.join(Runtime)}, {BOTH}",
            )
        )
    elif platforms and runtime == Runtime.PYTHON:
        problems.append(
            Problem(
                "--platform",
                "is for native FMUs; those with Python inside run everywhere",
                "add --runtime native",
            )
        )
    if fmi not in list(Fmi):
        problems.append(
            Problem(f"--fmi {fmi}", "there is no such version of FMI here", "choose 2 or 3")
        )
    elif fmi == Fmi.THREE and runtime != Runtime.NATIVE:
        problems.append(
            Problem(f"--fmi 3 --runtime {runtime}", ONLY_NATIVE, "add --runtime native")
        )
    return problems


def _size_problems(names: Sequence[str], sizes: Mapping[str, Value]) -> list[Problem]:
    known = {size for name in names for size in component(name).sizes}
    problems = [
        Problem(
            f"--size {size}",
            f"{' and '.join(names)} {'have' if len(names) > 1 else 'has'} no such size",
            nearest(size, known),
        )
        for size in sizes
        if size not in known
    ]
    problems += [
        Problem(f"--size {size}", f"{value!r} is no whole number", "give a whole number")
        for size, value in sizes.items()
        if not isinstance(value, int)
    ]
    for name in names if not problems else []:
        problems += range_problems(
            f"--size, {name}",
            name,
            {s: int(n) for s, n in sizes.items() if s in component(name).sizes},
        )
    return problems


def is_cold(names: Iterable[str]) -> bool:
    """Whether kernels of any of these components have never been compiled and kept on this machine."""
    from rockshed.components.catalogue import component
    from rockshed.components.common.kernels import has_kernels

    return not all(has_kernels(component(name).folder.name) for name in names)
