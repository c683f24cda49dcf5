"""Inputs over time from a table, as a component whose outputs follow them."""

import struct
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path

import numpy as np

from ..core.errors import InputRefused, Problem, counted
from ..core.fmu.description import Port, UnitDefinition
from ..core.fmu.slave import OK, REAL, Addresses, ValueReferences, Values
from ..core.input_text import shown
from ..core.system.signals import TIME, Signals
from ..input_files.csv_table import CsvRow, CsvTable, read_csv

_TRUTH = {"true": 1.0, "false": 0.0}
_FORM = (
    "write `time` and names of inputs in the first line, without units, and below a number for "
    "each: s, and the unit of the input"
)


# ---------------------------------------------------------------- the file


def read_signals(file: Path) -> Signals:
    """Read a table of inputs from a CSV file.

    Parameters
    ----------
    file : Path
        The column ``time`` (s) comes first, then a column for each input, in its unit.

    Returns
    -------
    Signals
        At least one row.

    Raises
    ------
    InputRefused
        Everything that is wrong with the file, by line and column.
    """
    table = read_csv(file)
    if len(table.rows) < 2:
        raise InputRefused([Problem(str(file), "has no row of values", _FORM)])
    titles = [field.text for field in table.rows[0].fields]
    problems = _title_problems(table, titles)
    if problems:
        raise InputRefused(problems)
    rows = [_row(table, row, len(titles), problems) for row in table.rows[1:]]
    if not problems:
        problems += _time_problems(table, [row[0] for row in rows])
    if problems:
        raise InputRefused(problems)
    values = np.array(rows).T
    return Signals(values[0], dict(zip(titles[1:], values[1:], strict=True)))


def _title_problems(table: CsvTable, titles: Sequence[str]) -> list[Problem]:
    where = table.place(table.rows[0])
    problems = []
    if titles[0] != TIME:
        problems.append(Problem(where, f"the first column is {shown(titles[0])}, not time", _FORM))
    twice = sorted({title for title in titles if titles.count(title) > 1})
    problems += [Problem(where, f"{title} has two columns", "keep one of them") for title in twice]
    return problems


def _row(table: CsvTable, row: CsvRow, width: int, problems: list[Problem]) -> list[float]:
    """Return the numbers of a line; what is none becomes a problem."""
    if len(row.fields) != width:
        what = f"has {counted(len(row.fields), 'field')}, and the first line {width}"
        problems.append(Problem(table.place(row), what, _FORM))
        return [0.0] * width
    values = []
    for number, field in enumerate(row.fields):
        value = _TRUTH.get(field.text.lower(), table.number(field))
        if value is None:
            what = f"{shown(field.text)} is no finite number"
            problems.append(Problem(table.place(row, number), what, "write a number"))
        values.append(0.0 if value is None else value)
    return values


def _time_problems(table: CsvTable, times: Sequence[float]) -> list[Problem]:
    return [
        Problem(
            table.place(row, 0),
            f"the time {time:g} s comes after {before:g} s",
            "sort the rows by time",
        )
        for row, before, time in zip(table.rows[2:], times, times[1:], strict=False)
        if time < before
    ]


# ---------------------------------------------------------------- the component


