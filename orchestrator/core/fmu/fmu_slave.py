"""FMU files behind the interface of :mod:`rockshed.core.fmu.slave`.

It imports fmpy, as do the modules beside it for FMI 3.0 and for messages.
"""

import contextlib
import ctypes
import hashlib
import io
import itertools
import math
import os
import sys
import weakref
import zipfile
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any
from urllib.parse import unquote
from xml.etree import ElementTree

import numpy as np
import pythonfmu  # noqa: F401 (FMUs bring parts of it; the first import serves the whole process)
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import (
    FMU2Slave,
    calloc,
    fmi2CallbackAllocateMemoryTYPE,
    fmi2CallbackFreeMemoryTYPE,
    fmi2CallbackFunctions,
    fmi2CallbackLoggerTYPE,
    fmi2CoSimulation,
    fmi2FMUstate,
    free,
)
from fmpy.model_description import (
    ModelDescription,
    ModelVariable,
    ValidationError,
    read_model_description,
)

from ...platforms import NoBinaryError, binary, platforms_in
from ...temporary import TemporaryFolder
from ..errors import InputRefused, Problem
from .annotations import NOTHING, Annotation, read_annotations
from .archive import MOST_DESCRIPTION, Archive, ArchiveError
from .description import Dependencies, Description, Port, UnitDefinition
from .fmi3_slave import Fmi3Slave
from .logger import set_logger
from .slave import (
    ERROR,
    FATAL,
    INTEGER,
    OK,
    REAL,
    Addresses,
    Messages,
    Slave,
    ValueReferences,
    Values,
    status_name,
)
from .types import BOOLEAN_3, TYPES, TYPES_2

_DESCRIPTION_FILE = "modelDescription.xml"
TERMINALS_FILE = "terminalsAndIcons/terminalsAndIcons.xml"
"""File in an FMU of FMI 3.0 that describes its terminals."""
DRIVEN = ("2.0", "3.0")
"""Versions of FMI that this program drives."""
UNREADABLE_XML = (ElementTree.ParseError, LookupError, ValueError)
"""Errors of the reader of XML: no XML, an encoding that nobody knows, bytes that it has not."""
_LAST_SUCCESSFUL_TIME, _TERMINATED = 2, 3
"""Kinds of status that FMI asks for (fmi2StatusKind)."""
_MOST_ELEMENTS = 1_000_000
"""Most elements of an array."""
_BASE_UNITS = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")


class UnusableError(ValueError):
    """An FMU that cannot be used.

    Attributes
    ----------
    remedy : str
        Something to do about it.
    """

    def __init__(self, what: str, remedy: str) -> None:
        self.remedy = remedy
        super().__init__(what)


