"""Extrapolation of inputs between exchanges: which inputs, and when what feeds them was shown."""

from collections.abc import Collection, Iterable, Mapping, Sequence

from ..errors import Problem
from ..fmu.description import Description
from .plan import End, Extrapolated
from .system import SystemSpec
from .timing import Timing


def extrapolation_problems(
    system: SystemSpec, descriptions: Mapping[str, Description], fed: Iterable[End]
) -> list[Problem]:
    """Refuse components that are to extrapolate inputs and have none for it.

    Parameters
    ----------
    system : SystemSpec
        The components.
    descriptions : mapping of str to Description
        Of those whose FMUs could be read.
    fed : iterable of End
        Inputs that connections feed.
    """
    able = {end.component for end in fed if not end.port.is_held}
    return [
        Problem(
            f"{name}.extrapolation",
            f"is {spec.extrapolation}, and no connection feeds a real input of {name} that changes "
            "continuously",
            "leave it out",
        )
        for name, spec in system.components.items()
        if spec.extrapolation and name in descriptions and name not in able
    ]


class Extrapolating:
    """The inputs of a system that follow polynomials.

    Parameters
    ----------
    system : SystemSpec
        Checked.
    order : sequence of str
        Components in the order of their turns.
    timing : Timing
        Of the run.
    """

    def __init__(self, system: SystemSpec, order: Sequence[str], timing: Timing) -> None:
        self._system = system
        self._timing = timing
        self._turns = {name: turn for turn, name in enumerate(order)}
        self._orders = {
            name: system.extrapolation if spec.extrapolation is None else spec.extrapolation
            for name, spec in system.components.items()
        }

    @property
    def components(self) -> dict[str, bool]:
        """Components that extrapolate, and whether a bond counts what happens in each step."""
        return {name: name in self._bound for name, order in self._orders.items() if order}

    @property
    def _bound(self) -> Collection[str]:
        """Components whose work the ledger counts by forces and motions."""
        bonds = self._system.bonds.values()
        givers = {bond.giver for bond in bonds if bond.work is None}
        return givers | {bond.taker for bond in bonds}

    def inputs(
        self, inputs: Sequence[End], outputs: Sequence[End], source: Sequence[int]
    ) -> tuple[Extrapolated, ...]:
        """Return the inputs that are extrapolated.

        Parameters
        ----------
        inputs, outputs : sequence of End
            The buses.
        source : sequence of int
            Place among the outputs that feeds each input; one behind them feeds none.
        """
        return tuple(
            self._extrapolated(place, end.component, outputs[feeding].component)
            for place, (end, feeding) in enumerate(zip(inputs, source, strict=True))
            if self._orders[end.component] and not end.port.is_held and feeding < len(outputs)
        )

    def _extrapolated(self, place: int, target: str, owner: str) -> Extrapolated:
        exchange = self._timing.exchange
        is_before = self._turns[owner] < self._turns[target]
        has_stepped = self._system.master == "sequential" and is_before
        order = self._orders[target]
        every = max(exchange, self._timing.steps[owner])
        return Extrapolated(place, order, exchange if has_stepped else 0, every, owner)
