"""FMUs of FMI 3.0 in a run, alone and beside those of FMI 2.0."""

import numpy as np
import pytest

from rockshed.core.errors import InputRefused, RunFailed
from rockshed.core.fmu.fmu_slave import FmuFile
from rockshed.core.run import simulate
from rockshed.core.system.reading import system_from
from tests.cosim.fmi3_fmus import SIMPLE, XML, library, pack
from tests.cosim.mocks import Mock, called_back, inp, out

LARGEST = 2**53 - 1


@pytest.fixture(scope="module")
def binary(tmp_path_factory):
    """The library of the FMU with one of everything."""
    return library(tmp_path_factory.mktemp("thing"))


@pytest.fixture(scope="module")
def thing(binary, tmp_path_factory):
    return pack(binary, tmp_path_factory.mktemp("fmi3") / "Thing.fmu")


def things(fmu, connections=(), a=(), b=(), **settings):
    """Two instances, a before b, that are connected."""
    parameters = {"a": dict(a), "b": dict(b)}
    data = {
        "name": "things",
        "components": {n: {"fmu": str(fmu), "parameters": parameters[n]} for n in "ab"},
        "connections": list(connections),
        "exchange_step": 0.1,
        "stop_time": 1.0,
        **settings,
    }
    return system_from(data)


def last(run, name):
    return run.series[name][-1]


@pytest.fixture
def reasons(tmp_path):
    """Return why a system is refused."""

    def said(system):
        with pytest.raises(InputRefused) as refusal:
            simulate(system, tmp_path / "refused")
        assert not (tmp_path / "refused").exists()
        return str(refusal.value)

    return said


@pytest.mark.parametrize(
    ("connection", "given", "shown"),
    [
        ("a.y -> b.u", {}, [6.0, 14.0]),
        ("a.y[*] -> b.u[*]", {}, [6.0, 14.0]),
        ("a.y[2] -> b.u[1]", {"u[2]": 4.5}, [14.0, 9.0]),
        ("a.sum -> b.u[2]", {}, [1.0, 42.0]),
    ],
)
@pytest.mark.parametrize("master", ["sequential", "jacobi"])
def test_arrays_and_elements_travel_and_other_elements_keep_their_values(
    thing, tmp_path, master, connection, given, shown
):
    fed = {"u[1]": 1.5, "u[2]": 3.5}
    run = simulate(things(thing, [connection], fed, given, master=master), tmp_path / "run")
    assert [last(run, f"b.y[{i}]") for i in (1, 2)] == shown


EXTREMES = {
    "Float32": (-0.10000000149011612, 3.4028234663852886e38),
    "Int8": (-128, 127),
    "UInt8": (0, 255),
    "Int16": (-32768, 32767),
    "UInt16": (0, 65535),
    "Int32": (-(2**31), 2**31 - 1),
    "UInt32": (0, 2**32 - 1),
    "Int64": (-LARGEST, LARGEST),
    "UInt64": (0, LARGEST),
    "Boolean": (False, True),
}


@pytest.mark.parametrize("which", [0, 1])
def test_all_types_travel_exactly_with_calls_of_c_and_through_python(thing, tmp_path, which):
    values = {f"{name}_in": limits[which] for name, limits in EXTREMES.items()}
    connections = [f"a.{name}_out -> b.{name}_in" for name in SIMPLE]
    system = things(thing, [*connections, "a.chosen -> b.option"], {**values, "option": "two"})
    for way, sources in (("direct", None), ("back", called_back(system))):
        run = simulate(system, tmp_path / way, sources=sources)
        found = {name: last(run, f"b.{name}_out") for name in SIMPLE}
        assert found == {name: limits[which] for name, limits in EXTREMES.items()}
        assert last(run, "b.chosen") == 2.0