class FmuFile:
    """An FMU file, from which instances are made.

    Parameters
    ----------
    path : Path
        Of the file.
    to_run : bool
        Whether it is to run on this machine: then one that cannot is refused.

    Attributes
    ----------
    origin : dict of str to str
        Path, and hash of the content once it has been read.
    library : str
        Path of this machine's library inside it, once the description has been read.
    cannot_run : Problem, optional
        The reason why it cannot run on this machine, once the description has been read.
    """

    def __init__(self, path: Path, to_run: bool = True) -> None:
        self.path = path
        self.origin = {"fmu": str(path)}
        self.library = ""
        self.cannot_run: Problem | None = None
        self._to_run = to_run

    def model_description(self) -> bytes:
        """Read the modelDescription.xml, and see whether this machine can run the FMU.

        Raises
        ------
        InputRefused
            No such file, not an FMU, or no binary for this machine where it is to run.
        """
        if os.path.isdir(self.path):  # Path.is_dir raises where a name is too long
            raise self._refusal(
                "is a folder, and no FMU", "name the FMU, or pack the folder as zip"
            )
        if not os.path.isfile(self.path):
            raise self._refusal("there is no such file", "build the FMU or correct the path")
        content = self.path.read_bytes()
        self.origin["sha256"] = hashlib.sha256(content).hexdigest()
        with self._archive(content) as archive:
            archive.check_size()
            xml = archive.read(_DESCRIPTION_FILE, MOST_DESCRIPTION)
            if xml is None:
                raise self._refusal(
                    f"is not an FMU: there is no {_DESCRIPTION_FILE} in it", "export it again"
                )
            with contextlib.suppress(UnusableError):  # then that is the reason
                self._find_library(_checked_root(xml), archive)
        if self._to_run:
            self.refuse_to_run()
        return xml

    def refuse_to_run(self) -> None:
        """Refuse an FMU that cannot run on this machine.

        Raises
        ------
        InputRefused
            It has no binary for it.
        """
        if self.cannot_run is not None:
            raise InputRefused([self.cannot_run])

    @contextlib.contextmanager
    def _archive(self, content: bytes | None = None) -> Iterator[Archive]:
        """Open the archive; what is wrong with it becomes a refusal."""
        try:
            with Archive(self.path if content is None else io.BytesIO(content)) as archive:
                yield archive
        except ArchiveError as error:
            raise self._refusal(str(error), error.remedy) from error

    def content(self, name: str) -> bytes | None:
        """Read a file in the FMU; return None if it is not in it."""
        with self._archive() as archive:
            return archive.read(name, MOST_DESCRIPTION)

    def platforms(self) -> list[str]:
        """Return the folders of the FMU with libraries, by the names of their platforms."""
        with self._archive() as archive:
            return platforms_in(archive.names)

    def unpack(self, folder: Path, under: str = "") -> None:
        """Unpack everything into a folder, or what lies in one of its own folders.

        Raises
        ------
        InputRefused
            The archive is damaged or too large, or is another one than that whose description was
            read.
        """
        content = self.path.read_bytes()
        found = hashlib.sha256(content).hexdigest()
        if found != self.origin.get("sha256", found):
            raise self._refusal("has changed while it was loaded", "run again")
        with self._archive(content) as archive:
            archive.unpack(folder, under)

    def _find_library(self, root: ElementTree.Element, archive: Archive) -> None:
        """Look for this machine's library inside the FMU."""
        kind = root.find("CoSimulation")
        identifier = "" if kind is None else kind.get("modelIdentifier", "")
        fmi = int(root.get("fmiVersion", "2")[0])
        try:
            self.library = binary(identifier, fmi, archive.names, archive.head)
        except NoBinaryError as error:
            self.cannot_run = Problem(str(self.path), str(error), error.remedy)

    def _refusal(self, what: str, remedy: str) -> InputRefused:
        return InputRefused([Problem(str(self.path), what, remedy)])

    def instantiate(self, name: str) -> Slave:
        """Unpack the file into a temporary folder, load its library and make an instance.

        Parameters
        ----------
        name : str
            Of the component.

        Raises
        ------
        InputRefused
            The library cannot be loaded, or it makes no instance.
        """
        description = read_description(self.model_description())
        self.refuse_to_run()
        if description.is_fmi_3:
            return Fmi3Slave(self, name, description)
        return FmuSlave(self, name, description)


@lru_cache(maxsize=32)
def read_description(xml: bytes, sizes: tuple[tuple[str, int], ...] = ()) -> Description:
    """Read a model description of FMI 2.0 or 3.0.

    An array of FMI 3.0 is described by its elements, ``name[1]``, ``name[2]``, ...

    Parameters
    ----------
    xml : bytes
        Content of ``modelDescription.xml``.
    sizes : tuple of (str, int)
        Names and values of structural parameters that differ from their start values.

    Returns
    -------
    Description

    Raises
    ------
    UnusableError
        It is for another version of FMI or no co-simulation, or cannot be understood.
    """
    root = _checked_root(xml)
    archive = io.BytesIO()
    with zipfile.ZipFile(archive, "w") as file:
        file.writestr(_DESCRIPTION_FILE, xml)
    warnings: tuple[str, ...] = ()
    try:
        model = read_model_description(archive)
    except ValidationError as error:
        warnings = tuple(error.problems)
        model = _read_leniently(archive, error)
    except Exception as error:  # whatever a broken file does to the reader
        what = f"its {_DESCRIPTION_FILE} cannot be read: {error}"
        raise UnusableError(what, "export it again") from error
    _check_references(model)
    try:
        return _described(model, root, warnings, dict(sizes))
    except UnusableError:
        raise
    except (ValueError, TypeError, AttributeError, OverflowError) as error:
        what = f"its {_DESCRIPTION_FILE} is not valid: {error}"
        raise UnusableError(what, "export it again") from error