class SignalSource:
    """Where an FMU file is expected: a component whose outputs follow a table.

    Parameters
    ----------
    signals : Signals
        The table.
    ports : sequence of Port
        Inputs that the outputs feed; names, kinds and units are theirs.
    held : collection of str
        Names of those whose values are held between two rows.
    origin : mapping of str to str
        For the record of a run.
    """

    def __init__(
        self,
        signals: Signals,
        ports: Sequence[Port],
        held: Collection[str],
        origin: Mapping[str, str],
    ) -> None:
        self.signals = signals
        self.ports = list(ports)
        self.held = frozenset(held)
        self.origin = dict(origin)

    def model_description(self) -> bytes:
        """Return a description of FMI 2.0 with an output for each input that is fed."""
        known = {port.unit.name: port.unit for port in self.ports if port.unit}
        units = "".join(map(_unit, known.values()))
        variables = "".join(self._variable(number) for number in range(len(self.ports)))
        unknowns = "".join(f'<Unknown index="{i}"/>' for i in range(1, len(self.ports) + 1))
        return f"""<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="Signals" guid="signals">
<CoSimulation modelIdentifier="Signals" canHandleVariableCommunicationStepSize="true"
 canGetAndSetFMUstate="true" canSerializeFMUstate="true"/>
{f"<UnitDefinitions>{units}</UnitDefinitions>" if units else ""}
<ModelVariables>{variables}</ModelVariables>
<ModelStructure><Outputs>{unknowns}</Outputs><InitialUnknowns>{unknowns}</InitialUnknowns>
</ModelStructure></fmiModelDescription>""".encode()

    def _variable(self, number: int) -> str:
        from xml.sax.saxutils import quoteattr  # late: it imports a client of the web

        port = self.ports[number]
        unit = f" unit={quoteattr(port.unit.name)}" if port.unit and port.kind == REAL else ""
        is_continuous = port.kind == REAL and port.name not in self.held
        return (
            f"<ScalarVariable name={quoteattr(port.name)} valueReference='{number}' "
            f"description={quoteattr(port.description)} causality='output' "
            f"variability='{'continuous' if is_continuous else 'discrete'}'>"
            f"<{port.kind}{unit}/></ScalarVariable>"
        )

    def instantiate(self, name: str) -> "SignalSlave":
        """Return an instance for a component of this name."""
        return SignalSlave(self, name)


def _unit(unit: UnitDefinition) -> str:
    """Return a unit in the words of FMI."""
    from xml.sax.saxutils import quoteattr

    if unit.base is None:
        return f"<Unit name={quoteattr(unit.name)}/>"
    powers = "".join(f' {base}="{power}"' for base, power in unit.base.items())
    scale = f' factor="{unit.factor!r}" offset="{unit.offset!r}"'
    return f"<Unit name={quoteattr(unit.name)}><BaseUnit{powers}{scale}/></Unit>"


class SignalSlave:
    """An instance whose outputs are the values of a table at its time.

    Parameters
    ----------
    source : SignalSource
        The table.
    name : str
        Of the component.

    Attributes
    ----------
    time : float
        Time reached (s).
    """

    addresses: Addresses | None = None
    """There are no C functions to call."""

    def __init__(self, source: SignalSource, name: str) -> None:
        self.name = name
        self.messages: list[tuple[int, str]] = []
        self.time = 0.0
        self._source = source

    def set(self, references: ValueReferences, values: Values, kind: str = REAL) -> int:
        """Return OK: there is nothing to set."""
        return OK

    def get(self, references: ValueReferences, out: Values, kind: str = REAL) -> int:
        """Write the values at the present time into ``out``."""
        ports = self._source.ports
        for place, reference in enumerate(references):
            name = ports[reference].name
            out[place] = self._source.signals.at(self.time, name, name in self._source.held)
        return OK

    def set_text(self, reference: int, text: str) -> int:
        """Return OK: there is no text."""
        return OK

    def setup_experiment(self, start: float, stop: float, tolerance: float | None = None) -> int:
        """Take the time (s) of the start."""
        self.time = start
        return OK

    def enter_initialisation(self) -> int:
        """Return OK: the values follow from the time."""
        return OK

    def exit_initialisation(self) -> int:
        """Return OK: the values follow from the time."""
        return OK

    def step(self, time: float, step: float) -> int:
        """Go to the end of a step (s)."""
        self.time = time + step
        return OK

    def terminated_at(self) -> float | None:
        """Return None: it never wants to end."""
        return None

    def state(self) -> bytes:
        """Return the time as bytes."""
        return struct.pack("<d", self.time)

    def restore(self, content: bytes) -> None:
        """Take over the time of :meth:`state`.

        Raises
        ------
        RuntimeError
            These are no bytes of it.
        """
        try:
            (self.time,) = struct.unpack("<d", content)
        except struct.error as error:
            raise RuntimeError(f"{self.name}: no state of a table of inputs: {error}") from error

    def reset(self) -> int:
        """Go back to the time zero."""
        self.time = 0.0
        return OK

    def terminate(self) -> int:
        """Return OK: there is nothing to end."""
        return OK

    def free(self) -> None:
        """Hold nothing that is given back."""