def test_types_of_both_versions_of_fmi_meet_in_one_system(thing, tmp_path):
    """The whole number of one of FMI 2.0 is Int64 on the other side, and its truth one byte."""
    ports = [
        inp("x"),
        inp("count", kind="Integer"),
        inp("on", kind="Boolean"),
        out("double"),
        out("more", kind="Integer"),
        out("off", kind="Boolean"),
    ]

    def step(v, _time, _step):
        v["double"], v["more"], v["off"] = 2 * v["x"], v["count"] + 1, 1.0 - v["on"]

    mock = Mock(ports, step, lambda v: step(v, 0, 0))
    connections = [
        *("a.y[1] -> m.x", "a.UInt8_out -> m.count", "a.Boolean_out -> m.on"),
        *("m.double -> b.u[2]", "m.more -> b.Int64_in", "m.off -> b.Boolean_in"),
    ]
    system = things(thing, connections, {"UInt8_in": 255, "u[1]": 4.0})
    components = {**system.components, "m": system.components["a"].model_copy(update={"fmu": "m"})}
    components["m"] = components["m"].model_copy(update={"parameters": {}})
    system = system.model_copy(update={"components": components, "order": ["a", "m", "b"]})
    run = simulate(system, tmp_path / "run", sources={"m": mock})
    shown = [last(run, f"b.{name}") for name in ("y[2]", "Int64_out", "Boolean_out")]
    assert shown == [32.0, 256.0, 1.0]


def test_a_value_that_a_type_cannot_hold_ends_the_run_and_is_named(thing, tmp_path):
    system = things(thing, ["a.Int32_out -> b.UInt8_in"], {"Int32_in": 256})
    with pytest.raises(RunFailed, match=r"b\.UInt8_in is of the type UInt8, which cannot hold 256"):
        simulate(system, tmp_path / "run")


GROWING = "if (r[i] == 2) v[i] = t->n; else v[i] = t->of_UInt64 << (int)(100 * t->time + 0.5);"
"""The UInt64 that is shown doubles every 0.01 s."""


@pytest.fixture(scope="module")
def growing(tmp_path_factory):
    folder = tmp_path_factory.mktemp("growing")
    return pack(library(folder, getters={"UInt64": GROWING}), folder / "Growing.fmu")


@pytest.mark.parametrize("way", ["direct", "back", "isolated"])
@pytest.mark.parametrize("is_exchanged", [True, False], ids=["exchanged", "recorded"])
@pytest.mark.parametrize(("start", "at"), [(0.0, 0.4), (0.5, 0.5)], ids=["later", "at-once"])
def test_a_whole_number_of_more_than_53_bits_is_refused_with_variable_and_time(
    growing, tmp_path, way, is_exchanged, start, at
):
    """2**20 in the beginning, and 2**60 at 0.4 s."""
    more = {"isolate": ["a"]} if way == "isolated" else {}
    connections = ["a.UInt64_out -> b.UInt64_in"] if is_exchanged else ["a.y -> b.u"]
    given = {"UInt64_in": 2**20 if start == 0.0 else 9}
    times = {"start_time": start, "stop_time": 1.0}
    system = things(growing, connections, given, record=["a.UInt64_out"], **times, **more)
    sources = called_back(system) if way == "back" else None
    with pytest.raises((RunFailed, InputRefused)) as refused:
        simulate(system, tmp_path / "run", sources=sources)
    said = str(refused.value)
    assert "UInt64_out = " in said
    assert said.startswith("a")
    assert f"at t = {at:g} s" in said
    assert "more than 53 bits" in said


@pytest.mark.parametrize(
    ("connection", "reason"),
    [
        ("a.y[1] -> b.Int32_in", "a.y[1] is Float64 and b.Int32_in is Int32"),
        ("a.Boolean_out -> b.UInt8_in", "a.Boolean_out is Boolean"),
        ("a.given -> b.bytes", "a.given is Binary and b.bytes is Binary"),
        ("a.said -> b.u[1]", "a.said is String and b.u[1] is Float64"),
        ("a.sum -> b.u", "connects 1 output with 2 inputs"),
        ("a.y[3] -> b.u[1]", "a has no variable 'y[3]'"),
        ("a.y -> b.m", "b.m[1,1] is of the causality parameter, and an input is needed"),
        ("a.chosen <-> b.front", "one is matched by the rule bus, the other by plug"),
        ("a.front <-> b.front", "joins no output with an input: a.u is input and b.u is input"),
        ("a.front <-> b.reer", "b has no terminal 'reer'; did you mean rear?"),
    ],
)
def test_what_does_not_fit_together_is_refused_in_words(thing, reasons, connection, reason):
    assert reason in reasons(things(thing, [connection]))


