"""The sand cushion in time: start, settling, steps, and what it tells the outside."""

import math

from ..common.component import OK
from ..common.kernels import kernel, view
from ..common.substeps import substep_count, substep_length
from .contact_search import beam_count, disc_count, divide, forget, is_stale, rebuild
from .declarations import (
    ANGLE,
    BEAM_DISCS,
    FLOOR,
    FORCE_ROW,
    FREE,
    HALF_ROOT,
    INVERSE_MASS,
    KIND,
    LAW,
    LAYOUT,
    LINEAR,
    MEAN,
    PREPARED,
    RADIUS,
    RANDOM,
    ROUND,
    ROW,
    SPIN,
    SUM,
)
from .faults import (
    BEAM_GAPS,
    BEAM_TOO_NARROW,
    BEAM_UNORDERED,
    DISC_TOO_WIDE,
    DIVERGED,
    LIST_FULL,
    ROCK_BESIDE,
    ROCK_INSIDE,
    SMOOTH_BUT_COHESIVE,
    TOO_DENSE,
    TOO_LOOSE,
)
from .forces import ROLLING, advance_discs, contact_forces, forget_forces, touch
from .packing import disc_mass, mean_base, pack

V, A = LAYOUT.scalar, LAYOUT.array


_FAR = 1e6
"""Height (m) at which the rock waits while the sand settles."""
_TOUCHING = 1e-9
"""Overlap (m) of rock and sand at the start that passes as touching."""
_GAP = 0.02
"""Gap between two beam discs, in diameters, that passes as none."""
_SETTLING_STEP = 0.4
"""Step of the settling, in stable steps."""
_SETTLING_RATE = 30.0
"""Damping of all motion while settling (1/s)."""
_LOOSE_FRICTION, _LOOSE_ROLLING = 2.0, 1.0
"""Friction and rolling resistance with which a prepared layer first settles."""
_PREPARATION_STEP = 0.8
"""Step of the preparation of a layer, in stable steps."""
_PREPARATION_RATE, _PREPARATION_TIME = 0.7, 100.0
"""Damping of all motion while a layer is prepared, times sqrt(r/g), and time that it may take to settle, and again in which
friction falls to nothing, in sqrt(r/g)."""
_NEARLY_AT_REST = 1e-2
"""Unrest with which a layer counts as settled while it is prepared."""
_DENSITY_TOLERANCE = 0.01
_COLLAPSE = 0.04
"""How far from ``solid_fraction`` a prepared layer may be: too loose when it was compacted all it can, or too dense at rest, to
which also capillary forces press it."""
_AT_REST = 1e-6
"""Sand is at rest when no disc is accelerated by more than this part of gravity, nor moves faster than this times sqrt(g r)."""
_CHECK_EVERY = 50
_INSTANT = 1e-9
"""Internal steps that pass while the forces at the start are computed: no time, but not a division by zero either."""


# --- parameters to laws ---


@kernel
def set_law(kind, stiffness, friction, w, law):
    """Constants of one kind of contact from its k_n (N/m), eq. (1): c = 2 h sqrt(m k), k_s = s k_n. Contacts of sand may yield,
    those of the rock with base and walls do not."""
    at = kind * len(LAW)
    of_sand = kind != KIND.rock_base and kind != KIND.rock_wall
    ratio = w[V.unloading_ratio] if of_sand else 1.0
    tangential = w[V.tangential_ratio] * stiffness
    law[at + LAW.normal] = stiffness
    law[at + LAW.damping] = 2.0 * w[V.damping] * math.sqrt(stiffness)
    law[at + LAW.tangential] = tangential
    law[at + LAW.tangential_damping] = 2.0 * w[V.damping] * math.sqrt(tangential)
    law[at + LAW.friction] = math.tan(friction)
    law[at + LAW.rolling] = w[V.rolling_resistance] if of_sand else 0.0
    law[at + LAW.unloading] = ratio * stiffness
    law[at + LAW.yielding] = 1.0 - 1.0 / ratio
    law[at + LAW.pull] = capillary_strength(w) if kind == KIND.sand else 0.0
    law[at + LAW.bridge] = w[V.cohesion_range]
    law[at + LAW.softness] = 1.0 / tangential


