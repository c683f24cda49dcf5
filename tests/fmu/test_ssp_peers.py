"""The laboratory impact as an SSP in other tools: it runs unchanged, and gives the bits of our Jacobi master."""

import json
import zipfile

import numpy as np
import pytest

from rockshed.cases.sonoda1993 import lab_system
from rockshed.cases.sonoda1993 import tests as laboratory_tests
from rockshed.core.run import simulate, sources_of
from rockshed.core.system.other_values import with_values
from rockshed.core.system.planning import make_plan
from rockshed.ssp.writing import write_ssp
from tests.fmu.test_peers import needs

STEP, STEPS, FINER = 1e-4, 80, 10
WATCH = [
    ("rock", "position.y"),
    ("rock", "angular_velocity"),
    ("sand", "rock.force.y"),
    ("sand", "transmitted_force"),
    ("beam", "midspan.deflection"),
]

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def laboratory(fmus):
    """The fourth test, oblique; the rock is stepped ten times in each exchange."""
    parts = {"rock": "FallingRock", "sand": "SandCushion", "beam": "RBSMBeam"}
    files = {name: str(fmus[part]) for name, part in parts.items()}
    system = lab_system(files, laboratory_tests()[4], "jacobi")
    system = with_values(system, {"rock.velocity0.x": 1.0, "rock.position0.x": 0.63})
    rock = system.components["rock"].model_copy(update={"step": STEP / FINER})
    return system.model_copy(
        update={
            "components": {**system.components, "rock": rock},
            "exchange_step": STEP,
            "stop_time": STEP * STEPS,
            "output_interval": STEP,
        }
    )


@pytest.fixture(scope="module")
def folder(laboratory, fmus, tmp_path_factory):
    """The SSP, unpacked beside its archive."""
    place = tmp_path_factory.mktemp("ssp")
    files = {name: fmus[fmu] for name, fmu in _parts()}
    write_ssp(make_plan(laboratory, sources_of(laboratory)), files, place / "lab.ssp")
    with zipfile.ZipFile(place / "lab.ssp") as archive:
        archive.extractall(place / "lab")
    return place


def _parts():
    return (("sand", "SandCushion"), ("rock", "FallingRock"), ("beam", "RBSMBeam"))


@pytest.fixture(scope="module")
def ours(laboratory, tmp_path_factory):
    result = simulate(laboratory, tmp_path_factory.mktemp("ours") / "run").series
    return np.array([result[".".join(port)] for port in WATCH])


@pytest.fixture
def theirs(python, folder, tmp_path):
    """Run a piece of code that makes ``series``; return it as an array."""

    def run(code):
        result = tmp_path / "series.json"
        script = "\n".join(
            [
                f"import os; os.chdir({str(folder)!r})",
                f"WATCH, STEP, STEPS = {WATCH!r}, {STEP!r}, {STEPS!r}",
                code,
                f"import json; json.dump([list(s) for s in series], open({str(result)!r}, 'w'))",
            ]
        )
        python(script, timeout=100, TMPDIR=str(tmp_path))
        return [np.array(values) for values in json.loads(result.read_text())]

    return run


def test_the_run_is_no_trivial_one(ours):
    assert ours[1, -1] != 0.0
    assert ours[3].max() > 30 * ours[3, 0] > 0.0


LIBCOSIM = """
from libcosimpy.CosimEnums import CosimVariableType
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
from libcosimpy.CosimObserver import CosimObserver

log_output_level(CosimLogLevel.ERROR)
execution = CosimExecution.from_ssp_file(ssp_path="lab/MultiRate.ssd")
observer = CosimObserver.create_time_series(buffer_size=5000)
assert execution.add_observer(observer)
reference = {
    (info.name.decode(), v.name.decode()): (info.index, v.reference)
    for info in execution.slave_infos()
    for v in execution.slave_variables(info.index)
}
for port in WATCH:
    assert observer.start_time_series(*reference[port], CosimVariableType.REAL)
assert execution.step(10 * STEPS)
series = [
    observer.time_series_real_samples(*reference[port], from_step=1, sample_count=10 * STEPS)[2]
    for port in WATCH
]
"""


@needs("libcosimpy")
def test_libcosim_runs_each_component_at_its_own_rate(theirs, ours):
    series = theirs(LIBCOSIM)
    assert [values.size for values in series] == [800, 800, 80, 80, 80]
    for values, expected in zip(series, ours):
        np.testing.assert_array_equal(
            values[values.size // STEPS - 1 :: values.size // STEPS], expected[1:]
        )


ECOS = """
import ctypes
from importlib.metadata import files

for file in files("tbb"):
    if file.name == "libtbb.so.12":
        ctypes.CDLL(str(file.locate()))
from ecospy import EcosSimulation

with EcosSimulation(step_size=STEP, ssp_path="lab.ssp") as simulation:
    assert simulation.init(parameter_set="initialValues")
    rows = [[simulation.get_real("::".join(port)) for port in WATCH]]
    for _ in range(STEPS):
        simulation.step()
        rows.append([simulation.get_real("::".join(port)) for port in WATCH])
    simulation.terminate()
series = list(zip(*rows))
"""


@needs("ecospy", "tbb")
def test_ecos_gives_our_jacobi_result(theirs, ours):
    np.testing.assert_array_equal(theirs(ECOS), ours)


FMPY = """
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave
from fmpy.ssp.ssd import find_components, get_connections, read_ssd
from lxml import etree

ssd = read_ssd("lab.ssp")
slaves, reference, kind = {}, {}, {}
for component in find_components(ssd.system):
    file = f"lab/{component.source}"
    description = read_model_description(file)
    name = component.name
    reference |= {(name, v.name): [v.valueReference] for v in description.modelVariables}
    kind |= {(name, v.name): v.type for v in description.modelVariables}
    slaves[name] = FMU2Slave(
        instanceName=name,
        guid=description.guid,
        modelIdentifier=description.coSimulation.modelIdentifier,
        unzipDirectory=extract(file),
    )
    slaves[name].instantiate()
connections = [
    ((a.parent.name, a.name), (b.parent.name, b.name)) for a, b in get_connections(ssd.system)
]
assert len(connections) == 225


def get(port):
    return slaves[port[0]].getReal(reference[port])[0]


def transfer():
    values = [get(source) for source, _ in connections]
    for (_, target), value in zip(connections, values):
        slaves[target[0]].setReal(reference[target], [value])


for component in etree.parse("lab/SystemStructure.ssd").iter("{*}Component"):
    for parameter in component.iter("{*}Parameter"):
        port = component.get("name"), parameter.get("name")
        slave, value = slaves[port[0]], parameter[0].get("value")
        if kind[port] == "Real":
            slave.setReal(reference[port], [float(value)])
        else:
            slave.setInteger(reference[port], [int(value)])
for slave in slaves.values():
    slave.setupExperiment(startTime=0.0)
    slave.enterInitializationMode()
for _ in slaves:
    transfer()
for slave in slaves.values():
    slave.exitInitializationMode()
transfer()
rows = [[get(port) for port in WATCH]]
for n in range(STEPS):
    for slave in slaves.values():
        slave.doStep(n * STEP, STEP)
    transfer()
    rows.append([get(port) for port in WATCH])
for slave in slaves.values():
    slave.terminate()
    slave.freeInstance()
series = list(zip(*rows))
"""


@needs("fmpy")
def test_fmpy_reads_it_and_its_slaves_give_our_jacobi_result(theirs, ours):
    np.testing.assert_array_equal(theirs(FMPY), ours)
