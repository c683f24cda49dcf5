"""The part ``systems`` of the command ``rockshed bench``: impact systems in every master."""

from pathlib import Path

from ..core.errors import refusing_unwritable
from ..files import write_file
from ..systems.catalogue import impact_systems
from ..systems.journal import journal_in
from ..systems.masters.table import MASTERS
from ..systems.measured import SuiteRuns
from ..systems.measuring import QUICK, facts_of, measure, turns_of
from ..systems.results import overview
from .screen import Screen, spoken

DATA, FIGURE = "systems.json", "systems.png"


def bench_systems(folder: Path, quick: bool, rounds: int, screen: Screen) -> SuiteRuns:
    """Run the impact systems in every master, show one table, and keep data and figure.

    Ended before its end, the same command goes on where it was.

    Parameters
    ----------
    folder : Path
        Of the results.
    quick : bool
        Three systems, two exchange steps each, without other kinds of FMUs.
    rounds : int
        Rounds in which all masters take their turns.
    screen : Screen
        Of the command.

    Returns
    -------
    SuiteRuns

    Raises
    ------
    InputRefused
        The folder cannot be written or is in use, or FMUs cannot be built.
    """
    from ..systems.pictures import draw  # matplotlib is of no use to the other parts

    systems = impact_systems(QUICK if quick else ())
    with screen.busy("looking at kernels and tools"):
        facts = facts_of(systems, quick)
    with journal_in(folder, facts) as journal:
        turns = list(turns_of(systems, quick, rounds, MASTERS))
        before = sum(turn in journal.rows for turn in turns)
        screen.note(_begun(len(turns), before, journal.is_other))
        try:
            with screen.counting("turns of masters") as tell:
                measured = measure(systems, facts, rounds, journal, tell)
        except KeyboardInterrupt:
            screen.note(f"what was measured is kept in {folder}: the same command goes on there")
            raise
        with refusing_unwritable(folder):
            write_file(folder / DATA, measured.as_text().encode())
            draw(measured, folder / FIGURE)
        journal.remove()
    took = spoken(measured.wall_time)
    screen.show(overview(measured), f"data and figure in {folder}; the measurement took {took}")
    return measured


def _begun(turns: int, before: int, is_other: bool) -> str:
    """Return what is about to be done, in words."""
    if is_other:
        what = "what was measured before is of other kernels, tools or masters"
        return f"{turns} turns of masters, all of them: {what}"
    if before:
        return f"{turns} turns of masters, of which {before} were taken before"
    return f"{turns} turns of masters, about a second each"
