"""The partner's side of a wave port: a rigid mass that acts on the end of a rod.

The end of a rod of impedance Z (N s/m) obeys ``F = Z v - c``: F the force of the partner on the end
(N, compression positive), v the velocity of the end into the rod (m/s), c the wave that comes out
of the rod, known beforehand. At the toe of a pile the same rod is looked at from below: with v
counted downwards the law reads ``F = c - Z v`` there.
"""

from collections import namedtuple

from .kernels import kernel

End = namedtuple("End", "impedance wave position")
"""The end of a rod: impedance Z (N s/m), wave c that comes out of it in the step (N), and its
position at the start of the step (m, into the rod)."""
Ram = namedtuple("Ram", "position velocity touching separation")
"""A rigid mass at the end of a rod: position and velocity into the rod (m, m/s), 1.0 while it
touches and 0.0 otherwise, and the time at which it last left the rod (s; -1 before)."""
Course = namedtuple("Course", "start rate hidden")
"""The wave within a step as a straight line: its value at the start (N), its rate (N/s), and the
time (s) by which a separation may be older than the step in which the mean waves show it."""
Heard = namedtuple("Heard", "wave rate length")
"""The step before, as a partner keeps it: mean wave (N), its rate (N/s), and the length of the
step (s; 0: there was none)."""
Stroke = namedtuple("Stroke", "force mass_velocity end_velocity")
"""Means over a step: force between mass and rod (N), velocities of mass and rod's end (m/s)."""
Contact = namedtuple("Contact", "velocity mean_force separation")
"""Velocity of the mass at the end of the step (m/s), mean force between mass and rod (N), and the
part of the step, 0 to 1, after which they separated; 2 if they did not."""

TOGETHER = 2.0
"""``separation`` of a step in which the mass stays on the rod."""
_STEEPEST = 2.0
"""A wave whose rate grows by more than this factor from one step to the next has jumped."""


@kernel
def course(heard, wave, length):
    """Return how the wave goes within a step, of which its mean alone is known.

    From the means of this step and the one before: a straight line, wrong by the square of the
    step. Where the wave has jumped between the steps it is constant, which is as good as its front
    is sharp.

    Parameters
    ----------
    heard : Heard
        The step before.
    wave : float
        Mean wave of this step (N).
    length : float
        Of this step (s).

    Returns
    -------
    tuple of Course and Heard
        The wave within the step, and what the next step has to know of it.
    """
    rate = 0.0
    if heard.length > 0.0:
        rate = 2.0 * (wave - heard.wave) / (length + heard.length)
    now = Heard(wave, rate, length)
    if abs(rate) > _STEEPEST * abs(heard.rate):
        return Course(wave, 0.0, 0.0), now
    return Course(wave - 0.5 * rate * length, rate, 0.5 * length), now


@kernel
def struck(ram, mass, drive, end, way, time, dt):
    """Return a rigid mass after a step at the end of a rod, touching it or flying free.

    Parameters
    ----------
    ram : Ram
        At the start of the step.
    mass : float
        Its mass (kg).
    drive : float
        Force on it besides that of the rod, into the rod (N).
    end : End
        The end of the rod.
    way : Course
        The wave within the step: it tells the time of separation, the mean wave all else.
    time, dt : float
        Start and length of the step (s).

    Returns
    -------
    tuple of Ram and Stroke
        The mass at the end of the step, and the means over it.
    """
    velocity, touching, separation, force = ram.velocity, ram.touching, ram.separation, 0.0
    if touching > 0.0:
        contact = rigid_mass(mass, velocity, drive, end.impedance, end.wave, dt)
        force = contact.mean_force
        if contact.separation < TOGETHER:
            touching = 0.0
            separation = time + _parting(mass, velocity, drive, end, way, dt)
        velocity = contact.velocity
    else:
        velocity += drive / mass * dt
    mean, end_velocity = 0.5 * (ram.velocity + velocity), (force + end.wave) / end.impedance
    position, reached = ram.position + mean * dt, end.position + end_velocity * dt
    if touching == 0.0 and position >= reached:
        touching = 1.0
    if touching > 0.0:
        position = reached
    return Ram(position, velocity, touching, separation), Stroke(force, mean, end_velocity)


@kernel
def rigid_mass(mass, velocity, drive, impedance, wave, dt):
    """Return what a step does to a rigid mass that lies on the end of a rod.

    Implicit midpoint rule: stable and free of numerical loss for any step. The contact takes no
    tension; where the force falls to zero in the step, the mass gets the impulse until then (force
    linear in time) and flies on.

    Parameters
    ----------
    mass, velocity : float
        Of the mass (kg, m/s into the rod).
    drive : float
        Force on it besides that of the rod, into the rod (N).
    impedance, wave : float
        Z and c of the rod (N s/m, N).
    dt : float
        Length of the step (s).

    Returns
    -------
    Contact
        Velocity at the end, mean force and separation.
    """
    mean = _held(mass, velocity, drive, impedance, wave, dt)
    after = 2.0 * mean - velocity
    first, last = impedance * velocity - wave, impedance * after - wave
    if last >= 0.0:
        return Contact(after, impedance * mean - wave, TOGETHER)
    part = first / (first - last) if first > 0.0 else 0.0
    force = 0.5 * part * max(first, 0.0)
    return Contact(velocity + dt / mass * (drive - force), force, part)


@kernel
def _held(mass, velocity, drive, impedance, wave, dt):
    """Return the mean velocity (m/s) of a step in which the mass stays on the rod."""
    half = 0.5 * dt / mass
    return (velocity + half * (drive + wave)) / (1.0 + half * impedance)


@kernel
def _parting(mass, velocity, drive, end, way, dt):
    """Return the time (s) from the start of the step at which the force on the rod is zero.

    The force is taken as linear in time, with the wave as it goes within the step. The time is
    negative where the mean wave of the step before has hidden the separation.
    """
    after = 2.0 * _held(mass, velocity, drive, end.impedance, end.wave, dt) - velocity
    first = end.impedance * velocity - way.start
    last = end.impedance * after - way.start - way.rate * dt
    if last >= first:
        return 0.0
    return min(max(first / (first - last) * dt, -way.hidden), dt + way.hidden)
