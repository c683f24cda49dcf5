"""Records of a trial: columns of the tables that a campaign keeps. Reading them needs no numba."""

from collections import namedtuple

RESTED, PASSED_RIGHT, PASSED_LEFT, UNFINISHED, BELOW, STOPPED = range(6)
"""Ends of a trial: at rest, beyond the right or left end, not within the events allowed, not at all
for it starts below, or stopped by a barrier."""
Passage = namedtuple("Passage", "time x y height speed omega kinetic count vx vy")
PASSAGE = Passage(*range(10))
"""Columns of the first passage of a search line (s, m, m/s, rad/s, J), number of passages, and
components of the velocity (m/s)."""
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
Rock = namedtuple("Rock", "mass radius moment_of_inertia elongation x y vx vy omega angle")
ROCK = Rock(*range(10))
"""Columns of a rock with its start, where they are not the same in all trials: kg, m, kg m2,
a / b; place of the centre (m), velocity (m/s), angular velocity (rad/s) and angle (rad)."""
Knot = namedtuple("Knot", "time x y angle vx vy omega ax ay alpha mode cell")
KNOT = Knot(*range(12))
"""Columns of an event on a trajectory: the motion just after it, with the accelerations (m/s2,
rad/s2) that last until the next one, the mode of motion, and the number of the cell, from 1."""
Arrival = namedtuple("Arrival", "arrived time x y vx vy omega kinetic")
ARRIVAL = Arrival(*range(8))
"""Columns of the first hand-over of a trial: 1, or 0 of a trial that ends before; time (s), place
of the centre (m), velocity (m/s), angular velocity (rad/s), kinetic energy (J)."""
