"""Kernels as object code without Python, in a process of its own.

Numba compiles for one processor per process.
``python -m rockshed.fmus.native.kernels < order.json`` writes ``PLATFORM.o`` into the working
directory: the functions ``rockshed_initialise``, ``rockshed_evaluate`` and ``rockshed_step`` over
plain pointers. It prints the problems as a JSON list of texts.

Numba's own calling convention is wrapped, so no function of Python is needed; what a kernel needs
besides is checked against a list of functions that every C library has.
"""

import json
import re
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import llvmlite.binding as llvm
from llvmlite import ir
from llvmlite.binding import Linkage
from numba import njit, typeof, types
from numba.core.errors import NumbaError

from rockshed import components
from rockshed.components.catalogue import load
from rockshed.components.common.component import Component, Instance

from .subset import error_problem, symbol_problems

_OF_PROCESSOR = re.compile(r'"(?:target-cpu|target-features|tune-cpu)"="[^"]*" ?')
"""Attributes of functions that name the processor for which numba has compiled."""
ENTRIES = {name: f"rockshed_{name}" for name in ("initialise", "evaluate", "step")}
"""Names of the C functions by kernel."""


def main() -> None:
    """Carry out the order on standard input."""
    order = json.load(sys.stdin)
    component, instance = ordered(order)
    folder = component.folder
    problems = compile_problems(component, signatures(instance), folder)
    if not problems:
        module = linked(component, instance)
        problems = symbol_problems(module, folder)
    if not problems:
        llvm.initialize_all_targets()
        llvm.initialize_all_asmprinters()
        for platform, target in order["targets"].items():
            _write(Path(f"{platform}.o"), emitted(module, *target))
    json.dump(problems, sys.stdout)


def ordered(order: Mapping[str, Any]) -> tuple[Component, Instance]:
    """Return the component that an order is for, and an instance of it.

    Who orders has read the sources before. Where the variables have changed since, description and
    binary would mean different ones by a number: then this process ends with the reason.

    Parameters
    ----------
    order : mapping
        With ``folder``, ``sizes`` and ``kind`` of an instance.

    Returns
    -------
    tuple of Component and Instance
    """
    folder = Path(order["folder"])
    component = load(folder, f"{components.__name__}.{folder.name}")
    instance = component.instance(**order["sizes"])
    if instance.kind.hex() != order["kind"]:
        sys.exit(
            f"the variables declared in {folder} are not those with which this program was "
            "started. Remedy: start it again"
        )
    return component, instance


def _write(file: Path, content: bytes) -> None:
    """Write a file, or end with the reason in words: a full disk, for instance."""
    try:
        file.write_bytes(content)
    except OSError as error:
        sys.exit(f"{file.absolute()} cannot be written: {error.strerror or error}")


def signatures(instance: Instance) -> dict[str, tuple[Any, ...]]:
    """Return the types of the arguments of each kernel.

    Parameters
    ----------
    instance : Instance
        Of the component.

    Returns
    -------
    dict of str to tuple
        Types of numba by the name of the kernel.
    """
    buffers = tuple(map(typeof, (instance.w, instance.x, instance.k)))
    return {
        "initialise": buffers,
        "evaluate": buffers,
        "step": (types.float64, types.float64, *buffers),
    }


def compile_problems(
    component: Component, kinds: Mapping[str, tuple[Any, ...]], folder: Path
) -> list[str]:
    """Return what keeps kernels from being compiled at all, with lines of the sources.

    Parameters
    ----------
    component : Component
        The component.
    kinds : mapping of str to tuple
        Of :func:`signatures`.
    folder : Path
        The component's folder.

    Returns
    -------
    list of str
        A reason for each kernel that fails.
    """
    problems = []
    for name, signature in kinds.items():
        kernel: Any = getattr(component, name)
        try:
            kernel.compile(signature)
        except NumbaError as error:
            problems.append(error_problem(error, name, kernel, folder))
    return problems


def linked(component: Component, instance: Instance, any_size: bool = False) -> Any:
    """Return all kernels with everything that they call, as one LLVM module.

    Parameters
    ----------
    component : Component
        The component.
    instance : Instance
        Of this component; its buffers have the lengths of the FMU's.
    any_size : bool
        Whether the entries take the lengths of the buffers as further parameters.

    Returns
    -------
    llvmlite.binding.ModuleRef
        A module that shows the three entries only.
    """
    lengths = None if any_size else [len(instance.w), len(instance.x), len(instance.k)]
    whole = llvm.parse_assembly("")
    for name, signature in signatures(instance).items():
        caller = njit(
            error_model="numpy", _nrt=False, no_cpython_wrapper=True, no_cfunc_wrapper=True
        )(_caller(component, name))
        caller.compile(signature)
        compiled = caller.overloads[signature]
        whole.link_in(llvm.parse_assembly(compiled.library.get_llvm_str()))
        whole.link_in(llvm.parse_assembly(str(entry_module(ENTRIES[name], compiled, lengths))))
    return shown_only(whole, ENTRIES.values())


