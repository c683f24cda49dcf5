"""The tables that the exchange loop works on, as they lie in memory.

Addresses, places and ticks are int64, values float64.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Records = NDArray[np.void]
FloatTable = NDArray[np.float64]
IntegerTable = NDArray[np.int64]

NOT_FINITE = 1 << 40
"""Status of an operation that brought a value that is no finite number; no FMU returns it, as a
status has 32 bits."""
NOT_FITTING = 1 << 41
"""Status of an operation with a number that its type, or the bus, cannot hold."""
ENDED = 1 << 42
"""Status of a step in which an FMU of FMI 3.0 wants the run to end."""
STUCK = 1 << 43
"""Status of a step that returned early again and again, and came no further."""
UNCONVERGED = 1 << 44
"""Status of an exchange whose values do not fit together after all iterations."""


def _record(integers: str, reals: str = "") -> np.dtype[np.void]:
    return np.dtype(
        [(name, np.int64) for name in integers.split()]
        + [(name, np.float64) for name in reals.split()]
    )


OPERATION = _record(
    "action instance do_step may_return begin length first_move end_move owner first_discrete "
    "end_discrete first_posted end_posted"
)
"""One action of the schedule. instance, do_step: addresses. may_return: do_step is that of FMI 3.0,
which may return early. begin, length: of a step, in ticks, from the beginning of the period.
first_move, end_move: rows in the table of moves, for other actions. owner: number of the component.
first_discrete, end_discrete: rows in the table of discrete outputs; first_posted, end_posted: rows
in the table of sides of channels that are posted right after the outputs were taken."""

MOVE = _record(
    "function instance references count number begin form is_counted first_linear end_linear "
    "first_extrapolated end_extrapolated",
    "low high",
)
"""A call that moves ``number`` values from place ``begin`` of a bus on, those of ``count``
references. function, instance, references: addresses. form: how they travel, see :data:`FORMS`.
is_counted: the call is told ``number``. first_linear, end_linear: rows in the table of linear
inputs; first_extrapolated, end_extrapolated: in that of extrapolated ones. low, high: what the type
can hold."""

DOUBLE, SINGLE, BYTE, SHORT, INTEGER, LONG, TRUTH, TRUTH_OF_INTEGER = range(8)
"""Forms of values in calls. A truth is one byte, and any other number than 0 is true."""

FORMS = {
    **{"float64": DOUBLE, "float32": SINGLE, "bool": TRUTH},
    **{"int8": BYTE, "int16": SHORT, "int32": INTEGER, "int64": LONG},
    **{"uint8": BYTE, "uint16": SHORT, "uint32": INTEGER, "uint64": LONG},
}
"""Forms by the name of the number in memory. Whether one has a sign follows from ``low``."""

LINEAR = _record("place", "factor offset")
"""An input that gets factor times the value of its source plus offset."""

CHANNEL = _record(
    "given seen force position", "last_seen last_force last_position taken given_back"
)
"""A force of a power bond. Places as in :class:`rockshed.core.system.plan.BondPlaces`. taken,
given_back: work (J) on the taker, and on the giver by what it was shown."""

EXTRAPOLATED = _record(
    "place order ahead every owner known jumps newest older oldest", "value before earliest"
)
"""An input that follows a polynomial, as in :class:`rockshed.core.system.plan.Extrapolated`; owner
is the number of the component. known: how many values the polynomial has, up to 3; newest, older,
oldest: their times (ticks); value, before, earliest: the values. jumps: events of the owner until
the newest value."""

DISCRETE = _record("place", "last")
"""An output that changes at events alone, and its value before the newest one."""

CONDITION = _record("place sign waits", "number")
"""A comparison of an output with a number. sign: 0 to 3, see :data:`SIGNS`. waits: whether it has
not been true yet, and the loop stops for it."""
SIGNS = ("<", "<=", ">", ">=")

TAKER, GIVER = range(2)
POSTED = _record("channel side")
"""A side of a force of a power bond, TAKER or GIVER."""

WATCHED = _record("place low_at high_at", "low high last area")
"""Smallest and largest value of a watched output, and the exchanges after which they were reached;
its newest value, and the area under it: its integral in units of the exchange step."""


class Tables(NamedTuple):
    """Everything that the loop works on.

    Attributes
    ----------
    start, exchange : int
        Time at the start and exchange step (ticks).
    rate : int
        Ticks in a second.
    every : int
        Number of exchanges for one row of snapshots.
    width : int
        Numbers in a row.
    row : int
        The next row.
    units : int
        Exchange steps in one exchange.
    recording : int
        The first operation that reads what is recorded; the others follow it.
    exchanged : int
        Outputs that are exchanged; behind them stand values that nobody changes.
    forgets : int
        1 where steps are told that no earlier state is needed any more, else 0.
    first : array of int64
        Operations ``first[i]`` to ``first[i + 1]`` are those of exchange i of a period.
    operations : array of OPERATION
        All operations of a period, those of longer exchanges, then those that read what is
        recorded.
    moves : array of MOVE
        Calls that move values.
    inputs, outputs : array of float64
        The two buses.
    source : array of uint64
        For each input, the place of the output that feeds it; unsigned, so that numba does not
        look whether it counts from the end.
    linear : array of LINEAR
        Inputs that get other values than their sources have, by rising place.
    singles, bytes, shorts, integers, longs : array of float32, int8, int16, int32, int64
        One buffer for values on their way in another form, as long as any row of them.
    extrapolated : array of EXTRAPOLATED
        Inputs that do not hold between exchanges, by rising place.
    discrete : array of DISCRETE
        Outputs whose changes begin polynomials anew.
    jumps : array of int64
        Events of each component.
    channels : array of CHANNEL
        Forces of power bonds.
    posted : array of POSTED
        Sides that are posted after each step.
    watched : array of WATCHED
        Watched outputs.
    snapshots : array of float64
        Rows of :class:`rockshed.core.loop.snapshots.Snapshots`, one after the other.
    course : array of float64
        Factor and offset of each input of a course at each exchange, one exchange after the other;
        NaN where it is not changed.
    course_rows : array of int64
        Its inputs, by their rows in ``linear``.
    course_span : array of int64, shape (2,)
        The first exchange in it, and how many.
    conditions : array of CONDITION
        The loop stops behind the exchange after which one of them is true.
    journal : array of int64, shape (2,)
        Exchange and operation under way, -1 while none is.
    warned : array of int64
        For each operation, how often its status was Warning.
    returned : array of int64
        For each operation, how often its step has returned early.
    told : array of int64, shape (1,)
        The three truths that a step of FMI 3.0 tells: event, end of the run, early return.
    reached : array of float64, shape (1,)
        The time that it tells (s).
    """

    start: int
    exchange: int
    rate: int
    every: int
    width: int
    row: int
    units: int
    recording: int
    exchanged: int
    forgets: int
    first: IntegerTable
    operations: Records
    moves: Records
    inputs: FloatTable
    outputs: FloatTable
    source: NDArray[np.uint64]
    linear: Records
    singles: NDArray[np.float32]
    bytes: NDArray[np.int8]
    shorts: NDArray[np.int16]
    integers: NDArray[np.int32]
    longs: NDArray[np.int64]
    extrapolated: Records
    discrete: Records
    jumps: IntegerTable
    channels: Records
    posted: Records
    watched: Records
    snapshots: FloatTable
    course: FloatTable
    course_rows: IntegerTable
    course_span: IntegerTable
    conditions: Records
    journal: IntegerTable
    warned: IntegerTable
    returned: IntegerTable
    told: IntegerTable
    reached: FloatTable


NUMBERS = (
    "start",
    "exchange",
    "rate",
    "every",
    "width",
    "row",
    "units",
    "recording",
    "exchanged",
    "forgets",
)
"""The numbers among the :class:`Tables`, which come first."""

KINDS = {
    "first": np.dtype(np.int64),
    "operations": OPERATION,
    "moves": MOVE,
    "inputs": np.dtype(np.float64),
    "outputs": np.dtype(np.float64),
    "source": np.dtype(np.uint64),
    "linear": LINEAR,
    "singles": np.dtype(np.float32),
    "bytes": np.dtype(np.int8),
    "shorts": np.dtype(np.int16),
    "integers": np.dtype(np.int32),
    "longs": np.dtype(np.int64),
    "extrapolated": EXTRAPOLATED,
    "discrete": DISCRETE,
    "jumps": np.dtype(np.int64),
    "channels": CHANNEL,
    "posted": POSTED,
    "watched": WATCHED,
    "snapshots": np.dtype(np.float64),
    "course": np.dtype(np.float64),
    "course_rows": np.dtype(np.int64),
    "course_span": np.dtype(np.int64),
    "conditions": CONDITION,
    "journal": np.dtype(np.int64),
    "warned": np.dtype(np.int64),
    "returned": np.dtype(np.int64),
    "told": np.dtype(np.int64),
    "reached": np.dtype(np.float64),
}
"""Types of the arrays among the :class:`Tables`, in their order."""

ENTRY = "rockshed_advance"
"""Name of the loop as a C function in the object code."""


def head(tables: Tables) -> IntegerTable:
    """Return the numbers among the tables, then address and length of each array.

    Parameters
    ----------
    tables : Tables
        The arrays have to stay where they are.

    Returns
    -------
    array of int64

    Raises
    ------
    ValueError
        An array is not of its kind, or not in one piece.
    """
    entries = [getattr(tables, name) for name in NUMBERS]
    for name, kind in KINDS.items():
        array = getattr(tables, name)
        if array.dtype != kind or array.ndim != 1 or not array.flags.c_contiguous:
            raise ValueError(f"the table {name} is no row of {kind}")
        entries += [array.ctypes.data, array.size]
    return np.array(entries, np.int64)
