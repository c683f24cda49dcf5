"""Every kind of bad input and what the user is told. All of them are found before anything runs."""

import math
import zipfile

import pytest

from rockshed.core.errors import InputRefused
from rockshed.core.run import sources_of
from rockshed.core.system.planning import make_plan
from rockshed.core.system.reading import system_from
from tests.cosim.mocks import Mock, inp, mass, out, par, spring, wired

SHAPES = """<TypeDefinitions><SimpleType name='Shape'><Enumeration><Item name='sphere' value='1'/><Item name='disc' value='2'/>
            </Enumeration></SimpleType></TypeDefinitions>"""
BODY = Mock(
    [
        par("mass", 1.0, "kg", extra="min='0.001' max='100'"),
        par("shape", 1, kind="Enumeration", extra="declaredType='Shape'"),
        par("layers", 3, kind="Integer"),
        par("rough", 1, kind="Boolean"),
        inp("force.x", "N"),
        inp("force.y", "N"),
        inp("load[1]", "kN"),
        inp("load[2]", "kN"),
        inp("gear", kind="Integer"),
        out("position.x", "m"),
        out("speed", "m/s"),
        out("count", kind="Integer"),
    ],
    types=SHAPES,
)
PUSH = Mock(
    [
        inp("position", "m"),
        out("force.x", "N"),
        out("force.y", "N"),
        *(out(f"load[{i}]", "N") for i in (1, 2, 3)),
    ]
)


def problems(connections=(), mocks=None, **settings):
    system, sources = wired(mocks or {"body": BODY, "push": PUSH}, list(connections), **settings)
    with pytest.raises(InputRefused) as refusal:
        make_plan(system, sources)
    return [str(problem) for problem in refusal.value.problems]


@pytest.mark.parametrize(
    ("connection", "message"),
    [
        (
            "push.forse.x -> body.force.x",
            "push.forse.x -> body.force.x: push has no variable 'forse.x'; did you mean force.x or force.y?",
        ),
        ("pusher.force.x -> body.force.x", "there is no component 'pusher'; did you mean push?"),
        (
            "body.force.y -> body.force.x",
            "body.force.y is of the causality input, and an output is needed; outputs are: position.x, speed, count",
        ),
        (
            "push.force.x -> body.position.x",
            "body.position.x is of the causality output, and an input is needed",
        ),
        (
            "push.force.x -> body.mass",
            "body.mass is of the causality parameter, and an input is needed; a parameter is fixed before the run: set it under "
            "components.body.parameters",
        ),
        (
            "body.speed -> body.force.x",
            "body.speed is in m/s (1 m.s-1), body.force.x in N (1 kg.m.s-2); connect ports of one unit",
        ),
        (
            "push.load[1] -> body.load[1]",
            "push.load[1] is in N (1 kg.m.s-2), body.load[1] in kN (1000 kg.m.s-2)",
        ),
        (
            "push.load[*] -> body.load[*]",
            "connects 3 outputs with 2 inputs; give ranges of one length",
        ),
        ("push.load[1..4] -> body.load[*]", "push has no variable 'load[4]'; did you mean load["),
        ("push.weight[*] -> body.load[*]", "push has no variable 'weight[*]'"),
        (
            "push.force.x -> body.gear",
            "push.force.x is Real and body.gear is Integer; connect ports of one type",
        ),
    ],
)
def test_a_connection_that_cannot_be(connection, message):
    found = problems([connection])
    assert len(found) == 1
    assert message in found[0]


def test_an_input_driven_twice():
    assert problems(["push.force.x -> body.force.x", "push.force.y -> body.force.x"]) == [
        "body.force.x: is driven 2 times: by push.force.x and by push.force.y; keep one of the connections"
    ]


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("mass", -1.0, "body.mass: -1.0: allowed is 0.001 to 100 kg"),
        ("mass", math.nan, "body.mass: nan: must be a finite number"),
        ("mass", "heavy", "body.mass: 'heavy': must be a number"),
        ("mass", True, "must be a number, not true or false"),
        ("shape", "cube", "body.shape: 'cube': choose one of sphere, disc"),
        ("shape", 3, "body.shape: 3: choose one of sphere, disc"),
        ("layers", 2.5, "body.layers: 2.5: must be a whole number"),
        ("rough", "perhaps", "body.rough: 'perhaps': must be true or false"),
        ("maas", 1.0, "body has no variable 'maas'; did you mean mass?"),
        (
            "speed",
            1.0,
            "body.speed: is of the causality output and cannot be set; set parameters, unconnected inputs and variables with a start value only",
        ),
    ],
)
def test_a_value_that_is_refused(name, value, message):
    found = problems(components={"body": {"parameters": {name: value}}})
    assert len(found) == 1
    assert message in found[0]


