"""Statuses of the ground other than OK."""

from ..common.stepping import STEPPING_FAULTS

PLATE_OUTSIDE, NO_MASS, NO_RESISTANCE, OVERLOADED, NO_IMPEDANCE, MOVING_AT_START = range(1, 7)
DIVERGED = 20
REFUSALS = {
    PLATE_OUTSIDE: "the plate of plate.radius = {plate.radius} m does not fit into the box of "
    "box.width = {box.width} m: reduce its radius, or set box.width = 0 for open ground",
    NO_MASS: "nothing moves: plate.mass = {plate.mass} kg, the sand (soil.depth = {soil.depth} m, "
    "soil.density = {soil.density} kg/m3) and the body that gave impulse0 = {impulse0} N s "
    "(impulse0.mass = {impulse0.mass} kg) together have no mass: give one of them",
    NO_RESISTANCE: "resistance.start and resistance.end are both 0, and nothing stops the plate: "
    "give one of them",
    OVERLOADED: "preload = {preload} N is more than the ground bears at rest: raise "
    "ultimate_resistance = {ultimate_resistance} N (law smith) or resistance.start = "
    "{resistance.start} N (law mogami)",
    NO_IMPEDANCE: "toe.impedance = {toe.impedance} N s/m: the wave port needs the positive "
    "impedance of its rod: connect it, or set it",
    MOVING_AT_START: "impulse0 = {impulse0} N s needs a plate with mass: law mogami, or the port "
    "settlement",
}
"""Message of each refusal of the initialisation; a name in braces stands for the value of that
variable."""

FAULTS = {
    **STEPPING_FAULTS,
    **REFUSALS,
    DIVERGED: "settlement or work is no longer a finite number (force.y = {force.y} N, "
    "toe.velocity = {toe.velocity} m/s, toe.wave = {toe.wave} N): reduce the exchange step or the "
    "step of the component that computes them",
}
"""Message of each status."""
