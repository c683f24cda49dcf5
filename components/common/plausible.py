"""Plausible ranges of quantities: beyond them a value is most likely one in another unit."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Plausible:
    """The range that a quantity has in practice; values beyond it are computed, with a warning.

    Attributes
    ----------
    low, high : float
        Ends of the range, in the unit of the quantity. A value of 0 is never doubted.
    likely : tuple of str
        Units in which a value beyond the range may have been written, the likeliest first.
    """

    low: float
    high: float
    likely: tuple[str, ...] = ()

    def holds(self, value: float) -> bool:
        """Tell whether a value, or what it is without its sign, is within the range.

        Parameters
        ----------
        value : float
            In the unit of the quantity.

        Returns
        -------
        bool
        """
        return value == 0.0 or self.low <= abs(value) <= self.high
