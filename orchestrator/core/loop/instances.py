"""Instances of FMUs for one run, or for many runs one after the other.

An instance that has served a run is reset for the next one. A packing of sand that has come to rest
is restored where the next run would let the same one settle again. Neither changes a bit of a
result: a reset has to lead to the state after the instantiation, and outputs at the start have to
be those that were kept, or else instances are made anew.
"""

import hashlib
from collections import OrderedDict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InputRefused
from ..fmu.slave import ERROR, OK, Slave, Source
from ..results.checkpoints import BEGIN, Checkpoint
from ..system.plan import Plan
from .buses import Buses
from .initialisation import Entering, Stages, free, initialise, instantiate

_MOST_INSTANCES = 24
"""Instances that are kept for later runs, the ones used last."""
_MOST_BYTES = 256 << 20
"""Size (bytes) of the settled states that are kept."""
_SHARE = 0.5
"""Part of all state that has to be the same for a settled state to be of use."""


class FreshInstances:
    """Instances that serve one run."""

    def sources(self, made_from: Mapping[str, Source]) -> Mapping[str, Source]:
        """Return the makers of a run's instances, by component."""
        return made_from

    def make(
        self, plan: Plan, sources: Mapping[str, Source], entering: Entering
    ) -> dict[str, Slave]:
        """Make the instances of a run, see :func:`~.initialisation.instantiate`."""
        return instantiate(plan, sources, entering)

    def initialise(
        self, slaves: Mapping[str, Slave], buses: Buses, allow_unstable: bool, entering: Entering
    ) -> list[str]:
        """Bring instances to their first step, see :func:`~.initialisation.initialise`."""
        return initialise(slaves, buses, allow_unstable, entering)

    def give_back(self, slave: Slave) -> None:
        """Take an instance whose run has ended."""
        slave.free()


class _DescribedOnce:
    """A maker of instances whose description is read once."""

    def __init__(self, source: Source) -> None:
        self._source = source
        self._description = source.model_description()
        self.origin = source.origin

    def model_description(self) -> bytes:
        """Return the description as it was read first."""
        return self._description

    def content(self, name: str) -> bytes | None:
        """Read a file in the FMU; return None where there is none."""
        content = getattr(self._source, "content", None)
        return None if content is None else content(name)

    def instantiate(self, name: str) -> Slave:
        """Make an instance for a component of this name."""
        return self._source.instantiate(name)


@dataclass
class _Kept:
    """An instance that waits for its next run."""

    slave: Slave
    fresh: bytes
    is_proved: bool = False


@dataclass(frozen=True)
class _Settled:
    """States of instances in initialisation mode, whose outputs no longer change.

    Attributes
    ----------
    keys : mapping of str to str
        Digest of everything that was set before, by component.
    states : mapping of str to bytes
        Serialized, by component.
    outputs : array of float, shape (outputs,)
        All exchanged outputs.
    """

    keys: Mapping[str, str]
    states: Mapping[str, bytes]
    outputs: NDArray[np.float64]

    @property
    def size(self) -> int:
        """Number of bytes of all states."""
        return sum(map(len, self.states.values()))

    def same(self, keys: Mapping[str, str]) -> list[str]:
        """Return the components for which everything that was set is the same."""
        return [name for name, key in keys.items() if self.keys.get(name) == key]

    def is_of_use(self, keys: Mapping[str, str]) -> bool:
        """Tell whether most of the state can be restored for a run with these keys."""
        held = sum(len(self.states[name]) for name in self.same(keys))
        return held > _SHARE * self.size


