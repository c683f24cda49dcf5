"""Statuses of the pile rod other than OK."""

from ..common.stepping import MOST_STEPS, TOO_MANY_STEPS

(
    WAVES_NEED_CHARACTERISTICS,
    WAVES_AND_RAM,
    GAUGE_BELOW_TOE,
    STEP_TOO_LONG,
    WAVES_UNKNOWN,
    DIVERGED,
) = range(1, 7)

_LIMITS = "(head {head.step_limit} s, toe {toe.step_limit} s)"

FAULTS = {
    TOO_MANY_STEPS: f"the communication step holds more than {MOST_STEPS:,} internal steps of "
    "time_step = {time_step} s: reduce the communication step, the segments or the modulus",
    WAVES_NEED_CHARACTERISTICS: "a port of waves needs the scheme characteristics; masses and "
    "springs have ports of kinematics: change scheme or the port",
    WAVES_AND_RAM: "ram.mass = {ram.mass} kg takes the place of what acts through a head.port of "
    "waves: set ram.mass = 0 or head.port = kinematics",
    GAUGE_BELOW_TOE: "gauge.depth = {gauge.depth} m is below the toe: give a depth within the rod",
    STEP_TOO_LONG: "the communication step {exchange_step} s exceeds the limit of the ports, "
    "step_limit = {step_limit} "
    "s " + _LIMITS + ": reduce the exchange step, or use waves instead of kinematics",
    WAVES_UNKNOWN: "the waves of a next step of {exchange_step} s are not known yet, step_limit = "
    "{step_limit} s "
    + _LIMITS
    + ": reduce the exchange step below that by time_step = {time_step} s, or to a whole "
    "multiple of time_step",
    DIVERGED: "the motion is no longer a finite number; internal_step is {internal_step} s and the "
    "largest stable one {stable_step} s: reduce internal_step below that, or, if it is, the "
    "exchange step of what acts on it",
}
"""Message of each status; a name in braces stands for the value of that variable."""
