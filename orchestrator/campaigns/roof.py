"""Rocks of a campaign at a roof with a cushion: the box around it, and where each rock strikes.

Frame: that of the profile. From the box on a rock is in free flight until it touches the cushion,
so the strike follows from the arrival in closed form.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rockshed.components.slope_rockfall.declarations import LAYOUT
from rockshed.components.slope_rockfall.records import ARRIVAL, ROCK

from ..sites.rockfall.profile import Node
from ..sites.rockfall.start_check import distance
from ..sites.shed.geometry import WALL_THICKNESS
from .arrivals import Receiver
from .campaign import Campaign

_MARGIN = 0.05
"""Distance (m) by which the box keeps away from what is outside of the walls."""
_DEPTH = 1.0
"""Depth (m) of the box under the roof's top: a roof that bends farther is broken through."""
_ABOVE = 0.25
"""Distance of the lowest rock from the cushion at the upper side of the box / thickness: single
discs of sand stand out by 0.18 of it at most."""
_STEP = 0.01
"""Distance (m) of the places at which the box is compared with the ground."""
_ROUNDING = 1e-6
"""Depth (m) in the ground that is rounding."""
_LEVEL = 0.1
"""Depth under the cushion's surface / radius at which a rock that comes from the side still rolls
onto it."""

_Floats = NDArray[np.float64]


@dataclass(frozen=True)
class CushionOnProfile:
    """A cushion in the frame of the profile.

    Attributes
    ----------
    left, right : float
        Its ends (m).
    roof, surface : float
        y of its lower and upper side (m).
    """

    left: float
    right: float
    roof: float
    surface: float

    def ground_above(self, nodes: Sequence[Node]) -> float:
        """Return how far the profile stands out of the cushion's surface (m); 0 or less: not."""
        inner = [node.x for node in nodes if self.left < node.x < self.right]
        heights = _surface(nodes, np.array([self.left, *inner, self.right]))
        return float(heights.max()) - self.surface


def _surface(nodes: Sequence[Node], x: _Floats) -> _Floats:
    """Return the height of the profile at places (m)."""
    return np.interp(x, [node.x for node in nodes], [node.y for node in nodes])


def receiver_of(cushion: CushionOnProfile, nodes: Sequence[Node], radius: float) -> Receiver:
    """Return the box in which rocks are handed over to a cushion.

    It reaches to the outer faces of the walls, and beyond them where the ground is so low that a
    rock falls clear of the roof; it ends where a rock on the cushion would touch the ground.

    Parameters
    ----------
    cushion : CushionOnProfile
        Over which no ground stands out.
    nodes : sequence of Node
        Of the profile.
    radius : float
        Of the largest rock (m).
    """
    return Receiver(
        left=_side(cushion, nodes, radius, -1.0),
        bottom=cushion.roof - _DEPTH,
        right=_side(cushion, nodes, radius, 1.0),
        top=cushion.surface + radius + _ABOVE * (cushion.surface - cushion.roof),
    )


def _side(
    cushion: CushionOnProfile, nodes: Sequence[Node], radius: float, outwards: float
) -> float:
    """Return x of the side of the box towards the left (-1) or the right (1)."""
    end = cushion.right if outwards > 0.0 else cushion.left
    face = end + outwards * WALL_THICKNESS
    clear = face + outwards * (radius + _MARGIN)
    beyond = _surface(nodes, np.linspace(face, clear, 50))
    if beyond.max() + radius <= cushion.roof - _DEPTH:
        return clear
    outer = face - outwards * _MARGIN
    steps = np.arange(0.0, WALL_THICKNESS + 2.0 * radius, _STEP)
    places = outer - outwards * steps
    depth = radius - distance(nodes, places, np.full(len(places), cushion.surface + radius))
    inside = np.flatnonzero(depth > _ROUNDING)
    return float(places[min(inside[-1] + 1, len(places) - 1)]) if len(inside) else outer


# --- strikes ---