@kernel
def capillary_strength(w):
    """Force of a capillary bridge / distance of the centres (N/m), from the cohesion c of the sand.

    Rumpf (1970): discs of diameter D that fill the part sf of the layer and pull each other with F at z contacts have the tensile
    strength sf z F / (pi D dL); with z = 4 and c = strength * tan(phi), F = pi c D dL / (4 sf tan(phi)).
    """
    if w[V.cohesion] == 0.0:
        return 0.0  # also without friction, where the cohesion has no strength to follow from
    return (
        math.pi
        * w[V.cohesion]
        * w[V.depth]
        / (4.0 * w[V.solid_fraction] * math.tan(w[V.friction_angle]))
    )


@kernel
def sand_stiffness(w):
    """k_n = E_bar dD dL / R_ij0 between two discs (eq. 1) with dD = R_ij0, the distance of centres: k_n = E_bar dL."""
    return w[V.stiffness_factor] * w[V.modulus] * w[V.depth]


@kernel
def stiffness_against(radius, w):
    """k_n (eq. 1) between a sand disc and a body of another radius: dD is the sand disc's diameter, R_ij0 the sum of radii."""
    return sand_stiffness(w) * 2.0 * w[V.disc_radius] / (w[V.disc_radius] + radius)


@kernel
def boundary_stiffness(kind, w):
    """k_n (N/m) of a kind of contact with rock, base or wall. A plane counts as the disc's mirror image."""
    if kind == KIND.rock:
        return w[V.rock_stiffness_ratio] * stiffness_against(w[V.rock_radius], w)
    if kind == KIND.base:
        radius = (
            w[V.beam_radius]
            if w[V.base] == BEAM_DISCS and w[V.base_shape] == ROUND
            else w[V.disc_radius]
        )
        return w[V.base_stiffness_ratio] * stiffness_against(radius, w)
    if kind == KIND.wall:
        return w[V.wall_stiffness_ratio] * sand_stiffness(w)
    return w[V.rock_base_stiffness_ratio] * sand_stiffness(w)


@kernel
def set_laws(w, x, k):
    """Constants of all kinds of contact."""
    law = view(x, k, A.law)
    friction, wall_friction = w[V.friction_angle], w[V.wall_friction_angle]
    set_law(KIND.sand, sand_stiffness(w), friction, w, law)
    for kind in (KIND.rock, KIND.base, KIND.rock_base):
        set_law(kind, boundary_stiffness(kind, w), friction, w, law)
    for kind in (KIND.wall, KIND.rock_wall):
        set_law(kind, boundary_stiffness(kind, w), wall_friction, w, law)


@kernel
def stable_step_of(w):
    """Step below which the integration of the lightest disc among six neighbours of its kind is stable.

    For a contact, (n.(u_j - u_i))^2 <= 2 (n.u_i)^2 + 2 (n.u_j)^2, and six neighbours have sum n n^T = 3 I: translation has
    omega^2 <= 6 (unloading stiffness + k_s) / m. Discs that all turn the same way shear their contacts most: omega^2 <= 24 k_s / m,
    and rolling resistance adds 12 of its stiffness / I among discs, up to 16 in a corner of planes. Dashpots likewise, with the
    velocity of half a step before: dt <= 2 / omega (sqrt(1 + z^2) - z) with 2 z omega their bound.
    """
    least = w[V.disc_radius] * (1.0 - (w[V.disc_spread] if w[V.packing] >= RANDOM else 0.0))
    mass = disc_mass(least, w)
    stiffness = sand_stiffness(w)
    for kind in (KIND.rock, KIND.base, KIND.wall):
        stiffness = max(stiffness, boundary_stiffness(kind, w))
    contact = math.sqrt(stiffness / mass)
    ratio = w[V.tangential_ratio]
    springs, dashpots = 6.0 * (w[V.unloading_ratio] + ratio), 6.0 * (1.0 + math.sqrt(ratio))
    if w[V.rotation] == FREE:
        springs = max(springs, 24.0 * ratio + 8.0 * ROLLING * w[V.rolling_resistance] ** 2)
        dashpots = max(dashpots, 24.0 * math.sqrt(ratio))
    if w[V.base] != FLOOR:
        dashpots += (
            2.0 * (1.0 + math.sqrt(ratio)) * math.sqrt(w[V.beam_disc_mass] / mass)
        )  # between two beam discs
    omega = contact * math.sqrt(springs)
    z = w[V.damping] * dashpots * contact / omega
    return 2.0 / omega * (math.sqrt(1.0 + z * z) - z)


# --- rock and beam as given ---


