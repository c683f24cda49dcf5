"""Variables that one FMI call moves together."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import groupby, pairwise

import numpy as np

from .plan import End
from .slave import References

_WORTH_A_CALL = 16
"""Consecutive value references go in a call of their own where the blocks of a component are at least this long on average:
pythonfmu's slaves take such a block as one slice."""


@dataclass(frozen=True)
class Block:
    """Variables that one FMI call moves; their values lie in a row of numbers from place ``begin`` on."""

    kind: str
    references: References
    begin: int

    @cached_property
    def places(self) -> slice:
        """Where the values lie."""
        return slice(self.begin, self.begin + self.references.size)


def make_blocks(ends: Sequence[End], begin: int = 0) -> dict[str, list[Block]]:
    """Blocks of each component for ports that lie in this order in a row of numbers, from ``begin`` on."""
    blocks: dict[str, list[Block]] = {}
    for (component, kind), group in groupby(enumerate(ends, begin), lambda item: (item[1].component, item[1].port.kind)):
        members = list(group)
        references = np.array([end.port.reference for _, end in members], np.uint32)
        cuts = [0, *(np.flatnonzero(np.diff(references.astype(np.int64)) != 1) + 1), len(references)]
        if len(references) < _WORTH_A_CALL * (len(cuts) - 1):
            cuts = [0, len(references)]
        blocks.setdefault(component, []).extend(
            Block(kind, references[a:b].copy(), members[a][0]) for a, b in pairwise(cuts))
    return blocks
