"""Eight pairs of discs at once: rows of a table to columns of a block, and columns back to rows.

The law of contact is computed for a block of pairs, a quantity of all pairs beside the other, which the compiler turns into
vector instructions. The discs however lie in rows, one cache line each. Going from rows to columns one number at a time would
cost more than the law; as vectors it is two loads, one addition and a transposition of eight by eight numbers.

:func:`pairs_to_columns` and :func:`columns_to_pairs` are written in the compiler's own vector types, which it cuts to what the
processor has (8, 4 or 2 numbers wide). They compute nothing but sums of two numbers, in a fixed order, so the result has the
same bits everywhere. ``plain_...`` are their twins in plain loops, for reading and for the tests.
"""

from typing import Any

from llvmlite import ir

from ..compilation import intrinsic, kernel
from ..compilation import numba_types as types

LANES = 8
"""Pairs that are handled at once."""
FIELDS = 6
"""Columns that :func:`pairs_to_columns` fills: differences of x, y, vx, vy, sums of surface speed and radius."""
ROOT = 6
"""Column of the sum of the roots of mass."""
COLUMNS = 7

_REAL, _INDEX, _WORD = ir.DoubleType(), ir.IntType(64), ir.IntType(32)
_ROW = ir.VectorType(_REAL, 8)
_LOAD = ir.VectorType(_REAL, 4)


@kernel
def plain_pairs_to_columns(body, first, second, at, block, lane, stride):
    """Columns 0 to 6 of the block, lanes ``lane`` to ``lane + 7``, from the pairs ``at`` to ``at + 7``: of body rows i and j,
    j - i for x, y, vx, vy and j + i for surface speed, radius and root of mass."""
    for q in range(LANES):
        i, j = 8 * first[at + q], 8 * second[at + q]
        for c in range(4):
            block[c * stride + lane + q] = body[j + c] - body[i + c]
        for c in range(4, 6):
            block[c * stride + lane + q] = body[j + c] + body[i + c]
        block[ROOT * stride + lane + q] = body[j + 7] + body[i + 7]


@kernel
def plain_columns_to_pairs(load, first, second, at, block, lane, stride):
    """Add columns 0 (force to the right), 1 (upwards) and 2 (tangential force) of the block to the load rows of the pairs: the
    force acts on j, its reverse on i; the tangential force turns both the same way."""
    for q in range(LANES):
        i, j = 4 * first[at + q], 4 * second[at + q]
        x, y, turning = block[lane + q], block[stride + lane + q], block[2 * stride + lane + q]
        load[i] -= x
        load[i + 1] -= y
        load[i + 2] += turning
        load[j] += x
        load[j + 1] += y
        load[j + 2] += turning


def _constant(values: list[float], kind: ir.Type = _REAL) -> ir.Constant:
    return ir.Constant(ir.VectorType(kind, len(values)), [ir.Constant(kind, value) for value in values])


def _shuffle(builder: ir.IRBuilder, one: ir.Value, other: ir.Value, places: list[int]) -> ir.Value:
    return builder.shuffle_vector(one, other, _constant(places, _WORD))  # type: ignore[arg-type]


def _transpose(builder: ir.IRBuilder, rows: list[ir.Value]) -> list[ir.Value]:
    """Columns of eight rows, in three rounds that exchange neighbours at distance 1, 2 and 4."""
    for distance in (1, 2, 4):
        low = [p if not p & distance else p - distance + LANES for p in range(LANES)]
        high = [p + distance if not p & distance else p + LANES for p in range(LANES)]
        exchanged = list(rows)
        for r in range(LANES):
            if not r & distance:
                exchanged[r] = _shuffle(builder, rows[r], rows[r + distance], low)
                exchanged[r + distance] = _shuffle(builder, rows[r], rows[r + distance], high)
        rows = exchanged
    return rows


