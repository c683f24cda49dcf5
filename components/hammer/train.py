"""The train between ram and pile: ram, anvil and helmet on springs, and gas under the ram.

Bodies are rigid and stand one below the other; a spring lies under each, the last one on the head
of the rod. Springs are cushions: they take no tension. Under the last body there may be none: it
then lies rigidly on the head, and may leave it.

Every body obeys the implicit midpoint rule, every spring its law over its way in the step; the mean
forces of the step follow from one another, spring by spring, until they no longer change. That is
stable for every step, and no step creates energy.
"""

from ..common.kernels import kernel, view
from .cushion import cushion_force, mean_force, met, steeper
from .declarations import LAYOUT, MOST_BODIES

V, A = LAYOUT.scalar, LAYOUT.array

_SWEEPS, _MANY = 1000, 40
"""Sweeps over the springs at most, and those after which forces may differ more."""
_ALIKE, _SIMILAR, _UNLIKE = 1e-12, 1e-7, 1e-5
"""Parts of the force of a rigid ram by which a force may change in the last sweep: usually, after
many sweeps (a spring at rest has its mean force from rounded ways), and at most."""
UNSETTLED = -1.0
"""Returned in the place of a force that has not settled."""


@kernel
def has_train(w):
    """Return whether something stands between ram and head but a cushion."""
    masses = w[V.anvil_mass] + w[V.helmet_mass]
    return masses > 0.0 or w[V.pile_cushion_stiffness] > 0.0 or w[V.gas_force] > 0.0


@kernel
def bodies(w):
    """Return the number of bodies of the train, the ram counted."""
    return 1 + (w[V.anvil_mass] > 0.0) + (w[V.helmet_mass] > 0.0)


@kernel
def is_complete(w):
    """Return whether every spring but the last has a stiffness, and a second cushion a helmet."""
    if w[V.helmet_mass] == 0.0:
        return w[V.cushion_stiffness] > 0.0 and w[V.pile_cushion_stiffness] == 0.0
    return w[V.cushion_stiffness] > 0.0


@kernel
def assemble(w, x, k):
    """Put the bodies on one another, the ram ``gap`` above the next.

    Parameters
    ----------
    w, x : ndarray of float64
        Variables and state.
    k : ndarray of int64
        Integer state.
    """
    mass, speed, place = view(x, k, A.masses), view(x, k, A.speeds), view(x, k, A.places)
    stiffness, restitution = view(x, k, A.stiffnesses), view(x, k, A.restitutions)
    pressed, forces = view(x, k, A.pressed), view(x, k, A.spring_forces)
    for i in range(MOST_BODIES):
        mass[i], speed[i], place[i] = 1.0, 0.0, w[V.head_reached]
        stiffness[i], restitution[i] = 0.0, 1.0
        pressed[i], forces[i] = 0.0, 0.0
    mass[0], speed[0], place[0] = w[V.mass], w[V.impact_velocity], w[V.head_reached] - w[V.gap]
    view(x, k, A.elapsed)[0] = 0.0
    n = bodies(w)
    under = 0
    if w[V.anvil_mass] > 0.0:
        mass[1] = w[V.anvil_mass]
        stiffness[0], restitution[0] = w[V.anvil_stiffness], w[V.anvil_restitution]
        under = 1
    stiffness[under], restitution[under] = w[V.cushion_stiffness], w[V.cushion_restitution]
    if w[V.helmet_mass] > 0.0:
        mass[n - 1] = w[V.helmet_mass]
        stiffness[n - 1] = w[V.pile_cushion_stiffness]
        restitution[n - 1] = w[V.pile_cushion_restitution]


@kernel
def gas_force(time, w):
    """Return the force (N) of the gas under the ram at a time (s) after the ram has touched.

    Constant for ``gas.hold``, then falling evenly to zero at ``gas.end``.
    """
    if time < 0.0 or time >= w[V.gas_end]:
        return 0.0
    if time <= w[V.gas_hold]:
        return w[V.gas_force]
    return w[V.gas_force] * (w[V.gas_end] - time) / (w[V.gas_end] - w[V.gas_hold])


@kernel
def _gas(dt, w, x, k):
    """Return the force (N) of the gas in the middle of a step, and count the time of the blow.

    It begins when the ram first touches what is below it.
    """
    elapsed = view(x, k, A.elapsed)
    if elapsed[0] == 0.0 and _gap(0, w, x, k) > 0.0:
        return 0.0
    elapsed[0] += dt
    return gas_force(elapsed[0] - 0.5 * dt, w)


@kernel
def advance_train(now, dt, w, x, k):
    """Advance the train by a step and return the mean force on the head (N).

    Parameters
    ----------
    now, dt : float
        Start and length of the step (s).
    w, x : ndarray of float64
        Variables and state.
    k : ndarray of int64
        Integer state.

    Returns
    -------
    float
        Force (N), not negative; :data:`UNSETTLED` where a body is too light for the step.
    """
    n = bodies(w)
    gas = _gas(dt, w, x, k)
    forces, speed = view(x, k, A.spring_forces), view(x, k, A.speeds)
    mass, place = view(x, k, A.masses), view(x, k, A.places)
    before = 0.0
    if not _balance(gas, dt, w, x, k):
        return UNSETTLED
    head = (forces[n - 1] + w[V.head_wave]) / w[V.head_impedance]
    weight = w[V.gravity] * w[V.weight]
    above = 0.0
    for i in range(n):
        change = dt * (weight + (above - forces[i]) / mass[i])
        way = dt * (speed[i] + 0.5 * change)
        above = forces[i]
        speed[i] += change
        if i > 0:
            _book(i - 1, before, way, w, x, k)
        before = way
        place[i] += way
    _book(n - 1, before, dt * head, w, x, k)
    w[V.head_reached] += dt * head
    w[V.energy_work_head] -= forces[n - 1] * head * dt
    _land(w, x, k)
    if w[V.touching] > 0.0 and forces[0] == 0.0:
        w[V.separation] = now + dt
    w[V.touching] = 1.0 if forces[0] > 0.0 else 0.0
    w[V.position], w[V.velocity] = place[0], speed[0]
    return forces[n - 1]


