"""Rules of the house that no linter has, read from the syntax trees of the package."""

import ast
import re
from collections import defaultdict
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[2]
FOLDERS = ("orchestrator", "components", "fmus")
LONGEST_FUNCTION = 40
"""Lines, from ``def`` to the last one, its docstring not counted."""

Function = ast.FunctionDef | ast.AsyncFunctionDef
Documented = ast.Module | ast.ClassDef | Function


@dataclass(frozen=True)
class Breach:
    """A place that breaks a rule."""

    file: str
    name: str
    line: int
    detail: str = ""

    @property
    def place(self) -> str:
        """File and name, which stay when lines are added above."""
        return f"{self.file}: {self.name}"

    def __str__(self) -> str:
        return f"{self.file}:{self.line} {self.name} {self.detail}".rstrip()


@cache
def sources() -> dict[str, ast.Module]:
    """Return the syntax tree of every module of the package by its path in the repository."""
    files = sorted(file for folder in FOLDERS for file in (ROOT / folder).rglob("*.py"))
    return {
        file.relative_to(ROOT).as_posix(): ast.parse(file.read_text(encoding="utf-8"))
        for file in files
        if "dist" not in file.relative_to(ROOT).parts
    }


def named(node: ast.AST, name: str = "") -> Iterator[tuple[str, ast.AST]]:
    """Yield every node with the dotted name of the class or function in which it stands."""
    for child in ast.iter_child_nodes(node):
        inner = name
        if isinstance(child, ast.ClassDef | Function):
            inner = f"{name}.{child.name}" if name else child.name
        yield inner, child
        yield from named(child, inner)


def breaches(rule: Callable[[ast.AST], str | None]) -> list[Breach]:
    """Return the nodes for which a rule has an objection."""
    return [
        Breach(file, name or "module", getattr(node, "lineno", 1), detail)
        for file, tree in sources().items()
        for name, node in [("", tree), *named(tree)]
        if (detail := rule(node)) is not None
    ]


def too_long(node: ast.AST) -> str | None:
    """Object to functions of more than :data:`LONGEST_FUNCTION` lines."""
    if not isinstance(node, Function):
        return None
    lines = set(range(node.lineno, (node.end_lineno or node.lineno) + 1))
    for inner in ast.walk(node):
        if docstring(inner):
            text = inner.body[0]
            lines -= set(range(text.lineno, (text.end_lineno or text.lineno) + 1))
    return f"has {len(lines)} lines" if len(lines) > LONGEST_FUNCTION else None


def nested_condition(node: ast.AST) -> str | None:
    """Object to conditional expressions inside another."""
    if not isinstance(node, ast.IfExp):
        return None
    inner = (n for child in ast.iter_child_nodes(node) for n in ast.walk(child))
    return "is nested" if any(isinstance(n, ast.IfExp) for n in inner) else None


def kind(value: ast.expr) -> str:
    """Return the kind of thing that an expression makes, as far as one can see it."""
    if isinstance(value, ast.Constant):
        return "number" if type(value.value) in (int, float) else type(value.value).__name__
    if isinstance(value, ast.UnaryOp):
        return kind(value.operand)
    if isinstance(value, ast.Name | ast.Attribute | ast.Subscript | ast.BinOp):
        return "quantity"
    return type(value).__name__.lower()


def unlike_things(node: ast.AST) -> str | None:
    """Object to ``a, b = 1, "x"``: an assignment to unlike things on one line."""
    if not isinstance(node, ast.Assign) or not isinstance(node.value, ast.Tuple):
        return None
    if not any(isinstance(target, ast.Tuple) for target in node.targets):
        return None
    kinds = {kind(value) for value in node.value.elts}
    if "number" in kinds:
        kinds -= {"quantity"}
    return f"assigns {', '.join(sorted(kinds))}" if len(kinds) > 1 else None


def docstring(node: ast.AST) -> str | None:
    """Return the docstring of a node that can have one."""
    return ast.get_docstring(node) if isinstance(node, Documented) else None


def begins_with_what(node: ast.AST) -> str | None:
    """Object to docstrings, and to texts below a name, that begin with "What"."""
    text = docstring(node)
    if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
        text = node.value.value if isinstance(node.value.value, str) else None
    return text[:60] if text and re.match(r"What\b", text.strip()) else None


def names_an_option(node: ast.AST) -> str | None:
    """Object to texts with an option of the command line."""
    if not isinstance(node, ast.Constant):
        return None
    found = re.search(r"(?<![\w-])--[a-z][\w-]*", str(node.value))
    return f"names {found[0]}" if found else None


def says_little(node: ast.AST) -> str | None:
    """Object to docstrings of four words or fewer."""
    text = docstring(node)
    return text if text is not None and len(text.split()) <= 4 else None


def standard_gravity(node: ast.AST) -> str | None:
    """Object to 9.80665 in any power of ten, which ``units.standard_gravity`` has."""
    is_number = isinstance(node, ast.Constant) and isinstance(node.value, float)
    digits = f"{node.value:.6e}".partition("e")[0] if is_number else ""
    return "stands in units.standard_gravity" if digits == "9.806650" else None


def undocumented(node: ast.AST) -> str | None:
    """Object to modules and classes with public members without a docstring."""
    if not isinstance(node, ast.Module | ast.ClassDef):
        return None
    members = [child for child in node.body if isinstance(child, ast.ClassDef | Function)]
    silent = [m.name for m in members if not m.name.startswith("_") and docstring(m) is None]
    return f"has no docstring of {', '.join(silent)}" if silent else None


def leaves_a_folder(node: ast.AST) -> str | None:
    """Object to temporary folders that stay when their process is killed."""
    if not isinstance(node, ast.Attribute | ast.Name):
        return None
    name = node.attr if isinstance(node, ast.Attribute) else node.id
    return "is not TemporaryFolder" if name == "TemporaryDirectory" else None


def two_meanings() -> list[Breach]:
    """Return public classes and aliases whose name is defined in more than one module."""
    places = defaultdict(list)
    for file, tree in sources().items():
        for node in tree.body:
            name = meaning(node)
            if name and not name.startswith("_"):
                places[name].append(Breach(file, name, node.lineno))
    return [breach for found in places.values() if len(found) > 1 for breach in found]


def meaning(node: ast.stmt) -> str | None:
    """Return the name of a class, or of an alias of a type, that a statement defines."""
    if isinstance(node, ast.ClassDef):
        return node.name
    if isinstance(node, ast.Assign) and isinstance(node.value, ast.Subscript | ast.BinOp):
        (target, *_) = node.targets
        camel = isinstance(target, ast.Name) and re.fullmatch(r"[A-Z][a-z]\w*", target.id)
        return target.id if camel and isinstance(target, ast.Name) else None
    return None
