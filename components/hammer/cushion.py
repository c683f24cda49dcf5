"""The hammer cushion after Smith: loads along one line, unloads and reloads along a steeper one, takes no tension."""

from ..compilation import kernel


@kernel
def steeper(stiffness, restitution):
    """Stiffness (N/m) of unloading: the area under it is restitution squared times that under the line of loading."""
    return stiffness / (restitution * restitution)


@kernel
def cushion_force(compression, largest, stiffness, restitution):
    """Force (N) at a compression (m) when the largest so far was ``largest`` (m)."""
    if compression >= largest:
        return stiffness * max(compression, 0.0)
    return max(0.0, stiffness * largest - steeper(stiffness, restitution) * (largest - compression))


@kernel
def met(free, yielding, largest, stiffness, restitution):
    """Force F (N) of the cushion at the compression free - yielding * F (m): where its line meets that of the bodies beside it."""
    loading = stiffness * free / (1.0 + stiffness * yielding)
    if free - yielding * loading >= largest:
        return max(loading, 0.0)
    rise = steeper(stiffness, restitution)
    return max(0.0, ((stiffness - rise) * largest + rise * free) / (1.0 + rise * yielding))
