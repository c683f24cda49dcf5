"""Model descriptions of FMI 3.0, as a co-simulation sees them."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rockshed.core.fmu.fmu_slave import UnusableError, read_description
from rockshed.core.fmu.terminals import BUS, SEQUENCE, Terminal, TerminalMember, matched
from rockshed.core.fmu.types import TYPES, TYPES_3
from rockshed.fmus.description.fmi3 import model_description
from rockshed.systems.parts.spring import COMPONENT as SPRING
from tests.cosim.fmi3_fmus import SIMPLE, XML


def described(*changes, sizes=()):
    xml = XML
    for change in changes:
        xml = xml.replace(*change)
    return read_description(xml.encode(), sizes)


def test_elements_of_an_array_have_its_reference_their_place_and_their_own_start():
    known = described()
    names = [f"m[{i},{j}]" for i in (1, 2) for j in (1, 2, 3)]
    assert known.arrays["m"].names == tuple(names)
    assert known.arrays["m"].shape == (2, 3)
    ports = [known.ports[name] for name in names]
    assert {port.reference for port in ports} == {5}
    assert [port.element for port in ports] == [0, 1, 2, 3, 4, 5]
    assert [port.start for port in ports] == ["1", "2", "3", "4", "5", "6"]
    assert known.elements_of(ports[3]) == ports


def test_sizes_follow_structural_parameters_and_start_values_only_where_they_fit():
    assert [described(sizes=(("n", n),)).arrays["y"].shape for n in (1, 3, 8)] == [(1,), (3,), (8,)]
    one_for_all = described(sizes=(("n", 4),))
    assert [one_for_all.ports[f"u[{i}]"].start for i in (1, 4)] == ["0.5", "0.5"]
    two = ("start='0.5'", "start='0.5 0.6'")
    assert described(two).ports["u[2]"].start == "0.6"
    assert described(two, sizes=(("n", 4),)).ports["u[2]"].start is None


def test_every_type_has_its_kind_and_an_enumeration_travels_as_int64():
    ports = described().ports
    kinds = {name: ports[f"{name}_in"].kind for name in SIMPLE}
    assert {name for name, kind in kinds.items() if kind == "Integer"} == {
        name for name in SIMPLE if "Int" in name
    }
    assert (kinds["Float32"], kinds["Boolean"]) == ("Real", "Boolean")
    assert (ports["option"].type, ports["option"].items) == ("Int64", {"one": 1, "two": 2})
    assert (ports["n"].minimum, ports["n"].maximum) == (1.0, 8.0)  # of an unsigned type too


def test_another_name_of_a_variable_is_known_as_such():
    alias = "<Alias name='total' description='again'/>"
    ports = described(
        (
            "causality='output'/>\n<Float64 name='period'",
            f"causality='output'>{alias}</Float64>\n<Float64 name='period'",
        )
    ).ports
    total = ports["total"]
    assert (total.reference, total.is_alias, ports["sum"].is_alias) == (6, True, False)


def test_an_array_of_too_many_elements_is_refused():
    with pytest.raises(UnusableError, match="its m has more than 1,000,000 elements"):
        described(("<Dimension start='2'/>", "<Dimension start='1000000'/>"))


@given(name=st.sampled_from(TYPES_3), data=st.data())
def test_a_number_within_the_limits_of_its_type_survives_a_call(name, data):
    held = TYPES[name]
    numbers = (
        st.integers(int(held.low), int(held.high))
        if held.is_whole
        else st.floats(held.low, held.high, width=8 * held.number.itemsize)
    )
    value = float(data.draw(numbers))
    assert float(np.array([value]).astype(held.number)[0]) == value


def terminal(*names, rule="plug", kind=""):
    return Terminal({name: TerminalMember(f"v_{name}") for name in names}, rule, kind)


def test_members_of_terminals_are_matched_as_their_rule_says():
    def pairs(one, other):
        return [(a.variable, b.variable) for a, b in matched(one, other)]

    assert pairs(terminal("a", "b"), terminal("b", "a")) == [("v_a", "v_a"), ("v_b", "v_b")]
    assert pairs(terminal("a", "b", rule=BUS), terminal("c", "b", rule=BUS)) == [("v_b", "v_b")]
    ordered = (terminal(*names, rule=SEQUENCE) for names in ("ab", "cd"))
    assert pairs(*ordered) == [("v_a", "v_c"), ("v_b", "v_d")]


@pytest.mark.parametrize(
    ("one", "other", "reason"),
    [
        (terminal("a"), terminal("a", "b", "c"), "only one of both has b, c"),
        (terminal("a", rule=BUS), terminal("b", rule=BUS), "no member in common"),
        (terminal("a", rule=SEQUENCE), terminal("a", "b", rule=SEQUENCE), "one has 1 members"),
        (terminal("a"), terminal("a", rule=BUS), "the rule plug, the other by bus"),
        (terminal("a", kind="pipe"), terminal("a", kind="rod"), "of the kind pipe"),
        (terminal("a", rule="magic"), terminal("a", rule="magic"), "magic"),
    ],
)
def test_terminals_that_do_not_fit_say_why(one, other, reason):
    with pytest.raises(ValueError, match=reason):
        matched(one, other)


def test_the_unit_of_time_is_defined_where_no_variable_has_it():
    xml = model_description(SPRING, SPRING.with_sizes(), "{0}")
    assert b'<Unit name="s">' in xml
    assert read_description(xml).ports["compression"].unit_name == "m"
