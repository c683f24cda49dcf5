"""The ram on its cushion against the head of a rod, by the implicit midpoint rule."""

import math

from ..common.component import OK
from ..common.kernels import kernel, view
from ..common.stepping import TOO_MANY_STEPS
from ..common.substeps import are_too_many, substep_count, substep_length
from ..common.wave_port import Course, End, Heard, Ram, course, struck
from .cushion import cushion_force, met, steeper
from .declarations import HEARD, KINEMATICS, LAYOUT, WAVES
from .faults import (
    DIVERGED,
    GAS_ENDS_EARLY,
    NO_IMPEDANCE,
    NOT_SETTLED,
    RIGID_NEEDS_WAVES,
    TRAIN_INCOMPLETE,
    TRAIN_NEEDS_WAVES,
)
from .train import (
    UNSETTLED,
    advance_train,
    assemble,
    bodies,
    elastic,
    has_train,
    is_complete,
    kinetic,
    lifted,
)

V, A = LAYOUT.scalar, LAYOUT.array

UNBOUNDED_STEP = 1e6
"""Stable step (s) that is published: the midpoint rule is stable with every step."""
_ROUNDING = 1e-9


@kernel
def initialise(w, x, k):
    """Put the ram above or on the head, with the velocity of its fall.

    Parameters
    ----------
    w, x : ndarray of float64
        Variables and state.
    k : ndarray of int64
        Integer state.

    Returns
    -------
    int
        Status, OK or a fault of the parameters.
    """
    if has_train(w):
        if w[V.port] == KINEMATICS:
            return TRAIN_NEEDS_WAVES
        if not is_complete(w):
            return TRAIN_INCOMPLETE
        if w[V.gas_end] < w[V.gas_hold]:
            return GAS_ENDS_EARLY
    if w[V.port] == KINEMATICS and w[V.cushion_stiffness] == 0.0:
        return RIGID_NEEDS_WAVES
    view(x, k, A.largest)[0], view(x, k, A.ends)[0] = 0.0, 0.0
    heard = view(x, k, A.heard)
    heard[HEARD.wave], heard[HEARD.rate], heard[HEARD.length] = 0.0, 0.0, 0.0
    w[V.impact_velocity] = math.sqrt(2.0 * w[V.gravity] * w[V.drop_height] * w[V.efficiency])
    w[V.velocity], w[V.position] = w[V.impact_velocity], -w[V.gap]
    w[V.touching] = 1.0 if w[V.gap] == 0.0 and w[V.impact_velocity] > 0.0 else 0.0
    w[V.separation], w[V.blows], w[V.stable_step] = -1.0, 1.0, UNBOUNDED_STEP
    w[V.force], w[V.end_force] = 0.0, 0.0
    w[V.energy_supplied], w[V.energy_cushion_loss] = 0.0, 0.0
    w[V.energy_contact], w[V.energy_work_head] = 0.0, 0.0
    return OK


@kernel
def evaluate(w, x, k):
    """Compute the outputs at the start.

    With the port of kinematics the ram starts above the head's input position.
    """
    w[V.head_reached] = 0.0
    if w[V.port] == KINEMATICS:
        w[V.head_reached] = w[V.head_position]
    w[V.position] = w[V.head_reached] - w[V.gap]
    if has_train(w):
        assemble(w, x, k)
    w[V.energy_start] = 0.0
    publish(w, x, k)
    w[V.energy_start], w[V.energy_residual] = w[V.energy_residual], 0.0
    return OK


