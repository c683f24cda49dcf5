"""The discs' way through vector registers: rows to columns of a block, and back; rows on in time.

The contact law is computed for a block of pairs, with a column for each quantity. The discs however
lie in rows, one cache line each. To go from rows to columns one number at a time would cost more
than the law; as vectors it is two loads, one sum and a transposition of eight by eight numbers.
``plain_...`` are the twins in plain loops, for reading and for the tests: the same bits.
"""

from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from ...common.kernels import kernel
from ..arithmetic import larger, multiply_add
from ..declarations import BLOCK, FORCE_ROW, HALF_ROOT, INVERSE_MASS, LANES, ROW
from .lanes import INDEX, WORD, Access, Lanes, constant, spread

KINETIC, FASTEST, POTENTIAL = 0, 4, 6
"""Places of the sums of :func:`move_rows`: m/4 times old and new velocity to the right, upwards and
of the surface (J/4, and a number without meaning); largest square of the velocity, twice (m2/s2);
m/4 times x and y (kg m)."""


@kernel
def plain_pairs_to_columns(body, pair, at, block):
    """Fill the columns of the block from the BLOCK pairs from ``at`` on.

    Of the bodies i and j: j - i for x, y, vx, vy, and j + i for surface speed, radius and root of
    mass.

    Parameters
    ----------
    body : ndarray of float64
        Rows of the bodies.
    pair : ndarray of int64
        Pairs of discs.
    at : int
        First pair.
    block : ndarray of float64
        Columns 0 to 6 are written.
    """
    for q in range(BLOCK):
        i, j = pair[at + q] & 0xFFFFFFFF, pair[at + q] >> 32
        for c in range(4):
            block[c * BLOCK + q] = body[j + c] - body[i + c]
        for c in range(4, 6):
            block[c * BLOCK + q] = body[j + c] + body[i + c]
        block[6 * BLOCK + q] = body[j + 7] + body[i + 7]


@kernel
def plain_columns_to_pairs(load, pair, at, block):
    """Add the forces of a block to the loads of its pairs.

    The force acts on j, its reverse on i; the tangential force turns both the same way.

    Parameters
    ----------
    load : ndarray of float64
        Rows of the loads (N).
    pair : ndarray of int64
        Pairs of discs.
    at : int
        First pair.
    block : ndarray of float64
        Columns 0, 1 and 2: force to the right, upwards and tangential force (N).
    """
    for q in range(BLOCK):
        i = (pair[at + q] & 0xFFFFFFFF) * FORCE_ROW // ROW
        j = (pair[at + q] >> 32) * FORCE_ROW // ROW
        x, y, turning = block[q], block[BLOCK + q], block[2 * BLOCK + q]
        load[i] -= x
        load[i + 1] -= y
        load[i + 2] += turning
        load[j] += x
        load[j + 1] += y
        load[j + 2] += turning


def _transposed(rows: list[Lanes]) -> list[Lanes]:
    """Return the columns of eight rows, in three rounds of exchange at distance 1, 2 and 4."""
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
    """Return where the rows of both discs of a pair begin; argument 1 holds the pairs."""
    halves = access.pointer(1, pair, WORD)
    b = access.builder
    return b.zext(b.load(halves), INDEX), b.zext(b.load(b.gep(halves, [INDEX(1)])), INDEX)


@intrinsic
def pairs_to_columns(typing, body, pair, at, block):
    """Do with vectors the same as :func:`plain_pairs_to_columns`."""

    def generate(context, builder, signature, arguments):
        access = Access(context, builder, signature, arguments)
        sign = Lanes(builder, constant([-1.0] * 4 + [1.0] * 4))
        with access.lanes_of_block() as lane:
            rows = []
            for q in range(LANES):
                i, j = _bodies(access, access.place(builder.add(access[2], lane), q))
                rows.append(multiply_add(access.load(0, i, ROW), sign, access.load(0, j, ROW)))
            columns = _transposed(rows)
            for column, source in enumerate((0, 1, 2, 3, 4, 5, 7)):
                access.store(columns[source], 3, access.place(lane, column * BLOCK))
        return context.get_dummy_value()

    return types.void(body, pair, types.int64, block), generate


def _load_row(access: Access, body: ir.Value) -> ir.Value:
    """Return the address of the load row of a body whose row begins at ``body``.

    Load rows are half as long as body rows, so their places are counted in halves of numbers.
    """
    b = access.builder
    assert ROW == 2 * FORCE_ROW
    return b.gep(b.bitcast(access[0], WORD.as_pointer()), [body])


