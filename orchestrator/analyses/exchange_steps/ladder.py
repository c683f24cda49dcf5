"""The systems of a ladder of exchange steps: h, h/2, h/4, ..."""

from dataclasses import replace

from ...core.system.clock import exact
from ...runs.batch import slim
from ...runs.system import System


def ladder(system: System, levels: int, watch: tuple[str, ...] = ()) -> list[System]:
    """Return a system with its exchange step h, then h/2, h/4, ...

    Rows stand at the same times in all of them, those of the system itself. States are not
    recorded. Of the components' own steps see :func:`step_of`.

    Parameters
    ----------
    system : System
        With the coarsest step.
    levels : int
        Number of steps.
    watch : tuple of str
        Variables that are recorded besides.

    Returns
    -------
    list of System
        From coarse to fine.
    """
    return [_refined(system, level, watch) for level in range(levels)]


def _refined(system: System, level: int, watch: tuple[str, ...]) -> System:
    spec = slim(system.spec, None)
    exchange = spec.exchange_step
    components = {
        name: part.model_copy(update={"step": part.step and step_of(part.step, exchange, level)})
        for name, part in spec.components.items()
    }
    changes = {
        "components": components,
        "exchange_step": float(exact(exchange) / 2**level),
        "output_interval": spec.output_interval or exchange,
        "record": [*spec.record, *(name for name in watch if name not in spec.record)],
    }
    return System(replace(system.job, system=spec.model_copy(update=changes)))


def step_of(step: float, exchange: float, level: int) -> float:
    """Return the step of a component that has one of its own, at a level of the ladder.

    A step that divides the exchange step stays; one that does no longer is halved until it does. A
    component that is slower than the exchange from the beginning is halved with it: otherwise what
    it sees would never converge.

    Parameters
    ----------
    step : float
        Of the component in the system (s).
    exchange : float
        Exchange step of the system (s).
    level : int
        Halvings of that.

    Returns
    -------
    float
        In s.
    """
    own, whole = exact(step), exact(exchange)
    here = whole / 2**level
    if own >= whole:
        return float(own / 2**level)
    whole_parts = (own / 2**halvings for halvings in range(level + 1))
    return float(next((part for part in whole_parts if (here / part).denominator == 1), own))
