"""Kernels as object code for WebAssembly, in a process of its own.

``python -m rockshed.fmus.wasm.kernels < order.json`` writes ``VARIANT.o`` into the working
directory for those of :data:`VARIANTS` that are asked for, and prints the problems as a JSON list
of texts. The code that numba makes is the one of native FMUs; vectors are cut to what WebAssembly
has, and fused multiply-adds become what :mod:`.fused` writes.
"""

import json
import re
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

import llvmlite.binding as llvm
from llvmlite import ir
from numba import njit, types

from rockshed import components
from rockshed.components.catalogue import load
from rockshed.components.common.component import Instance

from ..native.kernels import (
    ENTRIES,
    compile_problems,
    described,
    linked,
    shown_only,
    signatures,
)
from ..native.subset import symbol_problems
from .fused import define_fused, define_relaxed
from .places import kept_places

_TRIPLE = "wasm32-unknown-unknown"
_FUSED = re.compile(r"@llvm\.fma\.v(\d+)f64\(")
_FUSED_DECLARED = re.compile(r"^declare .*@llvm\.fma\.v\d+f64\(.*$", re.MULTILINE)
_THREADS = re.compile(r"@pthread_(create|join)\b")
"""Renamed, as a library that has them for WebAssembly declares them otherwise."""
_EXACT = "fma"
"""Function of three numbers that the linker takes from its own library."""


@dataclass(frozen=True)
class Variant:
    """Code for hosts that can do more or less.

    Parameters
    ----------
    features : str
        What LLVM calls it.
    together : int
        Numbers in a register of the host.
    define : callable
        Writes the fused multiply-add.
    """

    features: str
    together: int
    define: Callable[[ir.Module, str, int, str, int], None]


VARIANTS: Mapping[str, Variant] = {
    "plain": Variant("", 1, define_fused),
    "simd": Variant("+simd128", 2, define_fused),
    "relaxed": Variant("+simd128,+relaxed-simd", 2, define_relaxed),
}
"""plain: WebAssembly of 2019. simd: vectors of two numbers. relaxed: besides, a multiply-add that
rounds once on some processors and twice on others; a host may use it only after it has looked."""


def main() -> None:
    """Carry out the order on standard input."""
    order = json.load(sys.stdin)
    folder = Path(order["folder"])
    component = load(folder, f"{components.__name__}.{folder.name}")
    instance = component.instance()
    problems = compile_problems(component, signatures(instance), folder)
    if not problems:
        module = linked(component, instance, any_size=True)
        for name, (place, columns) in order["tables"].items():
            module.link_in(_table_module(name, _named(place), columns, instance))
        shown_only(module, (*ENTRIES.values(), *order["tables"]))
        problems = symbol_problems(module, folder)
    if not problems:
        llvm.initialize_all_targets()
        llvm.initialize_all_asmprinters()
        code = kept_places(str(module))
        for name in order["variants"]:
            Path(f"{name}.o").write_bytes(emitted(code, VARIANTS[name], order["tables"]))
    json.dump(problems, sys.stdout)


def _named(place: str) -> Any:
    """Return the kernel that ``module:name`` names."""
    module, _, name = place.partition(":")
    return getattr(import_module(module), name)


def _table_module(name: str, kernel: Any, columns: int, instance: Instance) -> Any:
    """Return ``int64 name(w, x, k, table, nw, nx, nk, rows)`` around a kernel, as LLVM module.

    The kernel writes rows into the table and returns their number.
    """
    kinds = (*signatures(instance)["evaluate"], types.Array(types.float64, 2, "C"))
    caller = njit(error_model="numpy", _nrt=False, no_cpython_wrapper=True, no_cfunc_wrapper=True)(
        lambda w, x, k, table: kernel(w, x, k, table)
    )
    caller.compile(kinds)
    compiled = caller.overloads[kinds]
    convention, descriptor = compiled.target_context.call_conv, compiled.fndesc
    made, integer, pointer = ir.Module(), ir.IntType(64), ir.IntType(8).as_pointer()
    kind = convention.get_function_type(descriptor.restype, descriptor.argtypes)
    callee = ir.Function(made, kind, descriptor.llvm_func_name)
    entry = ir.Function(made, ir.FunctionType(integer, [pointer] * 4 + [integer] * 4), name)
    builder = ir.IRBuilder(entry.append_basic_block())
    wanted = kind.args
    arguments = [builder.alloca(wanted[0].pointee), builder.alloca(wanted[1].pointee)]
    for number, buffer in enumerate(entry.args[:4]):
        shape = [entry.args[4 + number]] + ([integer(columns)] if number == 3 else [])
        arguments += described(builder, wanted[len(arguments) :], buffer, shape)
    builder.call(callee, arguments)
    builder.ret(builder.load(arguments[0]))
    whole = llvm.parse_assembly(compiled.library.get_llvm_str())
    whole.link_in(llvm.parse_assembly(str(made)))
    return whole


def emitted(code: str, variant: Variant, tables: Mapping[str, Any]) -> bytes:
    """Return the object code of a module.

    Parameters
    ----------
    code : str
        The module as LLVM writes it, for pointers of any size.
    variant : Variant
        What the host can do.
    tables : mapping
        Names of the entries besides those of all components.

    Returns
    -------
    bytes
        An object file.
    """
    machine = llvm.Target.from_triple(_TRIPLE).create_target_machine(
        features=variant.features, opt=3, reloc="static", codemodel="default"
    )
    module = _with_fused(code, variant)
    module.triple = _TRIPLE
    module.data_layout = str(machine.target_data)
    shown_only(module, (*ENTRIES.values(), *tables))
    options = llvm.create_pipeline_tuning_options(speed_level=2)
    options.loop_unrolling = False
    passes = llvm.create_pass_builder(machine, options)
    passes.getModulePassManager().run(module, passes)
    result = machine.emit_object(module)
    assert isinstance(result, bytes)
    return result


def _with_fused(code: str, variant: Variant) -> Any:
    """Return the module with functions of :mod:`.fused` and of the runtime in it."""
    widths = sorted({int(width) for width in _FUSED.findall(code)})
    declared = [
        f"declare {kind} @fused_{n}({kind}, {kind}, {kind})"
        for n in widths
        for kind in [f"<{n} x double>"]
    ]
    own = _FUSED.sub(r"@fused_\1(", _FUSED_DECLARED.sub("", code))
    own = _THREADS.sub(r"@thread_\1", own)
    module = llvm.parse_assembly("\n".join([own, *declared]))
    if widths:
        extra = ir.Module()
        for width in widths:
            variant.define(extra, f"fused_{width}", width, _EXACT, variant.together)
        module.link_in(llvm.parse_assembly(str(extra)))
    return module


if __name__ == "__main__":
    main()
