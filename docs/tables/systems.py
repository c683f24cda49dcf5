"""The kept measurement of the impact systems: ``python -m docs.tables.systems FOLDER``.

FOLDER is that of a finished ``rockshed bench systems``. Its data and its figure take the place of
what is kept; then ``python -m docs.tables`` writes the tables of the pages.
"""

import re
import shutil
import sys
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from pathlib import Path

from rockshed.systems.catalogue import NAMES, impact_system
from rockshed.systems.findings import findings as found_out
from rockshed.systems.jobs import VARIANTS
from rockshed.systems.masters.table import MASTERS
from rockshed.systems.measured import MasterRun, SuiteRuns, from_text
from rockshed.systems.results import Summary, number, summaries, verdict
from rockshed.systems.stamps import stamp

from .forms import table
from .kept import FOLDER, NotKeptError

DATA = FOLDER / "systems.json"
_PLACE = re.compile(r" ?\(line \d+, column \d+\)")
"""Of a fault in a file, which is another one in each system."""
FIGURE = FOLDER.parent / "impact-systems.png"


@cache
def kept() -> SuiteRuns:
    """Return the kept measurement."""
    return from_text(DATA.read_text(encoding="utf-8"))


def take(folder: Path) -> None:
    """Keep a measurement and its figure.

    Parameters
    ----------
    folder : Path
        Of ``rockshed bench systems``.

    Raises
    ------
    NotKeptError
        The measurement is a quick one, or lacks systems.
    """
    text = (folder / "systems.json").read_text(encoding="utf-8")
    measured = from_text(text)
    missing = set(NAMES) - {row.system for row in measured.rows}
    if measured.quick or missing:
        raise NotKeptError(f"{folder}: is no whole measurement; run `rockshed bench systems`")
    DATA.write_text(text, encoding="utf-8")
    shutil.copy(folder / "systems.png", FIGURE)
    kept.cache_clear()


@cache
def present_stamp(name: str) -> str:
    """Return the stamp of a system by the present kernels."""
    return stamp(impact_system(name))


def outdated(measured: SuiteRuns) -> list[str]:
    """Return why a measurement is not that of the present suite, a line for each reason."""
    remedy = "run `rockshed bench systems`, then `python -m docs.tables.systems results/systems`"
    masters = {row.master for row in measured.rows}
    found = [
        f"{master.name}: is not measured; {remedy}"
        for master in MASTERS
        if master.name not in masters
    ]
    for name in NAMES:
        steps = {r.step for r in measured.rows if (r.system, r.variant) == (name, "fmi2-native")}
        if steps != set(impact_system(name).steps):
            found.append(f"{name}: has other exchange steps; {remedy}")
        if measured.stamps.get(name) != present_stamp(name):
            found.append(f"{name}: other than when measured, by kernels or truth; {remedy}")
    return found


def _by_system(cell: Callable[[Summary], str]) -> str:
    """Return a table with a row for each master and a column for each system."""
    found = {(s.system, s.master): s for s in summaries(kept())}
    lines = []
    for master in MASTERS:
        entries = [found.get((name, master.name)) for name in NAMES]
        cells = ["-" if entry is None else cell(entry) for entry in entries]
        if set(cells) != {"-"}:
            lines.append([master.name, *cells])
    return table(["master", *NAMES], lines)


def errors() -> str:
    """Return error and order of each master on each system."""

    def cell(summary: Summary) -> str:
        row = summary.stated
        if row.error is None:
            return "-"
        if row.error > 1.0:
            return "wrong"
        order = "" if summary.order is None else f" ({summary.order:.1f})"
        return f"{number(row.error)}{order}"

    return _by_system(cell)


def energies() -> str:
    """Return the energy that the coupling made, in percent of the impact energy."""

    def cell(summary: Summary) -> str:
        made = summary.stated.energy
        if made is None or summary.stated.error is None or summary.stated.error > 1.0:
            return "-"
        return f"{100.0 * made:+.2g} %"

    return _by_system(cell)


