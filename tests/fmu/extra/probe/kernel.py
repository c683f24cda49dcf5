"""Levels that rise with the inflow and leak: the state is hidden, the outputs are copies of it."""

from rockshed.components.common.component import OK
from rockshed.components.common.kernels import kernel, view

from .declarations import INFLOW_AT_START, LAYOUT, OVERFLOW

V, A = LAYOUT.scalar, LAYOUT.array


@kernel
def show(w, x, k):
    levels, hidden, counts = (
        view(w, k, A.level),
        view(x, k, A.hidden_level),
        view(k, k, A.hidden_count),
    )
    for i in range(len(levels)):
        levels[i] = hidden[i]
    w[V.count], w[V.initialisations] = counts[0], counts[1]


@kernel
def initialise(w, x, k):
    start, hidden, counts = (
        view(w, k, A.level0),
        view(x, k, A.hidden_level),
        view(k, k, A.hidden_count),
    )
    for i in range(len(start)):
        hidden[i] = start[i]
    counts[0] = int(w[V.first_count])
    counts[1] += 1
    w[V.stable_step] = 0.5
    return OK


@kernel
def evaluate(w, x, k):
    w[V.flow] = w[V.valve] * w[V.inflow]
    show(w, x, k)
    return INFLOW_AT_START if w[V.inflow] > w[V.limit] else OK


@kernel
def step(t, h, w, x, k):
    hidden, extra, counts = (
        view(x, k, A.hidden_level),
        view(w, k, A.extra),
        view(k, k, A.hidden_count),
    )
    w[V.flow] = w[V.valve] * w[V.inflow]
    for i in range(len(hidden)):
        leak = hidden[i] if w[V.leak] == 2.0 else 0.0
        hidden[i] += h * (w[V.flow] + extra[i] - leak)
        if hidden[i] > w[V.limit]:
            return OVERFLOW
    if w[V.counting] == 1.0:
        counts[0] += 1
    show(w, x, k)
    return OK
