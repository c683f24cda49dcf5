"""Rows of a table to columns of a block, columns back to rows, and rows on in time: the discs' way through vector registers.

The law of contact is computed for a block of pairs, a quantity of all pairs beside the other. The discs however lie in rows, one
cache line each. Going from rows to columns one number at a time would cost more than the law; as vectors it is two loads, one
sum and a transposition of eight by eight numbers. ``plain_...`` are the twins in plain loops, for reading and for the tests: the
same bits.
"""

from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from ...common.kernels import kernel
from ..declarations import BLOCK, FORCE_ROW, HALF_ROOT, INVERSE_MASS, LANES, ROW
from .lanes import INDEX, WORD, Access, Lanes, constant, fma, larger, spread

KINETIC, FASTEST, POTENTIAL = 0, 4, 6
"""Where the numbers of :func:`move_rows` begin: m/4 times old and new velocity to the right, upwards and of the surface (and a
number without meaning); largest square of the velocity, twice; m/4 times x and y."""


@kernel
def plain_pairs_to_columns(body, pair, at, block):
    """Columns 0 to 6 of the block from the BLOCK pairs from ``at`` on: of body rows i and j, j - i for x, y, vx, vy and j + i for
    surface speed, radius and root of mass."""
    for q in range(BLOCK):
        i, j = pair[at + q] & 0xFFFFFFFF, pair[at + q] >> 32
        for c in range(4):
            block[c * BLOCK + q] = body[j + c] - body[i + c]
        for c in range(4, 6):
            block[c * BLOCK + q] = body[j + c] + body[i + c]
        block[6 * BLOCK + q] = body[j + 7] + body[i + 7]


@kernel
def plain_columns_to_pairs(load, pair, at, block):
    """Add columns 0 (force to the right), 1 (upwards) and 2 (tangential force) of the block to the load rows of the pairs: the
    force acts on j, its reverse on i; the tangential force turns both the same way."""
    for q in range(BLOCK):
        i, j = (
            (pair[at + q] & 0xFFFFFFFF) * FORCE_ROW // ROW,
            (pair[at + q] >> 32) * FORCE_ROW // ROW,
        )
        x, y, turning = block[q], block[BLOCK + q], block[2 * BLOCK + q]
        load[i] -= x
        load[i + 1] -= y
        load[i + 2] += turning
        load[j] += x
        load[j + 1] += y
        load[j + 2] += turning


def _transposed(rows: list[Lanes]) -> list[Lanes]:
    """Columns of eight rows, in three rounds that exchange neighbours at distance 1, 2 and 4."""
    for distance in (1, 2, 4):
        low = [p if not p & distance else p - distance + LANES for p in range(LANES)]
        high = [p + distance if not p & distance else p + LANES for p in range(LANES)]
        exchanged = list(rows)
        for r in range(LANES):
            if not r & distance:
                exchanged[r] = rows[r].shuffled(low, rows[r + distance])
                exchanged[r + distance] = rows[r].shuffled(high, rows[r + distance])
        rows = exchanged
    return rows


def _bodies(access: Access, pair: ir.Value) -> tuple[ir.Value, ir.Value]:
    """Begin of the body rows of both discs of a pair; argument 1 holds the pairs."""
    halves = access.pointer(1, pair, WORD)
    b = access.builder
    return b.zext(b.load(halves), INDEX), b.zext(b.load(b.gep(halves, [INDEX(1)])), INDEX)


def _lanes_of_block(builder: ir.IRBuilder) -> Any:
    """A loop over a block, eight pairs at a time."""
    return cgutils.for_range_slice(builder, INDEX(0), INDEX(BLOCK), INDEX(LANES))


@intrinsic
def pairs_to_columns(typing, body, pair, at, block):
    """:func:`plain_pairs_to_columns` as vectors."""

    def generate(context, builder, signature, arguments):
        access = Access(context, builder, signature, arguments)
        sign = Lanes(builder, constant([-1.0] * 4 + [1.0] * 4))
        with _lanes_of_block(builder) as (lane, _):
            rows = []
            for q in range(LANES):
                i, j = _bodies(access, access.place(builder.add(access[2], lane), q))
                rows.append(fma(access.load(0, i, ROW), sign, access.load(0, j, ROW)))
            columns = _transposed(rows)
            for column, source in enumerate((0, 1, 2, 3, 4, 5, 7)):
                access.store(columns[source], 3, access.place(lane, column * BLOCK))
        return context.get_dummy_value()

    return types.void(body, pair, types.int64, block), generate


