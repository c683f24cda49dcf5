"""The description of FMI 3.0 says what the declarations say, and its terminals what the bonds are."""

import io
import zipfile
from dataclasses import replace
from pathlib import Path

import fmpy
import pytest
from fmpy.model_description import read_model_description
from lxml import etree

from rockshed.components.catalogue import NAMES, component
from rockshed.components.common.component import Component
from rockshed.components.common.ports import BOND_MEMBERS, Bond, Causality, Kind, Layout, inp, out
from rockshed.fmus.build import Fmi, Runtime, build_component
from rockshed.fmus.description.fmi3 import TERMINALS, model_description, terminals_and_icon

ALL = [*NAMES, "Probe"]
TYPES = {
    Kind.REAL: "Float64",
    Kind.INTEGER: "Int32",
    Kind.BOOLEAN: "Boolean",
    Kind.ENUMERATION: "Enumeration",
}
SCHEMA = Path(fmpy.__file__).parent / "schema" / "fmi3"


@pytest.fixture(params=ALL)
def described(request, fmi3_fmus, native_fmus, probe):
    """(component, its description in FMI 3.0, that in FMI 2.0)."""
    chosen = probe if request.param == "Probe" else component(request.param)
    return chosen, *(
        read_model_description(str(fmus[request.param])) for fmus in (fmi3_fmus, native_fmus)
    )


def test_every_variable_is_described_as_declared(described):
    chosen, description, in_fmi2 = described
    references = {v.name: v.valueReference for v in in_fmi2.modelVariables}
    sizes = chosen.with_sizes()
    for xml, declared in zip(description.modelVariables, chosen.layout.ordered):
        first, *_ = declared.element_names(sizes)
        assert (xml.name, xml.valueReference) == (declared.name, references[first])
        assert (xml.type, xml.causality, xml.description) == (
            TYPES[declared.kind],
            declared.causality,
            declared.description,
        )
        assert [int(d.start) for d in xml.dimensions] == (
            [] if declared.size is None else [sizes[declared.size]]
        )
        if declared.kind is Kind.REAL:
            assert xml.unit == xml.declaredType.unit == declared.unit
        if declared.kind is not Kind.BOOLEAN:
            assert [None if b is None else float(b) for b in (xml.min, xml.max)] == [
                declared.minimum,
                declared.maximum,
            ]


def test_the_sizes_and_the_time_stand_last(described):
    chosen, description, _ = described
    sizes = chosen.with_sizes()
    *rest, time = description.modelVariables[len(chosen.layout.ordered) :]
    assert {v.name: (v.type, v.causality, v.variability, int(v.start)) for v in rest} == {
        name: ("Int32", "local", "constant", value) for name, value in sizes.items()
    }
    assert (time.name, time.causality, time.unit, time.start) == ("time", "independent", "s", None)


def test_units_and_types_are_those_of_fmi_2(described):
    _, description, in_fmi2 = described
    units = [
        [(unit.name, repr(unit.baseUnit)) for unit in d.unitDefinitions]
        for d in (description, in_fmi2)
    ]
    types = [
        [(t.name, t.unit, [(item.name, item.value) for item in t.items]) for t in d.typeDefinitions]
        for d in (description, in_fmi2)
    ]
    assert units[0] == units[1]
    assert types[0] == types[1]


def test_no_output_depends_on_an_input_between_steps_and_at_the_start_on_what_is_declared(
    fmi3_fmus,
):
    description = read_model_description(str(fmi3_fmus["Probe"]))
    assert all(unknown.dependencies == [] for unknown in description.outputs)
    names = {
        unknown.variable.name: None
        if unknown.dependencies is None
        else [v.name for v in unknown.dependencies]
        for unknown in description.initialUnknowns
    }
    assert names == {
        "count": ["first_count"],
        "flow": ["inflow", "valve"],
        "initialisations": [],
        "stable_step": None,
        "level": ["level0"],
    }


def test_flags_log_categories_and_default_experiment(described):
    chosen, description, _ = described
    interface = description.coSimulation
    assert description.fmiVersion == "3.0"
    assert interface.canGetAndSetFMUstate
    assert interface.canSerializeFMUstate
    assert interface.canHandleVariableCommunicationStepSize
    assert not interface.needsExecutionTool
    assert not interface.hasEventMode
    assert not interface.canReturnEarlyAfterIntermediateUpdate
    assert [category.name for category in description.logCategories] == [
        "logStatusWarning",
        "logStatusError",
    ]
    assert description.defaultExperiment.stepSize == repr(chosen.default_step)
    flags = (
        etree.fromstring(model_description(chosen, chosen.with_sizes(), ""))
        .find("CoSimulation")
        .attrib
    )
    assert ("mightReturnEarlyFromDoStep" in flags) == (chosen.next_event is not None)
    assert chosen.name != "SlopeRockfall" or flags["mightReturnEarlyFromDoStep"] == "true"


