"""Faults seeded one by one into kernels are all caught by the experiments that FMUs carry.

Kernels are copied into a scratch package and run as Python, or compiled where they are vectors.
"""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from rockshed.fmus.parts import COMPONENTS

ROOT = Path(__file__).parents[2]

FAULTS = {
    # name: (component, file, what stands there, what stands there instead)
    "rock: gravity upwards": (
        "FallingRock",
        "common/rigid_body.py",
        "/ mass - gravity",
        "/ mass + gravity",
    ),
    "rock: position with the old velocity": (
        "FallingRock",
        "common/rigid_body.py",
        "motion.x + velocity_x * dt",
        "motion.x + motion.velocity_x * dt",
    ),
    "rock: moment of inertia of a disc": (
        "FallingRock",
        "falling_rock/kernel.py",
        "return 0.4 * w[V.mass]",
        "return 0.5 * w[V.mass]",
    ),
    "rock: the machine's work misses the weight": (
        "FallingRock",
        "falling_rock/kernel.py",
        "w[V.mass] * w[V.gravity] * w[V.velocity_y] * dt - contact",
        "-contact",
    ),
    "hammer: the weight is left out": (
        "Hammer",
        "hammer/kernel.py",
        "    drive = w[V.mass] * w[V.gravity] * w[V.weight]\n",
        "    drive = 0.0\n",
    ),
    "hammer: unloading with e instead of its square": (
        "Hammer",
        "hammer/cushion.py",
        "return stiffness / (restitution * restitution)",
        "return stiffness / restitution",
    ),
    "hammer: the wave has the wrong sign": (
        "Hammer",
        "hammer/kernel.py",
        "given, compliance = w[V.head_wave] / w[V.head_impedance], 1.0 / w[V.head_impedance]",
        "given, compliance = w[V.head_wave] / w[V.head_impedance], 1.01 / w[V.head_impedance]",
    ),
    "hammer: mean velocity is that at the end": (
        "Hammer",
        "hammer/kernel.py",
        "mean, head = 0.5 * (before + w[V.velocity])",
        "mean, head = w[V.velocity]",
    ),
    "ground: resistance does not grow": (
        "ImpulsiveGround",
        "impulsive_ground/motion.py",
        "return g.r0 + (g.r1 - g.r0) * min(1.0, clock / g.rise)",
        "return g.r0 + (g.r1 - g.r0) * min(0.5, clock / g.rise)",
    ),
    "ground: damping with the wrong sign": (
        "ImpulsiveGround",
        "impulsive_ground/motion.py",
        "factor = max(0.0, 1.0 + g.damping * toe)",
        "factor = max(0.0, 1.0 - g.damping * toe)",
    ),
    "ground: the spring never slides": (
        "ImpulsiveGround",
        "common/smith_soil.py",
        "    slid = way - elastic\n",
        "    slid = 0.0\n",
    ),
    "slope: a hundredth less of the acceleration": (
        "SlopeRockfall",
        "slope_rockfall/flight.py",
        "b[BODY.x] += span * (b[BODY.vx] + 0.5 * span",
        "b[BODY.x] += span * (b[BODY.vx] + 0.49 * span",
    ),
    "slope: rolling as a disc rolls": (
        "SlopeRockfall",
        "slope_rockfall/sliding_rolling.py",
        "acceleration = k1 / (1.0 + ratio * k2)",
        "acceleration = k1 / (1.0 + 0.5 * k2)",
    ),
    "slope: restitution without its root": (
        "SlopeRockfall",
        "slope_rockfall/restitution.py",
        "math.sqrt(radicand) / speed",
        "radicand / speed",
    ),
    "slope: rebound into the ground": (
        "SlopeRockfall",
        "slope_rockfall/restitution.py",
        "return u, -normal * tilted.v,",
        "return u, -0.99 * normal * tilted.v,",
    ),
    "rod: the front is a segment late": (
        "PileRod",
        "pile_rod/characteristics.py",
        "        up[i - 1] = rate[i] - arriving\n",
        "        up[i - 1] = rate[i] - down[i]\n",
    ),
    "rod: the toe reflects with the wrong sign": (
        "PileRod",
        "pile_rod/characteristics.py",
        "up[n - 1] = rate[n] - arriving",
        "up[n - 1] = arriving - rate[n]",
    ),
    "rod: radiated energy is halved": (
        "PileRod",
        "pile_rod/characteristics.py",
        "w[V.energy_radiated] += standing * velocity * velocity * dt",
        "w[V.energy_radiated] += 0.5 * standing * velocity * velocity * dt",
    ),
    "rod: masses move with half of the force": (
        "PileRod",
        "pile_rod/chain.py",
        "rate[0] += (force + load - below) / mass[0] * dt",
        "rate[0] += 0.5 * (force + load - below) / mass[0] * dt",
    ),
    "beam: bending of a neighbour": (
        "RBSMBeam",
        "rbsm_beam/chain.py",
        "moment[i + 1] = c.bending * ((v[i + 2] + v[i]) - 2.0 * v[i + 1])",
        "moment[i + 1] = c.bending * ((v[i + 2] + v[i]) - 2.01 * v[i + 1])",
    ),
    "beam: the reaction has the wrong sign": (
        "RBSMBeam",
        "rbsm_beam/chain.py",
        "reaction[1] = (moment[n + 1] - moment[n]",
        "reaction[1] = (moment[n] - moment[n + 1]",
    ),
    "beam: the pull acts on the next disc": (
        "RBSMBeam",
        "rbsm_beam/chain.py",
        "load_x[i] = force_x[i]",
        "load_x[i] = force_x[before]",
    ),
    "rock: force in y with the wrong sign": (
        "FallingRock",
        "common/rigid_body.py",
        "(load.force_y / mass - gravity)",
        "(-load.force_y / mass - gravity)",
    ),
    "slope: force in y with the wrong sign": (
        "SlopeRockfall",
        "slope_rockfall/kernel.py",
        "load = Load(w[V.force_x], w[V.force_y], w[V.torque])",
        "load = Load(w[V.force_x], -w[V.force_y], w[V.torque])",
    ),
    "slope: a hundredth less of the acceleration in y": (
        "SlopeRockfall",
        "slope_rockfall/flight.py",
        "b[BODY.y] += span * (b[BODY.vy] + 0.5 * span",
        "b[BODY.y] += span * (b[BODY.vy] + 0.49 * span",
    ),
    "slope: velocities exchanged where forces begin": (
        "SlopeRockfall",
        "slope_rockfall/kernel.py",
        "b[BODY.vx], b[BODY.vy], b[BODY.omega])\n",
        "b[BODY.vy], b[BODY.vx], b[BODY.omega])\n",
    ),
    "slope: inertia of a disc for a sphere": (
        "SlopeRockfall",
        "slope_rockfall/events.py",
        "return 0.4 * w[V.mass] * w[V.radius] * w[V.radius]",
        "return 0.5 * w[V.mass] * w[V.radius] * w[V.radius]",
    ),
    "ground: the clock begins a step late": (
        "ImpulsiveGround",
        "impulsive_ground/motion.py",
        "            if load <= g.r0:\n                b[BODY.clock] = 0.0",
        "            if load <= g.r0:\n                b[BODY.clock] = -1e-5",
    ),
    "hammer: the cushion loses nothing": (
        "Hammer",
        "hammer/cushion.py",
        "return stiffness / (restitution * restitution)",
        "return stiffness",
    ),
    "rod: no damping at the shaft": (
        "PileRod",
        "pile_rod/bookkeeping.py",
        "view(w, k, A.shaft_damping)[at], True",
        "0.0, True",
    ),
    "rod: no damping under the toe": (
        "PileRod",
        "pile_rod/bookkeeping.py",
        "        w[V.toe_damping],\n",
        "        0.0,\n",
    ),
    "beam: no damping by mass": (
        "RBSMBeam",
        "rbsm_beam/chain.py",
        "        w[V.damping_mass],\n",
        "        0.0,\n",
    ),
    "beam: no damping by stiffness": (
        "RBSMBeam",
        "rbsm_beam/chain.py",
        "        w[V.damping_stiffness],\n",
        "        0.0,\n",
    ),
    "beam: axes of the forces exchanged": (
        "RBSMBeam",
        "rbsm_beam/chain.py",
        "load_y[i] = force_y[i] +",
        "load_y[i] = force_x[i] +",
    ),
}
"""Faults in kernels that run as Python too."""