def _caller(component: Component, name: str) -> Callable[..., int]:
    """Return a function that calls a kernel.

    What numba has in its cache can be linked, but not looked at.
    """
    kernel = getattr(component, name)
    if name == "step":
        return lambda t, h, w, x, k: kernel(t, h, w, x, k)
    return lambda w, x, k: kernel(w, x, k)


def entry_module(entry: str, compiled: Any, lengths: list[int] | None) -> ir.Module:
    """Return a C function around a compiled kernel, in a module of its own.

    It is ``int64 entry([double t, double h,] double *w, double *x, int64 *k)`` and returns what the
    kernel returns, or the negative status of numba's calling convention if the kernel raises an
    exception. Without lengths three parameters follow, ``int64 nw, int64 nx, int64 nk``.

    Parameters
    ----------
    entry : str
        Name of the function.
    compiled : numba.core.compiler.CompileResult
        The kernel.
    lengths : list of int or None
        Numbers of elements of ``w``, ``x`` and ``k``; None for those that the caller gives.

    Returns
    -------
    llvmlite.ir.Module
        The module.
    """
    module = ir.Module()
    descriptor, convention = compiled.fndesc, compiled.target_context.call_conv
    callee = ir.Function(
        module,
        convention.get_function_type(descriptor.restype, descriptor.argtypes),
        descriptor.llvm_func_name,
    )
    integer, pointer = ir.IntType(64), ir.IntType(8).as_pointer()
    times = [ir.DoubleType()] * (len(descriptor.argtypes) - 3)
    told = [integer] * 3 if lengths is None else []
    function = ir.Function(
        module, ir.FunctionType(integer, [*times, pointer, pointer, pointer, *told]), entry
    )
    given = function.args[len(times) + 3 :] if lengths is None else map(integer, lengths)
    builder = ir.IRBuilder(function.append_basic_block())
    kinds = callee.function_type.args
    arguments = [
        builder.alloca(kinds[0].pointee),
        builder.alloca(kinds[1].pointee),
        *function.args[: len(times)],
    ]
    for buffer, length in zip(function.args[len(times) : len(times) + 3], given):
        arguments += described(builder, kinds[len(arguments) :], buffer, [length])
    status = builder.call(callee, arguments)
    raised = builder.icmp_signed("!=", status, status.type(0))
    negative = builder.sub(integer(0), builder.sext(status, integer))
    builder.ret(builder.select(raised, negative, builder.load(arguments[0])))
    return module


def described(
    builder: ir.IRBuilder, kinds: Sequence[Any], buffer: ir.Value, shape: Sequence[ir.Value]
) -> list[ir.Value]:
    """Return an array of numbers of 8 bytes as numba hands it over.

    Parameters
    ----------
    builder : llvmlite.ir.IRBuilder
        Where the call is written.
    kinds : sequence of llvmlite.ir.Type
        Types of the arguments from the first of this array on.
    buffer : llvmlite.ir.Value
        Address of its first number.
    shape : sequence of llvmlite.ir.Value
        Its lengths; the last one is that of numbers which follow each other.

    Returns
    -------
    list of llvmlite.ir.Value
        Owner, parent, number of elements, bytes of an element, data, shape, strides.
    """
    eight = ir.IntType(64)(8)
    items = shape[-1]
    strides = [eight]
    for longer, length in zip(reversed(shape[:-1]), reversed(shape[1:])):
        strides.insert(0, builder.mul(strides[0], length))
        items = builder.mul(items, longer)
    data = builder.bitcast(buffer, kinds[4])
    return [kinds[0](None), kinds[1](None), items, eight, data, *shape, *strides]


def shown_only(module: Any, names: Iterable[str]) -> Any:
    """Take out of a module what some functions do not need, and hide all else outside the library.

    Parameters
    ----------
    module : llvmlite.binding.ModuleRef
        The module, which is changed.
    names : iterable of str
        The functions.

    Returns
    -------
    llvmlite.binding.ModuleRef
        The module.
    """
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


def emitted(module: Any, triple: str, cpu: str) -> bytes:
    """Return the object code of a module for a platform.

    Parameters
    ----------
    module : llvmlite.binding.ModuleRef
        The module, which stays as it is.
    triple : str
        LLVM's name of the platform.
    cpu : str
        LLVM's name of the processor.

    Returns
    -------
    bytes
        An object file.
    """
    machine = llvm.Target.from_triple(triple).create_target_machine(
        cpu=cpu, features="", opt=3, reloc="pic", codemodel="default"
    )
    copy = llvm.parse_assembly(_OF_PROCESSOR.sub("", str(module)))
    copy.triple = triple
    copy.data_layout = str(machine.target_data)
    code = machine.emit_object(copy)
    assert isinstance(code, bytes)
    return code


if __name__ == "__main__":
    main()
