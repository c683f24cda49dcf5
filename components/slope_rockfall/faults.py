"""Statuses of the rock on a slope other than OK."""

from ..common.stepping import STEPPING_FAULTS

FOLDED, STEEP, ROUGH, LOCKED, ROUGHNESS_SIGN, TILT_SIGN = range(1, 7)
"""Faults of a cell, by number."""
LIMIT_SIGN, RECEIVER_EMPTY, START_BELOW = range(7, 10)
FORCE_OUTSIDE, LEFT_BELOW, DIVERGED, RESTLESS, NEVER_RECEIVED = range(20, 25)

RULES = {
    FOLDED: "its right node must lie to the right of its left node, a profile runs from left to "
    "right without folding back: order the nodes by x and remove repeated ones",
    STEEP: "it is steeper than 89.9 degrees; a vertical face needs some horizontal length: move "
    "one of its nodes",
    ROUGH: "roughness with its deviation reaches 2, the whole rock: reduce one of them",
    LOCKED: "mu tan(phi) with the largest roughness is 1 or more, and a sliding rock has no "
    "equation of motion: reduce friction, roughness or its deviation",
    ROUGHNESS_SIGN: "only a positive roughness has a lognormal distribution: choose another "
    "roughness.distribution",
    TILT_SIGN: "only a positive tilt has a lognormal distribution: choose another "
    "tilt.distribution",
}
"""Message of each fault of a cell: its reason, and the remedy."""
_FACTS = {
    FOLDED: "end.x[{fault.cell}] = {fault.value} m",
    STEEP: "end.x[{fault.cell}] = {fault.value} m",
    TILT_SIGN: "tilt[{fault.cell}] = {fault.value}",
    ROUGHNESS_SIGN: "roughness[{fault.cell}] = {fault.value}",
    ROUGH: "roughness[{fault.cell}] = {fault.value}, largest {fault.roughness}",
    LOCKED: "friction[{fault.cell}] = {fault.value}, roughness[{fault.cell}] up to "
    "{fault.roughness}, mu tan(phi) = {fault.locking}",
}

_OF_CELLS = {
    fault: f"cell {{fault.cell}} ({_FACTS[fault]}): {rule}" for fault, rule in RULES.items()
}
_OF_THE_ROCK = {
    LIMIT_SIGN: "limit_speed.mean = {limit_speed.mean} m/s: only a positive one has a lognormal "
    "distribution: choose another limit_speed.distribution",
    RECEIVER_EMPTY: "the receiver is empty: receiver.left = {receiver.left} m must be less than "
    "receiver.right = {receiver.right} m, and receiver.bottom = {receiver.bottom} m less than "
    "receiver.top = {receiver.top} m",
    START_BELOW: "the rock starts below the surface: its lowest point is at {height} m along the "
    "normal of cell {cell}; raise position0.y = {position0.y} m or set on_slope",
    FORCE_OUTSIDE: "a force ({force.x}, {force.y}) N, {torque} N m acts on the rock at "
    "({position.x}, {position.y}) m, which is not handed over: enlarge the receiver until it "
    "contains all that can touch the rock",
    LEFT_BELOW: "the rock has left the receiver at ({position.x}, {position.y}) m and is below "
    "the slope's surface (height {height} m): let the receiver end where what is in it meets the "
    "slope",
    DIVERGED: "the position is no longer a finite number; the force on the rock was ({force.x}, "
    "{force.y}) N: reduce the exchange step or the step of the component that computes it",
    NEVER_RECEIVED: "trial {trial} of seed {seed} never enters the receiver, and lead_time counts "
    "from there: choose another trial or receiver, or leave lead_time out",
    RESTLESS: "a million events in one step, at ({position.x}, {position.y}) m: give cell {cell} "
    "some roughness, or hardening below 1",
}
FAULTS = STEPPING_FAULTS | _OF_CELLS | _OF_THE_ROCK
"""Message of each status; a name in braces stands for the value of that variable."""