@kernel
def set_boundaries(ahead, w, x, k):
    """Put rock and beam discs where the inputs say, ``ahead`` seconds later; count the work their contact forces do on the sand.

    Before the first call their radii must be known.
    """
    n, m = disc_count(k), beam_count(k)
    body, load, sums = view(x, k, A.body), view(x, k, A.load), view(x, k, A.sums)
    sums[SUM.rock] -= place(
        n,
        w[V.rock_position_x],
        w[V.rock_position_y],
        w[V.rock_angle],
        w[V.rock_velocity_x],
        w[V.rock_velocity_y],
        w[V.rock_angular_velocity],
        ahead,
        body,
        load,
    )
    px, py, angle = (
        view(w, k, A.beam_position_x),
        view(w, k, A.beam_position_y),
        view(w, k, A.beam_angle),
    )
    vx, vy, omega = (
        view(w, k, A.beam_velocity_x),
        view(w, k, A.beam_velocity_y),
        view(w, k, A.beam_angular_velocity),
    )
    for b in range(m):
        sums[SUM.beam] -= place(
            n + 1 + b, px[b], py[b], angle[b], vx[b], vy[b], omega[b], ahead, body, load
        )


@kernel
def place(b, px, py, angle, vx, vy, omega, ahead, body, load):
    """Move boundary b; returns the work (J) that the present contact force on it does along this way."""
    at, force = ROW * b, FORCE_ROW * b
    new_x, new_y, new_angle = px + vx * ahead, py + vy * ahead, angle + omega * ahead
    radius = body[at + RADIUS]
    work = (
        load[force] * (new_x - body[at])
        + load[force + 1] * (new_y - body[at + 1])
        + load[force + 2] * radius * (new_angle - body[at + ANGLE])
    )
    body[at], body[at + 1], body[at + ANGLE] = new_x, new_y, new_angle
    body[at + 2], body[at + 3], body[at + SPIN] = vx, vy, omega * radius
    return work


