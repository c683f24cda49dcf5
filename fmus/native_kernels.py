"""Kernels as object code without Python, in a process of its own: numba compiles for one processor per process.

``python -m fmus.native_kernels < order.json`` writes ``PLATFORM.o`` into the working directory: the functions
``rockshed_initialise``, ``rockshed_evaluate`` and ``rockshed_step`` over plain pointers. It prints the problems it found as a JSON
list of texts.

Numba's own calling convention is wrapped, so no function of Python is needed; what a kernel needs besides is checked against a list
of functions that every C library has.
"""

import importlib
import json
import os
import re
import sys
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import llvmlite.binding as llvm
from llvmlite import ir
from llvmlite.binding import Linkage
from numba import njit, typeof, types
from numba.core.errors import NumbaError

import components
from components.component import Component, Instance

TRIPLES = {"linux64": "x86_64-unknown-linux-gnu", "win64": "x86_64-w64-windows-gnu", "darwin64": "x86_64-apple-macosx11.0"}
"""What LLVM calls the platforms of FMI."""

ENTRIES = {name: f"rockshed_{name}" for name in ("initialise", "evaluate", "step")}
"""Names of the C functions by kernel."""

ALLOWED = frozenset(re.findall(r"\w+", """
    acos acosh asin asinh atan atan2 atanh cbrt ceil copysign cos cosh erf erfc exp exp2 expm1 fabs floor fma fmax fmin fmod frexp
    hypot ldexp lgamma log log10 log1p log2 nearbyint pow rint round sin sinh sqrt tan tanh tgamma trunc
    memcpy memmove memset"""))
"""Functions of the C library that kernels may call. Anything else would be Python's or numba's."""


def main() -> None:
    """Carry out the order on standard input."""
    order = json.load(sys.stdin)
    component = load(Path(order["folder"]))
    instance = component.instance(**order["sizes"])
    try:
        module = linked(component, instance)
        problems = [f"{name}, {place}" for name in foreign_symbols(module) for place in places(module, name)]
    except NumbaError as error:
        problems = [told(error)]
    if not problems:
        llvm.initialize_all_targets()
        llvm.initialize_all_asmprinters()
        for platform in order["platforms"]:
            Path(f"{platform}.o").write_bytes(emitted(module, TRIPLES[platform], order["cpu"]))
    json.dump(problems, sys.stdout)


def load(folder: Path) -> Component:
    """The component of a folder, imported as if it lay among the others."""
    components.__path__.insert(0, str(folder.parent))
    component = importlib.import_module(f"{components.__name__}.{folder.name}").COMPONENT
    assert isinstance(component, Component)
    return component


def linked(component: Component, instance: Instance) -> Any:
    """All kernels with everything that they call, as one LLVM module that shows the three entries only.

    Raises:
        NumbaError: a kernel cannot be compiled without Python.
    """
    buffers = tuple(map(typeof, (instance.w, instance.x, instance.k)))
    lengths = [len(instance.w), len(instance.x), len(instance.k)]
    whole = llvm.parse_assembly("")
    for name, entry in ENTRIES.items():
        signature = (types.float64, types.float64, *buffers) if name == "step" else buffers
        caller = njit(error_model="numpy", _nrt=False, no_cpython_wrapper=True, no_cfunc_wrapper=True)(_caller(component, name))
        caller.compile(signature)
        compiled = caller.overloads[signature]
        whole.link_in(llvm.parse_assembly(compiled.library.get_llvm_str()))
        whole.link_in(llvm.parse_assembly(str(entry_module(entry, compiled, lengths))))
    return shown_only(whole, ENTRIES.values())


def _caller(component: Component, name: str) -> Callable[..., int]:
    """A function that calls a kernel: what numba has in its cache can be linked, but not looked at."""
    kernel = getattr(component, name)
    if name == "step":
        return lambda t, h, w, x, k: kernel(t, h, w, x, k)
    return lambda w, x, k: kernel(w, x, k)