COMPILED = {
    "sand: a hundredth more friction": (
        "SandCushion",
        "sand_cushion/contact_law.py",
        "limited(trial, law.friction * normal)",
        "limited(trial, 1.01 * law.friction * normal)",
    ),
}
"""Faults in the sand, whose law is compiled to vectors."""
SHORT = {
    "RBSMBeam": ("own-weight", "fixed-ends", "pull", "damped-load"),
    "PileRod": (
        "step-of-force",
        "fixed-toe",
        "masses-and-springs",
        "slipping-toe",
        "slipping-shaft",
    ),
}
"""Experiments that find the faults of a component, where all of them take long as Python."""

_SCRIPT = """
import importlib, json, sys
sys.path[:0] = [{scratch!r}, {root!r}]
from tests.fmu.kernels import missed
from rockshed.components.catalogue import component
from rockshed.fmus.experiments.found import experiments_of

found = {{}}
for package, name in {packages!r}.items():
    folder = component(name).folder.name
    faulty = importlib.import_module(package + "." + folder).COMPONENT
    sizes = component(name).with_sizes()
    chosen = {short!r}.get(name)
    found[package] = {{
        one.name: sorted(caught)
        for one in experiments_of(component(name), sizes)
        if (not chosen or one.name in chosen) and (caught := missed(faulty, sizes, one))
    }}
print(json.dumps(found))
"""


