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
Stroke = namedtuple("Stroke", "force mass_velocity end_velocity")
"""Means over a step: force between mass and rod (N), velocities of mass and rod's end (m/s)."""
Contact = namedtuple("Contact", "velocity mean_force separation")
"""Velocity of the mass at the end of the step (m/s), mean force between mass and rod (N), and the
part of the step, 0 to 1, after which they separated; 2 if they did not."""

TOGETHER = 2.0
"""``separation`` of a step in which the mass stays on the rod."""


@kernel
def struck(ram, mass, drive, end, time, dt):
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
        velocity, force = contact.velocity, contact.mean_force
        if contact.separation < TOGETHER:
            touching = 0.0
            separation = time + contact.separation * dt
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
    half = 0.5 * dt / mass
    mean = (velocity + half * (drive + wave)) / (1.0 + half * impedance)
    after = 2.0 * mean - velocity
    first, last = impedance * velocity - wave, impedance * after - wave
    if last >= 0.0:
        return Contact(after, impedance * mean - wave, TOGETHER)
    part = first / (first - last) if first > 0.0 else 0.0
    force = 0.5 * part * max(first, 0.0)
    return Contact(velocity + dt / mass * (drive - force), force, part)
