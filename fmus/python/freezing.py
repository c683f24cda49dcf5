"""Sources on their way into an FMU: imports of modules that the FMU brings along become relative.

An FMU holds copies of the component and of what it needs, under a package name of its own, so that
FMUs in one interpreter cannot confuse their modules. A source may name such a module by its place
in this library (``rockshed.components.common.ports``); in the copy it is the module next door.
"""

import ast
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

BROUGHT: Mapping[str, str] = {
    "rockshed.components.common": "components.common",
    "pythonfmu": "pythonfmu",
}
"""Packages that an FMU brings along, and their place in its library."""
_OURS = "rockshed"


@dataclass(frozen=True)
class Foreign:
    """An import of a module that an FMU does not bring along."""

    line: int
    module: str


def with_imports_moved(content: bytes, path: str) -> bytes:
    """Return a source as it stands in an FMU. Lines keep their numbers.

    Parameters
    ----------
    content : bytes
        Python source.
    path : str
        Place of the file in the FMU's library, with forward slashes.

    Returns
    -------
    bytes
        The source with relative imports in the place of absolute ones.

    Raises
    ------
    SyntaxError
        The source is no Python.
    """
    lines = content.splitlines(keepends=True)
    imports = [node for node in _imports(content) if isinstance(node, ast.ImportFrom)]
    for node in sorted(imports, key=lambda node: node.col_offset, reverse=True):
        place = None if node.level else _place(node.module or "")
        if place is not None:
            line, begin = lines[node.lineno - 1], node.col_offset
            moved = re.sub(
                rb"from(\s+)" + re.escape((node.module or "").encode()),
                rb"from\1" + ("." * (path.count("/") + 1) + place).encode(),
                line[begin:],
                count=1,
            )
            lines[node.lineno - 1] = line[:begin] + moved
    return b"".join(lines)


def foreign_imports(content: bytes, path: str) -> list[Foreign]:
    """Return the imports of a component's source that cannot work inside an FMU.

    Parameters
    ----------
    content : bytes
        Python source.
    path : str
        Place of the file in the FMU's library: ``components/FOLDER/...``.

    Returns
    -------
    list of Foreign
        Imports of this library's modules other than the shared ones, and relative imports that
        leave the component's folder for anything else.

    Raises
    ------
    SyntaxError
        The source is no Python.
    """
    own = ".".join(path.split("/")[:2])
    found = []
    for node in _imports(content):
        is_relative = isinstance(node, ast.ImportFrom) and node.level > 0
        for module in _targets(node, path):
            inside = _is_in(module, own) or _is_in(module, BROUGHT["rockshed.components.common"])
            if _is_in(module, _OURS) or (is_relative and not inside):
                found.append(Foreign(node.lineno, module))
    return found


def _targets(node: ast.Import | ast.ImportFrom, path: str) -> list[str]:
    """Return what an import names: absolute, or by the place in the library if it is there."""
    if isinstance(node, ast.Import):
        return [alias.name for alias in node.names]
    module = node.module or ""
    if node.level == 0:
        return [_place(module) or module]
    package = path.split("/")[:-1]
    base = package[: len(package) + 1 - node.level]
    return [".".join([*base, *filter(None, [module])])]


def _imports(content: bytes) -> Iterator[ast.Import | ast.ImportFrom]:
    for node in ast.walk(ast.parse(content)):
        if isinstance(node, ast.Import | ast.ImportFrom):
            yield node


def _place(module: str) -> str | None:
    """Return the place of a module in the FMU's library, None if it is not there."""
    for name, place in BROUGHT.items():
        if _is_in(module, name):
            return place + module.removeprefix(name)
    return None


def _is_in(module: str, package: str) -> bool:
    return module == package or module.startswith(f"{package}.")
