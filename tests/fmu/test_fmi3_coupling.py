"""Rock, sand and beam coupled by their terminals alone: the impact is that of the FMUs for FMI 2.0, bit for bit."""

import zipfile

import pytest
from lxml import etree

from rockshed.cases.sonoda1993 import lab_system
from rockshed.cases.sonoda1993 import tests as laboratory_tests
from rockshed.core.run import simulate
from rockshed.core.system.parts import Connection
from rockshed.fmus.description.fmi3 import TERMINALS

from .host import Host
from .host3 import Host3
from .test_peers import SYSTEM

MODELS = {"rock": "FallingRock", "sand": "SandCushion", "beam": "RBSMBeam"}
BONDS = [(("rock", "rock"), ("sand", "rock")), (("beam", "beam"), ("sand", "beam"))]
STEP, STEPS = SYSTEM["STEP"], 40


def terminal(file, name):
    """Variables of a terminal by member."""
    with zipfile.ZipFile(file) as archive:
        (found,) = etree.fromstring(archive.read(TERMINALS)).xpath(
            "//Terminal[@name=$name]", name=name
        )
    return {member.get("memberName"): member.get("variableName") for member in found}


def connections(hosts, files):
    """(output, input) of every member of every bond, each as (component, variable)."""
    for one, other in BONDS:
        ends = [(key, terminal(files[MODELS[key]], name)) for key, name in (one, other)]
        for member in ends[0][1]:
            pair = [(key, its[member]) for key, its in ends]
            yield sorted(
                pair, key=lambda port: hosts[port[0]].variables[port[1]].causality == "input"
            )


def run(hosts, transfer):
    """Jacobi: all step, then all exchange. Outputs at the end."""
    for (key, name), value in SYSTEM["START"].items():
        hosts[key][name] = value
    for host in hosts.values():
        if isinstance(host, Host):
            host.fmu.setupExperiment(startTime=0.0)
        host.fmu.enterInitializationMode()
    for _ in hosts:
        transfer()
    for host in hosts.values():
        host.fmu.exitInitializationMode()
    transfer()
    for i in range(STEPS):
        for host in hosts.values():
            assert host.step(i * STEP, STEP) == 0, host.messages
        transfer()
    return {key: host.outputs() for key, host in hosts.items()}


@pytest.fixture
def hosts():
    """Start the FMUs of a version by component."""
    opened = []

    def start(kind, files):
        hosts = {key: kind(files[model], key) for key, model in MODELS.items()}
        opened.extend(hosts.values())
        return hosts

    yield start
    for host in opened:
        host.__exit__()


def test_the_impact_through_terminals_has_the_bits_of_fmi_2(native_fmus, fmi3_fmus, hosts):
    two, three = hosts(Host, native_fmus), hosts(Host3, fmi3_fmus)
    ends = list(connections(three, fmi3_fmus))
    assert len(ends) == 18

    def by_elements():
        values = [two[key][name] for (key, name), _ in SYSTEM["CONNECTIONS"]]
        for (_, (key, name)), value in zip(SYSTEM["CONNECTIONS"], values):
            two[key][name] = value

    def by_arrays():
        values = [three[key].array(name) for (key, name), _ in ends]
        for (_, (key, name)), value in zip(ends, values):
            three[key].set_array(name, value)

    expected = run(two, by_elements)
    assert expected["sand"]["rock.force.y"] > 1000.0
    assert run(three, by_arrays) == expected


# ------------------------------------------------------------------ in a run of the orchestrator


@pytest.fixture(scope="module")
def impact(native_fmus, fmi3_fmus, tmp_path_factory):
    """Run the laboratory impact with some FMUs of FMI 3.0, and with other connections."""
    folder = tmp_path_factory.mktemp("impact")

    def simulated(three=(), **changes):
        kinds = {key: fmi3_fmus if key in three else native_fmus for key in MODELS}
        files = {key: str(kinds[key][model]) for key, model in MODELS.items()}
        system = lab_system(files, laboratory_tests()[4])
        fields = {"stop_time": 0.001, "output_interval": 1e-4, "state_interval": 1e-3, **changes}
        return simulate(system.model_copy(update=fields), folder / "run")

    return simulated


@pytest.fixture(scope="module")
def of_fmi_2(impact):
    return impact()


def same_bits(one, other):
    assert list(one.series) == list(other.series)
    different = [n for n in one.series if one.series[n].tobytes() != other.series[n].tobytes()]
    assert different == []
    assert list(one.states("sand")) == list(other.states("sand"))


@pytest.mark.parametrize("three", [("rock", "sand", "beam"), ("sand",), ("rock", "beam")])
def test_a_run_has_the_bits_of_fmi_2_with_any_of_its_fmus_for_fmi_3(impact, of_fmi_2, three):
    assert of_fmi_2.series["sand.rock.force.y"].max() > 500.0
    same_bits(impact(three), of_fmi_2)


@pytest.mark.parametrize("three", [(), ("rock", "sand", "beam"), ("sand",)])
def test_terminals_stand_for_all_connections_of_the_impact(impact, of_fmi_2, three):
    whole = ("sand.rock <-> rock.rock", "beam.beam <-> sand.beam")
    connections = [Connection.model_validate(text) for text in whole]
    same_bits(impact(three, connections=connections), of_fmi_2)
