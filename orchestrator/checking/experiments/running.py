"""Experiments carried out on the FMU under check, and their results compared."""

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..subject.calls import Called, CallRefused, NoInstance
from ..subject.subject import Subject
from .manifest import Setup, Untrue, content_of
from .tables import TableSeries, read_parameters, read_table

UNTOLD = 1e-3
"""Share of the largest reference that is taken for equal where no tolerance is told."""
_MOST_STEPS = 10_000_000
_ROUNDING = 1e-9
"""Share of a step by which times may differ."""

OutputRow = dict[str, tuple[Any, ...]]


@dataclass(frozen=True)
class Compared:
    """The outcome of an experiment.

    Attributes
    ----------
    name : str
        Of the experiment.
    worst : float
        Largest deviation over its tolerance: at most 1 where the experiment has passed.
    variable : str
        Where that is.
    deviation, tolerance : float
        There, in the unit of the variable.
    told : bool
        Whether the FMU tells a tolerance.
    refused : str
        Why it was not carried out; empty where it was.
    """

    name: str
    worst: float = 0.0
    variable: str = ""
    deviation: float = 0.0
    tolerance: float = 0.0
    told: bool = True
    refused: str = ""


def compared(subject: Subject, setup: Setup) -> Compared:
    """Carry out an experiment and compare its results with the references."""
    try:
        return _Running(subject, setup).compared()
    except Untrue as untrue:
        return Compared(setup.name, math.inf, refused=str(untrue))
    except (CallRefused, NoInstance) as error:
        return Compared(setup.name, math.inf, refused=f"the FMU does not do it: {error}")


def state_difference(subject: Subject, setup: Setup) -> str:
    """Return where results from the state differ from those from the parameters; empty if nowhere.

    Parameters
    ----------
    subject : Subject
        The FMU.
    setup : Setup
        An experiment with a state and parameters.

    Raises
    ------
    Untrue, CallRefused, NoInstance
        It cannot be carried out.
    """
    times, rows = _Running(subject, setup).course()
    _, others = _Running(subject, replace(setup, state=None)).course()
    # outputs at the start follow inputs only in the initialisation, which the state has behind it
    for time, row, other in list(zip(times, rows, others, strict=True))[1:]:
        for name in row:
            if row[name] != other[name]:
                return f"{setup.name}: at {time:g} s {name} is {row[name]} instead of {other[name]}"
    return ""


