"""The suite of impact systems as a folder that needs nothing of this program."""

import json
import shutil
from collections.abc import Callable, Sequence
from pathlib import Path

from rockshed.fmus.native.fmu import own_platform

from ..core.errors import InputRefused, Problem, refusing_unwritable
from ..core.system.plan import Plan
from ..runs.export import system_text
from ..temporary import TemporaryFolder
from .jobs import VARIANTS, FmuKind, build_parts, planned, write_job
from .masters.table import PEERS
from .system import ImpactSystem

SCORER = Path(__file__).with_name("scorer.py")
_PAGE = Path(__file__).with_name("SUITE.md")
"""README of the suite, with places for `{rows}` and `{platform}`."""


def export_systems(
    systems: Sequence[ImpactSystem], folder: Path, note: Callable[[str], None] = lambda text: None
) -> Path:
    """Write systems into a new or empty folder, which has all of them or, if it fails, nothing.

    Parameters
    ----------
    systems : sequence of ImpactSystem
        The systems.
    folder : Path
        A new or empty folder.
    note : callable
        Called with a line for each FMU that is built.

    Returns
    -------
    Path
        Its ``README.md``.

    Raises
    ------
    InputRefused
        The folder holds something, or cannot be written; an FMU cannot be built.
    """
    _refuse_used(folder)
    with refusing_unwritable(folder):
        folder.parent.mkdir(parents=True, exist_ok=True)
        with TemporaryFolder(".rockshed-", folder.parent) as place:
            whole = place / "suite"
            _write_suite(systems, whole, note)
            _refuse_used(folder)  # by somebody else in the meantime
            if folder.exists():
                folder.rmdir()
            whole.rename(folder)
    return folder / "README.md"


def _refuse_used(folder: Path) -> None:
    """Refuse a place that has something in it."""
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        reason = "is not empty" if folder.is_dir() else "is a file"
        raise InputRefused([Problem(str(folder), reason, "name a new or empty folder")])


def _write_suite(
    systems: Sequence[ImpactSystem], folder: Path, note: Callable[[str], None]
) -> None:
    """Write everything into a folder that is made."""
    folder.mkdir()
    for system in systems:
        place = folder / system.name
        place.mkdir()
        _write_facts(system, place)
        for variant in VARIANTS:
            _write_variant(system, variant, place / variant.name, note)
    shutil.copyfile(SCORER, folder / "score.py")
    shutil.copyfile(PEERS, folder / "run.py")
    (folder / "README.md").write_text(_readme(systems), encoding="utf-8")


def _write_facts(system: ImpactSystem, place: Path) -> None:
    """Write page, truth and declarations of a system."""
    times = system.times(system.steps[-1])
    rows = zip(times, system.truth(times), strict=True)
    head = f"time [s],{system.quantity} [{system.unit}]"
    lines = [head, *(f"{time:.12g},{float(value)!r}" for time, value in rows)]
    (place / "truth.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    facts = {
        "name": system.name,
        "title": system.title,
        "quantity": system.quantity,
        "unit": system.unit,
        "stop_time": system.stop_time,
        "steps": system.steps,
        "step": system.step,
        "tolerance": system.tolerance,
        "energies": system.energies,
        "start_energy": system.start_energy,
        "impact_energy": system.impact_energy,
    }
    (place / "system.json").write_text(json.dumps(facts, indent=1) + "\n", encoding="utf-8")
    (place / "README.md").write_text(page(system), encoding="utf-8")


def page(system: ImpactSystem) -> str:
    """Return the page of a system: what is declared of it, and the derivation."""
    account = ""
    if system.energies:
        names = " + ".join(f"`{name}`" for name in system.energies)
        account = (
            f"\n**Energy made**: {names} at the end, less {system.start_energy:.6g} J, as a part "
            f"of {system.impact_energy:.6g} J.\n"
        )
    steps = ", ".join(f"{step:g}" for step in system.steps)
    return (
        f"# {system.title}\n\n"
        f"**Quantity**: `{system.quantity}` ({system.unit}), until {system.stop_time:g} s.\n"
        f"**Tolerance**: {system.tolerance:g} of its largest value with the exchange step "
        f"{system.step:g} s. Exchange steps to measure with: {steps} s.\n{account}\n{system.page}"
    )


def _write_variant(
    system: ImpactSystem, variant: FmuKind, place: Path, note: Callable[[str], None]
) -> None:
    """Write FMUs of one kind, the SSPs, two system files and the job."""
    place.mkdir()
    files = build_parts(system, place, variant, note)
    plan = planned(system, files, system.step, "jacobi")
    write_job(system, plan, files, place)
    _write_toml(plan, place / "system.toml")
    _write_toml(planned(system, files, system.step, "implicit"), place / "implicit.toml")


def _write_toml(plan: Plan, file: Path) -> None:
    """Write a planned system as a file of this program, with FMUs beside it."""
    components = {
        name: spec.model_copy(update={"fmu": Path(spec.fmu).name})
        for name, spec in plan.system.components.items()
    }
    text = system_text(plan.system.model_copy(update={"components": components}))
    file.write_text(text, encoding="utf-8")


def _readme(systems: Sequence[ImpactSystem]) -> str:
    rows = "".join(
        f"| [{s.name}]({s.name}/README.md) | `{s.quantity}` | {s.step:g} | {s.tolerance:g} "
        f"| {s.title} |\n"
        for s in systems
    )
    text = _PAGE.read_text(encoding="utf-8")
    return text.replace("{rows}\n", rows).replace("{platform}", own_platform())
