"""Kernels as object code for WebAssembly, in a process of its own.

``python -m rockshed.fmus.wasm.kernels < order.json`` writes ``VARIANT.o``, or assembly,
``VARIANT.s``, into the working directory for those of :data:`VARIANTS` that are asked for, and
prints the problems as a JSON list of texts. The code that numba makes is the one of native FMUs;
vectors are cut to what WebAssembly has, and fused multiply-adds become what :mod:`.fused` writes.
"""

import json
import re
import sys
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

import llvmlite.binding as llvm
from llvmlite import ir
from numba import njit, types

from rockshed.components.common.component import Instance

from ..native.kernels import (
    ENTRIES,
    compile_problems,
    described,
    linked,
    ordered,
    shown_only,
    signatures,
)
from ..native.subset import symbol_problems
from .fused import RELAXED, define_fused, define_relaxed, define_sum
from .places import kept_places

_TRIPLE = "wasm32-unknown-unknown"
_FUSED = re.compile(r"@llvm\.fma\.v(\d+)f64\(")
_FUSED_DECLARED = re.compile(r"^declare .*@llvm\.fma\.v\d+f64\(.*$", re.MULTILINE)
_UNIT = r"-?(?:0\.0+|1\.0+)e\+00"
_SUM = re.compile(
    r"@llvm\.fma\.v(\d+)f64\((<\d+ x double> [^,]+, <\d+ x double> "
    rf"(?:<(?:double {_UNIT}(?:, )?)+>|splat \(double {_UNIT}\)),)"
)
"""A multiply-add one of whose factors is 1, -1 or 0 in each lane: its product is exact."""
_THREADS = re.compile(r"@pthread_(create|join)\b")
"""Renamed, as a library that has them for WebAssembly declares them otherwise."""
_RELAXED_CALL = re.compile(rf"\bcall\t{RELAXED}\b")
_RELAXED_CODE = "f64x2.relaxed_madd"
_RELAXED_KIND = re.compile(rf"^\t\.functype\t{RELAXED} .*\n", re.MULTILINE)
"""Declaration of the function that is called nowhere in the end."""
_EXACT = "exact_fma"
"""Function of three numbers in ``fma.h``."""
_SINGLE = re.compile(r"@llvm\.fma\.f64\b")


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
    "relaxed": Variant("+simd128", 2, define_relaxed),
}
"""plain: WebAssembly of 2019. simd: vectors of two numbers. relaxed: besides, a multiply-add that
rounds once on some processors and twice on others; a host may use it only after it has looked."""


def main() -> None:
    """Carry out the order on standard input."""
    order = json.load(sys.stdin)
    component, instance = ordered(order)
    folder = component.folder
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
            write_code(code, name, order["tables"], Path())
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


def write_code(code: str, name: str, tables: Iterable[str], folder: Path) -> None:
    """Compile a module, and write its object code or, with relaxed vectors, assembly.

    Parameters
    ----------
    code : str
        The module as LLVM writes it, for pointers of any size.
    name : str
        Key of :data:`VARIANTS`; the file is ``NAME.o`` or ``NAME.s``.
    tables : iterable of str
        Names of the entries besides those of all components.
    folder : Path
        Where the file goes.
    """
    variant = VARIANTS[name]
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
    if variant.define is define_relaxed:
        text = _RELAXED_CALL.sub(_RELAXED_CODE, machine.emit_assembly(module))
        (folder / f"{name}.s").write_text(_RELAXED_KIND.sub("", text))
    else:
        (folder / f"{name}.o").write_bytes(machine.emit_object(module))


def _with_fused(code: str, variant: Variant) -> Any:
    """Return the module with functions of :mod:`.fused` and of the runtime in it."""
    own, sums = _SUM.subn(r"@sum_\1(\2", _FUSED_DECLARED.sub("", code))
    widths = sorted({int(width) for width in _FUSED.findall(own)})
    exact = sorted({int(width) for width in re.findall(r"@sum_(\d+)\(", own)}) if sums else []
    own = _SINGLE.sub(f"@{_EXACT}", _FUSED.sub(r"@fused_\1(", own))
    own = _THREADS.sub(r"@thread_\1", own)
    declared = [
        f"declare {kind} @{name}_{n}({kind}, {kind}, {kind})"
        for name, all_of_them in (("fused", widths), ("sum", exact))
        for n in all_of_them
        for kind in [f"<{n} x double>"]
    ]
    module = llvm.parse_assembly("\n".join([own, *declared]))
    extra = ir.Module()
    for width in widths:
        variant.define(extra, f"fused_{width}", width, _EXACT, variant.together)
    for width in exact:
        define_sum(extra, f"sum_{width}", width)
    module.link_in(llvm.parse_assembly(str(extra)))
    return module


if __name__ == "__main__":
    main()
