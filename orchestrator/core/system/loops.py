"""Algebraic loops: values that depend on themselves at one time, as descriptions declare it."""

from collections.abc import Iterable, Mapping
from graphlib import CycleError, TopologicalSorter

from ..fmu.description import Dependencies, Description
from .plan import End

_MOST_TOLD = 3
"""Loops that are told one by one."""


def algebraic_loops(
    descriptions: Mapping[str, Description], links: Iterable[tuple[End, End]], at_start: bool
) -> list[str]:
    """Return loops as chains of ports, ``a.y -> b.u -> b.x -> a.v -> a.y``.

    Each has at least one connection that no other has. Outputs of which a description does not say
    what they depend on are in none.

    Parameters
    ----------
    descriptions : mapping of str to Description
        By component.
    links : iterable of (End, End)
        Source and target of every connection.
    at_start : bool
        Whether dependencies are those of the initialisation, and not those of the run.
    """
    feeding: dict[str, set[str]] = {}
    for source, target in links:
        feeding.setdefault(target.name, set()).add(source.name)
    for component, description in descriptions.items():
        told = description.initial_dependencies if at_start else description.dependencies
        for output, inputs in _of_ports(description, told).items():
            needed = {f"{component}.{name}" for name in inputs} & feeding.keys()
            if needed:
                feeding[f"{component}.{output}"] = needed
    return list(_cycles(feeding))


def _of_ports(description: Description, told: Dependencies) -> Dependencies:
    """Return dependencies port by port; those of an array are those of all its elements."""
    elements: dict[str, list[str]] = {
        port.array: [] for port in description.ports.values() if port.shape
    }
    for port in description.ports.values():
        if port.shape:
            elements[port.array].append(port.name)
    found: dict[str, tuple[str, ...]] = {}
    for output, inputs in told.items():
        ports = tuple(name for i in inputs for name in elements.get(i, [i]))
        found |= dict.fromkeys(elements.get(output, [output]), ports)
    return found


def _cycles(feeding: dict[str, set[str]]) -> Iterable[str]:
    """Yield cycles until there is none left; each is cut where it begins."""
    while True:
        try:
            TopologicalSorter(feeding).prepare()
        except CycleError as error:
            chain = error.args[1]
            yield " -> ".join(chain)
            feeding[chain[1]].discard(chain[0])
        else:
            return


def told(loops: list[str]) -> str:
    """Return the first loops as a list in words, and how many more there are."""
    more = len(loops) - _MOST_TOLD
    listed = "; ".join(loops[:_MOST_TOLD])
    return listed + (f"; and {more} more" if more > 0 else "")