class _Running:
    """One experiment on one FMU.

    Parameters
    ----------
    subject : Subject
        The FMU.
    setup : Setup
        The experiment.
    """

    def __init__(self, subject: Subject, setup: Setup) -> None:
        self._subject = subject
        self._setup = setup
        self._variables = {v.name: v for v in subject.variables}
        if setup.references is None:
            raise Untrue("has no references")
        self._references = read_table(setup.references, self._variables)
        self._stimuli = read_table(setup.stimuli, self._variables) if setup.stimuli else {}
        if wrong := [n for n in self._stimuli if self._variables[n].causality != "input"]:
            raise Untrue(f"has stimuli for {wrong[0]}, which is no input")
        self._parameters = (
            read_parameters(setup.parameters, self._variables, self._items())
            if setup.parameters
            else {}
        )

    def _items(self) -> dict[str, dict[str, int]]:
        return {
            variable.name: {item.name: int(item.value) for item in variable.declaredType.items}
            for variable in self._subject.model.modelVariables
            if getattr(variable.declaredType, "items", None)
        }

    def compared(self) -> Compared:
        """Carry the experiment out and compare."""
        times, rows = self.course()
        worst = Compared(self._setup.name)
        for name, series in self._references.items():
            deviation = self._deviation(name, series, times, rows)
            tolerance, told = self._tolerance(name, series)
            share = deviation / tolerance if tolerance > 0.0 else math.inf
            if deviation <= 0.0:
                share = 0.0
            if share > worst.worst or not worst.variable:
                worst = Compared(self._setup.name, share, name, deviation, tolerance, told)
        return worst

    # ------------------------------------------------------------------ the run

    def course(self) -> tuple[list[float], list[OutputRow]]:
        """Return times and outputs at all communication points."""
        start, stop, step = self._times()
        instance = self._begun(start) if self._setup.state is None else self._restored(start)
        read = [self._variables[name] for name in self._references]
        times, rows = [start], [instance.get(read)]
        for number in range(math.ceil((stop - start) / step - _ROUNDING)):
            time = start + number * step
            self._set_inputs(instance, time)
            # as the other tools count times, so that rounding is theirs
            done = instance.step(min(step, stop - time), time)
            times.append(min(stop, start + (number + 1) * step))
            rows.append(instance.get(read))
            if done.terminated:
                break
        instance.free()
        return times, rows

    def _begun(self, start: float) -> Called:
        """Return an instance that is initialised with parameters and inputs."""
        instance = self._subject.instantiate("experiment", logging=False)
        for name, values in self._parameters.items():
            instance.set(self._variables[name], values)
        self._set_inputs(instance, start)
        instance.initialise(start, None)
        return instance

    def _restored(self, start: float) -> Called:
        """Return an instance in the state of the experiment, with its inputs."""
        assert self._setup.state is not None
        instance = self._subject.instantiate("experiment")
        state = instance.deserialize(content_of(self._setup.state))
        instance.restore(state)
        instance.free_state(state)
        self._set_inputs(instance, start)
        return instance

    def _times(self) -> tuple[float, float, float]:
        setup, subject = self._setup, self._subject
        start = subject.start if setup.start is None else setup.start
        stop = subject.stop if setup.stop is None else setup.stop
        last = max(float(series.times[-1]) for series in self._references.values())
        stop = last if stop is None else stop
        step = self._default_step(start) if setup.step is None else setup.step
        if not (math.isfinite(start) and math.isfinite(stop) and stop > start):
            raise Untrue(f"goes from {start:g} to {stop:g} s")
        if not step > 0.0 or (stop - start) / step > _MOST_STEPS:
            raise Untrue(f"asks for {(stop - start) / step if step else math.inf:.3g} steps")
        if last > stop + step * 1e-6:
            raise Untrue(f"ends at {stop:g} s, and its references at {last:g} s")
        return start, stop, step

    def _default_step(self, start: float) -> float:
        """Return the step of the description; without one, that of the references."""
        if self._subject.has_step:
            return self._subject.step
        times = next(iter(self._references.values())).times
        gaps = np.diff(times)
        return float(gaps[gaps > 0.0].min()) if (gaps > 0.0).any() else self._subject.step

    def _set_inputs(self, instance: Called, time: float) -> None:
        for name, series in self._stimuli.items():
            variable = self._variables[name]
            continuous = variable.is_real and variable.variability == "continuous"
            instance.set(variable, series.at(time, continuous))

    # ------------------------------------------------------------------ the comparison

    def _deviation(
        self, name: str, series: TableSeries, times: list[float], rows: list[OutputRow]
    ) -> float:
        """Return the largest deviation; infinity where texts differ or the FMU ended earlier."""
        variable = self._variables[name]
        own = TableSeries(np.array(times), [row[name] for row in rows])
        near = _ROUNDING * max(1e-12, times[-1] - times[0])
        worst = 0.0
        for number, time in enumerate(series.times):
            if number + 1 < len(series.times) and series.times[number + 1] == time:
                continue  # a jump: what comes after it is compared
            if time > times[-1] + near:
                return math.inf
            place = int(np.searchsorted(own.times, time - near))
            is_met = place < len(times) and abs(times[place] - time) <= near
            found = own.values[place] if is_met else own.at(float(time), variable.is_real)
            worst = max(worst, *map(_apart, found, series.values[number]))
        return worst

    def _tolerance(self, name: str, series: TableSeries) -> tuple[float, bool]:
        """Return the tolerance of a variable, and whether the FMU tells it."""
        whole = name.partition("[")[0]  # an element of an array
        for told in (name, whole):
            if told in self._setup.tolerances:
                return self._setup.tolerances[told], True
        numbers = [abs(v) for row in series.values for v in row if isinstance(v, int | float)]
        largest = max(numbers, default=0.0) or 1.0
        share = UNTOLD if self._setup.tolerance is None else self._setup.tolerance
        return share * largest, self._setup.tolerance is not None


def _apart(one: Any, other: Any) -> float:
    if isinstance(one, int | float) and isinstance(other, int | float):
        return abs(float(one) - float(other)) if math.isfinite(one) else math.inf
    return 0.0 if one == other else math.inf
