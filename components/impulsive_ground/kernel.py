"""Life of the ground: faults of its parameters, start, steps for each port, outputs."""

import math
from typing import TYPE_CHECKING

from ..common.component import OK
from ..common.kernels import kernel, view
from ..common.stepping import TOO_MANY_STEPS
from ..common.substeps import are_too_many, substep_count, substep_length
from .declarations import BODY, KINEMATICS, LAYOUT, MOGAMI, SETTLEMENT, SMITH, WAVE
from .faults import (
    DIVERGED,
    MOVING_AT_START,
    NO_IMPEDANCE,
    NO_MASS,
    NO_RESISTANCE,
    OVERLOADED,
    PLATE_OUTSIDE,
    REFUSALS,
)
from .motion import (
    Ground,
    contact_force,
    drag_plate,
    lead_toe,
    load_plate_on_soil,
    move_toe,
    push_plate,
    resistance,
    strike_plate,
    strike_soil,
)
from .settlement import soil_mass

if TYPE_CHECKING:
    from ..common.component import Instance

V, A = LAYOUT.scalar, LAYOUT.array

UNBOUNDED_STEP = 1e6
"""Step (s) that is published where every step is stable."""


@kernel
def has_fault(fault, w):
    """Return whether the parameters have the fault of this number.

    Parameters
    ----------
    fault : int
        One of the numbers in :data:`faults.REFUSALS`.
    w : ndarray of float64
        Variables.

    Returns
    -------
    bool
        True if the initialisation has to refuse them.
    """
    massless = w[V.law] == SMITH and w[V.port] != SETTLEMENT
    if fault == PLATE_OUTSIDE:
        return w[V.box_width] > 0.0 and 2.0 * w[V.plate_radius] > w[V.box_width]
    if fault == NO_MASS:
        return not massless and virtual_mass(w) <= 0.0
    if fault == NO_RESISTANCE:
        return w[V.law] == MOGAMI and w[V.resistance_start] + w[V.resistance_end] <= 0.0
    if fault == OVERLOADED:
        return w[V.preload] > (
            w[V.ultimate_resistance] if w[V.law] == SMITH else w[V.resistance_start]
        )
    if fault == NO_IMPEDANCE:
        return w[V.port] == WAVE and w[V.toe_impedance] <= 0.0
    return w[V.impulse0] > 0.0 and massless


def problems(instance: "Instance") -> list[str]:
    """Return every fault of the parameters, in words.

    The impedance may still come from a rod: the initialisation sees to that.

    Parameters
    ----------
    instance : Instance
        Ground whose parameters are set.

    Returns
    -------
    list of str
        Messages, none if the parameters are in order.
    """
    return [
        instance.message(fault)
        for fault in REFUSALS
        if fault != NO_IMPEDANCE and has_fault(fault, instance.w)
    ]


@kernel
def virtual_mass(w):
    """Return the mass (kg) of plate and sand, and of the body that gave impulse0."""
    body = w[V.impulse0_mass] if w[V.impulse0] > 0.0 else 0.0
    return (
        w[V.plate_mass]
        + body
        + soil_mass(
            w[V.plate_radius],
            w[V.soil_depth],
            w[V.soil_spread],
            w[V.soil_density],
            w[V.soil_mass_form],
        )
    )


@kernel
def ground(w):
    """Return the constants that follow from the parameters."""
    return Ground(
        virtual_mass(w),
        w[V.ultimate_resistance] / w[V.quake],
        w[V.ultimate_resistance],
        w[V.damping],
        w[V.resistance_start],
        w[V.resistance_end],
        w[V.resistance_time],
        w[V.contact_stiffness],
        w[V.preload],
    )


