"""Records of a trial: columns of the tables that a campaign keeps. Reading them needs no numba."""

from collections import namedtuple

RESTED, PASSED_RIGHT, PASSED_LEFT, UNFINISHED, BELOW, STOPPED = range(6)
"""Ends of a trial: at rest, beyond the right or left end, not within the events allowed, not at all
for it starts below, or stopped by a barrier."""
Passage = namedtuple("Passage", "time x y height speed omega kinetic count")
PASSAGE = Passage(*range(8))
"""Columns of the first passage of a search line (s, m, m/s, rad/s, J), and number of passages."""
Barrier = namedtuple("Barrier", "reach capacity")
BARRIER = Barrier(*range(2))
"""Columns of a search line as a barrier: it stops a rock that passes it not farther than ``reach``
(m) from its first point, with no more kinetic energy than its capacity (J). A negative reach: it
stops none."""
Peak = namedtuple("Peak", "height speed kinetic")
PEAK = Peak(*range(3))
"""Largest values at a station; negative where the rock did not come by."""
Outcome = namedtuple(
    "Outcome", "end x y time impacts events height speed kinetic limit_speed barrier"
)
OUTCOME = Outcome(*range(11))
"""Columns of a trial: how and where it ended (m), numbers of impacts and events, the largest values
on the way (m, m/s, J), V_lim (m/s), and the number of the search line that stopped it, or -1."""