def _described(
    model: ModelDescription,
    root: ElementTree.Element,
    warnings: tuple[str, ...],
    sizes: Mapping[str, int],
) -> Description:
    units = {unit.name: _unit(unit) for unit in model.unitDefinitions}
    interface = model.coSimulation
    told = read_annotations(root)
    ports = _Ports(root, units, sizes)
    return Description(
        model.modelName,
        model.guid,
        interface.modelIdentifier,
        model.generationTool or "",
        interface.canBeInstantiatedOnlyOncePerProcess,
        interface.canGetAndSetFMUstate and interface.canSerializeFMUstate,
        {
            port.name: port
            for v in model.modelVariables
            for port in ports.of(v, told.variables.get(v.name, NOTHING))
        },
        warnings,
        told.contents,
        told.pictures,
        told.bonds,
        _tolerance(model.defaultExperiment),
        model.fmiVersion,
        interface.mightReturnEarlyFromDoStep,
        bool(interface.canGetAndSetFMUstate),
        bool(interface.canHandleVariableCommunicationStepSize),
        _dependencies(model.outputs),
        _dependencies(model.initialUnknowns),
    )


def _dependencies(unknowns: Iterable[Any]) -> Dependencies:
    """Return what variables depend on, of those of which that is told."""
    return {
        unknown.variable.name: tuple(variable.name for variable in unknown.dependencies)
        for unknown in unknowns
        if unknown.dependencies is not None
    }


def _tolerance(experiment: Any) -> float | None:
    """Return the tolerance of a DefaultExperiment; None where there is no positive one."""
    try:
        value = float(getattr(experiment, "tolerance", None) or 0.0)
    except ValueError:
        return None
    return value if 0.0 < value < 1.0 else None


def _checked_root(xml: bytes) -> ElementTree.Element:
    """Return the root of a description, after a look at its version and kind."""
    try:
        root = ElementTree.fromstring(xml)
    except UNREADABLE_XML as error:
        what = f"its {_DESCRIPTION_FILE} cannot be read: {error}"
        raise UnusableError(what, "export it again") from error
    if root.tag != "fmiModelDescription":
        what = f"its {_DESCRIPTION_FILE} describes no FMU: it begins with <{root.tag}>"
        raise UnusableError(what, "export it again")
    version = root.get("fmiVersion") or "without a version"
    if version.startswith(DRIVEN) and root.find("CoSimulation") is None:
        kinds = [text for tag, text in _OTHER_KINDS.items() if root.find(tag) is not None]
        what = f"is for {' and '.join(kinds) or 'nothing'} only; co-simulation is needed"
        raise UnusableError(what, "export it for co-simulation")
    if not version.startswith(DRIVEN):
        what = f"is FMI {version}; this program drives FMI {' and '.join(DRIVEN)}"
        raise UnusableError(what, "use an FMU of it for one of them")
    return root


_OTHER_KINDS = {"ModelExchange": "model exchange", "ScheduledExecution": "scheduled execution"}


def _read_leniently(archive: io.BytesIO, cause: Exception) -> ModelDescription:
    try:
        return read_model_description(archive, validate=False)
    except Exception as error:  # whatever a broken file does to the reader
        what = f"its {_DESCRIPTION_FILE} is not valid: {cause}"
        raise UnusableError(what, "export it again") from error