@kernel
def initialise(w, x, k):
    """Set the state at the start: at rest under the preload, or moving with what impulse0 gives.

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
    for fault in range(PLATE_OUTSIDE, MOVING_AT_START + 1):
        if fault != NO_IMPEDANCE and has_fault(fault, w):
            return fault
    g, b = ground(w), view(x, k, A.body)
    for i in range(len(b)):
        b[i] = 0.0
    b[BODY.spring] = g.preload if w[V.law] == SMITH else 0.0
    b[BODY.velocity] = w[V.impulse0] / g.mass if w[V.impulse0] > 0.0 else 0.0
    w[V.virtual_mass] = g.mass
    w[V.stable_step] = UNBOUNDED_STEP
    if w[V.law] == MOGAMI and w[V.port] == KINEMATICS:
        w[V.stable_step] = 2.0 * math.sqrt(g.mass / g.contact)
    w[V.energy_plastic], w[V.energy_damping] = 0.0, 0.0
    w[V.energy_work_contact], w[V.energy_start] = 0.0, 0.0
    publish(g, w, b)
    w[V.energy_start], w[V.energy_residual] = w[V.energy_residual], 0.0
    return OK


@kernel
def evaluate(w, x, k):
    """Compute the outputs at the start: the force that the first values of the inputs call for.

    Parameters
    ----------
    w, x : ndarray of float64
        Variables and state.
    k : ndarray of int64
        Integer state.

    Returns
    -------
    int
        Status, OK or NO_IMPEDANCE.
    """
    if has_fault(NO_IMPEDANCE, w):
        return NO_IMPEDANCE
    g, b = ground(w), view(x, k, A.body)
    w[V.step_limit] = step_limit(g, w)
    w[V.toe_force] = force_on_toe(g, w, b) - g.preload
    w[V.toe_mean_force] = w[V.toe_force]
    return OK


@kernel
def step_limit(g, w):
    """Return the longest communication step with a rod of the impedance Z.

    It is Z/k for a spring, M/Z for a mass; waves have no limit here. A held damping force J R_u v
    with J R_u >= Z grows in every step, however short: the limit is 0.

    Parameters
    ----------
    g : Ground
        Constants.
    w : ndarray of float64
        Variables.

    Returns
    -------
    float
        Step (s); UNBOUNDED_STEP where nothing limits it.
    """
    if w[V.toe_impedance] <= 0.0 or w[V.port] == WAVE:
        return UNBOUNDED_STEP
    if w[V.port] == SETTLEMENT:
        return g.mass / w[V.toe_impedance]
    if w[V.law] == SMITH and g.damping * g.ultimate >= w[V.toe_impedance]:
        return 0.0
    return w[V.toe_impedance] / (g.stiffness if w[V.law] == SMITH else g.contact)


@kernel
def step(t, h, w, x, k):
    """Advance by h with held inputs; an input motion goes on with its velocity.

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
        Status: OK, NO_IMPEDANCE or DIVERGED.
    """
    g, b = ground(w), view(x, k, A.body)
    if w[V.port] == WAVE and not w[V.toe_impedance] > 0.0:
        return NO_IMPEDANCE
    jump(g, w, b)
    if are_too_many(h, w[V.internal_step]):
        return TOO_MANY_STEPS
    n = substep_count(h, w[V.internal_step])
    dt = substep_length(h, n, w[V.internal_step])
    impulse = 0.0
    for _ in range(n):
        toe = b[BODY.settlement] - b[BODY.gap]
        more, work = advance(g, dt, w, b)
        impulse += more
        w[V.energy_work_contact] += work - g.preload * (b[BODY.settlement] - b[BODY.gap] - toe)
    w[V.toe_mean_force] = impulse / (n * dt) - g.preload
    publish(g, w, b)
    return (
        OK
        if math.isfinite(w[V.position_y] + w[V.velocity_y] + impulse + w[V.energy_work_contact])
        else DIVERGED
    )


@kernel
def jump(g, w, b):
    """Put the toe at its input position; it may have left the path on which it was led.

    Parameters
    ----------
    g : Ground
        Constants.
    w, b : ndarray of float64
        Variables, and state at the places :data:`BODY`.
    """
    if w[V.port] != KINEMATICS:
        return
    way = w[V.toe_position] - (b[BODY.settlement] - b[BODY.gap])
    if way == 0.0:
        return
    if w[V.law] == SMITH:
        work = move_toe(g, way, w, b)
    else:
        before = contact_energy(g, b)
        b[BODY.gap] -= way
        work = contact_energy(g, b) - before
    w[V.energy_work_contact] += work - g.preload * way


@kernel
def advance(g, dt, w, b):
    """Advance by one internal step.

    Parameters
    ----------
    g : Ground
        Constants.
    dt : float
        Length of the step (s).
    w, b : ndarray of float64
        Variables, and state at the places :data:`BODY`.

    Returns
    -------
    tuple of float
        Impulse (N s) and work (J) of the load, preload included.
    """
    if w[V.port] == SETTLEMENT:
        load = g.preload - w[V.force_y]
        return (
            load_plate_on_soil(g, load, dt, w, b)
            if w[V.law] == SMITH
            else push_plate(g, load, 0.0, dt, w, b)
        )
    if w[V.port] == WAVE:
        load = g.preload + w[V.toe_wave]
        if w[V.law] == SMITH:
            return strike_soil(g, load, w[V.toe_impedance], dt, w, b)
        return strike_plate(g, load, w[V.toe_impedance], dt, w, b)
    toe = w[V.toe_velocity]
    return lead_toe(g, toe, dt, w, b) if w[V.law] == SMITH else drag_plate(g, toe, dt, w, b)


# --- what the outside sees ---


@kernel
def contact_energy(g, b):
    """Return the energy (J) of the spring between toe and plate."""
    force = contact_force(g, b)
    return 0.5 * force * force / g.contact


@kernel
def smith_force(g, b, velocity):
    """Return the force (N) of Smith's soil on a toe with a velocity (m/s) downwards."""
    return b[BODY.spring] * max(0.0, 1.0 + g.damping * velocity)


