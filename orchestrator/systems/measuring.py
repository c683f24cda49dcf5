"""Impact systems in every master that is installed: errors, energies, costs."""

import os
import platform
import statistics
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import replace
from functools import partial
from itertools import groupby
from typing import Any

from ..temporary import TemporaryFolder
from ..versions import sources_digest
from .bench import REFERENCE, Bench
from .catalogue import impact_system
from .children import Children
from .jobs import NATIVE, VARIANTS, FmuKind
from .journal import Turn, TurnJournal
from .masters.table import MASTERS, MasterRow, versions
from .measured import MasterRun, SuiteRuns
from .stamps import stamp
from .system import ImpactSystem

QUICK = ("stiff-contact", "algebraic-loop", "terminals")
"""Systems of a quick measurement."""
_KINDS = {variant.name: variant for variant in VARIANTS}
_AT_ONCE = min(2, os.cpu_count() or 1)
"""Systems that are measured at once; those who take turns with one system never run at once."""


def facts_of(systems: Sequence[ImpactSystem], quick: bool) -> dict[str, Any]:
    """Return what measurements of some systems follow from, as plain data."""
    return {
        "versions": dict(versions()),
        "platform": f"{platform.system()} {platform.machine()}, Python {platform.python_version()}",
        "quick": quick,
        "stamps": {system.name: stamp(system) for system in systems},
        "program": sources_digest("systems"),
    }


def turns_of(
    systems: Sequence[ImpactSystem], quick: bool, rounds: int, masters: Sequence[MasterRow]
) -> Iterator[Turn]:
    """Yield all turns of a measurement in their order.

    In each round every master takes its turn with native FMUs of FMI 2.0, the reference first; of
    the other kinds there is one round, as their costs are not told.
    """
    ordered = sorted(masters, key=lambda master: master.name != REFERENCE)
    for system in systems:
        for variant in VARIANTS[:1] if quick else VARIANTS:
            for number in range(rounds if variant == NATIVE else 1):
                for master in ordered:
                    yield Turn(system.name, variant.name, master.name, number)


def measure(
    systems: Sequence[ImpactSystem],
    facts: Mapping[str, Any],
    rounds: int = 3,
    journal: TurnJournal | None = None,
    tell: Callable[[int, int], None] = lambda done, total: None,
    masters: Sequence[MasterRow] = MASTERS,
) -> SuiteRuns:
    """Run systems in all masters, all exchange steps and all kinds of FMUs.

    Native FMUs of FMI 2.0 with every exchange step; the others with the one at which the tolerance
    is stated. A tool that is not installed has a row that says so.

    Parameters
    ----------
    systems : sequence of ImpactSystem
        The systems.
    facts : mapping
        Of :func:`facts_of`; a quick measurement has two exchange steps and native FMUs of FMI 2.0.
    rounds : int
        Rounds in which all masters take their turns; costs are medians.
    journal : TurnJournal, optional
        What was measured before, which is not measured again; what is measured now is added.
    tell : callable
        Called with the number of turns that were taken and of all.
    masters : sequence of MasterRow
        Who runs them; without the one that others are compared with, no bits are.

    Returns
    -------
    SuiteRuns

    Raises
    ------
    InputRefused
        FMUs cannot be built.
    """
    known = journal or TurnJournal()
    turns = list(turns_of(systems, facts["quick"], rounds, masters))
    left = [turn for turn in turns if turn not in known.rows]
    children = Children()
    with TemporaryFolder() as place:
        work = [
            partial(
                _work,
                list(group),
                Bench(
                    impact_system(name),
                    _KINDS[kind],
                    place / name / kind,
                    facts["versions"],
                    children,
                ),
                facts["quick"],
                known,
                {master.name: master for master in masters},
                lambda: tell(sum(each in known.rows for each in turns), len(turns)),
            )
            for (name, kind), group in groupby(left, key=lambda turn: turn[:2])
        ]
        _all_of(work, children)
    shared = {key: facts[key] for key in ("versions", "platform", "quick", "stamps")}
    rows = merged(known.rows[turn] for turn in turns)
    return SuiteRuns(rows, **shared, rounds=rounds, wall_time=round(known.seconds / _AT_ONCE, 1))


def _all_of(work: Iterable[Callable[[], None]], children: Children) -> None:
    """Do some work, two pieces at once; where one fails or the user ends it, the others end too."""
    with ThreadPoolExecutor(_AT_ONCE) as pool:
        try:
            for future in as_completed([pool.submit(each) for each in work]):
                future.result()
        except BaseException:
            children.end()
            pool.shutdown(cancel_futures=True)
            raise


def _work(
    turns: Sequence[Turn],
    bench: Bench,
    quick: bool,
    known: TurnJournal,
    masters: Mapping[str, MasterRow],
    tell: Callable[[], None],
) -> None:
    """Take the turns of one bench."""
    with bench.children.at_work:
        steps = _steps(bench.system, bench.variant, quick)
        if REFERENCE in masters and turns[0].master != REFERENCE:
            bench.know_reference(steps)
        for _, taken in groupby(turns, key=lambda turn: (turn.round, masters[turn.master].tool)):
            _take(list(taken), bench, steps, known, masters)
            tell()


def _take(
    turns: Sequence[Turn],
    bench: Bench,
    steps: Sequence[float],
    known: TurnJournal,
    masters: Mapping[str, MasterRow],
) -> None:
    """Let masters of one tool take their turns of one round; who had no result has none again."""
    begun = time.monotonic()
    first = {turn: known.rows.get(turn._replace(round=0), []) for turn in turns}
    without = [turn for turn in turns if first[turn] and all(row.reason for row in first[turn])]
    running = [masters[turn.master] for turn in turns if turn not in without]
    found = bench.run(running, steps) if running else {}
    seconds = (time.monotonic() - begun) / len(turns)
    for turn in turns:
        known.add(turn, first[turn] if turn in without else found[turn.master], seconds)


def _steps(system: ImpactSystem, variant: FmuKind, quick: bool) -> Sequence[float]:
    """Return the exchange steps (s) of the runs."""
    if variant != NATIVE:
        return (system.step,)
    place = system.steps.index(system.step)
    return system.steps[place - 1 : place + 1] if quick else system.steps


def merged(rounds: Iterable[Sequence[MasterRun]]) -> list[MasterRun]:
    """Return one row for all rounds of the same run: the first, with the median of the costs."""
    found: dict[tuple[str, str, str, float], list[MasterRun]] = {}
    for row in (row for rows in rounds for row in rows):
        found.setdefault((row.system, row.variant, row.master, row.step), []).append(row)
    return [_median(rows) for rows in found.values()]


def _median(rows: Sequence[MasterRun]) -> MasterRun:
    costs = [row.cost for row in rows if row.cost is not None]
    return replace(rows[0], cost=statistics.median(costs)) if costs else rows[0]
