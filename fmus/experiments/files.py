"""Experiments as files inside an FMU, as FMI-LS-REF and MA-HS-Experiments have them.

The manifest names every file with its role, and in an annotation its checksum. A file of
experiments (``.exp``) for each purpose refers to parameters (SSV), stimuli and expected results
(CSV). The tolerances of the results stand in an annotation, as the standards have no place for one
that is not the same for all outputs; so does the state from which an experiment may begin.
"""

import hashlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from lxml import etree
from numpy.typing import NDArray

from rockshed.components.common.component import Component
from rockshed.components.common.ports import Kind, Sizes, Variable

from ..description.annotations import TOOL
from ..description.documentation import EXPERIMENTS_PAGE
from ..description.fmi2 import literal
from ..parts import STATES, Files, Fmi
from .declaration import Experiment, Given, Purpose, SerializedState, Stimulus, rows
from .found import experiments_of
from .page import experiments_html
from .recorded import STATE_PLATFORM

FOLDER = "extra/org.fmi-standard.fmi-ls-ref"
"""Folder of FMI-LS-REF inside an FMU."""
MANIFEST = f"{FOLDER}/fmi-ls-manifest.xml"
_LS = "http://fmi-standard.org/fmi-ls-manifest"
_LS_NAME = "org.fmi-standard.fmi-ls-ref"
_LS_VERSION = "1.0.0-beta.1"
_LS_DESCRIPTION = (
    "Layered Standard providing information on related files included in an FMU."  # as it is fixed
)
_SSV = "http://ssp-standard.org/SSP1/SystemStructureParameterValues"
_SSC = "http://ssp-standard.org/SSP1/SystemStructureCommon"
_EXPERIMENTS_TYPE = "application/x-ma-hs-experiments"
_PARAMETERS_TYPE = "application/x-ssp-parameter-set"
_ABOUT = {
    Purpose.SMOKE: "does the FMU run here as it does at home?",
    Purpose.VALIDATION: "closed forms that the documentation derives",
    Purpose.UNCERTAINTY: "what parameters that are not well known do",
}


@dataclass(frozen=True)
class _Related:
    """A file of the layered standard: name in its folder, role, type, description and content."""

    name: str
    role: str
    type: str
    description: str
    content: bytes


def experiment_files(component: Component, sizes: Sizes, fmi: Fmi = Fmi.TWO) -> Files:
    """Return the files of a component's experiments.

    Parameters
    ----------
    component : Component
        The component.
    sizes : mapping of str to int
        All its sizes.
    fmi : Fmi
        Version of FMI: arrays are columns and parameters by themselves in FMI 3.0.

    Returns
    -------
    Files
        Content by path inside the FMU; empty without experiments.

    Raises
    ------
    BuildError
        An experiment names what the component has not.
    """
    experiments = experiments_of(component, sizes)
    if not experiments:
        return {}
    writer = _Writer(component, sizes, fmi)
    related = [file for one in experiments for file in writer.data_files(one)]
    states = {one.state.name: one.state for one in experiments if one.state}
    related += [_of_state(state, fmi) for state in states.values()]
    for purpose in Purpose:
        chosen = [one for one in experiments if one.purpose is purpose]
        if chosen:
            related.append(writer.experiments_file(purpose, chosen))
    files = {f"{FOLDER}/{file.name}": file.content for file in related}
    page = experiments_html(component, experiments).encode()
    shown = _Related(
        f"../../{EXPERIMENTS_PAGE}", "document", "text/html", "what the experiments show", page
    )
    return files | {MANIFEST: _manifest([shown, *related]), EXPERIMENTS_PAGE: page}


def _of_state(state: SerializedState, fmi: Fmi) -> _Related:
    """Return a state with the role of its platform, which each version of FMI names otherwise."""
    platform = STATE_PLATFORM.in_fmi2 if fmi is Fmi.TWO else STATE_PLATFORM.in_fmi3
    what = f"state of {state.name}, initialised: the first step may follow"
    role = f"serialized-state/{platform}"
    return _Related(state_file(state), role, "application/octet-stream", what, state.content)