def _check_references(model: ModelDescription) -> None:
    """Refuse value references that 32 bits cannot hold."""
    for variable in model.modelVariables:
        if not 0 <= int(variable.valueReference) < 1 << 32:
            what = (
                f"its {_DESCRIPTION_FILE} is not valid: the valueReference "
                f"{variable.valueReference} of {variable.name} is no whole number below 2^32"
            )
            raise UnusableError(what, "export it again")


def _unit(unit: Any) -> UnitDefinition:
    if unit.baseUnit is None:
        return UnitDefinition(unit.name)
    exponents = {symbol: int(getattr(unit.baseUnit, symbol)) for symbol in _BASE_UNITS}
    return UnitDefinition(
        unit.name,
        {symbol: n for symbol, n in exponents.items() if n},
        unit.baseUnit.factor,
        unit.baseUnit.offset,
    )


_CALLED_2 = {"Enumeration": INTEGER}
_CALLED_3 = {"Enumeration": "Int64", "Boolean": BOOLEAN_3}
"""Types of FMI calls that move a variable of another type."""


class _Ports:
    """Makes ports of variables.

    Parameters
    ----------
    root : Element
        Of the model description.
    units : dict of str to UnitDefinition
        By name.
    sizes : mapping of str to int
        Values of structural parameters that differ from their start values.
    """

    def __init__(
        self,
        root: ElementTree.Element,
        units: dict[str, UnitDefinition],
        sizes: Mapping[str, int],
    ) -> None:
        is_fmi_3 = (root.get("fmiVersion") or "").startswith("3")
        listed = root.find("ModelVariables") if is_fmi_3 else None
        self._called = _CALLED_3 if is_fmi_3 else _CALLED_2
        self._elements = {entry.get("name"): entry for entry in ([] if listed is None else listed)}
        self._units = units
        self._sizes = sizes

    def of(self, variable: ModelVariable, annotation: Annotation) -> Iterator[Port]:
        """Yield one port, or as many as an array has elements."""
        port = replace(self._port(variable), annotation=annotation)
        if not variable.dimensions:
            yield port
            return
        lengths = tuple(map(self._length, variable.dimensions))
        if math.prod(lengths) > _MOST_ELEMENTS:
            what = f"its {variable.name} has more than {_MOST_ELEMENTS:,} elements"
            raise UnusableError(what, "export it with smaller arrays")
        places = itertools.product(*(range(1, length + 1) for length in lengths))
        starts = self._starts(variable, math.prod(lengths))
        for element, (place, start) in enumerate(zip(places, starts)):
            name = f"{port.name}[{','.join(map(str, place))}]"
            yield replace(port, name=name, start=start, shape=lengths, element=element)

    def _length(self, dimension: Any) -> int:
        if dimension.start is not None:
            return int(dimension.start)
        size = dimension.variable
        return self._sizes.get(size.name, int(size.start))

    def _starts(self, variable: ModelVariable, count: int) -> list[str | None]:
        """Return the start values of all elements.

        They are unknown where there is another number of them: a size differs from its own start.
        """
        entry = self._elements[variable.name]
        listed = [start.get("value", "") for start in entry.findall("Start")]
        starts: list[str | None] = [*(listed or (variable.start or "").split())]
        if len(starts) == 1:
            return starts * count
        return starts if len(starts) == count else [None] * count

    def _port(self, variable: ModelVariable) -> Port:
        def attribute(name: str) -> Any:
            own = getattr(variable, name, None)
            if own is not None or variable.declaredType is None:
                return own
            return getattr(variable.declaredType, name)

        def bound(name: str) -> float | None:
            own = attribute(name)
            if own is None and variable.name in self._elements:  # the reader forgets unsigned ones
                own = self._elements[variable.name].get(name)
            return None if own is None else float(own)

        unit = attribute("unit")
        items = variable.declaredType.items if variable.declaredType is not None else []
        called = self._called.get(variable.type, variable.type)
        return Port(
            variable.name,
            variable.valueReference,
            TYPES[called].kind if called in TYPES else called,
            variable.causality,
            called,
            unit=None if unit is None else self._units.get(unit, UnitDefinition(unit)),
            minimum=bound("min"),
            maximum=bound("max"),
            items={item.name: int(item.value) for item in items},
            start=variable.start,
            description=variable.description or "",
            has_own_start=_has_own_start(variable),
            is_constant=variable.variability == "constant",
            is_tunable=variable.variability == "tunable",
            is_discrete=variable.variability == "discrete",
            is_alias=variable.alias is not None,
        )


