"""Life of the rod: start at rest, advance, publish."""

import math

from ..common.component import OK
from ..common.kernels import kernel, view
from ..common.smith_soil import static, stored, stretched
from ..common.stepping import TOO_MANY_STEPS
from ..common.substeps import substep_count
from .bookkeeping import shaft_soil, toe_soil
from .chain import spring_energy, spring_force
from .declarations import CHARACTERISTICS, LAYOUT, RAM, SOIL, WAVES
from .exchange import gives_waves, holds_too_much, publish_waves, run, waves_known
from .faults import (
    DIVERGED,
    GAUGE_BELOW_TOE,
    STEP_TOO_LONG,
    WAVES_AND_RAM,
    WAVES_NEED_CHARACTERISTICS,
    WAVES_UNKNOWN,
)
from .segments import (
    divide,
    find_free_stretches,
    gauge_segment,
    head_sign,
    lump,
    publish_limits,
    rod_length,
    stable_limit,
)

V, A = LAYOUT.scalar, LAYOUT.array


@kernel
def initialise(w, x, k):
    """Set the state at the start from the parameters: a rod at rest, a ram that touches it.

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
    if gives_waves(w) and w[V.scheme] != CHARACTERISTICS:
        return WAVES_NEED_CHARACTERISTICS
    if w[V.head_port] == WAVES and w[V.ram_mass] > 0.0:
        return WAVES_AND_RAM
    if w[V.gauge_depth] > rod_length(w, k):
        return GAUGE_BELOW_TOE
    for i in range(len(x)):
        x[i] = 0.0
    dt = divide(w, x, k)
    lump(dt, w, x, k)
    find_free_stretches(w, x, k)
    publish_limits(dt, w, x, k)
    w[V.stable_step] = stable_limit(dt, w, x, k)
    w[V.time_step] = dt
    if w[V.scheme] != CHARACTERISTICS:
        w[V.time_step] = dt / substep_count(dt, w[V.internal_step])
    _put_ram(w, x, k)
    _clear(w, k)
    return OK


@kernel
def _put_ram(w, x, k):
    """Put the ram on the head, with its velocity."""
    ram = view(x, k, A.ram_state)
    if w[V.ram_mass] > 0.0:
        ram[RAM.velocity], ram[RAM.touching] = w[V.ram_velocity], 1.0
        if w[V.scheme] != CHARACTERISTICS:
            view(x, k, A.rate)[0] = w[V.ram_velocity]


@kernel
def _clear(w, k):
    """Clear energies, works and envelopes."""
    compression, tension = view(w, k, A.stress_compression), view(w, k, A.stress_tension)
    for i in range(len(compression)):
        compression[i], tension[i] = 0.0, 0.0
    w[V.energy_radiated], w[V.energy_plastic] = 0.0, 0.0
    w[V.energy_damping], w[V.energy_contact] = 0.0, 0.0
    w[V.energy_work_head], w[V.energy_work_toe], w[V.energy_work_gravity] = 0.0, 0.0, 0.0
    w[V.energy_head], w[V.energy_transferred], w[V.energy_start] = 0.0, 0.0, 0.0
    w[V.head_contact_force], w[V.toe_contact_force] = 0.0, 0.0
    w[V.exchange_step], w[V.delay] = 0.0, 0.0
    w[V.ram_separation] = -1.0


@kernel
def evaluate(w, x, k):
    """Compute the outputs at the start; the inputs act from then on."""
    w[V.energy_start] = 0.0
    publish_waves(0.0, w, x, k)
    publish(w, x, k)
    w[V.energy_start], w[V.energy_residual] = w[V.energy_residual], 0.0
    return OK


@kernel
def step(t, h, w, x, k):
    """Advance by a communication step with the forces in the inputs.

    Parameters
    ----------
    t, h : float
        Start and length of the step (s).
    w, x : ndarray of float64
        Variables and state.
    k : ndarray of int64
        Integer state.

    Returns
    -------
    int
        Status: OK, STEP_TOO_LONG, WAVES_UNKNOWN or DIVERGED.
    """
    w[V.exchange_step] = h
    if h > w[V.step_limit] * (1.0 + 1e-9):
        return STEP_TOO_LONG
    if holds_too_much(h, w, x, k):
        return TOO_MANY_STEPS
    run(t, h, w, x, k)
    if not waves_known(h, w, x, k):
        return WAVES_UNKNOWN
    publish_waves(h, w, x, k)
    publish(w, x, k)
    return (
        OK
        if math.isfinite(w[V.energy_kinetic] + w[V.energy_elastic] + w[V.head_position])
        else DIVERGED
    )


@kernel
def publish(w, x, k):
    """Refresh the outputs from the state."""
    if w[V.scheme] == CHARACTERISTICS:
        _publish_waves_inside(w, x, k)
    else:
        _publish_chain(w, x, k)
    _publish_ends(w, x, k)
    _publish_soil(w, x, k)
    _publish_gauge(w, x, k)
    w[V.energy_residual] = (
        w[V.energy_kinetic]
        + w[V.energy_elastic]
        + w[V.energy_ram]
        + w[V.energy_soil]
        + w[V.energy_ground]
        + w[V.energy_radiated]
        + w[V.energy_plastic]
        + w[V.energy_damping]
        + w[V.energy_contact]
        - w[V.energy_work_head]
        - w[V.energy_work_toe]
        - w[V.energy_work_gravity]
        - w[V.energy_start]
    )


@kernel
def _publish_waves_inside(w, x, k):
    """Write forces, velocities and energies of the segments from their two waves."""
    down, up = view(x, k, A.down), view(x, k, A.up)
    impedance = view(x, k, A.impedance)
    dt = w[V.time_step]
    force, velocity = view(w, k, A.force), view(w, k, A.velocity)
    kinetic, elastic = 0.0, 0.0
    for i in range(len(impedance)):
        velocity[i] = down[i] + up[i]
        strain = down[i] - up[i]
        force[i] = impedance[i] * strain
        kinetic += 0.5 * impedance[i] * dt * velocity[i] * velocity[i]
        elastic += 0.5 * impedance[i] * dt * strain * strain
    w[V.energy_kinetic], w[V.energy_elastic] = kinetic, elastic
    w[V.energy_ground], w[V.energy_ground_elastic], w[V.energy_naive] = 0.0, 0.0, 0.0


@kernel
def _publish_chain(w, x, k):
    """Write forces, velocities and energies of masses and springs."""
    rate, mass = view(x, k, A.rate), view(x, k, A.mass)
    n, last = k[A.impedance + 1], view(k, k, A.free)[2]
    force, velocity = view(w, k, A.force), view(w, k, A.velocity)
    for i in range(n):
        force[i] = spring_force(i, w, x, k)
        velocity[i] = rate[i + 1]
    first = 1 if w[V.ram_mass] > 0.0 else 0
    kinetic, elastic, naive, moving, held = 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(last + 1):
        motion = 0.5 * mass[i] * rate[i] * rate[i]
        ahead = spring_energy(i, w[V.time_step], w, x, k)
        naive += motion + spring_energy(i, 0.0, w, x, k)
        if i < n:
            elastic += ahead
        else:
            held += ahead
        if first <= i <= n:
            kinetic += motion
        elif i > n:
            moving += motion
    w[V.energy_kinetic], w[V.energy_elastic] = kinetic, elastic
    w[V.energy_ground], w[V.energy_ground_elastic], w[V.energy_naive] = moving + held, held, naive


@kernel
def _publish_ends(w, x, k):
    place, rate = view(x, k, A.place), view(x, k, A.rate)
    ram = view(x, k, A.ram_state)
    n = k[A.impedance + 1]
    sign = head_sign(w)
    head, speed = place[0], rate[0]
    if w[V.ram_mass] > 0.0 and w[V.scheme] != CHARACTERISTICS:
        ram[RAM.position], ram[RAM.velocity] = place[0], rate[0]
        if ram[RAM.touching] == 0.0:
            head, speed = place[1], rate[1]
    w[V.head_position], w[V.head_velocity] = sign * head, sign * speed
    w[V.head_zv] = w[V.head_impedance] * speed
    w[V.toe_position], w[V.toe_velocity] = place[n], rate[n]
    w[V.ram_position], w[V.ram_speed] = ram[RAM.position], ram[RAM.velocity]
    w[V.ram_touching] = ram[RAM.touching]
    w[V.energy_ram] = 0.5 * w[V.ram_mass] * ram[RAM.velocity] * ram[RAM.velocity]


@kernel
def _publish_soil(w, x, k):
    n = k[A.impedance + 1]
    resistance = view(w, k, A.shaft_force)
    ahead = 0.0
    rate = view(x, k, A.rate)
    if w[V.scheme] != CHARACTERISTICS:
        ahead = w[V.time_step]
    total = 0.0
    for i in range(1, n + 1):
        shaft = shaft_soil(i, w, x, k)
        resistance[i - 1] = static(shaft, shaft.stretch)
        total += stored(shaft, shaft.stretch, stretched(shaft, ahead * rate[i]))
    toe = toe_soil(True, w, x, k)
    w[V.energy_soil] = total + stored(toe, toe.stretch, stretched(toe, ahead * rate[n]))
    w[V.toe_set] = view(x, k, A.place)[n] - toe.stretch if w[V.toe_condition] == SOIL else 0.0


@kernel
def _publish_gauge(w, x, k):
    i, stress, area = gauge_segment(w, k), view(w, k, A.stress), view(x, k, A.cell_area)
    force = view(w, k, A.force)
    for j in range(len(stress)):
        stress[j] = force[j] / area[j]
    w[V.gauge_force], w[V.gauge_velocity] = force[i], view(w, k, A.velocity)[i]
    w[V.gauge_stress] = stress[i]
    w[V.gauge_zv] = view(x, k, A.impedance)[i] * w[V.gauge_velocity]
