"""The partner's side of a wave port: what acts on the end of a rod and is told the waves that come out of it.

The end of a rod of impedance Z (N s/m) obeys ``F = Z v - c``: F the force of the partner on the end (N, compression positive), v
the velocity of the end into the rod (m/s), c the wave that comes out of the rod, known beforehand. At the toe of a pile the same
rod is looked at from below: with v counted downwards the law reads ``F = c - Z v`` there.
"""

from collections import namedtuple

from .kernels import kernel

Contact = namedtuple("Contact", "velocity mean_force separation")
"""Velocity of the mass at the end of the step (m/s), mean force between mass and rod (N), and the part of the step, 0 to 1, after
which they separated; 2 if they did not."""

TOGETHER = 2.0
"""``separation`` of a step in which the mass stays on the rod."""


@kernel
def rigid_mass(mass, velocity, drive, impedance, wave, dt):
    """A step dt (s) of a rigid mass (kg) that lies on the end of a rod, under its own force drive (N, into the rod).

    Implicit midpoint rule: stable and free of numerical loss for any dt. The contact takes no tension; where the force falls to
    zero in the step, the mass gets the impulse until then (force linear in time) and flies on.
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
