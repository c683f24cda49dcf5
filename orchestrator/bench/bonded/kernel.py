"""Each force and position follows from one that is given."""

from rockshed.components.common.component import OK
from rockshed.components.common.kernels import kernel, view

from .declarations import LAYOUT

A = LAYOUT.array


@kernel
def initialise(w, x, k):
    """Keep nothing from the initialisation."""
    return OK


@kernel
def evaluate(w, x, k):
    """Compute the outputs from the inputs."""
    force = view(w, k, A.force)
    position = view(w, k, A.position)
    spring = view(w, k, A.spring)
    way = view(w, k, A.way)
    for i in range(force.size):
        spring[i] = position[i]
        way[i] = 0.5 * force[i] + 1.0
    return OK


@kernel
def step(t, h, w, x, k):
    """Compute the outputs at the end of a step."""
    return evaluate(w, x, k)
