"""The pile rod: longitudinal waves in a struck rod or pile, by four schemes."""

from pathlib import Path

from ..common.component import Component
from ..common.shown import Curve, Panel, Picture
from . import kernel
from .declarations import LAYOUT, SIZES

_LIMITS = "(head {head.step_limit} s, toe {toe.step_limit} s)"

COMPONENT = Component(
    name="PileRod",
    title="Pile rod: longitudinal waves in a struck rod, with soil at shaft and toe",
    layout=LAYOUT,
    initialise=kernel.initialise,
    evaluate=kernel.evaluate,
    step=kernel.step,
    folder=Path(__file__).parent,
    sizes=SIZES,
    faults={
        kernel.WAVES_NEED_CHARACTERISTICS: "a port of waves needs the scheme characteristics; masses and springs have ports of "
        "kinematics: change scheme or the port",
        kernel.WAVES_AND_RAM: "ram.mass = {ram.mass} kg takes the place of what acts through a head.port of waves: set ram.mass = "
        "0 or head.port = kinematics",
        kernel.GAUGE_BELOW_TOE: "gauge.depth = {gauge.depth} m is below the toe: give a depth within the rod",
        kernel.STEP_TOO_LONG: "the communication step {exchange_step} s exceeds the limit of the ports, step_limit = {step_limit} "
        "s " + _LIMITS + ": reduce the exchange step, or use waves instead of kinematics",
        kernel.WAVES_UNKNOWN: "the waves of a next step of {exchange_step} s are not known yet, step_limit = {step_limit} s "
        + _LIMITS
        + ": reduce the exchange step below that by time_step = {time_step} s, or to a whole "
        "multiple of time_step",
        kernel.DIVERGED: "the motion is no longer a finite number; internal_step is {internal_step} s and the largest stable one "
        "{stable_step} s: reduce internal_step below that, or, if it is, the exchange step of what acts on it",
    },
    default_step=1e-5,
    pictures=(
        Picture(
            "piles",
            (
                Panel(
                    "force",
                    "kN",
                    (
                        Curve("head.contact_force", "force at the head"),
                        Curve("head.zv", "Z v there", dashed=True),
                        Curve("toe.contact_force", "force at the toe"),
                    ),
                ),
            ),
        ),
    ),
)
