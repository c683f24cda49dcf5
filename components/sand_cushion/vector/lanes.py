"""Arithmetic on several numbers at once: formulas of single numbers, as vector instructions.

:class:`Lanes` stands for a vector of float64 while a function is being compiled (inside a numba
intrinsic). Every operation is rounded as the same operation on single numbers is, and :func:`fused`
rounds once on every processor, so the results have the same bits whatever the width of the
processor's vectors: the compiler cuts 8 lanes to 8, 4 or 2.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils

from ..declarations import BLOCK, LANES

REAL, INDEX, WORD = ir.DoubleType(), ir.IntType(64), ir.IntType(32)


class Lanes:
    """A vector of float64 with the arithmetic of a number; comparisons give a mask."""

    def __init__(self, builder: ir.IRBuilder, value: ir.Value) -> None:
        self.builder, self.value = builder, value

    def made(self, value: ir.Value) -> Lanes:
        """Return another vector at the same place of the program."""
        return Lanes(self.builder, value)

    def like(self, other: Lanes | float) -> ir.Value:
        """Return a number in every lane, as wide as this vector; a vector as it is."""
        if isinstance(other, Lanes):
            return other.value
        return constant([float(other)] * self.value.type.count)

    def __add__(self, other: Lanes | float) -> Lanes:
        return self.made(self.builder.fadd(self.value, self.like(other)))

    def __sub__(self, other: Lanes | float) -> Lanes:
        return self.made(self.builder.fsub(self.value, self.like(other)))

    def __mul__(self, other: Lanes | float) -> Lanes:
        return self.made(self.builder.fmul(self.value, self.like(other)))

    __radd__, __rmul__ = __add__, __mul__

    def __truediv__(self, other: Lanes) -> Lanes:
        if isinstance(other, Divisor):
            return self * other.reciprocal
        return self.made(self.builder.fdiv(self.value, other.value))

    def __rtruediv__(self, other: float) -> Lanes:
        return self.made(self.builder.fdiv(self.like(other), self.value))

    def __rsub__(self, other: float) -> Lanes:
        return self.made(self.builder.fsub(self.like(other), self.value))

    def __neg__(self) -> Lanes:
        return self.made(self.builder.fneg(self.value))

    def __gt__(self, other: Lanes | float) -> Lanes:
        return self.made(self.builder.fcmp_ordered(">", self.value, self.like(other)))

    def selected(self, yes: Lanes | float, no: Lanes | float) -> Lanes:
        """Return one of two vectors, lane by lane; this vector is a mask."""
        vector = yes if isinstance(yes, Lanes) else no
        assert isinstance(vector, Lanes)
        chosen = self.builder.select(self.value, vector.like(yes), vector.like(no))
        return vector.made(chosen)

    def fused(self, other: Lanes, added: Lanes) -> Lanes:
        """Return this vector times another plus a third, rounded once."""
        return _intrinsic("fma", self, other, added)

    def shuffled(self, places: list[int], other: Lanes | None = None) -> Lanes:
        """Return some of the numbers of this vector and, behind them, of another.

        Parameters
        ----------
        places : list of int
            Which numbers; those of the other vector begin behind the last of this.
        other : Lanes, optional
            The other vector, this one by default.

        Returns
        -------
        Lanes
            The numbers in this order.
        """
        second = self.value if other is None else other.value
        return self.made(self.builder.shuffle_vector(self.value, second, constant(places, WORD)))


def constant(values: list[Any], kind: ir.Type = REAL) -> ir.Constant:
    """Return a vector that is known at compilation."""
    return ir.Constant(
        ir.VectorType(kind, len(values)), [ir.Constant(kind, value) for value in values]
    )


def spread(builder: ir.IRBuilder, number: ir.Value, width: int) -> Lanes:
    """Return a vector with a number in every lane."""
    empty = ir.Constant(ir.VectorType(REAL, width), ir.Undefined)
    return Lanes(builder, builder.insert_element(empty, number, WORD(0))).shuffled([0] * width)


class Divisor(Lanes):
    """A vector whose reciprocal is known: division by it multiplies with the reciprocal."""

    def __init__(self, lanes: Lanes, reciprocal: Lanes) -> None:
        super().__init__(lanes.builder, lanes.value)
        self.reciprocal = reciprocal


def divisor(lanes: Lanes) -> Divisor:
    """Return a vector together with its reciprocal: one division for all quotients."""
    return Divisor(lanes, 1.0 / lanes)


def divisors(one: Lanes, other: Lanes) -> tuple[Divisor, Divisor]:
    """Return two vectors together with their reciprocals, for the price of one division."""
    both = 1.0 / (one * other)
    return Divisor(one, both * other), Divisor(other, both * one)


def sqrt(number: Lanes) -> Lanes:
    """Return the square roots, lane by lane."""
    return _intrinsic("sqrt", number)


def _intrinsic(name: str, *arguments: Lanes) -> Lanes:
    builder, kind = arguments[0].builder, arguments[0].value.type
    function = cgutils.get_or_insert_function(
        builder.module,
        ir.FunctionType(kind, [kind] * len(arguments)),
        f"llvm.{name}.v{kind.count}f64",
    )
    return Lanes(builder, builder.call(function, [argument.value for argument in arguments]))


class Access:
    """Loads and stores in the arrays that are arguments of an intrinsic."""

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
        """Return the place ``number`` elements behind ``begin``."""
        return self.builder.add(begin, INDEX(number))

    def pointer(self, argument: int, place: ir.Value | int, kind: ir.Type) -> ir.Value:
        """Return the address of an element, for access as another type."""
        at = place if isinstance(place, ir.Value) else INDEX(place)
        return self.builder.bitcast(self.builder.gep(self._data[argument], [at]), kind.as_pointer())

    def number(self, argument: int, place: ir.Value | int) -> ir.Value:
        """Load a number from a float array."""
        return self.builder.load(self.pointer(argument, place, REAL))

    def load(self, argument: int, place: ir.Value | int, width: int) -> Lanes:
        """Load a vector from a float array."""
        return self.loaded(self.pointer(argument, place, REAL), width)

    def store(self, lanes: Lanes, argument: int, place: ir.Value | int) -> None:
        """Store a vector in a float array."""
        self.put(lanes, self.pointer(argument, place, REAL))

    def loaded(self, address: ir.Value, width: int) -> Lanes:
        """Load a vector from an address."""
        kind = ir.VectorType(REAL, width).as_pointer()
        return Lanes(self.builder, self.builder.load(self.builder.bitcast(address, kind), align=8))

    def put(self, lanes: Lanes, address: ir.Value) -> None:
        """Store a vector at an address."""
        self.builder.store(
            lanes.value, self.builder.bitcast(address, lanes.value.type.as_pointer()), align=8
        )

    @contextmanager
    def lanes_of_block(self) -> Iterator[ir.Value]:
        """Open a loop over a block, as many pairs at a time as a vector has lanes."""
        bounds = (INDEX(0), INDEX(BLOCK), INDEX(LANES))
        with cgutils.for_range_slice(self.builder, *bounds) as (lane, _):
            yield lane

    def running(self, argument: int, place: int, width: int) -> Running:
        """Return a running value that begins with numbers of an array; see :meth:`Running.keep`."""
        return Running(self, argument, place, self.load(argument, place, width))


class Running:
    """A vector that changes from round to round of a loop, held in a register."""

    def __init__(self, access: Access, argument: int, place: int, start: Lanes) -> None:
        self._access, self._argument, self._place = access, argument, place
        self._cell = cgutils.alloca_once_value(access.builder, start.value)

    @property
    def now(self) -> Lanes:
        """Present value of the vector."""
        return Lanes(self._access.builder, self._access.builder.load(self._cell))

    def become(self, lanes: Lanes) -> None:
        """Change the present value to another vector."""
        self._access.builder.store(lanes.value, self._cell)

    def keep(self) -> None:
        """Store the value in the array, behind the loop."""
        self._access.store(self.now, self._argument, self._place)
