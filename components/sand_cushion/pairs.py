"""Forces between sand discs, in blocks of pairs, and the motion of the discs that follows."""

import math
from collections import namedtuple

from ..common.kernels import inlined, kernel, view
from .bodies import bodies_of
from .contact_law import rolling_response
from .contact_search import first_of, part_count, second_of
from .declarations import (
    BLOCK,
    COLUMN,
    FORCE_ROW,
    FREE,
    KIND,
    LANES,
    LAW,
    LAYOUT,
    MOTION,
    RADIUS,
    ROLL,
    ROW,
    SPIN,
    SUM,
    TALLY,
)
from .laws import law_of
from .vector.law import lasting_law, plain_law
from .vector.rows import (
    FASTEST,
    KINETIC,
    POTENTIAL,
    columns_to_pairs,
    forces_to_pairs,
    move_rows,
    pairs_to_columns,
)
from .vector.threads import shared_among_threads

V, A = LAYOUT.scalar, LAYOUT.array

Model = namedtuple("Model", "turns rolls lasts dt gravity")
"""Whether discs turn, resist rolling, and have contacts that yield or stick together; time step (s)
and gravity (m/s2)."""

Pairs = namedtuple("Pairs", "pair spring plastic roll law angle block tally rolling motion")
"""Pairs of discs: their numbers, tangential spring forces (N), permanent overlaps (m), rolling
moments (N m), constants of the law; angles of the discs (rad); and room for a part's work: block of
columns, energies in lanes, energies of rolling, sums over the motion."""


@inlined
def set_to_zero(numbers):
    """Set all numbers to zero.

    Parameters
    ----------
    numbers : ndarray
        They are set.
    """
    for q in range(numbers.size):
        numbers[q] = 0.0


@inlined
def part_of(buffer, k, entry, c, length):
    """Return the room of part c in an array that holds ``length`` numbers for each part.

    Parameters
    ----------
    buffer : ndarray
        ``x`` or ``k``.
    k : ndarray of int64
        Integers of the instance.
    entry : int
        Entry of the array in ``k``.
    c : int
        Number of the part.
    length : int
        Numbers for each part.

    Returns
    -------
    ndarray, shape (length,)
        A view.
    """
    begin = k[entry] + c * length
    return buffer[begin : begin + length]


@inlined
def pairs_of(c, x, k):
    """Return the :class:`Pairs` for part c, views of the state.

    Parameters
    ----------
    c : int
        Number of the part.
    x, k : ndarray
        State and integers of the instance.

    Returns
    -------
    Pairs
    """
    return Pairs(
        view(k, k, A.pair),
        view(x, k, A.spring),
        view(x, k, A.plastic),
        view(x, k, A.roll),
        view(x, k, A.law),
        view(x, k, A.angle),
        part_of(x, k, A.block, c, BLOCK * len(COLUMN)),
        part_of(x, k, A.tally, c, LANES * len(TALLY)),
        part_of(x, k, A.rolling, c, len(ROLL)),
        part_of(x, k, A.motion, c, MOTION),
    )


@inlined
def model_of(dt, w):
    """Return the :class:`Model` that the parameters ask for, with the time step ``dt`` (s).

    Parameters
    ----------
    dt : float
        Time step (s).
    w : ndarray of float64
        Variables of the instance.

    Returns
    -------
    Model
    """
    turns = w[V.rotation] == FREE
    lasts = w[V.unloading_ratio] > 1.0 or w[V.cohesion] > 0.0
    return Model(turns, turns and w[V.rolling_resistance] > 0.0, lasts, dt, w[V.gravity])


@inlined
def press_block(p, model, bodies, pairs):
    """Compute the forces of a block of pairs, those from ``p`` on.

    Parameters
    ----------
    p : int
        First pair.
    model : Model
        Choices and constants of the step.
    bodies : Bodies
        Columns of all bodies.
    pairs : Pairs
        Pairs of a part, with their contacts.
    """
    block, dt = pairs.block, model.dt
    pairs_to_columns(bodies.rows, pairs.pair, p, block)
    if model.lasts:
        lasting_law(block, pairs.spring, pairs.plastic, pairs.law, dt, p, pairs.tally)
    else:
        plain_law(block, pairs.spring, pairs.plastic, pairs.law, dt, p, pairs.tally)
    if model.turns:
        columns_to_pairs(bodies.loads, pairs.pair, p, block)
    else:
        forces_to_pairs(bodies.loads, pairs.pair, p, block)
    if model.rolls:
        roll_block(p, dt, bodies, pairs)


