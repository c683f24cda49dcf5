"""Verification of a run: it is run again, and every bit is compared."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..core import continuing
from ..core.continuing import system_of
from ..core.errors import InputRefused, Problem, RunFailed
from ..core.loop.master import Progress
from ..core.results.bits import Difference, first_difference
from ..core.results.changes import changes_of
from ..core.results.checkpoints import read_settled
from ..core.results.reading import StoredRun
from ..core.run import simulate as simulate_spec
from ..core.system.planning import make_plan
from ..temporary import TemporaryFolder
from .continuing import sources_of_run
from .run import Run, read_run
from .system import System


@dataclass(frozen=True)
class Verification:
    """The comparison of a run with itself.

    Attributes
    ----------
    run : Run
        The run.
    difference : Difference or None
        First value that was another one the second time: ``what``, ``time`` (s), ``value`` and
        ``again``; None where every bit was the same.
    """

    run: Run
    difference: Difference | None

    def __bool__(self) -> bool:
        return self.difference is None

    def __str__(self) -> str:
        if self.difference is not None:
            return f"differs: {self.difference}"
        compared = ", ".join(f"{n:,} {word}" for word, n in self.counts.items())
        return f"verified: the same to the bit ({compared})"

    @property
    def counts(self) -> dict[str, int]:
        """Number of rows and columns, and of recorded states."""
        components = self.run.provenance.get("components") or {}
        states = sum(1 for name in components for _ in self.run.states(name))
        columns = len(self.run.columns)
        return {"rows": self.run.time.size, "columns": columns, "recorded states": states}


def verify(
    run: StoredRun | str | Path,
    *,
    system: System | None = None,
    progress: Progress | None = None,
) -> Verification:
    """Run the system of a run again, and compare rows, recorded states and metrics to the bit.

    Parameters
    ----------
    run : Run, str or Path
        A complete run, or its folder. Everything that it follows from stands in ``run.json``.
    system : System, optional
        For a run with components of one's own in its process: the same system.
    progress : callable, optional
        Called with the time reached and the stop time (s), every now and then.

    Returns
    -------
    Verification
        True where every bit is the same; else it tells the first difference.

    Raises
    ------
    InputRefused
        The run is not complete, or FMUs, kernels or versions are others than those of the run.
    KeyboardInterrupt
        Ctrl-C has ended the second run.

    Examples
    --------
    >>> import rockshed
    >>> system = rockshed.case("lab-impact", in_process=True, stop_time=0.001)
    >>> bool(rockshed.verify(rockshed.simulate(system)))
    True
    """
    first = run if isinstance(run, Run) else read_run(Path(str(getattr(run, "folder", run))))
    if first.status != "complete":
        what = f"is no complete run, but {first.status}"
        remedy = "`rockshed resume` goes on with one that has checkpoints"
        raise InputRefused([Problem(str(first.folder), what, remedy)])
    spec = system_of(first)
    sources = sources_of_run(first, system)
    make_plan(spec, sources)  # reads the FMUs
    continuing.refuse_others(first, sources)
    conduct: dict[str, Any] = {"changes": changes_of(first.provenance), "progress": progress}
    if "branch" in first.provenance:
        conduct["settled"] = read_settled(first.folder)
    with TemporaryFolder("rockshed-") as place:
        try:
            again = simulate_spec(
                spec, place / "again", sources=sources, allow_unstable=True, **conduct
            )
        except RunFailed as failure:
            return Verification(first, Difference("run", failure.time, "complete", str(failure)))
        if again.status == "interrupted":
            raise KeyboardInterrupt
        return Verification(first, first_difference(first, again))