class KeptInstances:
    """Instances that serve one run after the other, for the runs of one thread."""

    def __init__(self) -> None:
        self._sources: dict[str, tuple[object, _DescribedOnce]] = {}
        self._waiting: OrderedDict[object, _Kept] = OrderedDict()
        self._in_use: dict[int, tuple[object, _Kept]] = {}
        self._settled: OrderedDict[str, list[_Settled]] = OrderedDict()

    def sources(self, made_from: Mapping[str, Source]) -> Mapping[str, Source]:
        """Return the makers of a run's instances, by component; files are read once."""
        return {name: self._source(source) for name, source in made_from.items()}

    def _source(self, source: Source) -> Source:
        path = getattr(source, "path", None)
        if path is None:
            return source
        try:
            status = path.stat()
        except OSError:
            return source  # which says what is wrong with it
        process = source.origin.get("process")
        mark = (status.st_mtime_ns, status.st_size, status.st_ino, process)
        known, found = self._sources.get(str(path), (None, None))
        if found is None or known != mark:
            found = _DescribedOnce(source)
            self._sources[str(path)] = (mark, found)
        return found

    # ------------------------------------------------------------------ instances

    def make(
        self, plan: Plan, sources: Mapping[str, Source], entering: Entering
    ) -> dict[str, Slave]:
        """Return an instance for each component, reset or new, in the order of the plan.

        Raises
        ------
        InputRefused
            The reasons of all that cannot be made.
        """
        found: dict[str, Slave] = {}
        for name in plan.order:
            waiting = self._waiting.pop(_origin(name, sources[name]), None)
            if waiting is not None and self._is_reset(waiting):
                found[name] = waiting.slave
                self._in_use[id(waiting.slave)] = (_origin(name, sources[name]), waiting)
        missing = [name for name in plan.order if name not in found]
        try:
            new = instantiate(plan, sources, entering, missing)
        except BaseException:
            for slave in found.values():
                self.give_back(slave)
            raise
        for name, slave in new.items():
            if plan.descriptions[name].serializes_state:
                kept = _Kept(slave, slave.state())
                self._in_use[id(slave)] = (_origin(name, sources[name]), kept)
        return {name: found[name] if name in found else new[name] for name in plan.order}

    def _is_reset(self, kept: _Kept) -> bool:
        """Reset an instance; one that does not become as it was once is freed."""
        slave = kept.slave
        slave.messages = type(slave.messages)()
        done = slave.reset() == OK and not slave.messages
        if done and not kept.is_proved:
            kept.is_proved = done = slave.state() == kept.fresh
        if not done:
            slave.free()
        return done

    def give_back(self, slave: Slave) -> None:
        """Take an instance whose run has ended; one with an error is freed."""
        place, kept = self._in_use.pop(id(slave), (None, None))
        if kept is None or any(status >= ERROR for status, _ in slave.messages):
            slave.free()
            return
        self._waiting[place] = kept
        while len(self._waiting) > _MOST_INSTANCES:
            _, oldest = self._waiting.popitem(last=False)
            oldest.slave.free()

    def close(self) -> None:
        """Free all instances that wait, and forget what was kept."""
        free(kept.slave for kept in self._waiting.values())
        self._waiting.clear()
        self._settled.clear()
        self._sources.clear()

    # ------------------------------------------------------------------ settled states

    def settled(self) -> Checkpoint | None:
        """Return the newest settled states, for another process; None where there are none."""
        if not self._settled:
            return None
        system = next(reversed(self._settled))
        settled = self._settled[system][0]
        facts = {"system": system, "keys": dict(settled.keys)}
        return Checkpoint(BEGIN, facts, {"outputs": settled.outputs}, settled.states)

    def know(self, settled: Checkpoint) -> None:
        """Take settled states that :meth:`settled` gave; those of another system are of no use."""
        keys = {str(name): str(key) for name, key in settled.facts["keys"].items()}
        known = _Settled(keys, settled.states, settled.tables["outputs"])
        self._keep(str(settled.facts["system"]), known)

    def initialise(
        self, slaves: Mapping[str, Slave], buses: Buses, allow_unstable: bool, entering: Entering
    ) -> list[str]:
        """Bring instances to their first step, from a settled state where one is of use.

        Raises
        ------
        InputRefused
            As :func:`~.initialisation.initialise` does.
        """
        plan = buses.plan
        if any(id(slave) not in self._in_use for slave in slaves.values()):
            return initialise(slaves, buses, allow_unstable, entering)
        keys = {name: self._key(plan, slave) for name, slave in slaves.items()}
        system = _system_key(plan)
        of_use = (kept for kept in self._settled.get(system, ()) if kept.is_of_use(keys))
        known = max(of_use, key=lambda kept: len(kept.same(keys)), default=None)
        if known is not None:
            restored = _Restored(slaves, buses, known, known.same(keys))
            try:
                warnings = initialise(slaves, buses, allow_unstable, entering, restored)
            except (InputRefused, RuntimeError):
                restored.is_as_kept = False  # without it, the reasons are the instances' own
            if restored.is_as_kept:
                return warnings
            self._start_anew(slaves, buses)
        seen = _Seen(slaves, buses)
        warnings = initialise(slaves, buses, allow_unstable, entering, seen)
        if seen.states and known is None:
            self._keep(system, _Settled(keys, seen.states, seen.outputs))
        return warnings

    def _key(self, plan: Plan, slave: Slave) -> str:
        """Return a digest of everything that an instance is told before its initialisation."""
        place, _ = self._in_use[id(slave)]
        starts = tuple((port.name, value) for port, value in plan.starts[slave.name])
        span = (plan.timing.seconds(0), plan.timing.seconds(plan.timing.exchanges))
        return _digest(place, starts, span, plan.tolerance(slave.name))

    def _start_anew(self, slaves: Mapping[str, Slave], buses: Buses) -> None:
        """Reset instances that were brought to a state which is of no use."""
        for slave in slaves.values():
            slave.messages = type(slave.messages)()
            slave.reset()
        buses.clear()

    def _keep(self, system: str, settled: _Settled) -> None:
        self._settled.setdefault(system, []).insert(0, settled)
        self._settled.move_to_end(system)
        while self._settled and self._bytes() > _MOST_BYTES:
            oldest = next(iter(self._settled))
            self._settled[oldest].pop()
            if not self._settled[oldest]:
                del self._settled[oldest]

    def _bytes(self) -> int:
        return sum(kept.size for listed in self._settled.values() for kept in listed)