def test_the_files_are_where_fmi_3_has_them(fmi3_fmus):
    with zipfile.ZipFile(fmi3_fmus["FallingRock"]) as archive:
        names = set(archive.namelist())
    assert {name.split("/")[0] for name in names} == {
        "modelDescription.xml",
        "binaries",
        "documentation",
        "extra",
        "terminalsAndIcons",
    }
    assert {"documentation/index.html", "terminalsAndIcons/icon.png", TERMINALS} <= names


# ------------------------------------------------------------------ terminals


def members(file):
    """Of each terminal of an FMU: the variable of each member."""
    with zipfile.ZipFile(file) as archive:
        root = etree.fromstring(archive.read(TERMINALS))
    etree.XMLSchema(etree.parse(str(SCHEMA / "fmi3TerminalsAndIcons.xsd"))).assertValid(root)
    return {
        terminal.get("name"): {m.get("memberName"): m.get("variableName") for m in terminal}
        for terminal in root.iter("Terminal")
    }


@pytest.mark.parametrize("name", [name for name in NAMES if component(name).bonds])
def test_terminals_are_valid_and_name_inputs_and_outputs(fmi3_fmus, name):
    causalities = {
        v.name: v.causality for v in read_model_description(str(fmi3_fmus[name])).modelVariables
    }
    terminals = members(fmi3_fmus[name])
    assert [*terminals] == [bond.name for bond in component(name).bonds]
    for its in terminals.values():
        assert set(its) <= set(BOND_MEMBERS)
        assert {causalities[variable] for variable in its.values()} == {"input", "output"}


def test_terminals_of_both_ends_of_a_bond_fit_together(fmi3_fmus):
    variables = {
        name: {v.name: v for v in read_model_description(str(fmi3_fmus[name])).modelVariables}
        for name in NAMES
    }
    terminals = {name: members(fmi3_fmus[name]) for name in NAMES}
    for one, other, terminal in (
        ("FallingRock", "SandCushion", "rock"),
        ("SlopeRockfall", "SandCushion", "rock"),
        ("RBSMBeam", "SandCushion", "beam"),
        ("Hammer", "PileRod", "head"),
        ("ImpulsiveGround", "PileRod", "toe"),
    ):
        ends = terminals[one][terminal], terminals[other][terminal]
        assert set(ends[0]) == set(ends[1])
        for member in ends[0]:
            here, there = variables[one][ends[0][member]], variables[other][ends[1][member]]
            assert {here.causality, there.causality} == {"input", "output"}
            assert (here.unit, [d.start for d in here.dimensions]) == (
                there.unit,
                [d.start for d in there.dimensions],
            )
    assert set(terminals["ImpulsiveGround"]["plate"]) == set(terminals["RBSMBeam"]["support"])
    assert terminals["RBSMBeam"]["support"] == {
        "position.y": "support.position.y",
        "velocity.y": "support.velocity.y",
        "force.y": "support.mean_force.y",
    }


def test_a_component_without_bonds_and_icon_has_no_terminals(fmi3_fmus, probe):
    assert terminals_and_icon(probe) == {}


def test_a_bond_that_carries_no_power_is_refused(probe):
    layout = Layout(
        (
            inp("rock.position.x", "position", "m"),
            inp("rock.force.x", "force", "N"),
            out("work", "work", "J"),
        )
    )
    with pytest.raises(
        ValueError,
        match="Lone: bond 'rock' needs motion and force, one of them an input, one an output",
    ):
        Component(
            "Lone",
            "lone",
            layout,
            probe.initialise,
            probe.evaluate,
            probe.step,
            probe.folder,
            bonds=(Bond("rock", "motion of the rock", "rock."),),
        )


@pytest.mark.parametrize(
    ("named", "told"), [({"force.x": "forse"}, "force.x"), ({"push": "force.x"}, "push")]
)
def test_a_bond_that_names_what_is_not_there_is_refused(named, told):
    rock = component("FallingRock")
    bond = Bond("rock", "motion of the rock, force on it", named=named)
    with pytest.raises(ValueError, match=f"bond 'rock' names {told}: no member"):
        replace(rock, bonds=(bond,))


def test_parameters_are_no_members_of_a_bond():
    variables = component("FallingRock").layout.variables
    assert {v.causality for v in Bond("rock", "").members(variables).values()} == {
        Causality.INPUT,
        Causality.OUTPUT,
    }


# ------------------------------------------------------------------ sizes


def test_another_size_has_longer_arrays(fmi3_fmus, probe, tmp_path):
    file = build_component(probe, {"tanks": 5}, tmp_path, runtime=Runtime.NATIVE, fmi=Fmi.THREE)
    assert file.name == "Probe-tanks5.fmu"
    description = read_model_description(io.BytesIO(file.read_bytes()))
    assert {int(d.start) for v in description.modelVariables for d in v.dimensions} == {5}
