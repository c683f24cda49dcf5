"""Rock, sand and beam coupled by their terminals alone: the impact is that of the FMUs for FMI 2.0, bit for bit."""

import zipfile

import pytest
from lxml import etree

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