@dataclass(frozen=True)
class Strikes:
    """Rocks of a campaign that strike a cushion, a radius or more from its ends.

    Attributes
    ----------
    trials : int
        Of the campaign.
    number : array of int, shape (n,)
        Trial of each rock.
    delay : array of float, shape (n,)
        Time (s) from the hand-over to the strike.
    x : array of float, shape (n,)
        Place of the centre (m).
    velocity_x, velocity_y : array of float, shape (n,)
        To the right, and downwards (m/s).
    omega : array of float, shape (n,)
        Angular velocity, counter-clockwise (rad/s).
    energy : array of float, shape (n,)
        Kinetic energy, of rotation too (J).
    mass, radius : array of float, shape (n,)
        Of the rock (kg, m).
    on_ends, beyond, below : int
        Numbers of rocks that strike nearer to an end; that come by over the cushion; and that come
        from the side, below its surface.
    """

    trials: int
    number: NDArray[np.int64]
    delay: _Floats
    x: _Floats
    velocity_x: _Floats
    velocity_y: _Floats
    omega: _Floats
    energy: _Floats
    mass: _Floats
    radius: _Floats
    on_ends: int
    beyond: int
    below: int

    @property
    def speed(self) -> _Floats:
        """Speed of the centre (m/s), shape (n,)."""
        return np.hypot(self.velocity_x, self.velocity_y)

    @property
    def elsewhere(self) -> int:
        """Number of trials whose rock does not come to the box."""
        return self.trials - len(self.number) - self.on_ends - self.beyond - self.below


def bodies_of(campaign: Campaign) -> tuple[_Floats, _Floats]:
    """Return mass (kg) and radius (m) of the rock of each trial.

    Parameters
    ----------
    campaign : Campaign
        The campaign.
    """
    if campaign.rocks is None:
        w = campaign.w
        mass, radius = (float(w[getattr(LAYOUT.scalar, name)]) for name in ("mass", "radius"))
        return np.full(campaign.trials, mass), np.full(campaign.trials, radius)
    rocks = campaign.rocks.sample(0, campaign.trials)
    return rocks[:, ROCK.mass], rocks[:, ROCK.radius]


def strikes_of(campaign: Campaign, arrived: _Floats, cushion: CushionOnProfile) -> Strikes:
    """Return where the rocks of a campaign strike a cushion.

    Parameters
    ----------
    campaign : Campaign
        The campaign.
    arrived : array of float, shape (trials, len(ARRIVAL))
        Its rocks at the box around the cushion.
    cushion : CushionOnProfile
        The cushion.

    Returns
    -------
    Strikes
    """
    mass, radius = bodies_of(campaign)
    gravity = float(campaign.w[LAYOUT.scalar.gravity])
    came = arrived[:, ARRIVAL.arrived] > 0.0
    above = arrived[:, ARRIVAL.y] - cushion.surface - radius
    level = came & (above >= -_LEVEL * radius)  # the first strike on the cushion is what counts
    height = np.where(level, np.maximum(above, 0.0), 0.0)
    upwards = arrived[:, ARRIVAL.vy]
    velocity_y = np.sqrt(upwards**2 + 2.0 * gravity * height)
    delay = (upwards + velocity_y) / gravity
    x = arrived[:, ARRIVAL.x] + arrived[:, ARRIVAL.vx] * delay
    over = level & (cushion.left <= x) & (x <= cushion.right)
    clear = over & (cushion.left + radius < x) & (x < cushion.right - radius)
    return Strikes(
        campaign.trials,
        np.flatnonzero(clear),
        delay[clear],
        x[clear],
        arrived[clear, ARRIVAL.vx],
        velocity_y[clear],
        arrived[clear, ARRIVAL.omega],
        (arrived[:, ARRIVAL.kinetic] + mass * gravity * height)[clear],
        mass[clear],
        radius[clear],
        on_ends=int((over & ~clear).sum()),
        beyond=int((level & ~over).sum()),
        below=int((came & ~level).sum()),
    )