def _load_row(access: Access, body: ir.Value) -> ir.Value:
    """Begin of a load row, which is half as long as the body row that begins at ``body``: places are halves of numbers."""
    b = access.builder
    assert ROW == 2 * FORCE_ROW
    return b.gep(b.bitcast(access[0], WORD.as_pointer()), [body])


def _columns_to_pairs(turning: bool) -> Any:
    def columns_to_pairs(typing, load, pair, at, block):
        """:func:`plain_columns_to_pairs` as vectors."""

        def generate(context, builder, signature, arguments):
            access = Access(context, builder, signature, arguments)
            nothing, sign = (
                Lanes(builder, constant([0.0] * LANES)),
                Lanes(builder, constant([-1.0, -1.0, 1.0, 1.0])),
            )
            even, odd = [0, 8, 2, 10, 4, 12, 6, 14], [1, 9, 3, 11, 5, 13, 7, 15]
            width = FORCE_ROW if turning else 2
            with _lanes_of_block(builder) as (lane, _):
                x, y, turn = (
                    access.load(3, access.place(lane, column * BLOCK), LANES) for column in range(3)
                )
                forces = (x.shuffled(even, y), x.shuffled(odd, y))
                turns = (turn.shuffled(even, nothing), turn.shuffled(odd, nothing))
                for q in range(LANES):
                    i, j = (
                        _load_row(access, body)
                        for body in _bodies(access, access.place(builder.add(access[2], lane), q))
                    )
                    two = q - q % 2
                    row = forces[q % 2].shuffled(
                        [two, two + 1, two + 8, two + 9][:width], turns[q % 2]
                    )
                    before = access.loaded(i, width)
                    access.put(fma(row, sign, before) if turning else before - row, i)
                    access.put(row + access.loaded(j, width), j)
            return context.get_dummy_value()

        return types.void(load, pair, types.int64, block), generate

    return intrinsic(columns_to_pairs)


columns_to_pairs, forces_to_pairs = (
    _columns_to_pairs(turning=True),
    _columns_to_pairs(turning=False),
)
""":func:`plain_columns_to_pairs` as vectors; and the same for discs that do not turn, without what would turn them."""


@intrinsic
def move_rows(typing, body, load, begin, end, dt, gravity, turning, motion):
    """Semi-implicit Euler for the discs from ``begin`` to before ``end``: velocity first, then position with the new velocity.
    Their forces are forgotten. ``turning``: 2 where discs turn (d(omega r)/dt = torque r / I with I = m r^2 / 2), else 0.
    ``motion`` holds the numbers that KINETIC, FASTEST and POTENTIAL explain; they grow."""

    def generate(context, builder, signature, arguments):
        access = Access(context, builder, signature, arguments)
        zero, dt = constant([0.0] * 4), access[4]
        gain, fall = zero, builder.insert_element(zero, builder.fmul(access[5], dt), WORD(1))
        for lane, rate in enumerate((dt, dt, builder.fmul(access[6], dt))):
            gain = builder.insert_element(gain, rate, WORD(lane))
        gain, fall, way = Lanes(builder, gain), Lanes(builder, fall), spread(builder, dt, 2)
        kinetic, fastest, potential = (
            access.running(7, place, width)
            for place, width in ((KINETIC, 4), (FASTEST, 2), (POTENTIAL, 2))
        )
        rows = (builder.mul(access[q], INDEX(ROW)) for q in (2, 3))
        with cgutils.for_range_slice(builder, *rows, INDEX(ROW)) as (at, _):
            velocity, force = access.place(at, 2), builder.lshr(at, INDEX(1))
            inverse = spread(builder, access.number(0, access.place(at, INVERSE_MASS)), 4)
            root = spread(builder, access.number(0, access.place(at, HALF_ROOT)), 4)
            old, position, mass = access.load(0, velocity, 4), access.load(0, at, 2), root * root
            new = fma(access.load(1, force, FORCE_ROW), inverse * gain, old - fall)
            access.store(new, 0, velocity)  # and the radius, to which nothing was added
            kinetic.become(fma(mass * old, new, kinetic.now))
            potential.become(fma(mass.shuffled([0, 1]), position, potential.now))
            speed = new.shuffled([0, 1])
            access.store(fma(speed, way, position), 0, at)
            square = speed * speed
            fastest.become(larger(square + square.shuffled([1, 0]), fastest.now))
            access.store(Lanes(builder, zero), 1, force)
        for total in (kinetic, fastest, potential):
            total.keep()
        return context.get_dummy_value()

    kinds = (types.int64,) * 2 + (types.float64,) * 3
    return types.void(body, load, *kinds, motion), generate