def test_arrays_of_different_shapes_are_refused_with_both(thing, reasons):
    said = reasons(things(thing, ["a.y -> b.u"], {"n": 3}))
    assert "connects an array of 3 with one of 2 elements" in said


def test_a_unit_that_is_not_defined_is_refused_unless_a_factor_says_what_it_means(
    binary, tmp_path, reasons
):
    xml = XML.replace("name='sum'", "name='sum' unit='furlong'").replace(
        "name='u' ", "name='u' unit='m' "
    )
    odd = pack(binary, tmp_path / "X.fmu", xml)
    said = reasons(things(odd, ["a.sum -> b.u[1]"]))
    assert "the unit furlong of a.sum is not defined in its model description" in said
    assert "b.u[1] is in m (1 m)" in said
    given = {"source": "a.sum", "target": "b.u[1]", "factor": 201.168}
    run = simulate(things(odd, [given]), tmp_path / "run")
    assert last(run, "b.y[1]") == 2.0 * 201.168 * 21.0


@pytest.mark.parametrize(
    ("values", "reason"),
    [
        ({"n": 9}, "a.n: 9: allowed is 1 to 8"),
        ({"u[2]": 1.0, "n": 1}, "a has no variable 'u[2]'"),
        ({"option": "three"}, "choose one of one, two"),
        ({"UInt64_in": 2**60}, "allowed is 0 to 9007199254740991"),
        ({"Int8_in": -129}, "allowed is -128 to 127"),
        ({"bytes": "00"}, "is of the type Binary"),
    ],
)
def test_values_that_do_not_fit_are_refused(thing, reasons, values, reason):
    assert reason in reasons(things(thing, (), values))


def test_sizes_are_set_before_anything_else(thing, tmp_path):
    given = {"n": 3, "u[1]": 1.0, "u[2]": 2.0, "u[3]": 3.0}
    run = simulate(things(thing, ["a.y -> b.u"], given, {"n": 3}), tmp_path / "run")
    assert [last(run, f"b.y[{i}]") for i in (1, 2, 3)] == [4.0, 8.0, 12.0]
    assert run.provenance["components"]["a"]["parameters"]["n"]["value"] == 3


def test_a_matrix_keeps_the_elements_that_are_not_given(thing, tmp_path):
    run = simulate(things(thing, (), {"m[2,3]": 106.0}), tmp_path / "run")
    assert (last(run, "a.sum"), last(run, "b.sum")) == (121.0, 21.0)


def test_terminals_are_connected_as_a_whole(thing, tmp_path):
    """Each doubles the other, and so they grow with every exchange."""
    whole, single = (
        simulate(things(thing, listed, record=["*.y[*]"]), tmp_path / name)
        for name, listed in (
            ("whole", ["a.front <-> b.rear"]),
            ("single", ["a.y -> b.u", "b.y -> a.u"]),
        )
    )
    assert whole["b.y[1]"][-1] > whole["b.y[1]"][0] > 1.0
    assert len(whole.series) == 5
    assert all(np.array_equal(whole.series[name], single.series[name]) for name in single.series)


@pytest.mark.parametrize("back", [False, True])
def test_a_step_that_ends_early_at_an_event_is_made_to_its_end_and_counted(thing, tmp_path, back):
    system = things(thing, (), {"period": 0.03})
    sources = called_back(system) if back else None
    run = simulate(system, tmp_path / "run", sources=sources)
    assert last(run, "a.events") == 33.0
    if not back:  # the loop sees one step
        # three events of a period of ten fall on the end of a step
        assert run.provenance["early_returns"] == {"a": 30}
        assert run.metrics["early_returns_of_a"].value == 30


