"""``model.h``: what the slave in C has to know of a component, from its declarations."""

import re
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from rockshed.components.common.component import (
    FOREIGN_STATE,
    HEADER,
    IMPOSSIBLE_STATE,
    LOST,
    NOT_FINITE,
    NOT_WHOLE,
    OUT_OF_RANGE,
    UNKNOWN_STATUS,
    Component,
    Instance,
)
from rockshed.components.common.ports import Causality, Kind, Sizes, Variable
from rockshed.components.common.restoring import INDEX_WRONG, NUMBER_NOT_FINITE, TABLE_DIFFERS
from rockshed.components.common.units import range_in_words

from ..python import conduct

_TEMPLATE = Path(__file__).with_name("model.h.j2")
_OF_COMPONENTS = {
    "NOT_FINITE": NOT_FINITE,
    "OUT_OF_RANGE": OUT_OF_RANGE,
    "UNKNOWN_STATUS": UNKNOWN_STATUS,
    "FOREIGN": FOREIGN_STATE,
    "NOT_WHOLE": NOT_WHOLE,
    "LOST": LOST,
    "IMPOSSIBLE": IMPOSSIBLE_STATE,
    "TABLE_DIFFERS": TABLE_DIFFERS,
    "NUMBER_NOT_FINITE": NUMBER_NOT_FINITE,
    "INDEX_WRONG": INDEX_WRONG,
}
"""Sentences of components by their name in C."""


@dataclass(frozen=True)
class Baseline:
    """The processor that kernels are compiled for.

    Parameters
    ----------
    name : str
        As LLVM knows it.
    leaf_1, leaf_7, leaf_81 : int
        Bits that the instruction CPUID must report in ecx of leaf 1, ebx of leaf 7 and ecx of
        leaf 80000001h.
    """

    name: str
    leaf_1: int
    leaf_7: int
    leaf_81: int


def model_header(component: Component, sizes: Sizes, guid: str, cpu: Baseline) -> bytes:
    """Return ``model.h``.

    Parameters
    ----------
    component : Component
        The component.
    sizes : mapping of str to int
        The sizes it is built with.
    guid : str
        GUID of the FMU.
    cpu : Baseline
        The processor that its kernels are compiled for.

    Returns
    -------
    bytes
        A header in C.
    """
    from jinja2 import Environment, StrictUndefined

    environment = Environment(
        undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True, keep_trailing_newline=True
    )
    environment.filters |= {"text": _text, "format": _literal, "real": _real, "mask": _mask}
    template = environment.from_string(_TEMPLATE.read_text(encoding="utf-8"))
    shared = {"component": component, "sizes": sizes, "guid": guid, "cpu": cpu}
    return template.render(**shared, **_tables(component, sizes), **_conduct()).encode()


def _conduct() -> dict[str, object]:
    return {
        "phases": conduct.Phase,
        "settled": conduct.SETTLED,
        "stale": conduct.Stale,
        "calls": conduct.CALLS,
        "remedies": conduct.REMEDIES,
        "not_initialised": conduct.NOT_INITIALISED,
        "to_initialise": conduct.TO_INITIALISE,
        "sentences": conduct.SENTENCES | _OF_COMPONENTS,
    }


def _tables(component: Component, sizes: Sizes) -> dict[str, object]:
    from ..description.fmi3 import TIME

    instance = Instance(component, sizes)
    references = instance.references
    ordered = component.layout.ordered
    event = component.next_event
    lengths = [len(variable.element_names(sizes)) for variable in ordered]
    traits = [_traits(v) for v, length in zip(ordered, lengths) for _ in range(length)]
    return {
        "instance": instance,
        "internal_step": references.get("internal_step", -1),
        "stable_step": references.get("stable_step", -1),
        "own_step": references.get("time_step", -1),
        "event_time": references[event.time] if event else -1,
        "zero_until_event": [references[name] for name in event.while_zero] if event else [],
        "table": component.layout.table(sizes)[0],
        "indices": list(_indices(component, sizes)),
        "read_only": [*sizes, TIME],
        "header": instance.to_bytes()[: HEADER.size],
        "variables": list(_variables(component, sizes)),
        "variable_of": [i for i, length in enumerate(lengths) for _ in range(length)],
        "traits": traits,
        "alike": _alike(traits),
        "deferred": sorted(component.deferred),
        "faults": _numbered_faults(component, instance),
    }


def _variables(component: Component, sizes: Sizes) -> Iterator[dict[str, object]]:
    first = 0
    for variable in component.layout.ordered:
        bounds = variable.minimum, variable.maximum
        yield {
            "declared": variable,
            "first": first,
            "length": 0 if variable.size is None else sizes[variable.size],
            "low": -sys.float_info.max if bounds[0] is None else bounds[0],
            "high": sys.float_info.max if bounds[1] is None else bounds[1],
            "unit": "" if variable.unit == "1" else f" {variable.unit}",
            "range": range_in_words(*bounds, variable.unit),
        }
        first += len(variable.element_names(sizes))


def _indices(component: Component, sizes: Sizes) -> Iterator[dict[str, object]]:
    for indices in component.layout.index_ranges(sizes):
        declared, places = indices.declared, indices.places
        lowest, width = declared.bits
        yield {
            "array": indices.array,
            "is_integer": int(indices.integer),
            "places": [places.start, places.stop, places.step],
            "lowest": lowest,
            "mask": hex((1 << width) - 1),
            "range": [indices.low, indices.high, declared.multiple],
            "ascending": int(declared.ascending),
        }


def _traits(variable: Variable) -> str:
    is_bounded = variable.minimum is not None or variable.maximum is not None
    if variable.kind is not Kind.REAL:
        return "0"
    if variable.causality is not Causality.INPUT or is_bounded:
        return "IS_REAL"
    return "IS_REAL | IS_FREE"


def _alike(items: Sequence[str]) -> list[int]:
    """Return for each item the number of equal ones from it on."""
    counts: list[int] = []
    for item, following in zip(reversed(items), [None, *reversed(items)]):
        counts.append(counts[-1] + 1 if item == following else 1)
    return counts[::-1]


def _numbered_faults(component: Component, instance: Instance) -> dict[int, str]:
    """Return the messages of all statuses with references in the place of names."""
    return {
        status: re.sub(
            r"\{([^}]+)\}", lambda match: f"{{{instance.references[match.group(1)]}}}", text
        )
        for status, text in component.faults.items()
    }


def _mask(phases: Sequence[conduct.Phase]) -> str:
    """Return a number with the bits of phases."""
    return hex(sum(1 << phase for phase in phases))


def _real(value: float) -> str:
    return float(value).hex()


def _text(text: str) -> str:
    """Return a literal of C. Some hosts take messages for formats: they have no percent sign."""
    return _literal(text.replace("%", "percent"))


def _literal(text: str) -> str:
    def escaped(byte: int) -> str:
        is_plain = 32 <= byte < 127 and chr(byte) not in '"\\?'
        return chr(byte) if is_plain else f"\\{byte:03o}"

    return f'"{"".join(map(escaped, text.encode()))}"'
