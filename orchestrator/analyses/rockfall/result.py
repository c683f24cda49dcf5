"""The result of a rockfall campaign."""

from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from rockshed.components.slope_rockfall.records import BELOW, OUTCOME, UNFINISHED
from rockshed.components.slope_rockfall.trajectory import MOST_EVENTS

from ...campaigns.campaign import Campaign, TrialRecords
from ...campaigns.files import (
    Envelopes,
    envelope_table,
    envelopes,
    trajectory_table,
    trial_table,
    write_facts,
    write_tables,
    write_trajectories,
)
from ...campaigns.passages import ENDS, LinePassages, line_passages
from ...campaigns.replay import MODES, Replay, check, events_of, replay
from ...campaigns.summary import metrics_of
from ...core.results.metric import Metric
from ...sites.rockfall.preparation import PreparedSlope
from ...tables import Table
from ..frame import FloatArray, Result
from .tables import line_tables, notes, thin_lines


class RockfallResult(Result):
    """Trials of a rockfall campaign, with statistics at lines and barriers and along the profile.

    Attributes
    ----------
    slope : PreparedSlope
        Site, profile and component.
    campaign : Campaign
        Values that all trials share.
    records : TrialRecords
        First passages, largest values and ends of all trials.
    wall_time : float
        Time (s) that the trials took.
    executor : mapping of str to Any
        Number of workers, and the scheduler.
    animated : sequence of int
        Trials of which :meth:`save` writes animations, in the format ``animation``.
    trajectories : int
        Number of trials, from the first on, whose trajectories it writes.
    """

    kind = "rockfall"

    def __init__(
        self,
        slope: PreparedSlope,
        campaign: Campaign,
        records: TrialRecords,
        wall_time: float,
        executor: Mapping[str, Any],
        along: Envelopes | None = None,
    ) -> None:
        super().__init__()
        self.slope = slope
        self.campaign = campaign
        self.records = records
        self.wall_time = wall_time
        self.executor = executor
        self._along = along
        self.animated: tuple[int, ...] = ()
        self.animation = "gif"
        self.trajectories = 0

    @property
    def name(self) -> str:
        """Name of the site, or of its file."""
        return self.slope.name

    @cached_property
    def lines(self) -> list[LinePassages]:
        """Passages of the search lines and barriers, in the order of the site."""
        return line_passages(self.campaign, self.records)

    @cached_property
    def rocks(self) -> FloatArray | None:
        """Rock and start of each trial, shape (trials, len(ROCK)); None where all are the same."""
        rocks = self.campaign.rocks
        return None if rocks is None else rocks.sample(0, self.campaign.trials)

    @cached_property
    def envelopes(self) -> Envelopes:
        """Largest values and percentiles at the stations by quantity and name, NaN for no rock."""
        return self._along or envelopes(self.records)

    def metric_list(self) -> list[Metric]:
        """Return ends of the trials, and each line with mean, deviation and percentiles."""
        return list(metrics_of(self.campaign, self.records, self.lines))

    @property
    def ends(self) -> dict[str, int]:
        """Number of trials by the way in which they end."""
        codes = self.records.outcomes[:, OUTCOME.end].astype(int)
        return {words: int(np.sum(codes == code)) for code, words in ENDS.items()}

    @property
    def summary(self) -> str:
        """Number of trials and of their ends in one line."""
        return f"{self.campaign.trials} trials, {self._listed_ends()}"

    @property
    def warnings(self) -> list[str]:
        """Values of the site that are not usual, and trials that mean nothing, a sentence each."""
        return [*self.slope.warnings, *self._doubtful_ends()]

    def _doubtful_ends(self) -> Iterator[str]:
        unfinished, below = self.ends[ENDS[UNFINISHED]], self.ends[ENDS[BELOW]]
        if unfinished:
            yield (
                f"{unfinished} of {self.campaign.trials} trials are not finished after "
                f"{MOST_EVENTS} events; they count as ended where they were then, and are shown "
                "there: give the ground some roughness, or hardening below 1"
            )
        if below:
            yield (
                f"{below} of {self.campaign.trials} rocks start inside the slope and have no "
                "trajectory: start them higher"
            )

    @property
    def notes(self) -> list[str]:
        """Ends of the trials, and the meaning of the intervals."""
        effort = f"{self.campaign.trials} trials in {self.wall_time:.2f} s"
        heading = f"{effort}, seed {self.campaign.seed}: {self._listed_ends()}"
        remarks = notes(bool(self.lines), self.slope.site.hypercube > 0)
        return [heading, *self.slope.notes, *remarks, *thin_lines(self.lines)]

    def _listed_ends(self) -> str:
        return ", ".join(f"{number} {words}" for words, number in self.ends.items() if number)

    def tables(self) -> list[Table]:
        """Return a table for each line and barrier.

        Returns
        -------
        list of Table
            A row for each quantity: mean, standard deviation, percentiles with their intervals.
        """
        return line_tables(self.lines)

    def to_arrow(self) -> Any:
        """Return a row for each trial.

        Returns
        -------
        pyarrow.Table
            End, largest values, and the first passage of each line; null where there is none.
        """
        return trial_table(self.campaign, self.records, self.rocks)

    def animate(self, trials: Sequence[int], animation: str) -> None:
        """Choose the trials of which :meth:`save` writes animations.

        Parameters
        ----------
        trials : sequence of int
            Their numbers.
        animation : str
            Format, ``mp4`` or ``gif``.
        """
        check(self.campaign, trials)
        self.animated = tuple(dict.fromkeys(trials))
        self.animation = animation

    def replay(self, trial: int, interval: float = 0.02) -> Replay:
        """Compute a trial again, step by step.

        Parameters
        ----------
        trial : int
            Its number.
        interval : float
            Time (s) between two instants.

        Returns
        -------
        Replay
            Motion of the rock over time.
        """
        check(self.campaign, [trial])
        return replay(self.slope, self.campaign, trial, interval)

    def to_trajectories(self, count: int | None = None) -> Any:
        """Return the events of the first trials, between which accelerations are constant.

        Parameters
        ----------
        count : int, optional
            Number of trials; all by default.

        Returns
        -------
        pyarrow.Table
            A row for each event: time, place, velocities, accelerations, mode and cell.
        """
        number = self.campaign.trials if count is None else min(count, self.campaign.trials)
        knots = [events_of(self.campaign, trial) for trial in range(number)]
        return trajectory_table(knots, MODES)

    def write_files(self, folder: Path) -> list[Path]:
        """Write trials, envelopes, summary and ``run.json`` into a folder, and return them."""
        along = envelope_table(self.slope, self.campaign, self.records, self.envelopes)
        facts = {"wall_time": self.wall_time, **self.executor}
        paths = (
            [write_trajectories(self.to_trajectories(self.trajectories), folder)]
            if self.trajectories
            else []
        )
        return [
            *write_tables(self.to_arrow(), along, folder),
            *paths,
            *write_facts(self.slope, self.metric_list(), facts, folder),
        ]