@inlined
def roll_block(begin, dt, bodies, pairs):
    """Let rolling resistance act in a block of pairs, those from ``begin`` on.

    Parameters
    ----------
    begin : int
        First pair.
    dt : float
        Time step (s).
    bodies : Bodies
        Columns of all bodies.
    pairs : Pairs
        Pairs of a part, with their contacts.
    """
    law = law_of(KIND.sand, 1.0, pairs.law)
    rows, loads = bodies.rows, bodies.loads  # columns would cost 3 % of a step here
    for q in range(BLOCK):
        normal = pairs.block[3 * BLOCK + q]
        if normal <= 0.0:
            pairs.roll[begin + q] = 0.0
            continue
        first, second = first_of(pairs.pair[begin + q]), second_of(pairs.pair[begin + q])
        i, j = ROW * first, ROW * second
        ri, rj = rows[i + RADIUS], rows[j + RADIUS]
        speed, radius = rows[j + SPIN] / rj - rows[i + SPIN] / ri, ri * rj / (ri + rj)
        rolling = rolling_response(pairs.roll[begin + q], speed, radius, normal, law, dt)
        pairs.roll[begin + q] = rolling.moment
        pairs.rolling[ROLL.lost] += rolling.dissipated
        pairs.rolling[ROLL.elastic] += rolling.elastic
        loads[FORCE_ROW * first + 2] += rolling.moment / ri
        loads[FORCE_ROW * second + 2] -= rolling.moment / rj


@kernel
def press_pairs(span, c, moving, dt, w, x, k):
    """Compute the forces between the discs of some pairs: eq. (1) of the paper.

    Parameters
    ----------
    span : tuple of int
        First pair and the one behind the last, whole blocks.
    c : int
        Part of the discs whose room is used.
    moving : bool
        Whether these are all pairs within part c. Its discs then go on in time, each as soon as it
        has its last force.
    dt : float
        Time step (s).
    w, x : ndarray of float64
        Variables and state.
    k : ndarray of int64
        Integer state.
    """
    bodies, pairs, model = bodies_of(x, k), pairs_of(c, x, k), model_of(dt, w)
    part = view(k, k, A.part)
    begin, end = span
    done, last = part[c], part[c + 1]
    for p in range(begin, end, BLOCK):
        press_block(p, model, bodies, pairs)
        if moving:
            ready = last
            if p + BLOCK < end:
                ready = first_of(pairs.pair[p + BLOCK])
            move_discs(done, ready, model, bodies, pairs)
            done = ready
    if moving:
        move_discs(done, last, model, bodies, pairs)


@inlined
def move_discs(begin, end, model, bodies, pairs):
    """Move the discs from ``begin`` to before ``end`` on, and forget the forces on them.

    Parameters
    ----------
    begin : int
        First disc.
    end : int
        The one behind the last.
    model : Model
        Choices and constants of the step.
    bodies : Bodies
        Columns of all bodies.
    pairs : Pairs
        Pairs of a part, with their contacts.
    """
    turning = 2.0 if model.turns else 0.0
    rows, loads, dt = bodies.rows, bodies.loads, model.dt
    move_rows(rows, loads, begin, end, dt, model.gravity, turning, pairs.motion)
    if model.turns:
        for i in range(begin, end):
            pairs.angle[i] += rows[ROW * i + SPIN] / rows[ROW * i + RADIUS] * dt


@kernel
def press_part(c, moving, dt, w, x, k):
    """Do :func:`press_pairs` for the pairs within part c.

    Parameters
    ----------
    c : int
        Number of the part.
    moving : bool
        Whether the discs move too.
    dt : float
        Time step (s).
    w, x, k : ndarray
        Variables, state and integers of the instance.
    """
    part, row = view(k, k, A.part), view(k, k, A.row)
    press_pairs((row[part[c]], row[part[c + 1]]), c, moving, dt, w, x, k)


press_parts = shared_among_threads(press_part)


