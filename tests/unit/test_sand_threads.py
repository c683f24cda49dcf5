"""Threads share the work of a step, and neither they nor the width of the processor's vectors
change a bit of the result."""

import os
import subprocess
import sys

import llvmlite.binding as llvm
import numpy as np
import pytest

from rockshed.components.common.kernels import kernel
from rockshed.components.sand_cushion import COMPONENT, forces
from rockshed.components.sand_cushion.contact_search import forget
from rockshed.components.sand_cushion.declarations import PART
from rockshed.components.sand_cushion.vector.threads import shared_among_threads
from tests.sand_discs import SMALL_BOX, cushion, force_rebuild, rows, run, stirred

MODELS = [
    {"rotation": "locked"},
    {"rotation": "free", "rolling_resistance": 0.3},
    {"rotation": "free", "unloading_ratio": 3.0, "cohesion": 500.0},
]


@kernel
def count_up(part, step, numbers):
    for i in range(1000 * part, 1000 * (part + 1)):
        numbers[i] += step


share = shared_among_threads(count_up)


@kernel
def call(threads, parts, step, numbers):
    share(threads, parts, step, numbers)


@pytest.mark.parametrize("threads", [1, 2, 3, 7, 200])
def test_every_part_is_done_once(threads):
    numbers = np.zeros(10_000)
    call(threads, 9, 2.5, numbers)
    assert (numbers[:9000] == 2.5).all()
    assert not numbers[9000:].any()


def moving(changes, second_part, threads=1):
    """A small cushion in motion. It is one part by itself; here the second part begins with the
    disc ``second_part``."""
    instance = stirred(cushion({**SMALL_BOX, "packing": "hexagonal", **changes}), 0.3)
    instance.state("part")[:] = 0, second_part, instance.sizes["discs"]
    instance["threads"] = threads
    forget(
        instance.x, instance.k
    )  # springs pass from a list to one that is divided in the same way
    force_rebuild(instance)
    return instance


@pytest.mark.parametrize("changes", MODELS, ids=str)
def test_the_bits_are_the_same_on_one_thread_and_on_two(changes):
    one, two = (moving(changes, 34, threads) for threads in (1, 2))
    for instance in (one, two):
        run(instance, 0.01, 1e-3)
    assert one["energy.sliding"] > 0.0
    np.testing.assert_array_equal(one.x, two.x)
    np.testing.assert_array_equal(one.k, two.k)
    for name in (
        "kinetic",
        "elastic",
        "normal_dashpot",
        "tangential_dashpot",
        "sliding",
        "rolling",
        "plastic",
        "capillary",
    ):
        assert one[f"energy.{name}"] == two[f"energy.{name}"]


@pytest.mark.parametrize("changes", MODELS, ids=str)
def test_the_division_into_parts_changes_rounding_only(changes):
    """Also springs of pairs between the parts survive a rebuild, in every step here."""
    whole, divided = moving(changes, 60), moving(changes, 34)
    for _ in range(200):
        force_rebuild(divided)
        run(whole, 1e-5)
        run(divided, 1e-5)
    assert rows(divided)[:, :5] == pytest.approx(rows(whole)[:, :5], rel=1e-9, abs=1e-9)
    assert divided.state("angle") == pytest.approx(whole.state("angle"), abs=1e-9)
    for name in (
        "kinetic",
        "elastic",
        "normal_dashpot",
        "tangential_dashpot",
        "sliding",
        "rolling",
        "plastic",
        "capillary",
    ):
        assert divided[f"energy.{name}"] == pytest.approx(
            whole[f"energy.{name}"], rel=1e-8, abs=1e-15
        )


def test_a_large_cushion_is_divided_by_itself_and_uses_more_threads():
    discs = 3 * PART + 1
    states = []
    for threads in (1, 2, 3):
        sand = COMPONENT.instance(discs=discs)
        for name, value in {
            "base": "floor",
            "box.left": 0.0,
            "box.width": 2.5,
            "rock.position.x": 1.0,
            "rock.position.y": 50.0,
            "packing": "hexagonal",
            "threads": threads,
            "settling.time": 1e-4,
        }.items():
            sand[name] = value
        sand.initialise()
        assert sand.state("part").tolist() == [0, PART, 2 * PART, discs]
        stirred(sand, 1.0)
        run(sand, 5e-4)
        states.append(sand.x)
    np.testing.assert_array_equal(states[0], states[1])
    np.testing.assert_array_equal(states[0], states[2])


STEPS = """
import sys
from rockshed.components.sand_cushion import COMPONENT, forces
sand = COMPONENT.instance(discs=60, elements=4)
sand.from_bytes(open(sys.argv[1], "rb").read())
for _ in range(100):
    forces.advance_discs(1e-5, sand.w, sand.x, sand.k)
open(sys.argv[2], "wb").write(sand.to_bytes())
"""


@pytest.mark.skipif(
    not llvm.get_host_cpu_features().get("avx512f"),
    reason="this processor has no AVX-512 to compare with",
)
@pytest.mark.parametrize("changes", MODELS, ids=str)
def test_avx2_and_avx512_give_the_same_bits(tmp_path, changes):
    """Compiled for a processor with AVX2 in a process of its own, against this process."""
    sand = moving(changes, 34)
    (tmp_path / "start").write_bytes(sand.to_bytes())
    subprocess.run(
        [sys.executable, "-c", STEPS, tmp_path / "start", tmp_path / "end"],
        check=True,
        env={**os.environ, "NUMBA_CPU_NAME": "x86-64-v3", "NUMBA_CPU_FEATURES": ""},
    )
    for _ in range(100):
        forces.advance_discs(1e-5, sand.w, sand.x, sand.k)
    assert (tmp_path / "end").read_bytes() == sand.to_bytes() != (tmp_path / "start").read_bytes()
