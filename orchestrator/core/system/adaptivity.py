"""The table ``[adaptive]`` of a system: an exchange step that follows the error of the coupling."""

from typing import Literal

from .fields import Seconds, SystemData, Tolerance


class Adaptive(SystemData):
    """An exchange step that follows the error of the coupling.

    The exchange step of the system is the smallest one; the others are 2, 4, 8, ... times as long.

    Attributes
    ----------
    tolerance : float
        Error of one exchange: with ``doubling``, root mean square of the errors of all exchanged
        values, each as a part of the largest value so far of its component and unit; with
        ``ledger``, energy that the couplings have made, as a part of E0.
    largest_step : float
        Longest step (s) that is tried.
    control : str
        ``doubling``: a step is compared with two of half of it, after which all FMUs go back; the
        two are kept. ``ledger``: the energy residual of the last step is looked at, and none is
        taken back.
    """

    tolerance: Tolerance
    largest_step: Seconds
    control: Literal["doubling", "ledger"] = "doubling"
