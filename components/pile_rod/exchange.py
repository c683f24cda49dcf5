"""Ports and clock of the rod.

Forces from outside act over whole internal steps; the waves that come out of the rod next are known
beforehand.
"""

from ..common.kernels import kernel, view
from ..common.substeps import are_too_many
from . import chain, characteristics
from .declarations import CHARACTERISTICS, CLOCK, LAYOUT, PARALLEL, PORT, WAVES
from .segments import head_sign

V, A = LAYOUT.scalar, LAYOUT.array

_ROUNDING = 1e-9


@kernel
def gives_waves(w):
    """Return whether a port of waves is in use."""
    return w[V.head_port] == WAVES or (w[V.toe_condition] == PORT and w[V.toe_port] == WAVES)


@kernel
def lies_behind(w):
    """Return whether forces are known only after the step to which they belong."""
    return gives_waves(w) and w[V.exchange] == PARALLEL


@kernel
def holds_too_much(h, w, x, k):
    """Whether more time waits to be gone through than fits into the internal steps of one call."""
    clock = view(x, k, A.clock)
    waiting, behind = clock[CLOCK.waiting], clock[CLOCK.behind]
    known = waiting >= 0.0 and behind >= 0.0
    return not known or are_too_many(waiting + behind + h, w[V.time_step])


@kernel
def run(time, h, w, x, k):
    """Advance by a communication step with the inputs in w, in whole internal steps.

    The rest of the communication step, shorter than an internal step, waits for the next call.

    Parameters
    ----------
    time, h : float
        Start and length of the communication step (s).
    w, x : ndarray of float64
        Variables and state.
    k : ndarray of int64
        Integer state.
    """
    clock = view(x, k, A.clock)
    left, now = h, time - clock[CLOCK.waiting]
    if lies_behind(w):
        left = clock[CLOCK.behind]
        now -= left
        clock[CLOCK.behind] = h
    dt = w[V.time_step]
    on_head, on_toe = head_sign(w) * w[V.head_force] - w[V.head_preload], w[V.toe_force]
    while clock[CLOCK.waiting] + left >= dt * (1.0 - _ROUNDING):
        head_mean, toe_mean = on_head, on_toe
        if clock[CLOCK.waiting] > 0.0:
            part = dt - clock[CLOCK.waiting]
            head_mean = (clock[CLOCK.head_impulse] + on_head * part) / dt
            toe_mean = (clock[CLOCK.toe_impulse] + on_toe * part) / dt
            left -= part
            clock[CLOCK.waiting], clock[CLOCK.head_impulse] = 0.0, 0.0
            clock[CLOCK.toe_impulse] = 0.0
        else:
            left -= dt
        if w[V.scheme] == CHARACTERISTICS:
            characteristics.advance(now, dt, head_mean, toe_mean, w, x, k)
        else:
            chain.advance(now, dt, head_mean, toe_mean, w, x, k)
        now += dt
    if left > _ROUNDING * dt:
        clock[CLOCK.waiting] += left
        clock[CLOCK.head_impulse] += on_head * left
        clock[CLOCK.toe_impulse] += on_toe * left
    w[V.delay] = clock[CLOCK.waiting] + clock[CLOCK.behind]


@kernel
def waves_known(h, w, x, k):
    """Return whether the waves of the next step are independent of forces not yet known.

    Parameters
    ----------
    h : float
        Length of the next communication step (s).
    w, x : ndarray of float64
        Variables and state.
    k : ndarray of int64
        Integer state.

    Returns
    -------
    bool
        True where the rod can give the waves of both ports.
    """
    clock, free = view(x, k, A.clock), view(k, k, A.free)
    needed = (clock[CLOCK.waiting] + clock[CLOCK.behind] + h) / w[V.time_step] - _ROUNDING
    head = w[V.head_port] != WAVES or needed <= free[0]
    toe = w[V.toe_condition] != PORT or w[V.toe_port] != WAVES or needed <= free[1]
    return head and toe


@kernel
def publish_waves(h, w, x, k):
    """Write the waves (N) that come out of the ends, mean over a next step of length h (s)."""
    clock = view(x, k, A.clock)
    n = k[A.impedance + 1]
    begin = (clock[CLOCK.waiting] + clock[CLOCK.behind]) / w[V.time_step]
    end = begin + h / w[V.time_step]
    w[V.head_wave] = head_sign(w) * _mean(begin, end, n, True, w, x, k)
    w[V.toe_wave] = _mean(begin, end, n, False, w, x, k)


@kernel
def _mean(begin, end, n, at_head, w, x, k):
    """Return the mean wave (N) of the arrivals from begin to end (internal steps ahead) at an end.

    begin and end may coincide.
    """
    first, last = _cell(begin + _ROUNDING, n), _cell(end - _ROUNDING, n)
    if last <= first:
        return _arriving(first, n, at_head, w, x, k)
    total = (first + 1 - begin) * _arriving(first, n, at_head, w, x, k) + (end - last) * _arriving(
        last, n, at_head, w, x, k
    )
    for j in range(first + 1, last):
        total += _arriving(j, n, at_head, w, x, k)
    return total / (end - begin)


@kernel
def _cell(steps, n):
    return min(max(int(steps), 0), n - 1)


@kernel
def _arriving(j, n, at_head, w, x, k):
    """Return the wave (N) that arrives in the internal step j from now.

    The weight of the nodes on its way is in it.
    """
    impedance = view(x, k, A.impedance)
    own = impedance[0] if at_head else impedance[n - 1]
    wave = view(x, k, A.up)[j] if at_head else view(x, k, A.down)[n - 1 - j]
    return own * (2.0 * wave + (j + 0.5) * w[V.time_step] * w[V.gravity])