def _has_own_start(variable: ModelVariable) -> bool:
    """Tell whether an output or a local variable takes a start value."""
    return (
        variable.causality in ("output", "local")
        and variable.initial in ("exact", "approx")
        and variable.variability != "constant"
    )


_slaves: "weakref.WeakValueDictionary[int, FmuSlave]" = weakref.WeakValueDictionary()
_keys = itertools.count(1)


def _log(environment: int, _instance: bytes, status: int, _category: bytes, message: bytes) -> None:
    """Pass a message of an FMU to the slave it belongs to."""
    slave = _slaves.get(environment)
    if slave is not None:
        slave.messages.append((status, (message or b"").decode("utf-8", "replace")))


_LOGGER = fmi2CallbackLoggerTYPE(_log)


def _made_by_pythonfmu(generation_tool: str) -> bool:
    return "PythonFMU" in generation_tool


def _callbacks(environment: int, generation_tool: str) -> fmi2CallbackFunctions:
    """Return the callbacks of one instance.

    pythonfmu logs plain text where FMI asks for a format: a percent sign in it must not be read.
    """
    callbacks = fmi2CallbackFunctions()
    callbacks.allocateMemory = fmi2CallbackAllocateMemoryTYPE(calloc)
    callbacks.freeMemory = fmi2CallbackFreeMemoryTYPE(free)
    callbacks.componentEnvironment = environment
    if _made_by_pythonfmu(generation_tool):
        callbacks.logger = _LOGGER
    else:
        set_logger(callbacks, _LOGGER)
    return callbacks


def _release_python(library: ctypes.CDLL) -> None:
    """Let go what pythonfmu's binary would let go a second time when the process ends.

    That may abort the process. Runs when a slave is freed, or else when Python ends, which is
    before the library's own end.
    """
    release = getattr(library, "finalizePythonInterpreter", None)
    if release is not None:
        release.restype = None
        release()


_MOVE = ctypes.CFUNCTYPE(
    ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t, ctypes.c_void_p
)
_STEP = ctypes.CFUNCTYPE(
    ctypes.c_int, ctypes.c_void_p, ctypes.c_double, ctypes.c_double, ctypes.c_int
)


