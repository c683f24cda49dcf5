"""One trial again, by itself: the component stepped through it, instant by instant."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rockshed.components.slope_rockfall.trajectory import OUTCOME

from ...core.errors import InputRefused, Problem
from .campaign import compute
from .preparation import Prepared
from .results import ENDS

MODES = ("in flight", "rolling", "sliding", "spinning", "at rest", "handed over")
_OUTPUTS = {
    "x": "position.x",
    "y": "position.y",
    "angle": "angle",
    "vx": "velocity.x",
    "vy": "velocity.y",
    "mode": "mode",
    "height": "height",
    "energy": "energy.kinetic",
}


@dataclass(frozen=True)
class Replay:
    """A trial at evenly spaced times, and at its end: arrays (n,) in SI units. end: how it ended, in words."""

    number: int
    end: str
    time: NDArray[np.float64]
    x: NDArray[np.float64]
    y: NDArray[np.float64]
    angle: NDArray[np.float64]
    vx: NDArray[np.float64]
    vy: NDArray[np.float64]
    mode: NDArray[np.float64]
    height: NDArray[np.float64]
    energy: NDArray[np.float64]

    @property
    def speed(self) -> NDArray[np.float64]:
        """Speed of the centre (m/s)."""
        return np.hypot(self.vx, self.vy)


def check(made: Prepared, number: int) -> None:
    """Refuse a trial that the campaign has not.

    Raises:
        InputRefused: there is no trial of this number.
    """
    if not 0 <= number < made.campaign.trials:
        raise InputRefused(
            [
                Problem(
                    f"--replay {number}",
                    "the campaign has no such trial",
                    f"choose one from 0 to {made.campaign.trials - 1}",
                )
            ]
        )


def replay(made: Prepared, number: int, interval: float) -> Replay:
    """Trial ``number`` every ``interval`` seconds until it ends. The bits are those of the campaign."""
    outcome = compute(made.campaign, number, 1).outcomes[0]
    rock = made.instance.component.instance(**made.instance.sizes)
    rock.w[:] = made.campaign.w
    rock["trial"] = number
    rock.initialise()
    end = float(outcome[OUTCOME.time])
    times = np.append(np.arange(0.0, end, interval), end)
    rows = np.empty((len(times), len(_OUTPUTS)))
    places = [rock.references[name] for name in _OUTPUTS.values()]
    rows[0] = rock.w[places]
    for i in range(1, len(times)):
        rock.step(times[i - 1], times[i] - times[i - 1])
        rows[i] = rock.w[places]
    return Replay(
        number, ENDS[int(outcome[OUTCOME.end])], times, **dict(zip(_OUTPUTS, rows.T, strict=True))
    )