def caught(faults, scratch, **environment):
    """Experiments that each fault fails, with their outputs, by the name of the fault."""
    packages, names = {}, {}
    for number, (fault, (owner, file, there, instead)) in enumerate(faults.items()):
        package = f"faulty_components_{number}"
        names[package], packages[package] = fault, owner
        copy = scratch / package
        shutil.copytree(COMPONENTS, copy, ignore=shutil.ignore_patterns("__pycache__", "README.md"))
        source = (copy / file).read_text(encoding="utf-8")
        assert source.count(there) == 1, (fault, source.count(there))
        (copy / file).write_text(source.replace(there, instead), encoding="utf-8")
    script = _SCRIPT.format(scratch=str(scratch), root=str(ROOT), packages=packages, short=SHORT)
    done = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", script],
        capture_output=True,
        text=True,
        env=os.environ | environment,
        timeout=600,
    )
    assert done.returncode == 0, done.stderr[-3000:]
    return {names[package]: each for package, each in json.loads(done.stdout).items()}


@pytest.mark.slow
def test_twenty_seeded_faults_in_kernels_are_all_caught(tmp_path):
    assert len(FAULTS) >= 20
    found = caught(FAULTS, tmp_path, NUMBA_DISABLE_JIT="1")
    for fault, experiments in found.items():
        print(f"| {fault} | {', '.join(experiments)} |")
    assert [fault for fault, experiments in found.items() if not experiments] == []


def test_a_copy_without_a_fault_fails_no_experiment(tmp_path):
    """So it is the faults that are caught."""
    places = {owner: (owner, file, there, there) for owner, file, there, _ in FAULTS.values()}
    sound = {owner: place for owner, place in places.items() if owner not in SHORT}
    assert caught(sound, tmp_path, NUMBA_DISABLE_JIT="1") == {owner: {} for owner in sound}


@pytest.mark.slow
def test_faults_in_the_law_of_the_sand_are_caught(tmp_path):
    found = caught(COMPILED, tmp_path, ROCKSHED_CACHE_DIR=str(tmp_path / "cache"))
    assert [fault for fault, experiments in found.items() if not experiments] == []
