"""The model description says what the declarations say, and is valid."""

import zipfile

import pytest
from fmpy.model_description import read_model_description
from fmpy.validation import validate_fmu

from rockshed.components.catalogue import NAMES, component
from rockshed.components.common.ports import Kind
from rockshed.fmus.build import build_component


@pytest.mark.parametrize("name", [*NAMES, "Probe"])
def test_fmpy_finds_nothing_to_say(fmus, name):
    assert validate_fmu(str(fmus[name])) == []


@pytest.mark.parametrize("name", [name for name in NAMES if component(name).sizes])
def test_fmpy_finds_nothing_to_say_about_another_size(tmp_path, name):
    sizes = {
        key: max(size.minimum, size.default // 2) for key, size in component(name).sizes.items()
    }
    assert validate_fmu(str(build_component(component(name), sizes, tmp_path))) == []


def declared(fmus, probe, name):
    """(variable of the XML, its declaration, its element's number) of each variable; the sizes are left out."""
    chosen = probe if name == "Probe" else component(name)
    sizes = chosen.with_sizes()
    elements = [(v, i) for v in chosen.layout.ordered for i in range(len(v.element_names(sizes)))]
    variables = read_model_description(str(fmus[name])).modelVariables
    return [(xml, v, i, sizes) for xml, (v, i) in zip(variables, elements)], variables[
        len(elements) :
    ]


@pytest.mark.parametrize("name", [*NAMES, "Probe"])
def test_every_variable_is_described_as_declared(fmus, probe, name):
    variables, _ = declared(fmus, probe, name)
    for reference, (xml, variable, number, sizes) in enumerate(variables):
        assert xml.valueReference == reference
        assert xml.name == variable.element_names(sizes)[number]
        assert (xml.type, xml.causality, xml.description) == (
            variable.kind,
            variable.causality,
            variable.description,
        )
        assert (
            xml.initial
            == {"parameter": "exact", "input": "exact", "output": "calculated"}[xml.causality]
        )
        assert (
            None
            if xml.start is None
            else float(xml.start.replace("true", "1").replace("false", "0"))
        ) == (None if xml.causality == "output" else variable.start_at(number, sizes))
        if variable.kind is Kind.REAL:
            assert xml.unit == xml.declaredType.unit == variable.unit
        if variable.kind is not Kind.BOOLEAN:
            assert [None if b is None else float(b) for b in (xml.min, xml.max)] == [
                variable.minimum,
                variable.maximum,
            ]


@pytest.mark.parametrize("name", [*NAMES, "Probe"])
def test_start_values_lie_in_their_range(fmus, probe, name):
    for xml, variable, number, sizes in declared(fmus, probe, name)[0]:
        if xml.start is not None:
            start = variable.start_at(number, sizes)
            assert variable.minimum is None or variable.minimum <= start, xml.name
            assert variable.maximum is None or start <= variable.maximum, xml.name


def test_units_are_defined_by_base_units(fmus):
    units = {
        unit.name: unit.baseUnit
        for unit in read_model_description(str(fmus["FallingRock"])).unitDefinitions
    }
    exponents = {
        name: {
            symbol: getattr(u, symbol) for symbol in ("kg", "m", "s", "rad") if getattr(u, symbol)
        }
        for name, u in units.items()
    }
    assert exponents == {
        "s": {"s": 1},
        "m": {"m": 1},
        "m/s": {"m": 1, "s": -1},
        "m/s2": {"m": 1, "s": -2},
        "rad": {"rad": 1},
        "rad/s": {"rad": 1, "s": -1},
        "kg": {"kg": 1},
        "kg.m2": {"kg": 1, "m": 2},
        "N": {"kg": 1, "m": 1, "s": -2},
        "N.m": {"kg": 1, "m": 2, "s": -2},
        "J": {"kg": 1, "m": 2, "s": -2},
    }
    assert {unit.factor for unit in units.values()} == {1.0}


def test_enumeration_has_its_words(fmus):
    variables = {v.name: v for v in read_model_description(str(fmus["FallingRock"])).modelVariables}
    assert [(item.name, item.value) for item in variables["shape"].declaredType.items] == [
        ("sphere", "1"),
        ("disc", "2"),
        ("given", "3"),
    ]


def test_sizes_are_constants_after_all_other_variables(fmus, probe):
    variables, rest = declared(fmus, probe, "Probe")
    assert [
        (
            v.name,
            v.valueReference,
            v.type,
            v.causality,
            v.variability,
            v.initial,
            v.start,
            v.description,
        )
        for v in rest
    ] == [
        ("tanks", len(variables), "Integer", "local", "constant", "exact", "3", "number of tanks")
    ]


def test_no_output_depends_on_an_input_between_steps_and_at_the_start_on_what_is_declared(fmus):
    description = read_model_description(str(fmus["Probe"]))
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
        **{f"level[{i}]": ["level0[1]", "level0[2]", "level0[3]"] for i in (1, 2, 3)},
    }


def test_flags_log_categories_and_default_experiment(fmus):
    description = read_model_description(str(fmus["Probe"]))
    interface = description.coSimulation
    assert interface.canGetAndSetFMUstate
    assert interface.canSerializeFMUstate
    assert interface.canHandleVariableCommunicationStepSize
    assert interface.needsExecutionTool
    assert interface.canNotUseMemoryManagementFunctions
    assert not interface.canBeInstantiatedOnlyOncePerProcess
    assert [category.name for category in description.logCategories] == [
        "logStatusWarning",
        "logStatusError",
    ]
    experiment = description.defaultExperiment
    assert (experiment.startTime, experiment.stopTime, experiment.stepSize) == (
        "0.0",
        "1.0",
        "0.01",
    )


def test_nothing_in_the_description_changes_with_the_time_of_the_build(fmus):
    with zipfile.ZipFile(fmus["FallingRock"]) as archive:
        assert b"generationDateAndTime" not in archive.read("modelDescription.xml")
