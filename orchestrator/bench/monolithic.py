"""The laboratory impact as one program, without ports, FMI or master.

This is the reference that the co-simulation is compared with: rock, sand and beam in one loop over
shared positions. It uses the components' physics (contact forces, motion of discs, rock and beam)
but its own loop: forces at the positions of the moment, then everything moves, the beam in shorter
steps.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rockshed.components.common.component import Instance
from rockshed.components.common.kernels import kernel, view
from rockshed.components.common.rigid_body import Load
from rockshed.components.falling_rock import COMPONENT as ROCK
from rockshed.components.falling_rock import kernel as rock_kernel
from rockshed.components.falling_rock.declarations import LAYOUT as ROCK_LAYOUT
from rockshed.components.rbsm_beam import COMPONENT as BEAM
from rockshed.components.rbsm_beam import kernel as beam_kernel
from rockshed.components.rbsm_beam.declarations import LAYOUT as BEAM_LAYOUT
from rockshed.components.sand_cushion import COMPONENT as SAND
from rockshed.components.sand_cushion import kernel as sand_kernel
from rockshed.components.sand_cushion import start as sand_start
from rockshed.components.sand_cushion.bodies import bodies_of
from rockshed.components.sand_cushion.declarations import LAYOUT as SAND_LAYOUT
from rockshed.components.sand_cushion.declarations import SUM

from ..core.system.system import SystemSpec

RV, SV, BV = ROCK_LAYOUT.scalar, SAND_LAYOUT.scalar, BEAM_LAYOUT.scalar
SA, BA = SAND_LAYOUT.array, BEAM_LAYOUT.array

COLUMNS = (
    "transmitted_force",
    "rock_force_y",
    "penetration",
    "beam_energy",
    "work_on_rock",
    "work_on_beam",
)


@dataclass
class Monolith:
    """Three subsystems in one program, initialised.

    ``history`` has a row of :data:`COLUMNS` for every step.
    """

    rock: Instance
    sand: Instance
    beam: Instance
    dt: float
    beam_step: float
    history: NDArray[np.float64]

    def run(self) -> None:
        """Make all steps, from the start to the stop time."""
        inertia = float(rock_kernel.inertia(self.rock.w))
        rock, sand, beam = self.rock, self.sand, self.beam
        status = _run(
            self.dt,
            round(self.dt / self.beam_step),
            self.beam_step,
            inertia,
            rock.w,
            sand.w,
            sand.x,
            sand.k,
            beam.w,
            beam.x,
            beam.k,
            self.history,
        )
        assert status == 0, f"stopped with status {status}"

    def column(self, name: str) -> NDArray[np.float64]:
        """One column of the history."""
        return self.history[:, COLUMNS.index(name)]


def from_system(
    system: SystemSpec, stop_time: float, dt: float = 1e-5, beam_step: float = 1e-6
) -> Monolith:
    """Return the monolithic program of a laboratory system: same parameters, same start."""
    instances = {
        name: component.instance(**_sizes(name, system))
        for name, component in (("rock", ROCK), ("sand", SAND), ("beam", BEAM))
    }
    for name, instance in instances.items():
        for parameter, value in system.components[name].parameters.items():
            instance[parameter] = value
    for shared in system.shared.values():
        for target in shared.targets:
            name, _, parameter = target.partition(".")
            instances[name][parameter] = shared.value
    rock, sand, beam = instances["rock"], instances["sand"], instances["beam"]
    for instance in (rock, beam):
        instance.initialise()
    for quantity in (
        "position.x",
        "position.y",
        "angle",
        "velocity.x",
        "velocity.y",
        "angular_velocity",
    ):
        sand[f"rock.{quantity}"] = rock[quantity]
        sand[f"beam.{quantity}"] = beam[quantity]
    sand.initialise()
    return Monolith(
        rock, sand, beam, dt, beam_step, np.zeros((round(stop_time / dt), len(COLUMNS)))
    )


def _sizes(name: str, system: SystemSpec) -> Mapping[str, int]:
    width = system.components["sand"].parameters["box.width"]
    return {"rock": {}, "sand": {"discs": round(float(width) / 0.01) * 10}, "beam": {}}[name]


@kernel
def _run(dt, beam_steps, beam_step, inertia, rw, sw, sx, sk, bw, bx, bk, history):
    bodies, sums = bodies_of(sx, sk), view(sx, sk, SA.sums)
    rock = bodies.rock
    fx, fy, torque = view(bw, bk, BA.force_x), view(bw, bk, BA.force_y), view(bw, bk, BA.torque)
    for s in range(history.shape[0]):
        status, _, _ = sand_start.advance(dt, sw, sx, sk)
        if status != 0:
            return status
        rock_fx, rock_fy = bodies.force_x[rock], bodies.force_y[rock]
        rock_torque = bodies.turn[rock] * sw[SV.rock_radius]
        rock_x, rock_y, rock_angle = rw[RV.position_x], rw[RV.position_y], rw[RV.angle]
        history[s, 0], history[s, 1] = sums[SUM.transmitted], rock_fy
        above = rock_y - sw[SV.rock_radius] - sw[SV.surface_level]
        history[s, 2] = sand_kernel.penetration(above, rock_fx != 0.0 or rock_fy != 0.0, sums)
        rock_kernel.move(Load(rock_fx, rock_fy, rock_torque), inertia, dt, rw)
        history[s, 4] = (
            rock_fx * (rw[RV.position_x] - rock_x)
            + rock_fy * (rw[RV.position_y] - rock_y)
            + rock_torque * (rw[RV.angle] - rock_angle)
        )
        for q in range(fx.size):
            b = rock + 1 + q
            fx[q], fy[q] = bodies.force_x[b], bodies.force_y[b]
            torque[q] = bodies.turn[b] * sw[SV.beam_radius]
        before = bw[BV.energy_work_contact]
        beam_kernel.advance(beam_steps, beam_step, bw, bx, bk)
        status = beam_kernel.publish(bw, bx, bk)
        if status != 0:
            return status
        history[s, 3], history[s, 5] = bw[BV.energy_elastic], bw[BV.energy_work_contact] - before
        _share(rw, bw, bk, bodies)
    return 0


@kernel
def _share(rw, bw, bk, bodies):
    """Move rock and beam discs of the sand to where rock and beam are."""
    rock = bodies.rock
    bodies.x[rock], bodies.y[rock] = rw[RV.position_x], rw[RV.position_y]
    bodies.vx[rock], bodies.vy[rock] = rw[RV.velocity_x], rw[RV.velocity_y]
    bodies.angle[rock] = rw[RV.angle]
    bodies.spin[rock] = rw[RV.angular_velocity] * bodies.radius[rock]
    px, py, angle = view(bw, bk, BA.position_x), view(bw, bk, BA.position_y), view(bw, bk, BA.angle)
    vx, vy = view(bw, bk, BA.velocity_x), view(bw, bk, BA.velocity_y)
    omega = view(bw, bk, BA.angular_velocity)
    for q in range(px.size):
        b = rock + 1 + q
        bodies.x[b], bodies.y[b], bodies.angle[b] = px[q], py[q], angle[q]
        bodies.vx[b], bodies.vy[b] = vx[q], vy[q]
        bodies.spin[b] = omega[q] * bodies.radius[b]
