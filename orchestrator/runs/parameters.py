"""Values that a system can be given, by name: their units, and how they are read."""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from rockshed.components.common.units import UNITS

from ..core.errors import InputRefused, Problem
from ..core.fmu.description import Description, Port
from ..core.fmu.fmu_slave import FmuFile, UnusableError, read_description
from ..core.fmu.slave import STRING
from ..core.loop.changes import settable_end
from ..core.system.fields import Value
from ..core.system.names import nearest, split_name
from ..core.system.plan import End, Plan
from ..core.system.quantities import finite_number, in_si
from ..core.system.values import value_for
from ..input_files.fields import ANY, fields, unit_of
from ..sites.shed.preparation import all_fields, is_field
from ..sites.shed.site import ShedProject
from .job import Job
from .values_in_si import value_of_port

PROJECT_SEED = "numerics.seed"
"""Field of a project that numbers the packing of its sand."""
_SEED = "seed"
"""Name of the parameter that numbers the packing of a component."""


@dataclass(frozen=True)
class SystemValues:
    """Names and units of the values of a prepared system.

    Attributes
    ----------
    job : Job
        The system.
    """

    job: Job

    @property
    def is_project(self) -> bool:
        """Whether the system is made of a project."""
        request = self.job.facts.get("request", {})
        return "project_file" in self.job.facts or request.get("project") is not None

    @cached_property
    def _descriptions(self) -> dict[str, Description]:
        """Descriptions of the components whose FMUs can be read; others are refused elsewhere."""
        found = {}
        for name, spec in self.job.system.components.items():
            try:
                found[name] = read_description(
                    FmuFile(Path(spec.fmu), to_run=False).model_description()
                )
            except (InputRefused, UnusableError):
                continue
        return found

    def known(self) -> list[str]:
        """Return the names of all values."""
        system = self.job.system
        ports = [
            f"{name}.{port.name}"
            for name, description in self._descriptions.items()
            for port in description.named("parameter")
        ]
        return [*(all_fields() if self.is_project else ()), *system.shared, *ports]

    def refusal(self, name: str) -> Problem | None:
        """Return why a value cannot be given; None where it can.

        Parameters
        ----------
        name : str
            Of the value.
        """
        if self.unit(name) is not None:
            return None
        return Problem(name, "is no value of this system", nearest(name, self.known()))

    def fault(self, name: str, value: Value) -> str:
        """Return nothing: what fits is for the project and the FMUs to say, with all values."""
        return ""

    def unit(self, name: str) -> str | None:
        """Return the SI unit of a value, ``1`` where it has none; None if there is none.

        Parameters
        ----------
        name : str
            Field of a project, ``component.parameter`` or the name of a shared value.
        """
        if self.is_project and is_field(name):
            parts = name.split(".")
            plain = ".".join([parts[0], ANY, *parts[2:]]) if parts[0] == "material" else name
            return unit_of(dict(fields(ShedProject))[plain]) or "1"
        port = self._port(name)
        return None if port is None else port.unit_name

    def _port(self, name: str) -> Port | None:
        shared = self.job.system.shared.get(name)
        target = shared.targets[0] if shared else name
        owner, parameter = split_name(target, self._descriptions)
        description = self._descriptions.get(owner)
        if description is None:
            return None
        return description.ports.get(parameter.replace("[*]", "[1]"))

    def read(self, name: str, value: Value) -> Value:
        """Return a value in SI; a word stays as it is.

        Parameters
        ----------
        name : str
            Of the value.
        value : Value
            A number, or a text with a unit, or a word.

        Raises
        ------
        ValueError
            Its unit is of another kind, or does not exist.
        """
        if not isinstance(value, str):
            return value
        text = value.strip()
        if not text[:1].isdigit() and text[:1] not in ("+", "-", "."):
            return text
        unit = self.unit(name)
        if unit in UNITS and unit != "1":
            return in_si(text, unit)
        number = finite_number(text)
        if number is None:
            named = "a number" if unit in (None, "1") else f"a number in {unit}"
            raise ValueError(f"must be {named} (given: {text})")
        return int(number) if text.lstrip("+-").isdigit() else number

    @property
    def seed(self) -> str | None:
        """Name of the value that numbers the packing; None where there is none."""
        if self.is_project:
            return PROJECT_SEED
        return self._own_seed

    @property
    def _own_seed(self) -> str | None:
        owners = [n for n, known in self._descriptions.items() if _SEED in known.ports]
        return f"{owners[0]}.{_SEED}" if owners else None

    @property
    def first_seed(self) -> int:
        """Number of the packing of the system as it is."""
        name = self._own_seed
        port = self._port(name) if name else None
        if name is None or port is None:
            return 0
        owner, _ = split_name(name, self._descriptions)
        given = self.job.system.components[owner].parameters.get(_SEED)
        return int(float(port.start or 0) if given is None else float(given))


@dataclass(frozen=True)
class BranchValues:
    """Names and units of the values that a run can be given on its way.

    Attributes
    ----------
    plan : Plan
        Of the run.
    """

    plan: Plan
    seed: str | None = None
    first_seed: int = 0

    def refusal(self, name: str) -> Problem | None:
        """Return why a value cannot be given between two steps; None where it can.

        Parameters
        ----------
        name : str
            ``component.variable``.
        """
        problems: list[Problem] = []
        settable_end(self.plan, name, problems)
        return problems[0] if problems else None

    def _end(self, name: str) -> End | None:
        return settable_end(self.plan, name, [])

    def unit(self, name: str) -> str | None:
        """Return the unit of a variable, ``1`` where it has none; None if it cannot be given.

        Parameters
        ----------
        name : str
            ``component.variable``.
        """
        end = self._end(name)
        return None if end is None else end.port.unit_name

    def read(self, name: str, value: Value) -> Value:
        """Return a value in the unit of its variable; a word stays as it is.

        Parameters
        ----------
        name : str
            Of the value.
        value : Value
            A number, or a text with a unit, or a word.

        Raises
        ------
        ValueError
            Its unit is of another kind, or does not exist.
        """
        end = self._end(name)
        if end is None or end.port.kind == STRING:
            return value
        found = value_of_port(end.port, value)
        number = finite_number(found) if isinstance(found, str) else None
        if number is None:
            return found
        return int(number) if str(found).strip().lstrip("+-").isdigit() else number

    def fault(self, name: str, value: Value) -> str:
        """Return why a variable does not take a value; empty where it does.

        Parameters
        ----------
        name : str
            Of the variable.
        value : Value
            As :meth:`read` returns it.
        """
        end = self._end(name)
        try:
            if end is not None:
                value_for(end.port, value)
        except ValueError as error:
            return str(error)
        return ""
