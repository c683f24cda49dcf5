"""A value under a name that a variable had before is taken, and the user is told the new name."""

from pathlib import Path

import pytest

from rockshed.components.common.component import Component
from rockshed.components.common.ports import Layout, Variable, param
from rockshed.components.common.ports import out as output
from rockshed.core.fmu.fmu_slave import read_description
from rockshed.core.run import simulate
from rockshed.core.system.planning import make_plan
from rockshed.core.system.renaming import with_present_names
from rockshed.core.system.system import SystemSpec
from rockshed.fmus.description import fmi2, fmi3
from tests.cosim.mocks import Mock, inp, out, par

SAND = Mock(
    [
        par("density", 1600.0, "kg", formerly="unit_weight mass_density"),
        inp("push[1]", "N", formerly="load"),
        inp("push[2]", "N", formerly="load"),
        out("settlement", "m", formerly="sinking"),
    ]
)
SAID = "sand.unit_weight is called sand.density now: use the new name, the old one will go"


def system(**parameters):
    return SystemSpec(
        name="renamed",
        components={"sand": {"fmu": "sand.fmu", "parameters": parameters}},
        stop_time=0.1,
        exchange_step=0.1,
    )


def planned(sand):
    plan = make_plan(sand, {"sand": SAND})
    return {port.name: value for port, value in plan.starts["sand"]}, list(plan.warnings)


def test_an_old_name_sets_the_variable_and_is_told():
    assert planned(system(unit_weight=1800.0)) == ({"density": 1800.0}, [SAID])
    assert planned(system(density=1800.0)) == ({"density": 1800.0}, [])


def test_a_value_under_an_old_name_goes_before_the_systems_own():
    assert planned(system(density=1700.0, unit_weight=1800.0)) == ({"density": 1800.0}, [SAID])


def test_elements_of_a_renamed_array():
    values, warnings = planned(system(**{"load[*]": 5.0}))
    assert values == {"push[1]": 5.0, "push[2]": 5.0}
    assert len(warnings) == 1


def test_old_names_in_what_is_recorded_and_watched():
    sand = system().model_copy(update={"record": ["sand.sinking"], "watch": ["sand.sinking"]})
    plan = make_plan(sand, {"sand": SAND})
    assert [end.name for end in plan.recorded] == ["sand.settlement"]
    assert len(plan.warnings) == 1


def test_the_warning_stands_in_the_results(tmp_path):
    done = simulate(system(unit_weight=1800.0), tmp_path / "run", sources={"sand": SAND})
    assert done.provenance["warnings"] == [SAID]
    assert done.provenance["components"]["sand"]["parameters"]["density"]["value"] == 1800.0


def test_values_of_a_request_get_their_present_names():
    renamed = {"sand": read_description(SAND.model_description()).renamed_bases}
    values, warnings = with_present_names(
        {"rock.mass": 4.0, "sand.unit_weight": 2.0, "sand.density": 2.0, "width": 3}, renamed
    )
    assert values == {"rock.mass": 4.0, "sand.density": 2.0, "width": 3}
    assert warnings == [SAID]


LAYOUT = Layout(
    (
        param("density", "density of the sand", 1600.0, "kg/m3", formerly=("unit_weight",)),
        param("load", "load on an element", 0.0, "N", size="elements", formerly=("pressure",)),
        output("settlement", "settlement", "m"),
    )
)


def component():
    from rockshed.components.common.component import Size

    return Component(
        name="Sand",
        title="sand",
        layout=LAYOUT,
        kernels="",
        folder=Path(),
        sizes={"elements": Size(2, 1, 9, "elements")},
    )


def test_an_instance_takes_old_names():
    sand = component().instance()
    with pytest.warns(FutureWarning, match="unit_weight is called density now"):
        sand["unit_weight"] = 1800.0
    assert sand["density"] == 1800.0
    with pytest.warns(FutureWarning, match="pressure is called load now"):
        sand["pressure[2]"] = 3.0
    assert list(sand["load"]) == [0.0, 3.0]
    with pytest.raises(KeyError):
        sand["weight"]


@pytest.mark.parametrize("written", [fmi2, fmi3])
def test_old_names_stand_in_the_model_description(written):
    xml = written.model_description(component(), {"elements": 2}, "token")
    described = read_description(xml)
    assert described.renamed_bases == {"unit_weight": "density", "pressure": "load"}


def test_an_old_name_that_is_taken_is_refused():
    twice = [Variable(n, "parameter", "", formerly=("b",)) for n in ("a", "b")]
    for declared in (twice, [*twice[:1], Variable("c", "parameter", "", formerly=("b",))]):
        with pytest.raises(ValueError, match=r"taken: \['b'\]"):
            Layout(tuple(declared))
