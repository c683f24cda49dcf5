"""The exact scheme: waves move by one segment in a step, and nodes divide them by impedances.

In a step dt = dx/c each segment hands its waves on to the nodes at its ends. The velocity v of a
node follows from

    Z1 (2 f - v) - Z2 (v - 2 b) = R,

with f the velocity of the wave that comes down from above, b that of the wave that comes up from
below, Z1 and Z2 the impedances above and below, and R the force that holds the node. Waves are
constant over a segment, so that jumps stay sharp.
"""

from ..common.kernels import kernel, view
from ..common.smith_soil import gripped
from ..common.wave_port import End, Heard, Ram, course, struck
from .bookkeeping import book_head, book_soil, envelope, shaft_soil, toe_soil
from .declarations import LAYOUT, MATCHED, PORT, RAM
from .segments import below_toe, toe_is_fixed

V, A = LAYOUT.scalar, LAYOUT.array


@kernel
def advance(time, dt, head_force, toe_force, w, x, k):
    """Advance the waves by one internal step.

    Parameters
    ----------
    time, dt : float
        Start and length of the step (s).
    head_force, toe_force : float
        Mean forces of the ports (N): downwards on the head, upwards on the toe.
    w, x : ndarray of float64
        Variables and state.
    k : ndarray of int64
        Integer state.
    """
    down, up, impedance = view(x, k, A.down), view(x, k, A.up), view(x, k, A.impedance)
    place, rate, n = view(x, k, A.place), view(x, k, A.rate), len(impedance)
    arriving = down[0]
    rate[0] = _head(time, dt, head_force, w, x, k)
    down[0] = rate[0] - up[0]
    for i in range(1, n):
        above, below = impedance[i - 1], impedance[i]
        drive = 2.0 * (above * arriving + below * up[i]) + weight(i, dt, w, x, k)
        rate[i] = _node(i, above + below, drive, dt, w, x, k)
        up[i - 1] = rate[i] - arriving
        envelope(i - 1, above * (down[i - 1] - up[i - 1]), w, x, k)
        arriving, down[i] = down[i], rate[i] - up[i]
    rate[n] = _toe(arriving, dt, toe_force, w, x, k)
    up[n - 1] = rate[n] - arriving
    envelope(n - 1, impedance[n - 1] * (down[n - 1] - up[n - 1]), w, x, k)
    for i in range(n + 1):
        place[i] += rate[i] * dt


@kernel
def weight(i, dt, w, x, k):
    """Return the weight (N) of the rod nearest to node i: half a segment on either side.

    Parameters
    ----------
    i : int
        Node, 0 is the head.
    dt : float
        Travel time of a segment (s).
    w, x : ndarray of float64
        Variables and state.
    k : ndarray of int64
        Integer state.

    Returns
    -------
    float
        1/2 dt g (Z1 + Z2).
    """
    impedance = view(x, k, A.impedance)
    above = impedance[i - 1] if i > 0 else 0.0
    below = impedance[i] if i < len(impedance) else 0.0
    return 0.5 * dt * w[V.gravity] * (above + below)


@kernel
def _head(time, dt, force, w, x, k):
    """Return the velocity of the head (m/s), mean over the step."""
    up, impedance = view(x, k, A.up), view(x, k, A.impedance)
    lead = weight(0, dt, w, x, k)
    wave = 2.0 * impedance[0] * up[0] + lead
    acting = force
    if w[V.ram_mass] > 0.0:
        acting = _ram(time, dt, force, wave, w, x, k)
    else:
        w[V.energy_work_head] += force * (force + wave) / impedance[0] * dt
    velocity = (acting + wave) / impedance[0]
    w[V.energy_work_gravity] += lead * velocity * dt
    book_head(acting, velocity, dt, w)
    return velocity


@kernel
def _ram(time, dt, force, wave, w, x, k):
    """Move the ram and return the mean force between it and the head (N)."""
    state = view(x, k, A.ram_state)
    head = view(x, k, A.place)[0]
    drive = force + w[V.ram_mass] * w[V.gravity]
    ram = Ram(state[RAM.position], state[RAM.velocity], state[RAM.touching], w[V.ram_separation])
    end = End(view(x, k, A.impedance)[0], wave, head)
    heard = Heard(state[RAM.wave], state[RAM.rate], state[RAM.length])
    way, heard = course(heard, wave, dt)
    state[RAM.wave], state[RAM.rate], state[RAM.length] = heard.wave, heard.rate, heard.length
    ram, stroke = struck(ram, w[V.ram_mass], drive, end, way, time, dt)
    state[RAM.position], state[RAM.velocity] = ram.position, ram.velocity
    state[RAM.touching], w[V.ram_separation] = ram.touching, ram.separation
    w[V.energy_contact] += stroke.force * (stroke.mass_velocity - stroke.end_velocity) * dt
    w[V.energy_work_head] += force * stroke.mass_velocity * dt
    w[V.energy_work_gravity] += w[V.ram_mass] * w[V.gravity] * stroke.mass_velocity * dt
    return stroke.force


@kernel
def _node(i, impedance, drive, dt, w, x, k):
    """Return the velocity (m/s) of a node inside the rod, mean over the step."""
    shaft = shaft_soil(i, w, x, k)
    velocity = drive / impedance
    if shaft.ultimate > 0.0:
        grip = gripped(impedance, drive, shaft, toe_soil(False, w, x, k), dt)
        velocity = grip.velocity
        book_soil(i, shaft, toe_soil(False, w, x, k), grip, dt, w, x, k)
    w[V.energy_work_gravity] += weight(i, dt, w, x, k) * velocity * dt
    return velocity


@kernel
def _toe(arriving, dt, force, w, x, k):
    """Return the velocity of the toe (m/s), mean over the step, from the arriving wave."""
    impedance = view(x, k, A.impedance)
    n, what = k[A.impedance + 1], w[V.toe_condition]
    below = impedance[n - 1]
    lead = weight(n, dt, w, x, k)
    shaft, toe = shaft_soil(n, w, x, k), toe_soil(True, w, x, k)
    drive, leaving = 2.0 * below * arriving + lead, below
    if toe_is_fixed(w):
        w[V.toe_contact_force] = drive
        return 0.0
    standing = below if what == MATCHED else below_toe(w, x, k)
    if what == PORT:
        drive -= force
    velocity = drive / (leaving + standing)
    w[V.toe_contact_force] = force if what == PORT else standing * velocity
    if shaft.ultimate + toe.ultimate > 0.0:
        grip = gripped(leaving + standing, drive, shaft, toe, dt)
        velocity = grip.velocity
        book_soil(n, shaft, toe, grip, dt, w, x, k)
    if what == PORT:
        w[V.energy_work_toe] -= force * velocity * dt
    w[V.energy_radiated] += standing * velocity * velocity * dt
    w[V.energy_work_gravity] += lead * velocity * dt
    return velocity