@kernel
def press_discs(dt, moving, w, x, k):
    """Add the forces between sand discs to their loads, and what they do to the energy.

    Parameters
    ----------
    dt : float
        Time step (s).
    moving : bool
        Whether the discs go on in time.
    w, x : ndarray of float64
        Variables and state.
    k : ndarray of int64
        Integer state.

    Returns
    -------
    tuple of float
        Kinetic and potential energy (J) at the beginning of the step, where the contact forces were
        computed: with velocities half a step before and after it, m v_before v_after / 2. Zero
        without ``moving``.
    """
    across, parts = view(k, k, A.across), part_count(k)
    for entry in (A.tally, A.motion, A.rolling):
        set_to_zero(view(x, k, entry))
    press_pairs((across[0], across[across.size - 1]), 0, False, dt, w, x, k)
    press_parts(int(w[V.threads]), parts, moving, dt, w, x, k)
    law, sums = view(x, k, A.law), view(x, k, A.sums)
    add_energies(dt, law, view(x, k, A.tally)[: parts * LANES * len(TALLY)], sums)
    add_rolling(view(x, k, A.rolling), sums)
    return add_motion(dt, w[V.gravity], view(x, k, A.motion)[: parts * MOTION], sums)


@kernel
def add_energies(dt, law, tally, sums):
    """Add the energies of the parts to the sums (J), which gives them their scale.

    Parameters
    ----------
    dt : float
        Time step (s).
    law : ndarray of float64
        Table of the laws of contact.
    tally : ndarray of float64
        Energies of the parts, lane by lane.
    sums : ndarray of float64
        Running sums, :data:`SUM`.
    """
    compliance = law[LAW.compliance]
    sums[SUM.elastic] += 0.5 * (
        total(TALLY.elastic, tally) + total(TALLY.stretched, tally) * compliance
    )
    sums[SUM.normal_dashpot] += total(TALLY.normal_dashpot, tally) * dt
    sums[SUM.tangential_dashpot] += (
        law[LAW.tangential_damping] * total(TALLY.tangential_dashpot, tally) * dt
    )
    sums[SUM.sliding] += (
        total(TALLY.sliding, tally) * dt + 0.5 * total(TALLY.released, tally) * compliance
    )
    sums[SUM.plastic] += total(TALLY.plastic, tally)
    sums[SUM.capillary] += total(TALLY.capillary, tally)


@kernel
def add_rolling(rolling, sums):
    """Add the energies of rolling resistance of the parts to the sums (J).

    Parameters
    ----------
    rolling : ndarray of float64
        Energies of the parts (J).
    sums : ndarray of float64
        Running sums, :data:`SUM`.
    """
    for q in range(0, rolling.size, len(ROLL)):
        sums[SUM.elastic] += rolling[q + ROLL.elastic]
        sums[SUM.rolling] += rolling[q + ROLL.lost]


@kernel
def total(energy, tally):
    """Return one of the energies of TALLY over all parts: the sum of the lanes in four pairs.

    Parameters
    ----------
    energy : int
        One of TALLY.
    tally : ndarray of float64
        Energies of the parts, lane by lane.

    Returns
    -------
    float
        Its sum.
    """
    result = 0.0
    for begin in range(LANES * energy, tally.size, LANES * len(TALLY)):
        lane = tally[begin : begin + LANES]
        result += (
            (lane[0] + lane[4]) + (lane[1] + lane[5]) + ((lane[2] + lane[6]) + (lane[3] + lane[7]))
        )
    return result


@kernel
def add_motion(dt, gravity, motion, sums):
    """Add the way of the fastest disc (m) to the sums; return energies, see :func:`press_discs`.

    Parameters
    ----------
    dt : float
        Time step (s).
    gravity : float
        Acceleration of gravity (m/s2).
    motion : ndarray of float64
        Sums over the discs of the parts.
    sums : ndarray of float64
        Running sums, :data:`SUM`.

    Returns
    -------
    tuple of float
        Kinetic and potential energy (J).
    """
    kinetic, potential, fastest = 0.0, 0.0, 0.0
    for q in range(0, motion.size, MOTION):
        kinetic += motion[q + KINETIC] + motion[q + KINETIC + 1] + 0.5 * motion[q + KINETIC + 2]
        potential += motion[q + POTENTIAL + 1]
        fastest = max(fastest, motion[q + FASTEST])
    sums[SUM.travelled] += math.sqrt(fastest) * dt
    return 2.0 * kinetic, 4.0 * potential * gravity