def entry_module(entry: str, compiled: Any, lengths: list[int]) -> ir.Module:
    """A C function ``int64 entry([double t, double h,] double *w, double *x, int64 *k)`` around a compiled kernel.

    It returns what the kernel returns, or the negative status of numba's calling convention if the kernel raises an exception.
    """
    module = ir.Module()
    descriptor, convention = compiled.fndesc, compiled.target_context.call_conv
    callee = ir.Function(module, convention.get_function_type(descriptor.restype, descriptor.argtypes), descriptor.llvm_func_name)
    times = [ir.DoubleType()] * (len(descriptor.argtypes) - len(lengths))
    integer, pointer = ir.IntType(64), ir.IntType(8).as_pointer()
    function = ir.Function(module, ir.FunctionType(integer, [*times, pointer, pointer, pointer]), entry)
    builder = ir.IRBuilder(function.append_basic_block())
    kinds = iter(callee.function_type.args)
    result = builder.alloca(next(kinds).pointee)
    arguments = [result, builder.alloca(next(kinds).pointee)]
    arguments += [given for given, _ in zip(function.args, times) if next(kinds)]
    for given, length in zip(function.args[len(times):], lengths):
        # owner, parent, number of elements, bytes of an element, data, shape, strides
        parts = [None, None, integer(length), integer(8), given, integer(length), integer(8)]
        arguments += [_as(builder, part, kind) for part, kind in zip(parts, kinds_of_array(kinds))]
    status = builder.call(callee, arguments)
    raised = builder.icmp_signed("!=", status, status.type(0))
    builder.ret(builder.select(raised, builder.sub(integer(0), builder.sext(status, integer)), builder.load(result)))
    return module


def kinds_of_array(kinds: Iterator[Any]) -> list[Any]:
    """The types of the next seven arguments, into which numba takes an array apart."""
    return [next(kinds) for _ in range(7)]


def _as(builder: ir.IRBuilder, value: Any, kind: Any) -> Any:
    if value is None:
        return kind(None)
    return builder.bitcast(value, kind) if isinstance(kind, ir.PointerType) else value


def shown_only(module: Any, names: Any) -> Any:
    """The module without what these functions do not need; nothing of it is visible outside the library."""
    for function in module.functions:
        if not function.is_declaration:
            function.linkage = "external" if function.name in names else "internal"
            if function.name in names:
                function.visibility = "hidden"
    for variable in module.global_variables:
        if not variable.is_declaration:
            variable.linkage = "internal"
    passes = llvm.create_new_module_pass_manager()
    passes.add_global_dead_code_eliminate_pass()
    machine = llvm.Target.from_triple(module.triple).create_target_machine()
    passes.run(module, llvm.create_pass_builder(machine, llvm.create_pipeline_tuning_options()))
    for number, function in enumerate(module.functions):
        if function.linkage == Linkage.internal:
            function.name = f"kernel_{number}"  # numba's own names change from build to build
    return module


def foreign_symbols(module: Any) -> list[str]:
    """What the module needs from outside and may not."""
    needed = [f.name for f in module.functions if f.is_declaration and not f.name.startswith("llvm.")]
    needed += [v.name for v in module.global_variables if v.is_declaration]
    return sorted(name for name in needed if name not in ALLOWED)


def places(module: Any, symbol: str) -> list[str]:
    """Where a symbol is used, as ``file, line n``; needs debug information in the module."""
    text = str(module)
    nodes = dict(re.findall(r"^(!\d+) = (.*)$", text, re.MULTILINE))
    used = re.findall(rf'^.*@"?{re.escape(symbol)}"?[ (,].*, !dbg (!\d+)', text, re.MULTILINE)
    return sorted({_place(nodes, node) for node in used}) or ["somewhere"]


def _place(nodes: Mapping[str, str], node: str) -> str:
    line = _field(nodes[node], "line")
    while "DILocation" in nodes[node] or "DILexicalBlock" in nodes[node]:
        node = _field(nodes[node], "scope")
    file = nodes[_field(nodes[node], "file")]
    return f"{os.path.join(_field(file, 'directory'), _field(file, 'filename'))}, line {line}"


def _field(node: str, name: str) -> str:
    found = re.search(rf'\b{name}: (?:"([^"]*)"|([^,)]+))', node)
    return (found.group(1) or found.group(2)) if found else "?"


def told(error: NumbaError) -> str:
    """What numba finds wrong, in one line with the place."""
    text = re.sub(r"\x1b\[[0-9;]*m", "", str(error))
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    place = re.findall(r'File "([^"]+)", line (\d+)', text)
    return f"{lines[1] if len(lines) > 1 and lines[0].startswith('Failed in') else lines[0]}" + (
        f", {place[-1][0]}, line {place[-1][1]}" if place else "")


def emitted(module: Any, triple: str, cpu: str) -> bytes:
    """Object code of a module for a platform."""
    machine = llvm.Target.from_triple(triple).create_target_machine(cpu=cpu, features="", opt=3, reloc="pic", codemodel="default")
    copy = module.clone()
    copy.triple = triple
    copy.data_layout = str(machine.target_data)
    code = machine.emit_object(copy)
    assert isinstance(code, bytes)
    return code


if __name__ == "__main__":
    main()
