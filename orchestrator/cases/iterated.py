"""The scheme of exchange ``implicit``: the system of a case, each window of it iterated.

Of ``impulse``, whose sand goes on with the velocities of its partners and returns mean forces, it
keeps everything that conserves impulses. What is other:

- The master is ``implicit``. Positions are those of the beginning of a step, velocities those of
  its middle, for the sand moves its partners on itself; of a rod, whose head follows a force at
  once, those of the end.
- Rods and ground have ports of kinematics: a wave is known before its step, and leaves nothing to
  iterate. A rod refuses no step, as the limit of it is that of explicit masters.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

from rockshed.components.common.units import ms

from ..core.system.fields import Value
from ..core.system.iteration import InputMoment, IteratedConnection, Iteration
from ..core.system.names import select
from ..core.system.system import SystemSpec
from .together import ComponentSizes

IMPLICIT = "implicit"
"""Name of the scheme."""
_BASE = "impulse"
_TOLERANCE = 1e-4
"""Of what components give each other, relative to the largest amount: a hundredth of a percent."""
_MOMENTS: Sequence[tuple[str, InputMoment]] = (
    ("*.position*", "begin"),
    ("*.angle*", "begin"),
    ("*velocity*", "middle"),
)
_Make = Callable[[Mapping[str, str], ComponentSizes, str], SystemSpec]
_Derive = Callable[[SystemSpec, ComponentSizes], Mapping[str, Value]]


@dataclass(frozen=True)
class IteratedTimes:
    """Times of the scheme, where they are other than those of ``impulse``.

    Attributes
    ----------
    exchange_step : float or None
        Time between two values (s); None as in ``impulse``.
    length : float or None
        Time that is iterated as a whole (s); None an exchange.
    """

    exchange_step: float | None = None
    length: float | None = None

    def in_words(self, system_step: str) -> str:
        """Return the scheme in words; ``system_step`` is the exchange in words of ``impulse``."""
        every = system_step if self.exchange_step is None else f"{self.exchange_step / ms:g} ms"
        what = f"windows of {self.length / ms:g} ms" if self.length else "each exchange"
        return f"{what} repeated until all values fit together, mean forces, exchange every {every}"


AS_IMPULSE = IteratedTimes()
"""Each exchange is iterated, and exchanges are those of ``impulse``."""


def couplings_with_implicit(couplings: Mapping[str, str], window: IteratedTimes) -> dict[str, str]:
    """Return the schemes of a case with ``implicit`` behind them.

    Parameters
    ----------
    couplings : mapping of str to str
        Schemes by name, with a description that ends in ``exchange every STEP``.
    window : IteratedTimes
        Of the case.
    """
    step = couplings[_BASE].rpartition("exchange every ")[2]
    return {**couplings, IMPLICIT: window.in_words(step)}


def making(make: _Make, rods: Sequence[str], window: IteratedTimes) -> _Make:
    """Return what makes the system of a case by the scheme ``implicit`` too.

    Parameters
    ----------
    make : callable
        Makes it by the other schemes.
    rods : sequence of str
        Components that are rods; the ground under ``rod_left`` is ``ground_left``.
    window : IteratedTimes
        Of the case.
    """
    return partial(_made, make, rods, window)


def _made(
    make: _Make,
    rods: Sequence[str],
    window: IteratedTimes,
    fmus: Mapping[str, str],
    sizes: ComponentSizes,
    coupling: str,
) -> SystemSpec:
    if coupling != IMPLICIT:
        return make(fmus, sizes, coupling)
    return _iterated(make(fmus, sizes, _BASE), rods, window)


def _iterated(system: SystemSpec, rods: Sequence[str], window: IteratedTimes) -> SystemSpec:
    components = dict(system.components)
    ports: Mapping[str, Mapping[str, Value]] = {
        **{rod: {"toe.port": "kinematics"} for rod in rods},
        **{rod.replace("rod", "ground", 1): {"port": "kinematics"} for rod in rods},
    }
    for name, changed in ports.items():
        own = components[name]
        components[name] = own.model_copy(update={"parameters": {**own.parameters, **changed}})
    iteration = Iteration(
        tolerance=_TOLERANCE, window=window.length, connections=_connections(system, rods)
    )
    changes = {
        "components": components,
        "master": "implicit",
        "iteration": iteration,
        "exchange_step": window.exchange_step or system.exchange_step,
    }
    return system.model_copy(update=changes)


def _connections(system: SystemSpec, rods: Sequence[str]) -> list[IteratedConnection]:
    """Return the moments of the inputs, those that the system has."""
    targets = [connection.target for connection in system.connections]
    moments = [
        IteratedConnection(target=target, input=moment)
        for target, moment in _MOMENTS
        if select(target, targets)
    ]
    return moments + [IteratedConnection(source=f"{rod}.*velocity", input="end") for rod in rods]


def deriving(derive: _Derive) -> _Derive:
    """Return what derives the values of a case by the scheme ``implicit`` too.

    Parameters
    ----------
    derive : callable
        Derives them by the other schemes.
    """
    return partial(_derived, derive)


def _derived(derive: _Derive, system: SystemSpec, sizes: ComponentSizes) -> Mapping[str, Value]:
    """Return the values without the stiffness from which rods know the longest explicit step."""
    values = derive(system, sizes)
    if system.master != "implicit":
        return values
    return {name: v for name, v in values.items() if not name.endswith(".partner.stiffness")}
