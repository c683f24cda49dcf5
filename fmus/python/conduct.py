"""How a slave behaves: when it takes a call, and the sentences in which it refuses one.

Declared once for both runtimes. The slave in Python uses this as it is; the slave in C gets it in
``model.h``. Sentences are formats of printf, which Python's ``%`` understands too.
"""

from dataclasses import dataclass
from enum import IntEnum


class Phase(IntEnum):
    """The stretches of a slave's life, by the number that stands in serialized states."""

    INSTANTIATED = 1
    INITIALISING = 2
    RUNNING = 3
    TERMINATED = 4
    FAILED = 5


SETTLED = 16
"""Is added to the number of the initialisation mode in a serialized state whose outputs are
computed: what has settled is not computed again after the state is restored."""


class Stale(IntEnum):
    """The parts that must be computed before an output is read in initialization mode."""

    NOTHING = 0
    OUTPUTS = 1
    STATE = 2


@dataclass(frozen=True)
class Call:
    """A call that belongs to phases: its name in messages, and the phases in which it is legal."""

    name: str
    phases: tuple[Phase, ...]


SET_UP = Call("set up the experiment", (Phase.INSTANTIATED,))
ENTER = Call("enter the initialization mode", (Phase.INSTANTIATED,))
EXIT = Call("exit the initialization mode", (Phase.INITIALISING,))
TERMINATE = Call("terminate", (Phase.RUNNING,))
SET = Call("set a variable", (Phase.INSTANTIATED, Phase.INITIALISING, Phase.RUNNING))
STEP = Call("step", (Phase.RUNNING,))
CALLS = {
    "SET_UP": SET_UP,
    "ENTER": ENTER,
    "EXIT": EXIT,
    "TERMINATE": TERMINATE,
    "SET": SET,
    "STEP": STEP,
}
"""Every call that is refused in some phase, by its name in C. All others are always legal."""

LOG_CATEGORIES = {
    "logStatusWarning": "something that deserves attention; the simulation can go on",
    "logStatusError": "a call was refused or has failed; the message names the variable, its value "
    "and a remedy",
}
"""Categories of the messages that a slave logs. pythonfmu's binary compares names only, so
``logAll`` would select nothing."""

TO_INITIALISE = {
    2: "set up the experiment, then enter and exit the initialization mode",
    3: "enter and exit the initialization mode",
}
"""The calls that initialise a slave, by the version of FMI."""
NOT_INITIALISED = "the slave is not initialised: "
"""Why calls are refused before the initialisation; the calls that initialise follow."""
REMEDIES = {
    Phase.INSTANTIATED: NOT_INITIALISED + TO_INITIALISE[2],
    Phase.INITIALISING: "the initialization mode is not finished: exit it first",
    Phase.RUNNING: "the slave is initialised already: reset it first",
    Phase.TERMINATED: "the slave is terminated: reset it first",
    Phase.FAILED: "an earlier call was refused or has failed, see the log: reset the slave or "
    "restore an earlier state",
}
"""Why a call is refused in a phase that is not its own, and what to do."""

SENTENCES = {
    "NOT_NOW": "cannot %s: %s",
    "TIMES": "start time = %s s, stop time = %s s: the start must be a finite number, and the stop "
    "not before it",
    "NO_START": "the start time is unknown: set up the experiment before entering the "
    "initialization mode",
    "UNSTABLE": "internal_step = %s s exceeds stable_step = %s s: the integration will be "
    "unstable; reduce internal_step to %s s or less",
    "STEP_REFUSED": "the step of %s s from t = %.9g s is refused: %s",
    "NO_LENGTH": "its length must be a positive number",
    "ELSEWHERE": "the slave is at t = %.9g s; steps follow one another, and only a restored state "
    "leads elsewhere",
    "BEYOND_STOP": "it passes the stop time %.9g s that the experiment was set up with",
    "STEP_FAILED": "at t = %.9g s %s",
    "NO_REFERENCE": "value reference %u is unknown: allowed is 0 to %d; take it from this FMU's "
    "modelDescription.xml",
    "OTHER_TYPE": "%s is of type %s, not %s: use the call of its type",
    "OUTPUT_SET": "%s = %s is refused: it is an output, which the component computes; set "
    "parameters or inputs",
    "FIXED": "%s = %s is refused: a parameter is fixed after the initialisation; reset the slave "
    "to change it",
    "BAD_INPUT": "at t = %.9g s: %s; correct what sends this value",
    "DEFERRED": "%s; the first step is refused while that holds",
    "NOT_VALID_YET": "the outputs are not valid yet: %s",
    "IMPOSSIBLE_PHASE": "its phase is %u",
    "IMPOSSIBLE_TIME": "its time is %s s",
    "DAMAGED": "this is no serialized state of a rockshed FMU, or it is damaged: restore another "
    "one",
}
"""Sentences of both slaves by their name in C. Numbers that are no times are written by
:func:`number` beforehand."""


def say(sentence: str, *values: object) -> str:
    """Return a sentence with values in it.

    Parameters
    ----------
    sentence : str
        Key of :data:`SENTENCES`.
    *values : object
        In the order of the format.

    Returns
    -------
    str
        The text.
    """
    return SENTENCES[sentence] % values


def number(value: float) -> str:
    """Return a number as messages of both slaves show it.

    Parameters
    ----------
    value : float
        The number; it need not be finite.

    Returns
    -------
    str
        Six significant digits.
    """
    return f"{value:.6g}"