@pytest.mark.parametrize(
    ("given", "set_to"),
    [
        ({"shape": "disc"}, 2.0),
        ({"shape": 2}, 2.0),
        ({"shape": "2"}, 2.0),
        ({"rough": False}, 0.0),
        ({"rough": "no"}, 0.0),
        ({"mass": "2.5"}, 2.5),
        ({"mass": 2}, 2.0),
        ({"layers": 7.0}, 7.0),
        ({"force.x": -3.0}, -3.0),
    ],
)
def test_values_as_people_write_them(given, set_to):
    system, sources = wired({"body": BODY}, [], components={"body": {"parameters": given}})
    [(port, value)] = make_plan(system, sources).starts["body"]
    assert (port.name, value) == (next(iter(given)), set_to)


def test_a_value_set_twice_or_beside_a_connection():
    found = problems(
        ["push.force.x -> body.force.x"],
        components={"body": {"parameters": {"mass": 1.0, "force.x": 2.0}}},
        shared={"m": {"value": 3.0, "targets": ["body.mass"]}},
    )
    assert found == [
        "body.force.x: is set in components.body.parameters and is connected; remove one of both",
        "body.mass: is set in components.body.parameters and in shared.m; remove one of both",
    ]


def test_a_shared_value_reaches_all_its_targets():
    system, sources = wired(
        {"a": BODY, "b": BODY}, [], shared={"m": {"value": 7.0, "targets": ["a.mass", "b.mass"]}}
    )
    starts = make_plan(system, sources).starts
    assert [(port.name, value) for name in "ab" for port, value in starts[name]] == [
        ("mass", 7.0),
        ("mass", 7.0),
    ]


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        (
            {"components": {"push": {"step": 0.03}}},
            "push.step: 0.03 s neither divides the exchange step 0.1 s nor is a whole multiple of it; nearest are 0.025 s or 0.05 s",
        ),
        (
            {"components": {"push": {"step": 0.25}}},
            "push.step: 0.25 s neither divides the exchange step 0.1 s nor is a whole multiple of it; nearest are 0.2 s or 0.3 s",
        ),
        ({"stop_time": 0.0}, "stop_time: 0 s is not after start_time = 0 s"),
        (
            {"stop_time": 0.95},
            "stop_time: 0.95 s is no whole number of steps of 0.1 s; nearest are 0.9 s or 1 s",
        ),
        (
            {"start_time": 2.0, "stop_time": 2.25},
            "stop_time: 2.25 s is no whole number of steps of 0.1 s after 2 s; nearest are 2.2 s or 2.3 s",
        ),
        (
            {"components": {"push": {"step": 0.3}}},
            "stop_time: 1 s is no whole number of steps of 0.3 s; nearest are 0.9 s or 1.2 s",
        ),
        (
            {"output_interval": 0.15},
            "output_interval: 0.15 s is no whole number of steps of 0.1 s; nearest are 0.1 s or 0.2 s",
        ),
        (
            {"state_interval": 0.05},
            "state_interval: 0.05 s is no whole number of steps of 0.1 s; nearest is 0.1 s",
        ),
        ({"exchange_step": 1e-13}, "exchange_step: 1e-13 s is no whole number of picoseconds"),
        ({"order": ["push"]}, "order: does not name body; name each component once"),
        (
            {"order": ["push", "body", "push"]},
            "order: names push 2 times; name each component once",
        ),
        (
            {"order": ["push", "body", "boddy"]},
            "order: there is no component 'boddy'; did you mean body?",
        ),
        (
            {"record": ["body.sped"]},
            "record: 'body.sped' selects no output; did you mean body.speed or",
        ),
        ({"watch": ["body.force.x"]}, "watch: 'body.force.x' selects no output"),
        (
            {"components": {"body": {"record_states": True}}},
            "state_interval: is missing, and states of body are to be recorded",
        ),
        (
            {"energy_alarm": {"reference": "body.energy"}},
            "energy_alarm.reference: body has no variable 'energy'",
        ),
    ],
)
def test_settings_that_do_not_fit(settings, message):
    found = problems(**settings)
    assert any(message in problem for problem in found), found


def test_states_of_a_component_that_cannot_serialize_them():
    found = problems(
        mocks={"body": Mock([out("x")], serializes=False)},
        state_interval=0.1,
        components={"body": {"record_states": True}},
    )
    assert found == ["body.record_states: the FMU cannot serialize its state; leave it out"]


def test_an_fmu_that_a_process_can_hold_only_once():
    single = Mock([out("x")], once=True)
    assert problems(mocks={"a": single, "b": single}) == [
        "a, b: use one FMU that can be instantiated only once in a process; isolate them, or export it under two names"
    ]


BOND = {"giver": "spring", "force": ["end1.force"], "taker": "mass", "position": ["position"]}
LINKS = ["spring.end1.force -> mass.force", "mass.position -> spring.end1.position"]


