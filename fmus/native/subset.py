"""Functions that kernels may need when they run without Python, and where one needs more."""

import os
import re
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..parts import COMPONENTS

if TYPE_CHECKING:
    from numba.core.errors import NumbaError

ALLOWED = frozenset(
    re.findall(
        r"\w+",
        """
    acos acosh asin asinh atan atan2 atanh cbrt ceil copysign cos cosh erf erfc exp exp2 expm1 fabs
    floor fma fmax fmin fmod frexp hypot ldexp lgamma log log10 log1p log2 nearbyint pow rint round
    sin sinh sqrt tan tanh tgamma trunc memcpy memmove memset pthread_create pthread_join""",
    )
)
"""Functions of the C library (under Windows: of the shim) that kernels may call. Anything else
would be Python's or numba's."""


UNKNOWN_PLACE = "at an unknown place"


def foreign_symbols(module: Any) -> list[str]:
    """Return the symbols that an LLVM module needs from outside and may not.

    Parameters
    ----------
    module : llvmlite.binding.ModuleRef
        The module.

    Returns
    -------
    list of str
        In alphabetical order.
    """
    needed = [
        f.name for f in module.functions if f.is_declaration and not f.name.startswith("llvm.")
    ]
    needed += [v.name for v in module.global_variables if v.is_declaration]
    return sorted(name for name in needed if name not in ALLOWED)


def symbol_problems(module: Any, folder: Path) -> list[str]:
    """Return the foreign symbols of a module by the lines of the sources that need them.

    Parameters
    ----------
    module : llvmlite.binding.ModuleRef
        Lines are known if it has debug information.
    folder : Path
        The component's folder.

    Returns
    -------
    list of str
        A place with its symbols each.
    """
    source, by_place = _Source(str(module), folder), dict[str, list[str]]()
    for symbol in foreign_symbols(module):
        for place in sorted(set(source.places(symbol))) or [UNKNOWN_PLACE]:
            by_place.setdefault(place, []).append(symbol)
    return [f"{place} ({', '.join(symbols)})" for place, symbols in by_place.items()]


class _Source:
    """The text of a module with debug information."""

    def __init__(self, text: str, folder: Path) -> None:
        self._ours = (str(folder) + os.sep, str(COMPONENTS) + os.sep)
        self._nodes = dict(re.findall(r"^(!\d+) = (.*)$", text, re.MULTILINE))
        self._functions = re.findall(
            r'^define [^\n]*?@"?([^"(]+)"?\((.*?)^\}', text, re.MULTILINE | re.DOTALL
        )

    def places(self, symbol: str, seen: frozenset[str] = frozenset()) -> Iterator[str]:
        """Yield where our sources use a symbol, be it by functions of others that they call."""
        named = re.compile(rf'@"?{re.escape(symbol)}"?(?![\w.$]).*!dbg (!\d+)')
        for function, body in self._functions:
            nodes = named.findall(body)
            own = [
                place
                for node in nodes
                for place in self._chain(node)
                if place.startswith(self._ours)
            ]
            yield from own[:1]
            if nodes and not own and function not in seen:
                yield from self.places(function, seen | {function})

    def _chain(self, node: str) -> Iterator[str]:
        """Yield the place of an instruction, then those of the calls by which it came there."""
        while node:
            location = self._nodes[node]
            scope = _field(location, "scope")
            while "DISubprogram" not in self._nodes[scope]:
                scope = _field(self._nodes[scope], "scope")
            file = self._nodes[_field(self._nodes[scope], "file")]
            path = os.path.join(_field(file, "directory"), _field(file, "filename"))
            yield (
                f"{path}, line {_field(location, 'line')}, in {_field(self._nodes[scope], 'name')}"
            )
            node = _field(location, "inlinedAt")


def _field(node: str, name: str) -> str:
    found = re.search(rf'\b{name}: (?:"([^"]*)"|([^,)]+))', node)
    return (found.group(1) or found.group(2)) if found else ""


def error_problem(error: "NumbaError", name: str, kernel: Any, folder: Path) -> str:
    """Return what numba finds wrong with a kernel, with the line as far as numba knows it.

    Parameters
    ----------
    error : NumbaError
        Raised by the compilation.
    name : str
        Name of the kernel.
    kernel : Dispatcher of numba
        The kernel.
    folder : Path
        The component's folder.

    Returns
    -------
    str
        Place and reason.
    """
    text = re.sub(r"\x1b\[[0-9;]*m", "", str(error))
    reasons = [
        line.strip()
        for line in text.splitlines()
        if line.strip() and not line.startswith(("Failed in", "During"))
    ]
    places = [
        (os.path.abspath(file), line)
        for pair in re.findall(r'(?:File "(.+)", line |at (.+) \()(\d+)', text)
        for file, line in [(pair[0] or pair[1], pair[2])]
    ]
    ours = [place for place in places if place[0].startswith(str(folder) + os.sep)]
    code = kernel.py_func.__code__
    file, line = ours[-1] if ours else (code.co_filename, code.co_firstlineno)
    return f"{file}, line {line}, in {name} ({reasons[0] if reasons else text})"
