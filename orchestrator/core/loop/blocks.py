"""Variables that one FMI call moves together."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import groupby, pairwise

import numpy as np

from ..fmu.slave import ValueReferences
from ..system.plan import End

_WORTH_A_CALL = 16
"""So many consecutive value references go in a call of their own: our slaves take them as one
slice. What lies between goes together."""


@dataclass(frozen=True)
class Block:
    """Variables of one component and kind that one FMI call moves.

    Attributes
    ----------
    kind : str
        Real, Integer or Boolean.
    references : array of uint32
        Value references.
    begin : int
        Place of the first value in a row of numbers; the others follow.
    """

    kind: str
    references: ValueReferences
    begin: int

    @cached_property
    def places(self) -> slice:
        """Places of the values in the row."""
        return slice(self.begin, self.begin + self.references.size)


def make_blocks(ends: Sequence[End], begin: int = 0) -> dict[str, list[Block]]:
    """Divide ports into blocks.

    Parameters
    ----------
    ends : sequence of End
        Ports in the order in which their values lie in a row of numbers.
    begin : int
        Place of the first one.

    Returns
    -------
    dict of str to list of Block
        Blocks of each component.
    """
    blocks: dict[str, list[Block]] = {}
    for (component, kind), group in groupby(
        enumerate(ends, begin), lambda item: (item[1].component, item[1].port.kind)
    ):
        members = list(group)
        references = np.array([end.port.reference for _, end in members], np.uint32)
        blocks.setdefault(component, []).extend(
            Block(kind, references[a:b].copy(), members[a][0])
            for a, b in pairwise(_cuts(references))
        )
    return blocks


def _cuts(references: ValueReferences) -> list[int]:
    """Return the places at which a row of references is cut, its ends included."""
    jumps = np.flatnonzero(np.diff(references.astype(np.int64)) != 1) + 1
    runs = pairwise([0, *jumps, len(references)])
    long = [run for run in runs if run[1] - run[0] >= _WORTH_A_CALL]
    return sorted({0, len(references), *(cut for run in long for cut in run)})