@pytest.mark.parametrize(
    ("change", "links", "message"),
    [
        (
            {"position": ["velocity"]},
            LINKS,
            "spring.end1.force in N times mass.velocity in m/s is no energy in J",
        ),
        (
            {"position": ["position", "velocity"]},
            LINKS,
            "has 1 force and 2 positions; name one position for each force",
        ),
        (
            {},
            LINKS[1:],
            "spring.end1.force is connected to no input of mass; the ledger takes the force that the taker was given",
        ),
        (
            {},
            LINKS[:1],
            "mass.position is connected to no input of spring; the ledger takes the displacement that the giver was shown",
        ),
        ({"work": "end1.force"}, LINKS, "spring.end1.force is in N; name an output in J"),
        ({"taker": "maas"}, LINKS, "bonds.b: there is no component 'maas'; did you mean mass?"),
    ],
)
def test_a_power_bond_that_cannot_be(change, links, message):
    found = problems(
        links, mocks={"spring": spring(), "mass": mass()}, bonds={"b": {**BOND, **change}}
    )
    assert any(message in problem for problem in found), found


def test_everything_is_told_at_once():
    found = problems(
        ["push.forse -> body.force.x", "push.force.y -> body.speed"],
        order=["body"],
        output_interval=0.15,
        components={"body": {"parameters": {"mass": -1.0, "nothing": 0}}},
    )
    assert len(found) == 6


# ---------------------------------------------------------------------- files


def file_problems(path):
    system = system_from(
        {
            "name": "x",
            "components": {"a": {"fmu": str(path)}},
            "exchange_step": 1.0,
            "stop_time": 1.0,
        }
    )
    with pytest.raises(InputRefused) as refusal:
        make_plan(system, sources_of(system))
    [problem] = refusal.value.problems
    assert problem.where == "a"
    assert str(path) in str(problem)
    return str(problem)


def archive(path, **files):
    with zipfile.ZipFile(path, "w") as file:
        for name, content in files.items():
            file.writestr(name.replace("__", "/"), content)
    return path


BINARIES = {
    "binaries__linux64__a.so": "",
    "binaries__win64__a.dll": "",
    "binaries__darwin64__a.dylib": "",
}


def test_a_file_that_is_missing(tmp_path):
    assert "there is no such file" in file_problems(tmp_path / "none.fmu")


def test_a_file_that_is_no_zip(tmp_path):
    (tmp_path / "a.fmu").write_text("nothing")
    assert "is not an FMU: not a zip archive" in file_problems(tmp_path / "a.fmu")


def test_an_archive_that_is_no_fmu(tmp_path):
    assert "is not an FMU: there is no modelDescription.xml in it" in file_problems(
        archive(tmp_path / "a.fmu", readme="")
    )


def test_a_description_that_is_no_xml(tmp_path):
    path = archive(tmp_path / "a.fmu", **BINARIES, **{"modelDescription.xml": "<fmi"})
    assert "its modelDescription.xml cannot be read" in file_problems(path)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            ('fmiVersion="2.0"', 'fmiVersion="1.0"'),
            "is FMI 1.0; this program drives FMI 2.0 and 3.0",
        ),
        (("CoSimulation", "ModelExchange"), "is for model exchange only; co-simulation is needed"),
    ],
)
def test_an_fmu_of_another_kind(tmp_path, foreign, change, message):
    with zipfile.ZipFile(foreign) as file:
        xml = file.read("modelDescription.xml").decode()
    path = archive(tmp_path / "a.fmu", **BINARIES, **{"modelDescription.xml": xml.replace(*change)})
    assert message in file_problems(path)


def test_an_fmu_for_another_machine(tmp_path, foreign):
    with zipfile.ZipFile(foreign) as file:
        xml = file.read("modelDescription.xml").decode()
    path = archive(
        tmp_path / "a.fmu", **{"modelDescription.xml": xml, "binaries__amiga__a.library": ""}
    )
    text = file_problems(path)
    assert "has no binary for this machine" in text
    assert "it has amiga" in text


@pytest.mark.parametrize(
    ("table", "key", "hint"),
    [("adaptive", "toll", "control"), ("iteration", "toleranc", "tolerance"), ("", "toll", "")],
)
def test_an_unknown_key_is_compared_with_those_of_its_own_table(table, key, hint):
    """``to`` is a key of a connection's faults, and of no other table."""
    data = {"name": "x", "components": {}, **({table: {key: 1}} if table else {key: 1})}
    with pytest.raises(InputRefused) as refused:
        system_from(data)
    (said,) = [str(p) for p in refused.value.problems if key in str(p)]
    assert (f"did you mean {hint}" in said) if hint else ("did you mean to" not in said)
