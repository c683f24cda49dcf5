"""The result of the blows on a pile."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rockshed.components.common.units import mm

from ...core.results.metric import Metric
from ...sites.pile.preparation import PreparedPile
from ...tables import Table
from ..frame import Result
from .blows import BearingPoint, Blow
from .drivability import Stage
from .files import (
    bearing_table,
    drivability_table,
    envelope_table,
    rods_table,
    trace_table,
    write_facts,
    write_tables,
)
from .rods import RodBlow
from .summary import metrics_of
from .tables import (
    blow_table,
    graph_tables,
    in_words,
    limit_warnings,
    notes,
    rod_table,
    stage_table,
    unverified,
    warnings,
)


class PileResult(Result):
    """Blows on a pile, one after the other, its bearing graph and its drivability.

    Attributes
    ----------
    pile : PreparedPile
        Site, from which hammer and rod are made.
    blows : sequence of Blow
        One after the other.
    graph : sequence of BearingPoint
        First and last blow for each resistance of the bearing graph.
    stages : sequence of Stage
        Penetrations of the drivability analysis.
    wall_time : float
        Time (s) that the blows took.
    rods : sequence of RodBlow
        Blows of a penetration test on rods of several lengths.
    """

    kind = "pile"

    def __init__(
        self,
        pile: PreparedPile,
        blows: Sequence[Blow],
        graph: Sequence[BearingPoint],
        stages: Sequence[Stage],
        wall_time: float,
        rods: Sequence[RodBlow] = (),
    ) -> None:
        super().__init__()
        self.pile = pile
        self.blows = tuple(blows)
        self.graph = tuple(graph)
        self.stages = tuple(stages)
        self.rods = tuple(rods)
        self.wall_time = wall_time

    @property
    def name(self) -> str:
        """Name of the site, or of its file."""
        return self.pile.name

    def metric_list(self) -> list[Metric]:
        """Return the values of each blow, and of the whole."""
        return list(metrics_of(self.pile, self.blows, self.graph, self.stages, self.rods))

    @property
    def summary(self) -> str:
        """Number of blows and penetration in one line."""
        total = sum(blow.set for blow in self.blows)
        graph = f", bearing graph of {len(self.graph)} resistances" if self.graph else ""
        depths = f", {len(self.stages)} penetrations" if self.stages else ""
        return f"{in_words(self.blows)}, penetration {total / mm:.1f} mm{graph}{depths}"

    @property
    def every_blow(self) -> list[Blow]:
        """All blows, those of the bearing graph and of the drivability too."""
        points = [blow for point in self.graph for blow in (point.first, point.last)]
        stages = [stage.blow for stage in self.stages if stage.blow]
        return [*self.blows, *points, *stages, *(rod.blow for rod in self.rods)]

    @property
    def notes(self) -> list[str]:
        """Energies and times, and the error of the energy balance."""
        return notes(self.pile, self.blows, self.every_blow, self.wall_time)

    @property
    def warnings(self) -> list[str]:
        """Values of the site that are not usual, and doubts about the blows, a sentence each."""
        return [
            *self.pile.warnings,
            *unverified(self.pile),
            *warnings(self.every_blow),
            *limit_warnings(self.pile, self.blows, self.stages),
        ]

    def tables(self) -> list[Table]:
        """Return the blows, the bearing graph and the drivability where the site has them.

        Returns
        -------
        list of Table
            A row for each blow: set, blow count, forces, stresses, energies.
        """
        tables = [blow_table(self.pile, self.blows)]
        if self.graph:
            tables += graph_tables(self.pile, self.graph)
        if self.stages:
            tables.append(stage_table(self.stages))
        if self.rods:
            tables.append(rod_table(self.rods))
        return tables

    def to_arrow(self) -> Any:
        """Return the traces of all blows, one after the other.

        Returns
        -------
        pyarrow.Table
            Time (s), number of the blow, forces (N) and displacements (m) of head, gauge and toe.
        """
        return trace_table(self.blows)

    def write_files(self, folder: Path) -> list[Path]:
        """Write traces, envelopes, bearing graph, drivability and the facts into a folder."""
        tables = {"traces": self.to_arrow(), "envelopes": envelope_table(self.pile, self.blows)}
        if self.graph:
            tables["bearing"] = bearing_table(self.pile, self.graph)
        if self.stages:
            tables["drivability"] = drivability_table(self.stages)
        if self.rods:
            tables["rods"] = rods_table(self.rods)
        return [
            *write_tables(tables, folder),
            *write_facts(self.pile, self.metric_list(), self.wall_time, folder),
        ]
