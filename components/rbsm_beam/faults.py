"""Statuses of the beam other than OK."""

from ..common.stepping import STEPPING_FAULTS

DIVERGED, BOX_OFF_BEAM, NO_PLACE, BAD_CORNERS, NO_REST, BAD_SPRING = range(1, 7)

FAULTS = {
    **STEPPING_FAULTS,
    BOX_OFF_BEAM: "the box, from box.left = {box.left} m on, {box.width} m wide, does not stand "
    "within the span from axis.x = {axis.x} m on, {span} m long, and has mass or sand in it: give "
    "box.left and box.width, or box.mass = 0 and cushion.weight = 0",
    NO_PLACE: "support.element: every support from number 3 on needs a disc of its own to stand "
    "under, a whole number from 1 (left) to the number of elements, and supports 1 and 2, which "
    "are the ends, have 0: give support.element[3] and on",
    BAD_CORNERS: "section.bending is yielding, and the corners of its moment-curvature line make "
    "none: moments {section.corner1.moment}, {section.corner2.moment}, {section.corner3.moment} "
    "N.m at curvatures section.corner1.moment/EI, {section.corner2.curvature}, "
    "{section.corner3.curvature} 1/m, then section.hardening_ratio = {section.hardening_ratio}; "
    "give section.corner1.moment > 0 and, for every further corner, a larger curvature and no "
    "smaller moment, so that the slope never rises (0 and 0 leave a corner out); hogging moments "
    "{section.corner1.hogging_moment}, {section.corner2.hogging_moment}, "
    "{section.corner3.hogging_moment} N.m are given for all of these corners or for none, and do "
    "not fall",
    BAD_SPRING: "elastic supports and support.stiffness belong together, and support.stiffness is "
    "{support.stiffness} N/m: give supports = elastic and a stiffness above 0, or none",
    NO_REST: "the section yields under the weights at the start and does not come to rest with "
    "them: section.corner1.moment is {section.corner1.moment} N.m, and past the last corner "
    "section.hardening_ratio = {section.hardening_ratio}; give a stronger section, or less "
    "cushion.weight and mass",
    DIVERGED: "the beam diverged: a displacement exceeds half the span ({span} m) or is no longer "
    "a number (midspan deflection {midspan.deflection} m, transmitted force {transmitted_force} "
    "N); internal_step is {internal_step} s and the largest stable one {stable_step} s: reduce "
    "internal_step below that, or, if it is, the exchange step of the component that computes the "
    "forces",
}
"""Message of each status; a name in braces stands for the value of that variable."""