@kernel
def step(t, h, w, x, k):
    """Advance by h against a head that moves as the inputs say, or against a wave.

    Parameters
    ----------
    t, h : float
        Start and length of the communication step (s).
    w, x : ndarray of float64
        Variables and state.
    k : ndarray of int64
        Integer state.

    Returns
    -------
    int
        Status: OK, NO_IMPEDANCE, NOT_SETTLED or DIVERGED.
    """
    if w[V.port] == WAVES and w[V.head_impedance] <= 0.0:
        return NO_IMPEDANCE
    if w[V.port] == KINEMATICS:
        _place_head(w, x, k)
    if are_too_many(h, w[V.internal_step]):
        return TOO_MANY_STEPS
    n = substep_count(h, w[V.internal_step])
    dt = substep_length(h, n, w[V.internal_step])
    way = _hear(h, w, x, k)
    impulse = 0.0
    for i in range(n):
        now = t + i * dt
        if w[V.blow_interval] > 0.0 and now >= w[V.blows] * w[V.blow_interval] - _ROUNDING * dt:
            _strike_again(w, x, k)
        if has_train(w):
            force = advance_train(now, dt, w, x, k)
            if force == UNSETTLED:
                return NOT_SETTLED
            impulse += dt * force
        elif w[V.cushion_stiffness] == 0.0:
            here = Course(way.start + i * dt * way.rate, way.rate, way.hidden)
            impulse += dt * _rigid(now, dt, here, w)
        else:
            impulse += dt * _cushioned(now, dt, w, x, k)
    w[V.force] = impulse / (n * dt)
    if has_train(w):
        w[V.end_force] = view(x, k, A.spring_forces)[bodies(w) - 1]
    elif w[V.cushion_stiffness] == 0.0:
        w[V.end_force] = w[V.touching] * max(
            0.0, w[V.head_impedance] * w[V.velocity] - w[V.head_wave]
        )
    else:
        w[V.end_force] = view(x, k, A.ends)[0]
    publish(w, x, k)
    return OK if math.isfinite(w[V.position] + w[V.force] + w[V.energy_work_head]) else DIVERGED


@kernel
def _compression(w):
    return w[V.position] - w[V.head_reached]


@kernel
def _cushion_energy(w, x, k):
    """Return the elastic energy in the cushion (J): what it would give back."""
    if has_train(w):
        return elastic(w, x, k)
    if w[V.cushion_stiffness] == 0.0:
        return 0.0
    stiffness, restitution = w[V.cushion_stiffness], w[V.cushion_restitution]
    force = cushion_force(_compression(w), view(x, k, A.largest)[0], stiffness, restitution)
    return 0.5 * force * force / steeper(stiffness, restitution)


@kernel
def _place_head(w, x, k):
    """Put the head at its input position, and the cushion with it.

    The work of the jump is that of the mean of the forces before and after.
    """
    largest = view(x, k, A.largest)
    stiffness, restitution = w[V.cushion_stiffness], w[V.cushion_restitution]
    way = w[V.head_position] - w[V.head_reached]
    kept = _cushion_energy(w, x, k)
    before = cushion_force(_compression(w), largest[0], stiffness, restitution)
    w[V.head_reached] = w[V.head_position]
    after = cushion_force(_compression(w), largest[0], stiffness, restitution)
    largest[0] = max(largest[0], _compression(w))
    work = 0.5 * (before + after) * way
    w[V.energy_work_head] -= work
    w[V.energy_cushion_loss] += kept - work - _cushion_energy(w, x, k)


@kernel
def _strike_again(w, x, k):
    """Put the ram on the head with the velocity of its fall, the cushion as new."""
    before = _mechanical(w, x, k)
    w[V.position], w[V.velocity], w[V.touching] = w[V.head_reached], w[V.impact_velocity], 1.0
    view(x, k, A.largest)[0] = 0.0
    if has_train(w):
        assemble(w, x, k)
        w[V.position], w[V.velocity] = view(x, k, A.places)[0], view(x, k, A.speeds)[0]
    w[V.blows] += 1.0
    w[V.energy_supplied] += _mechanical(w, x, k) - before


@kernel
def _mechanical(w, x, k):
    if has_train(w):
        return kinetic(w, x, k) + lifted(w, x, k) + elastic(w, x, k)
    return (
        0.5 * w[V.mass] * w[V.velocity] * w[V.velocity]
        - w[V.mass] * w[V.gravity] * w[V.weight] * w[V.position]
        + _cushion_energy(w, x, k)
    )


@kernel
def _hear(h, w, x, k):
    """Return how the wave of the rod goes within the communication step, and keep its mean."""
    kept = view(x, k, A.heard)
    before = Heard(kept[HEARD.wave], kept[HEARD.rate], kept[HEARD.length])
    way, heard = course(before, w[V.head_wave], h)
    kept[HEARD.wave], kept[HEARD.rate], kept[HEARD.length] = heard.wave, heard.rate, heard.length
    return way