def costs() -> str:
    """Return the processor time of an exchange in microseconds."""

    def cell(summary: Summary) -> str:
        row = summary.stated
        return "-" if row.cost is None else f"{1e6 * row.cost / row.exchanges:.2g}"

    return _by_system(cell)


def equal_costs() -> str:
    """Return the error of each master at one cost for all."""
    return _by_system(lambda summary: number(summary.at_equal_cost))


def reasons() -> str:
    """Return why masters have no result, at the stated exchange step with native FMUs."""
    groups: dict[tuple[str, str], list[str]] = {}
    for summary in summaries(kept()):
        if summary.stated.reason:
            key = (summary.master, _in_words(summary.stated.reason))
            groups.setdefault(key, []).append(summary.system)
    lines = [
        [master, "all" if len(names) == len(NAMES) else ", ".join(names), reason]
        for (master, reason), names in groups.items()
    ]
    return table(["master", "system", "what it says"], lines)


def findings() -> str:
    """Return what the numbers say about each master."""
    lines = []
    for each in found_out(kept()):
        cannot = ["all"] if len(each.cannot) == len(NAMES) else each.cannot
        cells = (cannot, each.beyond, each.lost, each.gained, each.energy)
        lines.append([each.master, *("; ".join(cell) or "-" for cell in cells)])
    titles = ["no result", "error > tolerance", "order lost", "order gained", "energy made"]
    return table(["master", *titles], lines)


def tools() -> str:
    """Return the versions of all tools and how they are used."""
    versions = kept().versions
    lines = [
        [master.name, master.package, versions[master.package] or "cannot be had", master.how]
        for master in MASTERS
    ]
    measured = kept()
    note = (
        f"\n\nMeasured on: {measured.platform}, in {measured.rounds} rounds, "
        f"in {measured.wall_time / 60.0:.0f} minutes."
    )
    return table(["master", "package", "version", "how it is used"], lines) + note


def _compatibility(variant: str) -> str:
    """Return what runs with FMUs of one kind, a row for each master."""
    found = {
        (row.system, row.master): row
        for row in kept().rows
        if row.variant == variant and row.step == impact_system(row.system).step
    }
    versions = kept().versions
    notes: list[str] = []
    lines = []
    for master in MASTERS:
        version = versions[master.package]
        if version is not None:
            rows = [found.get((name, master.name)) for name in NAMES]
            lines.append([master.name, version, *(_verdict(row, notes) for row in rows)])
    foot = "\n".join(f"{place}. {note}" for place, note in enumerate(notes, 1))
    shown = table(["tool", "version", *NAMES], lines)
    return f"{shown}\n\nPlatform: {kept().platform}.\n\n{foot}"


def _verdict(row: MasterRun | None, notes: list[str]) -> str:
    """Return a verdict; of a reason its number among the notes, which may grow."""
    if row is None:
        return "-"
    if not row.reason:
        return verdict(row)
    reason = _in_words(row.reason)
    if reason not in notes:
        notes.append(reason)
    return f"no, note {notes.index(reason) + 1}"


def _in_words(reason: str) -> str:
    """Return a reason as text of a table."""
    told = _PLACE.sub("", reason)
    return told.replace("|", "/").replace("<", "&lt;").strip()


def _kinds(names: Sequence[str]) -> Mapping[str, Callable[[], str]]:
    return {name: lambda name=name: _compatibility(name) for name in names}  # type: ignore[misc]


TABLES: Mapping[str, Callable[[], str]] = {
    "errors": errors,
    "energies": energies,
    "costs": costs,
    "equal-costs": equal_costs,
    "reasons": reasons,
    "findings": findings,
    "tools": tools,
    **_kinds([variant.name for variant in VARIANTS]),
}


if __name__ == "__main__":
    take(Path(sys.argv[1]))