class _Access:
    """Loads and stores at places of numba arrays."""

    def __init__(self, context: Any, builder: ir.IRBuilder, signature: Any, arguments: list[Any]) -> None:
        self.builder = builder
        self._data = [context.make_array(kind)(context, builder, value).data if isinstance(kind, types.Array) else value
                      for kind, value in zip(signature.args, arguments)]

    def __getitem__(self, argument: int) -> Any:
        return self._data[argument]

    def number(self, argument: int, place: ir.Value) -> ir.Value:
        """An element of an integer array."""
        return self.builder.load(self.builder.gep(self._data[argument], [place]))

    def _pointer(self, argument: int, place: ir.Value, kind: ir.Type) -> ir.Value:
        return self.builder.bitcast(self.builder.gep(self._data[argument], [place]), kind.as_pointer())

    def load(self, argument: int, place: ir.Value, kind: ir.Type) -> ir.Value:
        """A vector out of a float array."""
        return self.builder.load(self._pointer(argument, place, kind), align=8)

    def store(self, value: ir.Value, argument: int, place: ir.Value) -> None:
        """A vector into a float array."""
        self.builder.store(value, self._pointer(argument, place, value.type), align=8)


def _places(access: _Access, lane: int, width: int) -> tuple[ir.Value, ir.Value]:
    """Begin of the rows of both bodies of a pair; arguments 1, 2 and 3 are first, second and at."""
    b = access.builder
    pair = b.add(access[3], _INDEX(lane))
    return b.mul(access.number(1, pair), _INDEX(width)), b.mul(access.number(2, pair), _INDEX(width))


def _column(access: _Access, column: int) -> ir.Value:
    """Place of a column's lane in the block; arguments 5 and 6 are lane and stride."""
    b = access.builder
    return b.add(b.mul(access[6], _INDEX(column)), access[5])


def _signature(floats: Any, first: Any, second: Any, at: Any, block: Any, lane: Any, stride: Any) -> Any:
    return types.void(floats, first, second, types.int64, block, types.int64, types.int64)


@intrinsic
def pairs_to_columns(typing, body, first, second, at, block, lane, stride):
    """:func:`plain_pairs_to_columns` as vectors."""
    def generate(context, builder, signature, arguments):
        access = _Access(context, builder, signature, arguments)
        sign = _constant([-1.0] * 4 + [1.0] * 4)
        rows = []
        for q in range(LANES):
            i, j = _places(access, q, 8)
            rows.append(builder.fadd(access.load(0, j, _ROW), builder.fmul(access.load(0, i, _ROW), sign)))
        columns = _transpose(builder, rows)
        for column, source in (*((c, c) for c in range(FIELDS)), (ROOT, 7)):
            access.store(columns[source], 4, _column(access, column))
        return context.get_dummy_value()

    return _signature(body, first, second, at, block, lane, stride), generate


@intrinsic
def columns_to_pairs(typing, load, first, second, at, block, lane, stride):
    """:func:`plain_columns_to_pairs` as vectors."""
    def generate(context, builder, signature, arguments):
        access = _Access(context, builder, signature, arguments)
        x, y, turning = (access.load(4, _column(access, column), _ROW) for column in range(3))
        nothing = _constant([0.0] * 8)
        sign = _constant([-1.0, -1.0, 1.0, 1.0])
        even, odd = [0, 8, 2, 10, 4, 12, 6, 14], [1, 9, 3, 11, 5, 13, 7, 15]
        force = (_shuffle(builder, x, y, even), _shuffle(builder, x, y, odd))
        turn = (_shuffle(builder, turning, nothing, even), _shuffle(builder, turning, nothing, odd))
        for q in range(LANES):
            i, j = _places(access, q, 4)
            pair = q - q % 2
            row = _shuffle(builder, force[q % 2], turn[q % 2], [pair, pair + 1, pair + 8, pair + 9])
            access.store(builder.fadd(access.load(0, i, _LOAD), builder.fmul(row, sign)), 0, i)
            access.store(builder.fadd(access.load(0, j, _LOAD), row), 0, j)
        return context.get_dummy_value()

    return _signature(load, first, second, at, block, lane, stride), generate