@kernel
def _rigid(now, dt, way, w):
    """Return the mean force on the head (N) in a step of a rigid ram on the wave."""
    ram = Ram(w[V.position], w[V.velocity], w[V.touching], w[V.separation])
    end = End(w[V.head_impedance], w[V.head_wave], w[V.head_reached])
    drive = w[V.mass] * w[V.gravity] * w[V.weight]
    ram, stroke = struck(ram, w[V.mass], drive, end, way, now, dt)
    w[V.position], w[V.velocity] = ram.position, ram.velocity
    w[V.touching], w[V.separation] = ram.touching, ram.separation
    w[V.head_reached] += stroke.end_velocity * dt
    w[V.energy_work_head] -= stroke.force * stroke.end_velocity * dt
    w[V.energy_contact] += stroke.force * (stroke.mass_velocity - stroke.end_velocity) * dt
    return stroke.force


@kernel
def _cushioned(now, dt, w, x, k):
    """Advance the ram on its cushion by a step and return the mean force on the head (N)."""
    largest = view(x, k, A.largest)
    stiffness, restitution = w[V.cushion_stiffness], w[V.cushion_restitution]
    drive, before = w[V.mass] * w[V.gravity] * w[V.weight], w[V.velocity]
    kept, start = _cushion_energy(w, x, k), _compression(w)
    given, compliance = w[V.head_velocity], 0.0
    if w[V.port] == WAVES:
        given, compliance = w[V.head_wave] / w[V.head_impedance], 1.0 / w[V.head_impedance]
    half = 0.5 * dt / w[V.mass]
    free = dt * (before + half * drive - given)
    force = met(start, free, dt * (half + compliance), largest[0], stiffness, restitution)
    w[V.velocity] += 2.0 * half * (drive - force)
    mean, head = 0.5 * (before + w[V.velocity]), given + compliance * force
    w[V.position] += mean * dt
    w[V.head_reached] += head * dt
    largest[0] = max(largest[0], _compression(w))
    at_end = cushion_force(_compression(w), largest[0], stiffness, restitution)
    view(x, k, A.ends)[0] = at_end
    if w[V.touching] > 0.0 and at_end == 0.0:
        slack = largest[0] * (1.0 - restitution * restitution)
        w[V.separation] = now + dt * _way_down(start, _compression(w), slack)
    w[V.touching] = 1.0 if at_end > 0.0 else 0.0
    w[V.energy_work_head] -= force * head * dt
    w[V.energy_cushion_loss] += force * (_compression(w) - start) - (
        _cushion_energy(w, x, k) - kept
    )
    return force


@kernel
def _way_down(start, end, slack):
    """Return the part of the way from start to end (m) at which a cushion is without force.

    That is where its compression falls to ``slack`` (m).
    """
    if start <= slack or start <= end:
        return 0.0
    return min((start - slack) / (start - end), 1.0)


@kernel
def publish(w, x, k):
    """Write the outputs of cushion and energies."""
    w[V.cushion_compression] = max(_compression(w), 0.0)
    w[V.helmet_position], w[V.helmet_velocity] = w[V.head_reached], 0.0
    w[V.energy_kinetic] = 0.5 * w[V.mass] * w[V.velocity] * w[V.velocity]
    w[V.energy_gravity] = -w[V.mass] * w[V.gravity] * w[V.weight] * w[V.position]
    if has_train(w):
        _publish_train(w, x, k)
    w[V.energy_cushion] = _cushion_energy(w, x, k)
    w[V.energy_residual] = (
        w[V.energy_kinetic]
        + w[V.energy_gravity]
        + w[V.energy_cushion]
        + w[V.energy_cushion_loss]
        + w[V.energy_contact]
        - w[V.energy_work_head]
        - w[V.energy_supplied]
        - w[V.energy_start]
    )


@kernel
def _publish_train(w, x, k):
    """Write the outputs that anvil and helmet change."""
    places = view(x, k, A.places)
    last = bodies(w) - 1
    above = 1 if w[V.anvil_mass] > 0.0 else 0
    below = places[above + 1] if above < last else w[V.head_reached]
    w[V.cushion_compression] = max(places[above] - below, 0.0)
    if w[V.helmet_mass] > 0.0:
        w[V.helmet_position] = places[last]
        w[V.helmet_velocity] = view(x, k, A.speeds)[last]
    w[V.energy_kinetic], w[V.energy_gravity] = kinetic(w, x, k), lifted(w, x, k)
