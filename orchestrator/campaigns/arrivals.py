"""Rocks of a campaign at a receiver: where and how fast each is handed over for the first time.

A receiver changes nothing of a trial until then, so a rock arrives with the bits of its campaign.
"""

import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rockshed.components.slope_rockfall.declarations import BODY, LAYOUT
from rockshed.components.slope_rockfall.records import ARRIVAL
from rockshed.components.slope_rockfall.trajectory import arrivals

from .campaign import BLOCK, Campaign, own_buffers

V = LAYOUT.scalar


@dataclass(frozen=True)
class Receiver:
    """A box in which rocks are handed over, in the frame of the profile.

    Attributes
    ----------
    left, bottom, right, top : float
        Its sides (m).
    """

    left: float
    bottom: float
    right: float
    top: float


def arrivals_of(
    campaign: Campaign, receiver: Receiver, workers: int | None = None
) -> NDArray[np.float64]:
    """Compute all trials of a campaign up to a receiver.

    Parameters
    ----------
    campaign : Campaign
        With its barriers: a rock that one of them has stopped does not arrive.
    receiver : Receiver
        The box.
    workers : int, optional
        Number of threads; by default one for each core.

    Returns
    -------
    array of float, shape (trials, len(ARRIVAL))
    """
    found = np.empty((campaign.trials, len(ARRIVAL)))
    with ThreadPoolExecutor(workers or os.cpu_count() or 1) as pool:
        blocks = [
            pool.submit(_compute, campaign, receiver, first, found)
            for first in range(0, campaign.trials, BLOCK)
        ]
        for block in blocks:
            block.result()
    return found


def _compute(
    campaign: Campaign, receiver: Receiver, first: int, found: NDArray[np.float64]
) -> None:
    """Compute a block of trials into its rows."""
    rows = found[first : first + BLOCK]
    w, x, k, rocks = own_buffers(campaign, first, len(rows))
    w = w.copy()
    w[V.receiver_present] = 1.0
    w[V.receiver_left], w[V.receiver_right] = receiver.left, receiver.right
    w[V.receiver_bottom], w[V.receiver_top] = receiver.bottom, receiver.top
    where = (campaign.left, campaign.right, campaign.lines, campaign.barriers)
    arrivals(campaign.seed, first, *where, rocks, w, x, k, np.zeros(len(BODY)), rows)