class SettledInstances(KeptInstances):
    """Instances that serve one run; settled states come from, or go to, another process."""

    def give_back(self, slave: Slave) -> None:
        """Free an instance whose run has ended."""
        self._in_use.pop(id(slave), None)
        slave.free()


def _origin(name: str, source: Source) -> object:
    """Return the name of a component with everything that tells one maker from another."""
    return (name, *sorted(source.origin.items()))


def _system_key(plan: Plan) -> str:
    """Return a digest of what is connected with what."""
    ends = (tuple(end.name for end in listed) for listed in (plan.inputs, plan.outputs))
    ways = (sorted(plan.linear.items()), sorted(plan.scenario.at_start.items()))
    return _digest(plan.order, *ends, plan.source.tobytes(), *ways)


def _digest(*content: Any) -> str:
    """Return a digest of numbers and texts, the same in every process."""
    return hashlib.sha256(repr(content).encode()).hexdigest()


class _Seen(Stages):
    """Takes the states of instances when their outputs no longer change.

    Attributes
    ----------
    states : dict of str to bytes
        Empty where outputs go on changing, or an instance has said something.
    outputs : array of float
        All exchanged outputs then.
    """

    def __init__(self, slaves: Mapping[str, Slave], buses: Buses) -> None:
        self._slaves = slaves
        self._buses = buses
        self.states: dict[str, bytes] = {}
        self.outputs = np.empty(0)

    def settled(self, unsettled: str) -> None:
        """Take all states, unless an output still changes."""
        if unsettled or any(slave.messages for slave in self._slaves.values()):
            return
        self.states = {name: slave.state() for name, slave in self._slaves.items()}
        self.outputs = self._buses.outputs.copy()


class _Restored(Stages):
    """Restores settled states, and looks whether they still are settled.

    Attributes
    ----------
    is_as_kept : bool
        Whether the outputs of the restored instances are those that were kept.
    """

    def __init__(
        self, slaves: Mapping[str, Slave], buses: Buses, known: _Settled, names: Sequence[str]
    ) -> None:
        self._slaves = slaves
        self._buses = buses
        self._known = known
        self._names = names
        self.is_as_kept = False

    def entered(self) -> None:
        """Restore the states of the instances that were told the same."""
        for name in self._names:
            self._slaves[name].restore(self._known.states[name])

    def settled(self, unsettled: str) -> None:
        """Compare the outputs of these instances with those that were kept."""
        places = [place for name in self._names for place in self._buses.shows[name]]
        here = self._buses.outputs[places]
        self.is_as_kept = not unsettled and np.array_equal(here, self._known.outputs[places])
