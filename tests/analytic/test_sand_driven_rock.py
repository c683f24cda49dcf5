"""The balance of energy of a rock that is driven into sand: what does not add up, and its order."""

from functools import cache
from itertools import pairwise

import numpy as np
import pytest

from rockshed.components.catalogue import component
from rockshed.fmus.experiments.found import experiments_of
from tests.fmu.kernels import put

STEPS = (2e-5, 1e-5, 5e-6)
"""Internal steps (s)."""
MOTION = ("rock.position.x", "rock.position.y", "rock.angle")
LOADS = ("rock.force.x", "rock.force.y", "rock.torque")
LOSSLESS = (("damping", 0.0), ("friction_angle", 0.0))


@cache
def driven(name, step, exchange=None, changes=()):
    """Residual at the end of an experiment (J), and the part of it that held forces make.

    Forces at the rows are those of the beginning of the last internal step. The work that they do
    along the way of a step, held, less their mean before and after it, is told from the rows alone,
    which stand at each step.
    """
    made = component("SandCushion")
    sizes = made.with_sizes()
    (one,) = (each for each in experiments_of(made, sizes) if each.name == name)
    sand = made.instance(**sizes)
    for parameter, value in {**one.parameters, "internal_step": step, **dict(changes)}.items():
        sand[parameter] = value
    put(sand, one, 0.0)
    sand.initialise()
    exchange = exchange or step
    rows = []
    for number in range(round(one.stop_time / exchange)):
        put(sand, one, number * exchange)
        sand.step(number * exchange, exchange)
        rows.append([[sand[each] for each in names] for names in (MOTION, LOADS)])
    motion, loads = np.array(rows).transpose(1, 0, 2)
    held = float((np.diff(loads, axis=0) * np.diff(motion, axis=0)).sum()) / -2.0
    return sand["energy.residual"], held


NAMES = pytest.mark.parametrize("name", ["driven-rock", "rock-into-settled-sand"])


@NAMES
def test_the_residual_of_a_driven_rock_hangs_on_the_internal_step_and_not_on_the_exchange(name):
    """The rock moves on between exchanges by its velocity, which is constant: nothing is held."""
    residuals = [driven(name, 1e-5, exchange)[0] for exchange in (1e-4, 2e-5, 1e-5)]
    assert residuals[0] > 0.02
    assert residuals[1:] == pytest.approx(residuals[:1] * 2, rel=1e-6)


@NAMES
def test_the_residual_of_a_driven_rock_halves_with_the_internal_step(name):
    for coarse, fine in pairwise(driven(name, step)[0] for step in STEPS):
        assert coarse / fine == pytest.approx(2.0, rel=0.02)


@NAMES
def test_most_of_it_is_the_work_of_forces_that_hold_over_an_internal_step(name):
    residual, held = driven(name, 1e-5)
    assert 0.7 * residual < held < 0.9 * residual


def test_without_losses_the_rest_is_of_second_order():
    """With the mean of the forces before and after each step, energy is conserved."""
    both = [driven("driven-rock", step, changes=LOSSLESS) for step in STEPS]
    rests = [abs(residual - held) for residual, held in both]
    assert rests[-1] < 5e-5
    assert all(coarse > 3.5 * fine for coarse, fine in pairwise(rests))
    assert all(1.9 < one[1] / next_one[1] < 2.1 for one, next_one in pairwise(both))