@kernel
def size_boundaries(w, x, k):
    """Radii of rock and beam discs, the roots of their masses for the dashpots, and the bodies that are far away."""
    n, m = disc_count(k), beam_count(k)
    body = view(x, k, A.body)
    body[ROW * n + RADIUS] = w[V.rock_radius]
    body[ROW * n + HALF_ROOT] = 0.5 * math.sqrt(w[V.rock_mass])
    for b in range(n + 1, n + m + 1):
        body[ROW * b + RADIUS] = w[V.beam_radius]
        body[ROW * b + HALF_ROOT] = 0.5 * math.sqrt(w[V.beam_disc_mass])
    for b in range(n + m + 1, body.size // ROW):
        body[ROW * b] = _FAR


# --- motion of the discs ---


@kernel
def advance(dt, w, x, k):
    """One internal step with rock and beam where they are. Returns status, kinetic and potential energy at its beginning."""
    if is_stale(w, x, k) and not rebuild(w, x, k):
        return LIST_FULL, 0.0, 0.0
    kinetic, potential = advance_discs(dt, w, x, k)
    return OK, kinetic, potential


# --- start ---


@kernel
def unrest(w, x, k):
    """Largest acceleration (in g) and speed (in sqrt(g r)) of any disc, whichever is larger."""
    contact_forces(_INSTANT * w[V.stable_step], w, x, k)
    body, load = view(x, k, A.body), view(x, k, A.load)
    g = max(w[V.gravity], 1e-12)
    largest = 0.0
    for i in range(disc_count(k)):
        at, force = ROW * i, FORCE_ROW * i
        ax, ay = (
            load[force] * body[at + INVERSE_MASS],
            load[force + 1] * body[at + INVERSE_MASS] - w[V.gravity],
        )
        v2 = body[at + 2] * body[at + 2] + body[at + 3] * body[at + 3]
        largest = max(
            largest, math.sqrt(ax * ax + ay * ay) / g, math.sqrt(v2 / (g * w[V.disc_radius]))
        )
    forget_forces(x, k)
    return largest


@kernel
def slow_down(factor, w, x, k):
    """Multiply all velocities of the discs."""
    body = view(x, k, A.body)
    for i in range(disc_count(k)):
        for q in range(2, 5):
            body[ROW * i + q] *= factor


@kernel
def come_to_rest(longest, part, rate, rest, w, x, k):
    """Let the discs come to rest under gravity, with base and walls at rest and the rock away: until their unrest is below
    ``rest``, at most ``longest`` (s), in steps of ``part`` stable steps. All motion is damped with ``rate`` (1/s)."""
    dt = part * w[V.stable_step]
    for s in range(int(longest / dt)):
        status, _, _ = advance(dt, w, x, k)
        if status != OK:
            return status
        if s % _CHECK_EVERY == 0 and unrest(w, x, k) < rest:
            break
        slow_down(1.0 - rate * dt, w, x, k)
    return OK


@kernel
def settle(w, x, k):
    """Let the discs come to rest and publish how far they are from it."""
    status = come_to_rest(w[V.settling_time], _SETTLING_STEP, _SETTLING_RATE, _AT_REST, w, x, k)
    w[V.unrest] = unrest(w, x, k)
    slow_down(0.0, w, x, k)
    return status


@kernel
def prepare(w, x, k):
    """Bring the layer to ``solid_fraction``: let it settle as loosely as it can, with discs that hardly slide or roll, then make
    them slide more and more easily until it is dense enough. From there on it has the friction and the cohesion of the sand."""
    law = view(x, k, A.law)
    friction, rolling, pull = law[LAW.friction], law[LAW.rolling], law[LAW.pull]
    unit = math.sqrt(w[V.disc_radius] / max(w[V.gravity], 1e-12))
    rate, longest = _PREPARATION_RATE / unit, _PREPARATION_TIME * unit
    law[LAW.friction], law[LAW.rolling], law[LAW.pull] = _LOOSE_FRICTION, _LOOSE_ROLLING, 0.0
    status = come_to_rest(longest, _PREPARATION_STEP, rate, _NEARLY_AT_REST, w, x, k)
    dt = _PREPARATION_STEP * w[V.stable_step]
    for s in range(int(longest / dt)):
        if status != OK or solid_fraction(w, x, k) >= w[V.solid_fraction]:
            break
        law[LAW.friction] = _LOOSE_FRICTION * (1.0 - s * dt / longest)
        law[LAW.rolling] = _LOOSE_ROLLING * (1.0 - s * dt / longest)
        status, _, _ = advance(dt, w, x, k)
        slow_down(1.0 - rate * dt, w, x, k)
    law[LAW.friction], law[LAW.rolling], law[LAW.pull] = friction, rolling, pull
    return status


@kernel
def layer_height(w, x, k):
    """Height (m) of a layer of even density with the discs' centre of gravity, above the mean level of the base."""
    n, body = disc_count(k), view(x, k, A.body)
    mass, moment = 0.0, 0.0
    for i in range(n):
        area = body[ROW * i + RADIUS] * body[ROW * i + RADIUS]
        mass += area
        moment += area * body[ROW * i + 1]
    return 2.0 * (moment / mass - mean_base(w, body, n, beam_count(k)))


@kernel
def solid_fraction(w, x, k):
    """Part of the layer that discs fill, with the height :func:`layer_height`."""
    body = view(x, k, A.body)
    area = 0.0
    for i in range(disc_count(k)):
        area += math.pi * body[ROW * i + RADIUS] * body[ROW * i + RADIUS]
    return area / (w[V.box_width] * layer_height(w, x, k))


@kernel
def initialise(w, x, k):
    """Pack the discs and let them settle."""
    n = disc_count(k)
    w[V.stable_step] = stable_step_of(w)
    if 2.0 * w[V.disc_radius] * (1.0 + w[V.disc_spread]) > w[V.box_width] * (1.0 + _GAP):
        return DISC_TOO_WIDE
    if w[V.cohesion] > 0.0 and w[V.friction_angle] == 0.0:
        return SMOOTH_BUT_COHESIVE
    for q in range(x.size):
        x[q] = 0.0
    divide(k)
    set_laws(w, x, k)
    size_boundaries(w, x, k)
    set_boundaries(0.0, w, x, k)
    body = view(x, k, A.body)
    body[ROW * n + 1] = _FAR
    for b in range(n, n + 1 + beam_count(k)):
        for q in range(2, 5):
            body[ROW * b + q] = 0.0
    pack(w, x, k, sand_stiffness(w), boundary_stiffness(KIND.base, w))
    forget(x, k)
    if not rebuild(w, x, k):
        return LIST_FULL
    status = prepare(w, x, k) if w[V.packing] == PREPARED else OK
    if status == OK:
        status = settle(w, x, k)
    w[V.layer_height], w[V.layer_solid_fraction] = layer_height(w, x, k), solid_fraction(w, x, k)
    if status == OK and w[V.packing] == PREPARED:
        status = preparation_fault(w)
    sums = view(x, k, A.sums)
    for q in range(sums.size):
        sums[q] = 0.0
    sums[SUM.beam_key] = beam_key(w, k)
    return status


@kernel
def beam_key(w, k):
    """A number that changes with the beam's place, on which the sand has settled."""
    px, py = view(w, k, A.beam_position_x), view(w, k, A.beam_position_y)
    key = 0.0
    for b in range(px.size):
        key += (b + 1) * (px[b] + math.pi * py[b])
    return key


@kernel
def surface_under_rock(w, x, k):
    """Highest point (m) of the sand within a rock's radius of the rock; of all sand where there is none."""
    body = view(x, k, A.body)
    near, anywhere = -math.inf, -math.inf
    for i in range(disc_count(k)):
        top = body[ROW * i + 1] + body[ROW * i + RADIUS]
        anywhere = max(anywhere, top)
        if abs(body[ROW * i] - w[V.rock_position_x]) < w[V.rock_radius]:
            near = max(near, top)
    return near if near > -math.inf else anywhere


@kernel
def preparation_fault(w):
    """Fault of the start: a layer that is not as dense as it was to be."""
    if w[V.layer_solid_fraction] > w[V.solid_fraction] + _COLLAPSE:
        return TOO_LOOSE
    if w[V.layer_solid_fraction] < w[V.solid_fraction] - _DENSITY_TOLERANCE:
        return TOO_DENSE
    return OK


@kernel
def beam_fault(w, k):
    """Fault of the start: a beam that does not carry the whole cushion."""
    px = view(w, k, A.beam_position_x)
    widest = 0.0
    for b in range(px.size - 1):
        if px[b + 1] <= px[b]:
            return BEAM_UNORDERED
        widest = max(widest, px[b + 1] - px[b])
    if w[V.base] == BEAM_DISCS and widest > 2.0 * w[V.beam_radius] * (1.0 + _GAP):
        return BEAM_GAPS
    reach = w[V.beam_radius] * (1.0 + 1e-6)
    if px[0] - reach > w[V.box_left] or px[px.size - 1] + reach < w[V.box_left] + w[V.box_width]:
        return BEAM_TOO_NARROW
    return OK


@kernel
def rock_fault(w, x, k):
    """Fault of the start: a rock inside the sand or in a side wall."""
    n, m, body = disc_count(k), beam_count(k), view(x, k, A.body)
    for wall in range(n + m + 1, n + m + 3):
        _, _, gap, _, _ = touch(n, wall, w, body, n, m)
        if gap < -_TOUCHING:
            return ROCK_BESIDE
    for i in range(n):
        dx, dy = body[ROW * n] - body[ROW * i], body[ROW * n + 1] - body[ROW * i + 1]
        if math.sqrt(dx * dx + dy * dy) < w[V.rock_radius] + body[ROW * i + RADIUS] - _TOUCHING:
            return ROCK_INSIDE
    return OK


@kernel
def evaluate(w, x, k):
    """Outputs at the start; packs anew when the beam was moved since."""
    sums = view(x, k, A.sums)
    if w[V.base] != FLOOR:
        status = beam_fault(w, k)
        if status == OK and sums[SUM.beam_key] != beam_key(w, k):
            status = initialise(w, x, k)
        if status != OK:
            return status
    set_boundaries(0.0, w, x, k)
    w[V.surface_height] = surface_under_rock(w, x, k)
    w[V.penetration] = penetration(0.0, w)
    status = rock_fault(w, x, k)
    if status != OK:
        return status
    if not rebuild(w, x, k):
        return LIST_FULL
    contact_forces(_INSTANT * w[V.internal_step], w, x, k)
    for q in (
        SUM.normal_dashpot,
        SUM.tangential_dashpot,
        SUM.sliding,
        SUM.rolling,
        SUM.plastic,
        SUM.rock,
        SUM.beam,
    ):
        sums[q] = 0.0
    w[V.energy_start] = 0.0
    publish_energies(kinetic_energy(x, k), potential_energy(w, x, k), w, sums)
    w[V.energy_start] = (
        w[V.energy_kinetic] + w[V.energy_elastic] + w[V.energy_capillary] + w[V.energy_gravity]
    )
    w[V.energy_residual] = 0.0
    collect_forces(1.0, True, w, x, k)
    forget_forces(x, k)
    return OK


@kernel
def kinetic_energy(x, k):
    """Kinetic energy of all discs (J)."""
    body = view(x, k, A.body)
    total = 0.0
    for i in range(disc_count(k)):
        at = ROW * i
        speeds = (
            body[at + 2] * body[at + 2]
            + body[at + 3] * body[at + 3]
            + 0.5 * body[at + SPIN] * body[at + SPIN]
        )
        total += 0.5 * speeds / body[at + INVERSE_MASS]
    return total


@kernel
def potential_energy(w, x, k):
    """Energy of all discs in gravity (J)."""
    body = view(x, k, A.body)
    total = 0.0
    for i in range(disc_count(k)):
        total += body[ROW * i + 1] / body[ROW * i + INVERSE_MASS]
    return total * w[V.gravity]


# --- what the outside sees ---


@kernel
def collect_forces(share, first, w, x, k):
    """Add ``share`` of the present contact forces to the outputs, which begin anew with the ``first``."""
    n, m = disc_count(k), beam_count(k)
    load, sums = view(x, k, A.load), view(x, k, A.sums)
    fx, fy, torque = (
        view(w, k, A.beam_force_x),
        view(w, k, A.beam_force_y),
        view(w, k, A.beam_torque),
    )
    keep = 0.0 if first else 1.0
    at = FORCE_ROW * n
    w[V.rock_force_x] = keep * w[V.rock_force_x] + share * load[at]
    w[V.rock_force_y] = keep * w[V.rock_force_y] + share * load[at + 1]
    w[V.rock_torque] = keep * w[V.rock_torque] + share * load[at + 2] * w[V.rock_radius]
    for b in range(m):
        at = FORCE_ROW * (n + 1 + b)
        fx[b] = keep * fx[b] + share * load[at]
        fy[b] = keep * fy[b] + share * load[at + 1]
        torque[b] = keep * torque[b] + share * load[at + 2] * w[V.beam_radius]
    w[V.transmitted_force] = keep * w[V.transmitted_force] + share * sums[SUM.transmitted]


@kernel
def publish_energies(kinetic, potential, w, sums):
    """Energies at the beginning of the last internal step, and the error of their balance."""
    w[V.energy_kinetic], w[V.energy_gravity], w[V.energy_elastic] = (
        kinetic,
        potential,
        sums[SUM.elastic],
    )
    w[V.energy_normal_dashpot], w[V.energy_tangential_dashpot] = (
        sums[SUM.normal_dashpot],
        sums[SUM.tangential_dashpot],
    )
    w[V.energy_sliding], w[V.energy_rolling] = sums[SUM.sliding], sums[SUM.rolling]
    w[V.energy_work_rock], w[V.energy_work_beam] = sums[SUM.rock], sums[SUM.beam]
    w[V.energy_plastic], w[V.energy_capillary] = sums[SUM.plastic], sums[SUM.capillary]
    stored = w[V.energy_kinetic] + w[V.energy_elastic] + w[V.energy_capillary] + w[V.energy_gravity]
    lost = (
        w[V.energy_normal_dashpot]
        + w[V.energy_tangential_dashpot]
        + w[V.energy_sliding]
        + w[V.energy_rolling]
        + w[V.energy_plastic]
    )
    w[V.energy_residual] = (
        stored + lost - w[V.energy_work_rock] - w[V.energy_work_beam] - w[V.energy_start]
    )


@kernel
def penetration(ahead, w):
    """Depth (m) of the rock's lowest point under the surface at the start."""
    return w[V.surface_height] - (
        w[V.rock_position_y] + w[V.rock_velocity_y] * ahead - w[V.rock_radius]
    )


@kernel
def step(t, h, w, x, k):
    """Advance by h (s)."""
    n = substep_count(h, w[V.internal_step])
    dt = substep_length(h, n, w[V.internal_step])
    linear, mean = w[V.kinematics] == LINEAR, w[V.forces] == MEAN
    kinetic, potential = 0.0, 0.0
    for s in range(n):
        if s == 0 or linear:
            set_boundaries(s * dt if linear else 0.0, w, x, k)
        status, kinetic, potential = advance(dt, w, x, k)
        if status != OK:
            return status
        if mean:
            collect_forces(1.0 / n, s == 0, w, x, k)
    if not mean:
        collect_forces(1.0, True, w, x, k)
    publish_energies(kinetic, potential, w, view(x, k, A.sums))
    w[V.penetration] = penetration(h if linear else 0.0, w)
    return OK if math.isfinite(kinetic + w[V.energy_elastic]) else DIVERGED