@kernel
def force_on_toe(g, w, b):
    """Return the force (N) on the toe now, preload included."""
    if w[V.port] == SETTLEMENT:
        return g.preload - w[V.force_y]
    if w[V.law] == SMITH:
        return smith_force(g, b, b[BODY.velocity])
    if w[V.port] == KINEMATICS:
        return contact_force(g, b)
    if b[BODY.gap] > 0.0:
        return 0.0
    return max(0.0, g.preload + w[V.toe_wave] - w[V.toe_impedance] * b[BODY.velocity])


@kernel
def resisting_force(g, w, b):
    """Return the force (N) of the ground now, preload included.

    A plate at rest resists no more than it is loaded.
    """
    if w[V.law] == SMITH:
        return smith_force(g, b, b[BODY.velocity])
    now = resistance(g, b[BODY.clock])
    return now if b[BODY.velocity] > 0.0 else max(0.0, min(now, force_on_toe(g, w, b)))


@kernel
def publish(g, w, b):
    """Write outputs and energies from the state.

    Parameters
    ----------
    g : Ground
        Constants.
    w, b : ndarray of float64
        Variables, and state at the places :data:`BODY`.
    """
    springs = 0.0
    w[V.permanent_set] = b[BODY.settlement]
    if w[V.law] == SMITH:
        springs = 0.5 * b[BODY.spring] * b[BODY.spring] / g.stiffness
        w[V.permanent_set] += b[BODY.slack] - (b[BODY.spring] - g.preload) / g.stiffness
    elif w[V.port] == KINEMATICS:
        springs = contact_energy(g, b)
    moving = w[V.law] == MOGAMI or w[V.port] == SETTLEMENT
    w[V.settlement], w[V.position_y] = b[BODY.settlement], -b[BODY.settlement]
    w[V.velocity_y] = -b[BODY.velocity]
    w[V.toe_force] = force_on_toe(g, w, b) - g.preload
    w[V.resistance] = resisting_force(g, w, b)
    w[V.energy_kinetic] = 0.5 * g.mass * b[BODY.velocity] * b[BODY.velocity] if moving else 0.0
    w[V.energy_elastic] = springs
    w[V.energy_preload] = -g.preload * (b[BODY.settlement] - b[BODY.gap])
    w[V.energy_residual] = (
        w[V.energy_kinetic]
        + w[V.energy_elastic]
        + w[V.energy_preload]
        + w[V.energy_plastic]
        + w[V.energy_damping]
        - w[V.energy_work_contact]
        - w[V.energy_start]
    )
