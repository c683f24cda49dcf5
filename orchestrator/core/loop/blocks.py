"""Variables that one FMI call moves together."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import groupby, pairwise

import numpy as np

from ..fmu.slave import ValueReferences
from ..fmu.types import TYPES
from ..system.plan import End

_WORTH_A_CALL = 16
"""So many consecutive value references go in a call of their own: our slaves take them as one
slice. What lies between goes together."""


@dataclass(frozen=True)
class Block:
    """Variables of one component and type that one FMI call moves.

    Attributes
    ----------
    type : str
        Key of :data:`rockshed.core.fmu.types.TYPES`.
    references : array of uint32
        Value references.
    begin, number : int
        Place of the first value in a row of numbers, and how many follow one another there.
    """

    type: str
    references: ValueReferences
    begin: int
    number: int

    @cached_property
    def places(self) -> slice:
        """Places of the values in the row."""
        return slice(self.begin, self.begin + self.number)


def make_blocks(ends: Sequence[End], begin: int = 0) -> dict[str, list[Block]]:
    """Divide ports into blocks.

    Parameters
    ----------
    ends : sequence of End
        Ports in the order in which their values lie in a row of numbers; of an array of FMI 3.0
        all elements.
    begin : int
        Place of the first one.

    Returns
    -------
    dict of str to list of Block
        Blocks of each component.
    """
    blocks: dict[str, list[Block]] = {}
    for (component, moved), group in groupby(
        enumerate(ends, begin), lambda item: (item[1].component, item[1].port.type)
    ):
        members = list(group)
        references = np.array([end.port.reference for _, end in members], np.uint32)
        first = members[0][0]
        made = blocks.setdefault(component, [])
        if TYPES[moved].is_counted:
            is_first = np.array([end.port.element == 0 for _, end in members])
            made.append(Block(moved, references[is_first], first, references.size))
            continue
        made += [
            Block(moved, references[a:b].copy(), first + a, b - a)
            for a, b in pairwise(_cuts(references))
        ]
    return blocks


def _cuts(references: ValueReferences) -> list[int]:
    """Return the places at which a row of references is cut, its ends included."""
    jumps = np.flatnonzero(np.diff(references.astype(np.int64)) != 1) + 1
    runs = pairwise([0, *jumps, len(references)])
    long = [run for run in runs if run[1] - run[0] >= _WORTH_A_CALL]
    return sorted({0, len(references), *(cut for run in long for cut in run)})