class FmuSlave:
    """An instance of an FMU of FMI 2.0. See :class:`rockshed.core.fmu.slave.Slave`.

    Attributes
    ----------
    forgets : bool
        Whether it may forget states before a step: it will not go back to them.
    """

    forgets = True

    def __init__(self, file: FmuFile, name: str, description: Description) -> None:
        self.name = name
        self.messages: list[tuple[int, str]] = Messages()
        self._folder = TemporaryFolder()
        self._fmu: Any = None
        self._by_pythonfmu = _made_by_pythonfmu(description.generation_tool)
        self._mark = fmi2FMUstate()
        key = next(_keys)
        _slaves[key] = self
        try:
            file.unpack(Path(self._folder.name))
            # fmpy goes elsewhere, and stays there if the library cannot be loaded
            with contextlib.chdir(os.getcwd()):
                self._fmu = FMU2Slave(
                    name,
                    guid=description.guid,
                    modelIdentifier=description.identifier,
                    unzipDirectory=self._folder.name,
                    libraryPath=os.path.join(self._folder.name, *file.library.split("/")),
                )
            self._release = weakref.finalize(self, _release_python, self._fmu.dll)
            self._instantiate(_callbacks(key, description.generation_tool))
        except Exception as error:  # fmpy raises bare exceptions, and the loader many kinds
            self._unload()
            said = "; ".join(text for _, text in self.messages)
            raise InputRefused(
                [
                    Problem(
                        name,
                        f"no instance of {file.path} can be made: {error} {said}".rstrip(),
                        "see whether the FMU runs in another tool",
                    )
                ]
            ) from error
        self.addresses: Addresses | None = self._find_addresses()
        self._step = _STEP(self.addresses.do_step)
        self._setters = {kind: _MOVE(address) for kind, address in self.addresses.set.items()}
        self._getters = {kind: _MOVE(address) for kind, address in self.addresses.get.items()}

    def _instantiate(self, callbacks: fmi2CallbackFunctions) -> None:
        """Make the instance, as fmpy does but for the location of the resources.

        Of all that is escaped in the URI of a path, pythonfmu's binary knows spaces only, and ends
        the process where it does not find its files.
        """
        location = Path(self._folder.name, "resources").absolute().as_uri()
        if self._by_pythonfmu:
            location = unquote(location)
            if "%20" in location:  # the binary would read a space
                raise ValueError(
                    f"the temporary folder {self._folder.name} has %20 in its name: set TMPDIR to "
                    "another one"
                )
        self._fmu.callbacks = callbacks
        self._fmu.component = self._fmu.fmi2Instantiate(
            self.name.encode(),
            fmi2CoSimulation,
            self._fmu.guid.encode(),
            location.encode(),
            ctypes.byref(callbacks),
            0,
            1,
        )
        if self._fmu.component is None:
            raise ValueError("fmi2Instantiate returned no instance")

    def _find_addresses(self) -> Addresses:
        def address(function: str) -> int:
            return int(ctypes.cast(getattr(self._fmu.dll, function), ctypes.c_void_p).value or 0)

        return Addresses(
            int(self._fmu.component),
            {kind: address(f"fmi2Set{kind}") for kind in TYPES_2},
            {kind: address(f"fmi2Get{kind}") for kind in TYPES_2},
            address("fmi2DoStep"),
        )

    def set(self, references: ValueReferences, values: Values, kind: str = REAL) -> int:
        """Set variables of one kind."""
        if kind != REAL:
            values = values.astype(np.int32)
        return int(
            self._setters[kind](
                self._fmu.component, references.ctypes.data, references.size, values.ctypes.data
            )
        )

    def get(self, references: ValueReferences, out: Values, kind: str = REAL) -> int:
        """Read variables of one kind into ``out``."""
        if kind == REAL:
            return int(
                self._getters[kind](
                    self._fmu.component, references.ctypes.data, references.size, out.ctypes.data
                )
            )
        whole = np.zeros(references.size, np.int32)
        status = int(
            self._getters[kind](
                self._fmu.component, references.ctypes.data, references.size, whole.ctypes.data
            )
        )
        out[:] = whole
        return status

    def set_text(self, reference: int, text: str) -> int:
        """Set one variable of the kind String."""
        return self._status(self._fmu.setString, [reference], [text])

    def set_texts(self, reference: int, texts: list[str]) -> int:
        """Set one variable of the kind String."""
        return self._status(self._fmu.setString, [reference], texts)

    def get_texts(self, reference: int, count: int) -> tuple[int, list[str]]:
        """Return status and text of one variable of the kind String."""
        values = (ctypes.c_char_p * count)()
        passed = ((ctypes.c_uint * 1)(reference), 1, values)
        status = self._status(self._fmu.fmi2GetString, self._fmu.component, *passed)
        return status, [(value or b"").decode("utf-8", "replace") for value in values]

    def setup_experiment(self, start: float, stop: float, tolerance: float | None = None) -> int:
        """Tell start and end of the run (s), and the relative tolerance of the FMU's solver."""
        return self._status(self._fmu.setupExperiment, tolerance, start, stop)

    def enter_initialisation(self) -> int:
        """Enter the initialisation mode of the FMU."""
        return self._status(self._fmu.enterInitializationMode)

    def exit_initialisation(self) -> int:
        """Leave the initialisation mode of the FMU."""
        return self._status(self._fmu.exitInitializationMode)

    def step(self, time: float, step: float) -> int:
        """Make a step (s) from a time (s)."""
        return int(self._step(self._fmu.component, time, step, self.forgets))

    def terminated_at(self) -> float | None:
        """Return the time (s) up to which the last step went, if the FMU wants to end there.

        pythonfmu's binary says so of every step that has failed.
        """
        if self._by_pythonfmu:
            return None
        try:
            if not self._fmu.getBooleanStatus(_TERMINATED):
                return None
            return float(self._fmu.getRealStatus(_LAST_SUCCESSFUL_TIME))
        except FMICallException:
            return None

    def state(self) -> bytes:
        """Serialize the complete state.

        Raises
        ------
        RuntimeError
            A call failed.
        """
        with self._refusals_raised("the state cannot be read"):
            state = self._fmu.getFMUState()
            try:
                return bytes(self._fmu.serializeFMUState(state))
            finally:
                self._fmu.freeFMUState(state)

    def restore(self, content: bytes) -> None:
        """Take over a state of :meth:`state`.

        Parameters
        ----------
        content : bytes
            State of this FMU.

        Raises
        ------
        RuntimeError
            A call failed, or the slave says that this is no state of its own.
        """
        with self._refusals_raised("the state cannot be restored"):
            state = self._fmu.deserializeFMUState(content)
            try:
                self._fmu.setFMUState(state)
            finally:
                self._fmu.freeFMUState(state)

    def mark(self) -> None:
        """Keep the present state in memory.

        Raises
        ------
        RuntimeError
            A call failed.
        """
        with self._refusals_raised("the state cannot be kept"):
            self._forget_mark()
            self._fmu.fmi2GetFMUstate(self._fmu.component, ctypes.byref(self._mark))

    def roll_back(self) -> None:
        """Go back to the state that was kept.

        Raises
        ------
        RuntimeError
            A call failed.
        """
        with self._refusals_raised("the state that was kept is refused"):
            self._fmu.fmi2SetFMUstate(self._fmu.component, self._mark)

    def _forget_mark(self) -> None:
        if self._mark:
            self._fmu.fmi2FreeFMUstate(self._fmu.component, ctypes.byref(self._mark))
            self._mark = fmi2FMUstate()

    @contextlib.contextmanager
    def _refusals_raised(self, what: str) -> Iterator[None]:
        """Raise a RuntimeError for a bad status, or for an error that is logged.

        pythonfmu's binary returns OK for both.
        """
        earlier = self.messages
        self.messages = Messages()
        reasons: list[str] = []
        try:
            yield
        except FMICallException as error:
            reasons.append(str(error))
        finally:
            reasons += [text for status, text in self.messages if status >= ERROR]
            for message in self.messages:
                earlier.append(message)
            self.messages = earlier
        if reasons:
            raise RuntimeError(f"{self.name}: {what}: {'; '.join(reasons)}")

    def reset(self) -> int:
        """Go back to the state after the instantiation."""
        return self._status(self._fmu.reset)

    def terminate(self) -> int:
        """End the run of this instance."""
        return self._status(self._fmu.terminate)

    def free(self) -> None:
        """Free the instance, unload the library and remove the unpacked files.

        An instance that failed beyond repair is not called any more.
        """
        if all(status != FATAL for status, _ in self.messages):
            with contextlib.suppress(FMICallException):
                self._forget_mark()
            self._fmu.fmi2FreeInstance(self._fmu.component)
        self._unload()

    def _unload(self) -> None:
        if self._fmu is not None:
            self._release()
            self._fmu.freeLibrary()
        self._folder.cleanup()
        # where an FMU's Python code was
        sys.path[:] = [path for path in sys.path if not path.startswith(self._folder.name)]

    def _status(self, call: Callable[..., Any], *arguments: Any) -> int:
        """Return the status of a call of fmpy, which raises an exception for a bad one.

        The exception becomes a message where the FMU is silent.
        """
        count = len(self.messages)
        try:
            return int(call(*arguments) or OK)
        except FMICallException as error:
            if len(self.messages) == count:
                self.messages.append(
                    (error.status, f"{error.function} returned {status_name(error.status)}")
                )
            return int(error.status)
