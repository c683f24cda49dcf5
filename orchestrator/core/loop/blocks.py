"""Variables that one FMI call moves together."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import groupby, pairwise

import numpy as np

from ..fmu.slave import References
from ..system.plan import End

_WORTH_A_CALL = 16
"""So many consecutive value references go in a call of their own: our slaves take them as one slice. What lies between goes
together."""


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
    for (component, kind), group in groupby(
        enumerate(ends, begin), lambda item: (item[1].component, item[1].port.kind)
    ):
        members = list(group)
        references = np.array([end.port.reference for _, end in members], np.uint32)
        ends_of_runs = [
            0,
            *(np.flatnonzero(np.diff(references.astype(np.int64)) != 1) + 1),
            len(references),
        ]
        long = [run for run in pairwise(ends_of_runs) if run[1] - run[0] >= _WORTH_A_CALL]
        cuts = sorted({0, len(references), *(cut for run in long for cut in run)})
        blocks.setdefault(component, []).extend(
            Block(kind, references[a:b].copy(), members[a][0]) for a, b in pairwise(cuts)
        )
    return blocks
