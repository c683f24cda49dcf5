"""Scenarios as people write them: tables of inputs read, problems told by line and column."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ..core.system.signals import TIME
from ..core.system.system import SystemSpec
from .signals import read_signals

SCENARIO = "scenario"
"""Key of a system file."""


def read_inputs(file: Path) -> dict[str, list[float]]:
    """Read the table of inputs of a scenario.

    Parameters
    ----------
    file : Path
        A CSV file: ``time`` (s), then a column for each input ``component.input``, in its unit.

    Returns
    -------
    dict of str to list of float
        The columns by name, the times first.

    Raises
    ------
    InputRefused
        Everything that is wrong with the file, by line and column.
    """
    signals = read_signals(file)
    columns = {TIME: signals.time, **signals.columns}
    return {name: values.tolist() for name, values in columns.items()}


def with_inputs_read(system: SystemSpec, folder: Path) -> SystemSpec:
    """Return a system whose scenario has its table of inputs, and no longer the path of a file.

    A run keeps the table with its system: it can be verified and resumed when the file has changed.

    Parameters
    ----------
    system : SystemSpec
        Stays as it is.
    folder : Path
        From which a relative path counts.

    Returns
    -------
    SystemSpec

    Raises
    ------
    InputRefused
        The file is not in order.
    """
    scenario = system.scenario
    if not isinstance(scenario.inputs, str):
        return system
    read = scenario.model_copy(update={"inputs": read_inputs(folder / scenario.inputs)})
    return system.model_copy(update={SCENARIO: read})


def without_file(system: SystemSpec) -> SystemSpec:
    """Return a system whose scenario names no file, to see what else is wrong with it."""
    if not isinstance(system.scenario.inputs, str):
        return system
    scenario = system.scenario.model_copy(update={"inputs": None})
    return system.model_copy(update={SCENARIO: scenario})


def told(differing: Mapping[str, Any], system: SystemSpec) -> dict[str, Any]:
    """Return what differs in a system, its scenario in a few words."""
    words = {SCENARIO: str(system.scenario)} if SCENARIO in differing else {}
    return {**differing, **words}
