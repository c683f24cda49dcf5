"""Readers of components whose states or parameters need code of their own.

A component declares what its serialized state holds, ``granular.discs`` for instance. Who knows how
to draw and measure such contents is registered here under this name: the modules are imported when
they are first needed, and a component of one's own registers its own ones.
"""

from dataclasses import dataclass
from importlib import import_module
from types import ModuleType
from typing import Any

from rockshed.components.common.component import ComponentError

from ..core.results.reading import StoredRun


class ForeignStateError(ValueError):
    """A recorded state cannot be read: another version of the FMU has written it."""


@dataclass(frozen=True)
class Reader:
    """Modules that know the contents of a component.

    Attributes
    ----------
    measures : str
        Module with ``contact_frequency(parameters)``, ``doubts(parameters, structures)`` and
        ``description(parameters)``, and for reports, if it likes, ``assumptions(parameters)``.
    states : str
        Module with ``decoded(state)``, which gives the geometry in a serialized state.
    """

    measures: str
    states: str


_SAND = "rockshed.components.sand_cushion"
_READERS = {"granular.discs": Reader(f"{_SAND}.measures", f"{_SAND}.reader")}


def register(contents: str, reader: Reader) -> None:
    """Let components with these contents be drawn and measured.

    Parameters
    ----------
    contents : str
        Name that the components declare.
    reader : Reader
        Modules that know them.
    """
    _READERS[contents] = reader


def reader_of(run: StoredRun, component: str) -> Reader | None:
    """Return the reader of a component; None if nobody knows its contents.

    Parameters
    ----------
    run : StoredRun
        The run.
    component : str
        Name of the component in the system.
    """
    return _READERS.get(run.provenance["components"][component].get("contents", ""))


def measures(run: StoredRun, component: str) -> ModuleType | None:
    """Return the module that measures a component by its parameters; None if there is none.

    Parameters
    ----------
    run : StoredRun
        The run.
    component : str
        Name of the component in the system.
    """
    reader = reader_of(run, component)
    return None if reader is None else import_module(reader.measures)


def decoded(run: StoredRun, component: str, state: bytes) -> Any:
    """Return the geometry in a recorded state of a component that has a reader.

    Parameters
    ----------
    run : StoredRun
        The run.
    component : str
        Name of the component in the system.
    state : bytes
        A state from :meth:`~rockshed.core.results.reading.StoredRun.states`.

    Raises
    ------
    ForeignStateError
        Another version of the FMU has written the state.
    """
    reader = reader_of(run, component)
    assert reader is not None, f"{component} has no reader"
    try:
        return import_module(reader.states).decoded(state)
    except ComponentError as error:
        raise ForeignStateError(str(error)) from error