def state_file(state: SerializedState) -> str:
    """Return the name of the file of a state."""
    return f"{state.name}{STATES}"


def _manifest(related: Sequence[_Related]) -> bytes:
    names = {
        f"{{{_LS}}}fmi-ls-name": _LS_NAME,
        f"{{{_LS}}}fmi-ls-version": _LS_VERSION,
        f"{{{_LS}}}fmi-ls-description": _LS_DESCRIPTION,
    }
    root = etree.Element("fmiReferences", names, nsmap={"fmi-ls": _LS})
    for file in related:
        element = etree.SubElement(
            root,
            "Related",
            type=file.type,
            source=file.name,
            role=file.role,
            description=file.description,
        )
        checksum = hashlib.sha256(file.content).hexdigest()
        etree.SubElement(_annotation(element), "Content", sha256=checksum)
    return _text(root)


def _annotation(element: etree._Element) -> etree._Element:
    """Append an annotation of this program."""
    annotations = etree.SubElement(element, "Annotations")
    return etree.SubElement(annotations, "Annotation", type=TOOL)


def _text(root: etree._Element) -> bytes:
    return etree.tostring(root, xml_declaration=True, encoding="UTF-8", pretty_print=True)


class _Writer:
    """Writes the files of experiments for one FMU.

    Parameters
    ----------
    component : Component
        The component.
    sizes : mapping of str to int
        All its sizes.
    fmi : Fmi
        Version of FMI.
    """

    def __init__(self, component: Component, sizes: Sizes, fmi: Fmi) -> None:
        self._variables = {v.name: v for v in component.layout.variables}
        self._name = component.name
        self._sizes = sizes
        self._fmi = fmi

    # ------------------------------------------------------------------ XML

    def experiments_file(self, purpose: Purpose, experiments: Sequence[Experiment]) -> _Related:
        """Return the file of all experiments of a purpose."""
        about = _ABOUT[purpose]
        root = etree.Element("Experiments", name=f"{self._name}, {purpose}", description=about)
        for one in experiments:
            self._experiment(root, one)
        role = f"experiment/{purpose}"
        return _Related(f"{purpose}.exp", role, _EXPERIMENTS_TYPE, about, _text(root))

    def _experiment(self, root: etree._Element, one: Experiment) -> None:
        element = etree.SubElement(
            root,
            "Experiment",
            name=one.name,
            description=one.description,
            tolerance=repr(float(f"{one.tolerance:.3g}")),
        )
        etree.SubElement(
            element,
            "TransientSimulation",
            startTime="0.0",
            stopTime=repr(one.stop_time),
            stepSize=repr(one.step),
        )
        if one.parameters:
            etree.SubElement(element, "Parameters", type=_PARAMETERS_TYPE, source=f"{one.name}.ssv")
        if one.inputs:
            etree.SubElement(element, "Stimuli", type="text/csv", source=f"{one.name}_in.csv")
        references = etree.SubElement(
            element, "References", type="text/csv", source=f"{one.name}_ref.csv"
        )
        tolerances = etree.SubElement(_annotation(references), "Tolerances")
        for variable, expected in one.expected.items():
            etree.SubElement(
                tolerances,
                "Tolerance",
                variable=variable,
                absolute=repr(float(f"{expected.tolerance:.3g}")),
            )
        if one.state:
            etree.SubElement(_annotation(element), "State", source=state_file(one.state))

    def data_files(self, one: Experiment) -> Iterator[_Related]:
        """Yield parameters, stimuli and references of an experiment."""
        if one.parameters:
            what = f"parameters of {one.name}"
            content = self._parameters(one)
            yield _Related(f"{one.name}.ssv", "parameter", _PARAMETERS_TYPE, what, content)
        if one.inputs:
            what = f"stimuli of {one.name}"
            yield _Related(f"{one.name}_in.csv", "other", "text/csv", what, self._stimuli(one))
        what = f"expected results of {one.name}"
        content = self._table(one.times, one.references, "{:.12g}")
        yield _Related(f"{one.name}_ref.csv", "result", "text/csv", what, content)

    def _parameters(self, one: Experiment) -> bytes:
        version = "1.0" if self._fmi is Fmi.TWO else "2.0"
        root = etree.Element(
            f"{{{_SSV}}}ParameterSet", nsmap={"ssv": _SSV, "ssc": _SSC}, version=version
        )
        root.set("name", one.name)
        parent = etree.SubElement(root, f"{{{_SSV}}}Parameters")
        for name, value in one.parameters.items():
            self._parameter(parent, self._variables[name], value)
        return _text(root)

    def _parameter(self, parent: etree._Element, variable: Variable, value: Given) -> None:
        if isinstance(value, str | int | float):
            self._value(parent, variable.name, variable, value)
            return
        if self._fmi is Fmi.THREE:
            text = " ".join(literal(variable.kind, each) for each in value)
            element = self._value(parent, variable.name, variable, text)
            etree.SubElement(element, f"{{{_SSC}}}Dimension", size=str(len(value)))
            return
        for element_name, each in zip(variable.element_names(self._sizes), value, strict=True):
            self._value(parent, element_name, variable, each)

    def _value(
        self, parent: etree._Element, name: str, variable: Variable, value: float | str
    ) -> etree._Element:
        """Append a parameter; its value is a number, a word, or the text of an array."""
        element = etree.SubElement(parent, f"{{{_SSV}}}Parameter", name=name)
        text = value if isinstance(value, str) else literal(variable.kind, value)
        if variable.kind is Kind.ENUMERATION and not isinstance(value, str):
            text = variable.choices[int(value) - 1]
        etree.SubElement(element, f"{{{_SSV}}}{variable.kind.value}", value=text)
        return element

    # ------------------------------------------------------------------ tables

    def _stimuli(self, one: Experiment) -> bytes:
        """Return the table of the inputs, with a row for each communication point.

        Where all are constant there are two, at the begin and at the end.
        """
        times = rows(one.step, one.steps)
        if not any(_varies(stimulus) for stimulus in one.inputs.values()):
            times = times[[0, -1]]
        columns = {
            name: np.array([_at(stimulus, float(time)) for time in times])
            for name, stimulus in one.inputs.items()
        }
        return self._table(times, columns, "{!r}")

    def _table(
        self, times: NDArray[np.float64], columns: dict[str, NDArray[np.float64]], form: str
    ) -> bytes:
        """Return a table of numbers in the form of fmpy: an array of FMI 3.0 is one column."""
        names, texts = ["time"], [[repr(float(time)) for time in times]]
        for name, values in columns.items():
            table = values.reshape(len(times), -1)
            cells = [[form.format(float(cell)) for cell in row] for row in table]
            if self._fmi is Fmi.THREE:
                names.append(name)
                texts.append([" ".join(row) for row in cells])
            else:
                names += self._variables[name].element_names(self._sizes)
                texts += map(list, zip(*cells, strict=True))
        lines = [names, *zip(*texts, strict=True)]
        return "".join(",".join(line) + "\n" for line in lines).encode()


def _varies(stimulus: Stimulus) -> bool:
    return callable(stimulus) or (
        not isinstance(stimulus, int | float) and any(callable(each) for each in stimulus)
    )


def _at(stimulus: Stimulus, time: float) -> float | list[float]:
    """Return the value of an input at a time (s), of an array those of its elements."""
    if callable(stimulus):
        return float(stimulus(time))
    if isinstance(stimulus, int | float):
        return float(stimulus)
    return [float(each(time)) if callable(each) else float(each) for each in stimulus]
