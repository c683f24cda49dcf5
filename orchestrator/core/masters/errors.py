"""The error of exchanged values between two ways to the same time."""

import numpy as np

from ..loop.tables import FloatTable
from ..system.plan import Plan


class ValueErrors:
    """Compares the outputs that feed real inputs.

    Each counts as a part of the largest amount so far of all values of its component and unit: the
    forces on 24 elements have one size, whichever of them bears most. The norm is the root mean
    square, as for systems of differential equations (Hairer, Norsett and Wanner, Solving ordinary
    differential equations I, sec. II.4).

    Parameters
    ----------
    plan : Plan
        Says what feeds what.

    Attributes
    ----------
    sizes : array of float, shape (groups,)
        Largest amounts so far.
    """

    def __init__(self, plan: Plan) -> None:
        fed = sorted(
            {int(plan.source[place]) for place, end, _ in plan.fed if not end.port.is_held}
        )
        groups: dict[tuple[str, str], int] = {}
        self._places = np.array(fed, np.int64)
        self._group = np.array(
            [
                groups.setdefault((end.component, end.port.unit_name), len(groups))
                for end in (plan.outputs[place] for place in fed)
            ],
            np.int64,
        )
        self.sizes: FloatTable = np.zeros(len(groups))

    def of(self, values: FloatTable, others: FloatTable) -> float:
        """Return the error of the one outputs against the other; 0 where nothing is exchanged."""
        sizes = self._sizes_with(values)[self._group]
        apart = np.abs(values[self._places] - others[self._places])
        known = sizes > 0.0
        parts = apart[known] / sizes[known]
        return float(np.sqrt(np.mean(parts * parts))) if parts.size else 0.0

    def learn(self, outputs: FloatTable) -> None:
        """Take outputs that are kept into the sizes."""
        self.sizes[:] = self._sizes_with(outputs)

    def _sizes_with(self, outputs: FloatTable) -> FloatTable:
        found = self.sizes.copy()
        np.maximum.at(found, self._group, np.abs(outputs[self._places]))
        return found
