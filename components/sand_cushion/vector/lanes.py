"""Arithmetic on several numbers at once: formulas that read like those of single numbers, written out as vector instructions.

:class:`Lanes` stands for a vector of float64 while a function is being compiled (inside a numba intrinsic). Every operation is
rounded as the same operation on single numbers is, and :func:`fma` rounds once on every processor, so the results have the same
bits whatever the width of the processor's vectors: the compiler cuts 8 lanes to 8, 4 or 2.
"""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils

REAL, INDEX, WORD = ir.DoubleType(), ir.IntType(64), ir.IntType(32)


class Lanes:
    """A vector of float64, with the arithmetic of a number. Comparisons give a mask for :func:`where`."""

    def __init__(self, builder: ir.IRBuilder, value: ir.Value) -> None:
        self.builder, self.value = builder, value

    def made(self, value: ir.Value) -> Lanes:
        """Another vector at the same place of the program."""
        return Lanes(self.builder, value)

    def like(self, other: Lanes | float) -> ir.Value:
        """A number in every lane, as wide as this; a vector as it is."""
        return (
            other.value
            if isinstance(other, Lanes)
            else constant([float(other)] * self.value.type.count)
        )

    def __add__(self, other: Lanes | float) -> Lanes:
        return self.made(self.builder.fadd(self.value, self.like(other)))

    def __sub__(self, other: Lanes | float) -> Lanes:
        return self.made(self.builder.fsub(self.value, self.like(other)))

    def __mul__(self, other: Lanes | float) -> Lanes:
        return self.made(self.builder.fmul(self.value, self.like(other)))

    __radd__, __rmul__ = __add__, __mul__

    def __rtruediv__(self, other: float) -> Lanes:
        return self.made(self.builder.fdiv(self.like(other), self.value))

    def __rsub__(self, other: float) -> Lanes:
        return self.made(self.builder.fsub(self.like(other), self.value))

    def __neg__(self) -> Lanes:
        return self.made(self.builder.fneg(self.value))

    def __gt__(self, other: Lanes | float) -> Lanes:
        return self.made(self.builder.fcmp_ordered(">", self.value, self.like(other)))

    def shuffled(self, places: list[int], other: Lanes | None = None) -> Lanes:
        """Numbers of this vector and behind them those of another, in this order."""
        second = self.value if other is None else other.value
        return self.made(self.builder.shuffle_vector(self.value, second, constant(places, WORD)))


def constant(values: list[Any], kind: ir.Type = REAL) -> ir.Constant:
    """A vector that is known when compiling."""
    return ir.Constant(
        ir.VectorType(kind, len(values)), [ir.Constant(kind, value) for value in values]
    )


def spread(builder: ir.IRBuilder, number: ir.Value, width: int) -> Lanes:
    """A number in every lane."""
    empty = ir.Constant(ir.VectorType(REAL, width), ir.Undefined)
    return Lanes(builder, builder.insert_element(empty, number, WORD(0))).shuffled([0] * width)


def where(mask: Lanes, yes: Lanes | float, no: Lanes | float) -> Lanes:
    """Lane by lane, one of two."""
    vector = yes if isinstance(yes, Lanes) else no
    assert isinstance(vector, Lanes)
    return vector.made(mask.builder.select(mask.value, vector.like(yes), vector.like(no)))


def larger(one: Lanes, other: Lanes | float) -> Lanes:
    """Lane by lane, the larger of two."""
    return where(one > other, one, other)


def smaller(one: Lanes, other: Lanes | float) -> Lanes:
    """Lane by lane, the smaller of two."""
    return where(one > other, other, one)


def sqrt(number: Lanes) -> Lanes:
    """Square root."""
    return _intrinsic("sqrt", number)


def fma(one: Lanes, other: Lanes, added: Lanes) -> Lanes:
    """one * other + added, rounded once."""
    return _intrinsic("fma", one, other, added)


def _intrinsic(name: str, *arguments: Lanes) -> Lanes:
    builder, kind = arguments[0].builder, arguments[0].value.type
    function = cgutils.get_or_insert_function(
        builder.module,
        ir.FunctionType(kind, [kind] * len(arguments)),
        f"llvm.{name}.v{kind.count}f64",
    )
    return Lanes(builder, builder.call(function, [argument.value for argument in arguments]))


class Access:
    """Loads and stores at places of the numba arrays that an intrinsic got; other arguments as they are."""

    def __init__(
        self, context: Any, builder: ir.IRBuilder, signature: Any, arguments: list[Any]
    ) -> None:
        self.builder = builder
        self._data = [
            context.make_array(kind)(context, builder, value).data
            if isinstance(kind, types.Array)
            else value
            for kind, value in zip(signature.args, arguments)
        ]

    def __getitem__(self, argument: int) -> Any:
        return self._data[argument]

    def place(self, begin: ir.Value, number: int) -> ir.Value:
        """``number`` elements behind ``begin``."""
        return self.builder.add(begin, INDEX(number))

    def pointer(self, argument: int, place: ir.Value | int, kind: ir.Type) -> ir.Value:
        """Address of an element, for access as another type."""
        at = place if isinstance(place, ir.Value) else INDEX(place)
        return self.builder.bitcast(self.builder.gep(self._data[argument], [at]), kind.as_pointer())

    def number(self, argument: int, place: ir.Value | int) -> ir.Value:
        """A number out of a float array."""
        return self.builder.load(self.pointer(argument, place, REAL))

    def load(self, argument: int, place: ir.Value | int, width: int) -> Lanes:
        """A vector out of a float array."""
        return self.loaded(self.pointer(argument, place, REAL), width)

    def store(self, lanes: Lanes, argument: int, place: ir.Value | int) -> None:
        """A vector into a float array."""
        self.put(lanes, self.pointer(argument, place, REAL))

    def loaded(self, address: ir.Value, width: int) -> Lanes:
        """A vector from an address."""
        kind = ir.VectorType(REAL, width).as_pointer()
        return Lanes(self.builder, self.builder.load(self.builder.bitcast(address, kind), align=8))

    def put(self, lanes: Lanes, address: ir.Value) -> None:
        """A vector to an address."""
        self.builder.store(
            lanes.value, self.builder.bitcast(address, lanes.value.type.as_pointer()), align=8
        )

    def running(self, argument: int, place: int, width: int) -> Running:
        """A running value that begins with what an array holds; see :meth:`Running.keep`."""
        return Running(self, argument, place, self.load(argument, place, width))


class Running:
    """A vector that changes from round to round of a loop, held in a register."""

    def __init__(self, access: Access, argument: int, place: int, start: Lanes) -> None:
        self._access, self._argument, self._place = access, argument, place
        self._cell = cgutils.alloca_once_value(access.builder, start.value)

    @property
    def now(self) -> Lanes:
        """Its present value."""
        return Lanes(self._access.builder, self._access.builder.load(self._cell))

    def become(self, lanes: Lanes) -> None:
        """Change it."""
        self._access.builder.store(lanes.value, self._cell)

    def keep(self) -> None:
        """Behind the loop: put it back into the array."""
        self._access.store(self.now, self._argument, self._place)
