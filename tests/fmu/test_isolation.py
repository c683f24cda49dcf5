"""FMUs of one process share a Python interpreter. Ours disturb nobody and are disturbed by nobody."""

import ast
import dataclasses
import json
import shutil
import zipfile

import pytest

from rockshed.components.catalogue import component
from rockshed.fmus.build import build_component
from rockshed.fmus.python.isolation import require_libraries

LOADED_BY_NUMBA = """
import sys
import pythonfmu
from tests.fmu.host import Host
before = set(sys.modules)
import numba
print(sorted(name for name in sys.stdlib_module_names if name in sys.modules and name not in before))
"""

BUILD_FOREIGN = """
import sys
from pathlib import Path
from pythonfmu import FmuBuilder
script = Path(sys.argv[1]) / "foreign.py"
print(FmuBuilder.build_FMU(script, dest=sys.argv[2], project_files=[p for p in script.parent.iterdir() if p != script]))
"""

FOREIGN = """
from pythonfmu import Fmi2Causality, Fmi2Slave, Real
from components.helper import FACTOR
import fmus
{imports}

class Foreign(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.y = 0.0
        self.register_variable(Real("y", causality=Fmi2Causality.output))

    def do_step(self, current_time, step_size):
        self.y += FACTOR * fmus.FACTOR * step_size
        return True
"""

RUN = """
import json, sys
from tests.fmu.host import Host

results, hosts = {}, []
for i, file in enumerate(sys.argv[1:]):
    before = list(sys.path)
    host = Host(file, f"instance {i}")
    if "Foreign" not in file:
        assert sys.path == before
    hosts.append(host.start())
for step in range(20):
    for host in hosts:
        assert host.step(step * 0.01, 0.01) == 0, host.messages
for file, host in zip(sys.argv[1:], hosts):
    if "Foreign" not in file:
        host.fmu.getReal([10 ** 6])
        assert "value reference 1000000 is unknown" in host.errors()[0]
    results[file] = {name: value.hex() if isinstance(value, float) else value for name, value in host.outputs().items()}
for host in hosts:
    host.close()
print(json.dumps(results))
"""


@pytest.fixture(scope="session")
def foreign(tmp_path_factory):
    """Function that builds a foreign FMU with pythonfmu's builder: it ships modules whose names others use too."""

    def make(python, imports=""):
        source = tmp_path_factory.mktemp("source")
        (source / "foreign.py").write_text(FOREIGN.format(imports=imports))
        for package in ("components", "fmus", "rockshed"):
            (source / package).mkdir()
            (source / package / "__init__.py").write_text("FACTOR = 2.0\n")
        (source / "components" / "helper.py").write_text("FACTOR = 3.0\n")
        for name in {"numpy", "numba", "llvmlite", *ast.literal_eval(python(LOADED_BY_NUMBA))}:
            (source / f"{name}.py").write_text("njit = ndarray = 'not the real one'\n")
        file = python(BUILD_FOREIGN, source, tmp_path_factory.mktemp("foreign")).strip()
        return with_another_pythonfmu(file)

    return make


def with_another_pythonfmu(file):
    """The FMU ships a pythonfmu in which nothing can be logged."""
    changed = file.replace("Foreign.fmu", "changed-Foreign.fmu")
    with zipfile.ZipFile(file) as old, zipfile.ZipFile(changed, "w") as new:
        for path in old.namelist():
            new.writestr(
                path,
                old.read(path).replace(
                    b"self.log_queue.append(log_msg)", b"raise RuntimeError('the other one')"
                ),
            )
    return changed


@pytest.fixture(scope="module")
def heavier_rock(tmp_path_factory):
    """An FMU with the same names as FallingRock's and other code."""
    rock = component("FallingRock")
    folder = tmp_path_factory.mktemp("changed") / "falling_rock"
    shutil.copytree(rock.folder, folder)
    kernel = folder / "kernel.py"
    own, changed = "w[V.gravity], dt)", "2.0 * w[V.gravity], dt)"
    assert own in kernel.read_text()
    kernel.write_text(kernel.read_text().replace(own, changed))
    return build_component(
        dataclasses.replace(rock, folder=folder), destination=tmp_path_factory.mktemp("other")
    )


@pytest.mark.slow
def test_ours_and_a_foreign_fmu_with_modules_of_any_name_give_what_they_give_alone(
    fmus, python, foreign, heavier_rock
):
    other, rock, probe, heavier = foreign(python), fmus["FallingRock"], fmus["Probe"], heavier_rock
    alone = {}
    for file in (other, rock, probe, heavier):
        alone |= json.loads(python(RUN, file))
    assert float.fromhex(alone[other]["y"]) == pytest.approx(0.2 * 3.0 * 2.0)
    assert alone[str(rock)]["velocity.y"] != alone[str(heavier)]["velocity.y"]
    for order in (
        (other, rock, probe, heavier),
        (heavier, rock, probe, other),
        (rock, other, heavier, probe),
    ):
        assert json.loads(python(RUN, *order)) == alone


IMPOSTER = """
import sys
from tests.fmu.host import Host
foreign = Host(sys.argv[1]).start()
try:
    Host(sys.argv[2], folder=sys.argv[3])
except Exception:
    print(Host.last.messages)
else:
    raise SystemExit("it should have been refused")
assert sys.path.count(sys.argv[3] + "/resources") == 0
foreign.steps(3, 0.1)
assert abs(foreign["y"] - 1.8) < 1e-12
foreign.close()
"""


def test_a_foreign_module_in_the_place_of_a_library_is_told(fmus, python, foreign, tmp_path):
    text = python(
        IMPOSTER, foreign(python, "import numba"), fmus["FallingRock"], tmp_path / "unpacked"
    )
    assert "another FMU has loaded a module of its own under this name" in text
    assert "Remedy: instantiate FallingRock first, or in a process of its own" in text


MISSING = """
import sys
from tests.fmu.host import Host
sys.modules["numba"] = None
before = list(sys.path)
try:
    Host(sys.argv[1])
except Exception:
    print(Host.last.messages)
assert sys.path == before
del sys.modules["numba"]
Host(sys.argv[1]).start().steps(3, 1e-4)
"""


def test_a_missing_library_is_told_and_can_be_mended(fmus, python):
    text = python(MISSING, fmus["FallingRock"])
    assert "FallingRock needs numba in the Python that runs it" in text
    assert "Remedy: pip install numpy numba" in text


def test_an_old_python_is_told(monkeypatch):
    monkeypatch.setattr("sys.version_info", (3, 9, 1))
    with pytest.raises(
        ImportError, match=r"FallingRock needs Python 3\.11 or later; this process runs 3\."
    ):
        require_libraries("FallingRock")


ALONE = """
import sys
from tests.fmu.host import Host
for name in ("rockshed", "pythonfmu", "markdown_it", "filelock", "scipy"):
    sys.modules[name] = None
for file in sys.argv[1:]:
    host = Host(file)
    host.start().steps(2, float(host.description.defaultExperiment.stepSize))
    host.close()
"""


def test_an_fmu_needs_nothing_but_python_numpy_and_numba(fmus, python):
    python(ALONE, *fmus.values())
