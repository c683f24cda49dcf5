"""Faults that stop a sand cushion, and what they mean in words."""

from ..common.stepping import MOST_STEPS, STEPPING_FAULTS

(
    LIST_FULL,
    DIVERGED,
    ROCK_INSIDE,
    BEAM_TOO_NARROW,
    BEAM_UNORDERED,
    BEAM_GAPS,
    ROCK_BESIDE,
    DISC_TOO_WIDE,
    TOO_LOOSE,
    TOO_DENSE,
    SMOOTH_BUT_COHESIVE,
    SETTLING_TOO_LONG,
    ROCK_UNDER,
    ROCK_TOO_FAST,
) = range(1, 15)

FAULTS = {
    **STEPPING_FAULTS,
    SETTLING_TOO_LONG: (
        f"the sand would settle in more than {MOST_STEPS:,} steps: reduce settling.time "
        "({settling.time} s), or raise gravity ({gravity} m/s2) for a prepared layer"
    ),
    LIST_FULL: (
        "there is no more room for contact candidates (12 a disc): reduce disc.spread "
        "({disc.spread}) or the overlap of the discs"
    ),
    DIVERGED: (
        "the energy of the discs is no longer a finite number: the internal step "
        "{internal_step} s stands against a stable step of {stable_step} s; reduce "
        "internal_step or the exchange step"
    ),
    ROCK_INSIDE: (
        "the rock starts inside the sand, which reaches up to {surface_height} m under it: raise "
        "the rock's position0.y, at {rock.position.y} m, to that and its radius of {rock.radius} m"
    ),
    ROCK_BESIDE: (
        "the rock starts in or behind a side wall: with its radius of {rock.radius} m at x = "
        "{rock.position.x} m it does not fit into the box from {box.left} m on, {box.width} m "
        "wide; move the rock or widen the box, or give the walls a box.wall_height over which "
        "it comes"
    ),
    ROCK_UNDER: (
        "the rock starts in or under what carries the sand: its centre lies at y = "
        "{rock.position.y} m and its radius is {rock.radius} m; raise its position0.y above the "
        "surface at {surface_height} m by that radius"
    ),
    ROCK_TOO_FAST: (
        "the rock, at {rock.velocity.x} m/s to the right and {rock.velocity.y} m/s upwards, moves "
        "on by more than the radius of a sand disc, {disc.radius} m, between two looks at its "
        "contacts and would jump over them: reduce its velocity or the exchange step"
    ),
    DISC_TOO_WIDE: (
        "a sand disc of radius {disc.radius} m (spread {disc.spread}) does not fit into the "
        "box, which is {box.width} m wide: make the discs smaller or the box wider"
    ),
    TOO_LOOSE: (
        "the sand cannot lie as loosely as solid_fraction = {solid_fraction}: with its friction "
        "it falls to {layer.solid_fraction}; ask for that, raise friction_angle, "
        "rolling_resistance or cohesion, or take packing = random"
    ),
    TOO_DENSE: (
        "the sand cannot be packed as densely as solid_fraction = {solid_fraction}: it reaches "
        "{layer.solid_fraction}; ask for less, or raise disc.spread"
    ),
    SMOOTH_BUT_COHESIVE: (
        "cohesion = {cohesion} Pa needs friction: its capillary force has tan(phi) below the "
        "line, and friction_angle is 0; give it a value, or cohesion = 0"
    ),
    BEAM_TOO_NARROW: (
        "the beam is narrower than the cushion, whose box begins at box.left = {box.left} m and "
        "is box.width = {box.width} m wide: make the beam longer, move the box or set base = "
        "floor"
    ),
    BEAM_GAPS: (
        "there are gaps between the beam discs: beam.radius = {beam.radius} m is less than half "
        "the distance of their centres; set it to half that distance, or set base = "
        "beam_surface"
    ),
    BEAM_UNORDERED: (
        "the beam discs must follow each other from left to right (beam.position.x[i] ascending)"
    ),
}
"""Message of each fault; a name in braces stands for the value of that variable."""

DEFERRED = frozenset(
    {ROCK_INSIDE, ROCK_BESIDE, ROCK_UNDER, BEAM_UNORDERED, BEAM_GAPS, BEAM_TOO_NARROW}
)
"""Faults of inputs, which may still change before the first step."""