def _columns_to_pairs(turning: bool) -> Any:
    def columns_to_pairs(typing, load, pair, at, block):
        """Do with vectors the same as :func:`plain_columns_to_pairs`."""

        def generate(context, builder, signature, arguments):
            access = Access(context, builder, signature, arguments)
            nothing = Lanes(builder, constant([0.0] * LANES))
            sign = Lanes(builder, constant([-1.0, -1.0, 1.0, 1.0]))
            even, odd = [0, 8, 2, 10, 4, 12, 6, 14], [1, 9, 3, 11, 5, 13, 7, 15]
            width = FORCE_ROW if turning else 2
            with access.lanes_of_block() as lane:
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
                    access.put(multiply_add(row, sign, before) if turning else before - row, i)
                    access.put(row + access.loaded(j, width), j)
            return context.get_dummy_value()

        return types.void(load, pair, types.int64, block), generate

    return intrinsic(columns_to_pairs)


columns_to_pairs = _columns_to_pairs(turning=True)
"""Intrinsic: :func:`plain_columns_to_pairs` with vectors."""
forces_to_pairs = _columns_to_pairs(turning=False)
"""Intrinsic: the same for discs that do not turn, without tangential forces in the loads."""


def _rates(
    builder: ir.IRBuilder, dt: ir.Value, gravity: ir.Value, turning: ir.Value
) -> tuple[Lanes, Lanes]:
    """Return the factors of force / mass in a step (s), and the speed of fall gained (m/s)."""
    zero = constant([0.0] * 4)
    gain = zero
    for lane, rate in enumerate((dt, dt, builder.fmul(turning, dt))):
        gain = builder.insert_element(gain, rate, WORD(lane))
    fall = builder.insert_element(zero, builder.fmul(gravity, dt), WORD(1))
    return Lanes(builder, gain), Lanes(builder, fall)


@intrinsic
def move_rows(typing, body, load, begin, end, dt, gravity, turning, motion):
    """Move discs by semi-implicit Euler: velocity first, then position with the new velocity.

    Parameters
    ----------
    body, load : ndarray of float64
        Rows of the bodies and of their loads, which are set to zero.
    begin, end : int
        First disc and the one behind the last.
    dt, gravity : float
        Time step (s), acceleration of gravity (m/s2).
    turning : float
        2 where discs turn (d(omega r)/dt = torque r / I with I = m r^2 / 2), else 0.
    motion : ndarray of float64
        Sums that grow, at the places KINETIC, FASTEST and POTENTIAL.
    """

    def generate(context, builder, signature, arguments):
        access = Access(context, builder, signature, arguments)
        zero = constant([0.0] * 4)
        gain, fall = _rates(builder, access[4], access[5], access[6])
        way = spread(builder, access[4], 2)
        kinetic, fastest, potential = (
            access.running(7, place, width)
            for place, width in ((KINETIC, 4), (FASTEST, 2), (POTENTIAL, 2))
        )
        rows = (builder.mul(access[q], INDEX(ROW)) for q in (2, 3))
        with cgutils.for_range_slice(builder, *rows, INDEX(ROW)) as (at, _):
            velocity, force = access.place(at, 2), builder.lshr(at, INDEX(1))
            inverse = spread(builder, access.number(0, access.place(at, INVERSE_MASS)), 4)
            root = spread(builder, access.number(0, access.place(at, HALF_ROOT)), 4)
            old, position = access.load(0, velocity, 4), access.load(0, at, 2)
            mass = root * root
            new = multiply_add(access.load(1, force, FORCE_ROW), inverse * gain, old - fall)
            access.store(new, 0, velocity)  # and the radius, to which nothing was added
            kinetic.become(multiply_add(mass * old, new, kinetic.now))
            potential.become(multiply_add(mass.shuffled([0, 1]), position, potential.now))
            speed = new.shuffled([0, 1])
            access.store(multiply_add(speed, way, position), 0, at)
            square = speed * speed
            fastest.become(larger(square + square.shuffled([1, 0]), fastest.now))
            access.store(Lanes(builder, zero), 1, force)
        for total in (kinetic, fastest, potential):
            total.keep()
        return context.get_dummy_value()

    kinds = (types.int64,) * 2 + (types.float64,) * 3
    return types.void(body, load, *kinds, motion), generate