@kernel
def _balance(gas, dt, w, x, k):
    """Find the mean forces of the springs in a step, each with those of its neighbours.

    Returns whether they have settled.
    """
    forces, n = view(x, k, A.spring_forces), bodies(w)
    scale = w[V.head_impedance] * w[V.impact_velocity] + w[V.mass] * w[V.gravity]
    change = 0.0
    for sweep in range(_SWEEPS):
        change = 0.0
        for i in range(n):
            force = _spring(i, dt, w, x, k)
            if i == 0:
                force = max(force, gas)
            change = max(change, abs(force - forces[i]))
            forces[i] = force
        if change <= (_ALIKE if sweep < _MANY else _SIMILAR) * scale:
            break
    return change <= _UNLIKE * scale


@kernel
def _spring(i, dt, w, x, k):
    """Return the mean force (N) of spring i in a step, with those of its neighbours as they are."""
    mass, speed, forces = view(x, k, A.masses), view(x, k, A.speeds), view(x, k, A.spring_forces)
    n = bodies(w)
    weight = w[V.gravity] * w[V.weight]
    above = forces[i - 1] if i > 0 else 0.0
    half = 0.5 * dt / mass[i]
    upper = speed[i] + 0.5 * dt * weight + half * above
    if i == n - 1:
        lower, compliance = w[V.head_wave] / w[V.head_impedance], 1.0 / w[V.head_impedance]
        if view(x, k, A.stiffnesses)[i] == 0.0:
            if _gap(i, w, x, k) > 0.0:
                return 0.0
            return max((upper - lower) / (half + compliance), 0.0)
    else:
        compliance = 0.5 * dt / mass[i + 1]
        lower = speed[i + 1] + 0.5 * dt * weight - compliance * forces[i + 1]
    return met(
        -_gap(i, w, x, k),
        dt * (upper - lower),
        dt * (half + compliance),
        view(x, k, A.pressed)[i],
        view(x, k, A.stiffnesses)[i],
        view(x, k, A.restitutions)[i],
    )


@kernel
def _gap(i, w, x, k):
    """Return the way (m) until body i touches what is below it; negative where it presses."""
    place = view(x, k, A.places)
    below = w[V.head_reached] if i == bodies(w) - 1 else place[i + 1]
    return below - place[i]


@kernel
def _book(i, upper, lower, w, x, k):
    """Book the works on spring i while its ends go the ways ``upper`` and ``lower`` (m).

    Called before the body below has moved, with the one above moved already.
    """
    force = view(x, k, A.spring_forces)[i]
    pressed = view(x, k, A.pressed)
    stiffness, restitution = view(x, k, A.stiffnesses)[i], view(x, k, A.restitutions)[i]
    way = upper - lower
    start = -_gap(i, w, x, k) - upper
    if stiffness == 0.0:
        w[V.energy_contact] += force * way
        return
    kept = stored(start, pressed[i], stiffness, restitution)
    mean = mean_force(start, way, pressed[i], stiffness, restitution)
    pressed[i] = max(pressed[i], start + way)
    after = stored(start + way, pressed[i], stiffness, restitution)
    w[V.energy_cushion_loss] += mean * way - (after - kept)
    extra = (force - mean) * way
    if i == 0 and w[V.gas_force] > 0.0:
        w[V.energy_supplied] -= extra
    else:
        w[V.energy_contact] += extra


@kernel
def _land(w, x, k):
    """Put a last body that has reached the head on it, where no spring lies between."""
    last = bodies(w) - 1
    if view(x, k, A.stiffnesses)[last] > 0.0:
        return
    if _gap(last, w, x, k) > 0.0 and view(x, k, A.spring_forces)[last] == 0.0:
        return
    kept = lifted(w, x, k) + elastic(w, x, k)
    view(x, k, A.places)[last] = w[V.head_reached]
    w[V.energy_contact] += kept - lifted(w, x, k) - elastic(w, x, k)


@kernel
def stored(compression, pressed, stiffness, restitution):
    """Return the elastic energy (J) of a spring: what it would give back."""
    force = cushion_force(compression, pressed, stiffness, restitution)
    return 0.5 * force * force / steeper(stiffness, restitution)


@kernel
def kinetic(w, x, k):
    """Return the kinetic energy (J) of all bodies."""
    mass, speed = view(x, k, A.masses), view(x, k, A.speeds)
    total = 0.0
    for i in range(bodies(w)):
        total += 0.5 * mass[i] * speed[i] * speed[i]
    return total


@kernel
def lifted(w, x, k):
    """Return the potential energy (J) of all bodies in gravity, zero at position 0."""
    mass, place = view(x, k, A.masses), view(x, k, A.places)
    total = 0.0
    for i in range(bodies(w)):
        total -= mass[i] * w[V.gravity] * w[V.weight] * place[i]
    return total


@kernel
def elastic(w, x, k):
    """Return the elastic energy (J) of all springs."""
    pressed, stiffness = view(x, k, A.pressed), view(x, k, A.stiffnesses)
    restitution = view(x, k, A.restitutions)
    total = 0.0
    for i in range(bodies(w)):
        if stiffness[i] > 0.0:
            total += stored(-_gap(i, w, x, k), pressed[i], stiffness[i], restitution[i])
    return total
