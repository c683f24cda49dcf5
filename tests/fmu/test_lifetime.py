"""Many instances, folders that come and go, and the cache of compiled kernels. Each test has its own process."""

import sys

import pytest

CYCLES = """
import gc, sys
import psutil
from tests.fmu.host import Host
folder = sys.argv[2]
path = list(sys.path)

def cycle():
    host = Host(sys.argv[1], folder=folder)
    host.start().steps(1, 1e-4)
    host.fmu.reset()
    host.start().steps(2, 1e-4)
    host.close(keep_folder=True)

def memory():
    gc.collect()
    return psutil.Process().memory_info().rss

for _ in range(50):
    cycle()
before = memory()
for _ in range(200):
    cycle()
print(memory() - before)
assert sys.path == path
"""


@pytest.mark.slow
def test_200_instances_one_after_the_other_leave_less_than_3_megabytes(fmus, python, tmp_path):
    assert int(python(CYCLES, fmus["FallingRock"], tmp_path / "with a space")) < 3_000_000


LET_GO = """
import ctypes, sys
from tests.fmu.host import Host
original, called = ctypes.CDLL, []

class Recorded(original):
    def __getattr__(self, name):
        if name == "finalizePythonInterpreter":
            called.append(self._name)
        return super().__getattr__(name)

first = Host(sys.argv[1])
ctypes.CDLL = Recorded
second = Host(sys.argv[1]).start()
assert called == [second.fmu.dll._name], called
ctypes.CDLL = original
second.steps(3, 1e-4)
first.start().steps(3, 1e-4)
assert first.outputs() == second.outputs()
first.close()
second.close()
"""


@pytest.mark.skipif(sys.platform != "linux", reason="only the binary for Linux lets go twice")
def test_each_instance_makes_its_binary_forget_the_interpreter(fmus, python):
    """Otherwise the binary lets go of it twice when the process ends; valgrind shows the access to memory given back before."""
    python(LET_GO, fmus["FallingRock"])


MOVED = """
import sys
from tests.fmu.host import Host
first = Host(sys.argv[1])
first.close()
assert not first.folder.exists()
second = Host(sys.argv[1]).start()
third = Host(sys.argv[1]).start()
assert second.folder != third.folder
for host in (second, third):
    host.steps(3, 1e-4)
assert second.outputs() == third.outputs()
second.close()
third.steps(3, 1e-4, first=3)
"""


def test_an_instance_outlives_the_folder_that_its_code_came_from(fmus, python):
    python(MOVED, fmus["FallingRock"])


CACHE = """
import sys, time
from tests.fmu.host import Host
start = time.perf_counter()
host = Host(sys.argv[1])
host.start().steps(1, 1e-5)
kernels = [m for name, m in sys.modules.items() if name.endswith("_lib.components.falling_rock.kernel")]
stats = kernels[0].step.stats
print(sum(stats.cache_hits.values()), sum(stats.cache_misses.values()))
host.close()
"""


def test_a_second_process_finds_the_compiled_kernels_though_the_fmu_is_unpacked_elsewhere(
    fmus, python, tmp_path
):
    def run():
        return python(CACHE, fmus["FallingRock"], ROCKSHED_CACHE_DIR=str(tmp_path)).split()

    assert run() == ["0", "1"]
    stored = sorted(path.name for path in tmp_path.rglob("*") if path.is_file())
    assert run() == ["1", "0"]
    assert sorted(path.name for path in tmp_path.rglob("*") if path.is_file()) == stored


def test_without_a_folder_for_the_cache_it_runs_all_the_same(fmus, python):
    assert (
        python(CACHE, fmus["FallingRock"], ROCKSHED_CACHE_DIR="/dev/null/nowhere").split()[0] == "0"
    )