@pytest.mark.parametrize("back", [False, True])
def test_texts_are_passed_on_and_recorded_with_the_times_of_their_changes(thing, tmp_path, back):
    given = {"text": "block", "period": 0.25}
    system = things(thing, ["a.said -> b.text"], given, record=["*.said"])
    run = simulate(system, tmp_path / "run", sources=called_back(system) if back else None)
    times = [0.0, 0.3, 0.5, 0.8, 1.0]
    assert [at for at, _ in run.texts["a.said"]] == pytest.approx(times, abs=1e-12)
    assert [text for _, text in run.texts["a.said"]] == [f"block {n}" for n in range(5)]
    # b takes its turn after a, and says the same with its own number behind
    assert run.texts["b.said"] == [(at, f"{text} 0") for at, text in run.texts["a.said"]]


def test_texts_travel_between_both_versions_of_fmi(thing, tmp_path):
    mock = Mock([inp("heard", kind="String"), out("told", kind="String"), out("x")])
    mock.step = lambda v, _time, _step: v.update(told=str(v["heard"]).upper())
    system = things(thing, ["a.said -> b.heard"], {"text": "rock"}, record=["*"])
    run = simulate(system, tmp_path / "run", sources={"b": mock})
    assert run.texts["b.told"][-1] == (0.1, "ROCK 0")


def test_a_step_that_returns_early_without_end_fails(binary, tmp_path, monkeypatch):
    """It has more events in a step than anyone waits for."""
    xml = XML.replace("name='period'", "name='period_'")
    fmu = pack(binary, tmp_path / "X.fmu", xml)
    with pytest.raises(RunFailed, match="the step returned early there again and again"):
        simulate(things(fmu, (), {"period_": 1e-300}), tmp_path / "run")


def test_an_fmu_ends_the_run_in_the_middle_of_a_step(thing, tmp_path):
    run = simulate(things(thing, (), {"end": 0.25}), tmp_path / "run")
    assert run.time[-1] == 0.25
    assert "a has ended the run at t = 0.25 s" in run.warnings


def test_states_are_restored_in_another_instance(thing):
    one, other = (FmuFile(thing).instantiate(name) for name in "ab")
    one.set(np.array([3], np.uint32), np.array([7.0, 8.0]), "Float64")
    other.restore(one.state())
    found = np.zeros(2)
    assert other.get(np.array([4], np.uint32), found, "Float64") == 0
    assert found.tolist() == [14.0, 16.0]
    with pytest.raises(RuntimeError, match="b: the state cannot be restored: no state of mine"):
        other.restore(b"short")
    one.free()
    other.free()


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (("CoSimulation", "ModelExchange"), "is for model exchange only"),
        (("CoSimulation", "ScheduledExecution"), "is for scheduled execution only"),
        (("fmiVersion='3.0'", "fmiVersion='1.0'"), "is FMI 1.0; this program drives"),
        (("Token='thing'", "Token='other'"), "fmi3InstantiateCoSimulation returned no instance"),
        (("valueReference='2'/></", "valueReference='99'/></"), "cannot be read"),
    ],
)
def test_an_fmu_that_cannot_be_run_is_refused_with_the_reason(
    binary, tmp_path, reasons, change, reason
):
    broken = pack(binary, tmp_path / "X.fmu", XML.replace(*change))
    assert reason in reasons(things(broken))


def test_an_fmu_for_another_machine_is_refused(binary, tmp_path, reasons):
    other = pack(binary, tmp_path / "X.fmu", platform="amiga-os")
    assert "has no binary for this machine" in reasons(things(other))


def test_terminals_that_cannot_be_read_are_refused(binary, tmp_path, reasons):
    broken = pack(binary, tmp_path / "X.fmu", terminals="<fmiTerminals")
    said = reasons(things(broken, ["a.front <-> b.rear"]))
    assert "its terminalsAndIcons.xml cannot be read" in said
