"""Impact systems in every master that is installed: errors, energies, costs."""

import json
import os
import platform
import re
import subprocess
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from ..processes import with_parent
from ..temporary import TemporaryFolder
from .jobs import NATIVE, VARIANTS, FmuKind, as_data, build_parts, planned, write_job
from .masters.table import CANNOT_BE_HAD, MASTERS, OURS, PEERS, MasterRow, python_of, versions
from .system import ImpactSystem, NumberArray

REFERENCE = "rockshed, jacobi"
"""MasterRow that the values of others are compared with."""
LIMIT = 120.0
"""Time (s) that a run may take."""
QUICK = ("stiff-contact", "algebraic-loop", "terminals")
"""Systems of a quick measurement."""
_MOST_WORDS = 160
_PATH = re.compile(r"(/[\w.+-]+){2,}")


@dataclass(frozen=True)
class MasterRun:
    """One run of one system by one master.

    Attributes
    ----------
    system, master, variant : str
        Names of the system, the master, and the kind of FMUs.
    step : float
        Exchange step (s).
    exchanges : int
        Their number.
    reason : str
        Why there is no result; empty where there is one.
    error : float or None
        Largest error of the quantity, as a part of its largest true value.
    energy : float or None
        Energy that the coupling has made, as a part of the impact energy; None where the system
        has no such account.
    cost : float or None
        Processor time of all exchanges (s).
    deviation : float or None
        Largest difference from the reference master, as a part of the largest true value; 0 where
        all bits are equal.
    """

    system: str
    master: str
    variant: str
    step: float
    exchanges: int
    reason: str = ""
    error: float | None = None
    energy: float | None = None
    cost: float | None = None
    deviation: float | None = None


@dataclass(frozen=True)
class SuiteRuns:
    """All measurements, with what they were made with.

    Attributes
    ----------
    rows : sequence of MasterRun
        In the order of their making.
    versions : mapping of str to str or None
        Of the tools' packages; None of those that are not installed.
    platform : str
        Machine and system.
    quick : bool
        Whether it is a part of the whole only.
    """

    rows: Sequence[MasterRun]
    versions: Mapping[str, str | None]
    platform: str
    quick: bool

    def as_text(self) -> str:
        """Return everything as JSON, a row a line."""
        facts = {"versions": dict(self.versions), "platform": self.platform, "quick": self.quick}
        rows = ",\n".join(json.dumps(asdict(row)) for row in self.rows)
        return json.dumps(facts, indent=1)[:-2] + f',\n "rows": [\n{rows}\n]}}\n'


def from_text(text: str) -> SuiteRuns:
    """Return measurements as :meth:`SuiteRuns.as_text` wrote them."""
    content = json.loads(text)
    rows = [MasterRun(**row) for row in content.pop("rows")]
    return SuiteRuns(rows, **content)


def measure(
    systems: Sequence[ImpactSystem],
    quick: bool = False,
    rounds: int = 3,
    note: Callable[[str], None] = lambda text: None,
    masters: Sequence[MasterRow] = MASTERS,
) -> SuiteRuns:
    """Run systems in all masters, all exchange steps and all kinds of FMUs.

    Native FMUs of FMI 2.0 with every exchange step; the others with the one at which the tolerance
    is stated. A tool that is not installed has a row that says so.

    Parameters
    ----------
    systems : sequence of ImpactSystem
        The systems.
    quick : bool
        Only two exchange steps, native FMUs of FMI 2.0, and one round.
    rounds : int
        Runs with the stated step, whose cost is the median.
    note : callable
        Called with a line for each step of the work.
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
    found = versions()
    rows: list[MasterRun] = []
    with TemporaryFolder() as place:
        for system in systems:
            for variant in VARIANTS[:1] if quick else VARIANTS:
                bench = Bench(system, variant, place / system.name / variant.name)
                for master in masters:
                    note(f"{system.name}, {variant.name}: {master.name}")
                    bench.run(master, _steps(system, variant, quick, rounds), found)
                rows += bench.rows()
    machine = f"{platform.system()} {platform.machine()}, Python {platform.python_version()}"
    return SuiteRuns(rows, found, machine, quick)


def _steps(system: ImpactSystem, variant: FmuKind, quick: bool, rounds: int) -> Sequence[float]:
    """Return the exchange steps (s) of the runs, that of several rounds more than once."""
    if variant != NATIVE:
        return (system.step,)
    place = system.steps.index(system.step)
    if quick:
        return system.steps[place - 1 : place + 1]
    return (*system.steps, *[system.step] * (rounds - 1))


class Bench:
    """A system with FMUs of one kind, to be run by every master.

    Parameters
    ----------
    system : ImpactSystem
        The system.
    variant : FmuKind
        Kind of FMUs.
    place : Path
        Folder for them, for jobs and answers.
    """

    def __init__(self, system: ImpactSystem, variant: FmuKind, place: Path) -> None:
        self.system, self.variant, self.place = system, variant, place
        self.files = build_parts(system, place / "fmus", variant)
        self._found: dict[tuple[str, float], list[dict[str, Any]]] = {}

    def run(
        self, master: MasterRow, steps: Sequence[float], installed: Mapping[str, str | None]
    ) -> None:
        """Let a master run the system with each of some exchange steps (s)."""
        reason = CANNOT_BE_HAD.get(master.tool, "")
        if not reason and installed[master.package] is None:
            reason = "not installed"
        if reason:
            answers = [{"reason": reason} for _ in steps]
        else:
            answers = self._answers(master, [self._job(master, step) for step in steps])
        for step, answer in zip(steps, answers, strict=True):
            self._found.setdefault((master.name, step), []).append(answer)

    def rows(self) -> list[MasterRun]:
        """Return what all masters have computed, compared with the truth and with one of them."""
        return [
            self._judged(master, step, answers, self._found.get((REFERENCE, step), [{}])[0])
            for (master, step), answers in self._found.items()
        ]

    def _job(self, master: MasterRow, step: float) -> Path:
        """Write what a master needs for one exchange step, and return its job."""
        options = "-".join(f"{key}{value}" for key, value in master.options.items())
        folder = self.place / f"{master.given}{options}-{step:g}"
        plan = planned(self.system, self.files, step, master.given, master.options)
        if not folder.exists():
            folder.mkdir(parents=True)
            write_job(self.system, plan, self.files, folder)
        shared = json.loads((folder / "job.json").read_text(encoding="utf-8"))
        facts = {"scheme": master.scheme, "fmpy": sys.executable, "inputs": self.inputs}
        facts["system"] = plan.system.model_dump(mode="json", exclude_defaults=True)
        file = folder / f"job of {master.name}.json"
        file.write_text(json.dumps({**shared, **facts}), encoding="utf-8")
        return file

    @cached_property
    def inputs(self) -> dict[str, dict[str, float]]:
        """Inputs after the initialisation, by component, for masters that have to be told."""
        plan = planned(self.system, self.files, self.system.step, "jacobi")
        wires = as_data(self.system, plan, self.files)["connections"]
        record = list(dict.fromkeys(f"{a}.{b}" for a, b, _, _ in wires))
        begin = {"record": record, "stop_time": plan.system.exchange_step}
        data = plan.system.model_copy(update=begin).model_dump(mode="json", exclude_defaults=True)
        file = self.place / "first exchange.json"
        watch = [name.partition(".")[::2] for name in record]
        file.write_text(json.dumps({"system": data, "watch": watch}), encoding="utf-8")
        found = self._run([sys.executable, str(OURS)], [file])[0]
        inputs: dict[str, dict[str, float]] = {}
        for a, b, component, port in wires:
            inputs.setdefault(component, {})[port] = found["values"][f"{a}.{b}"][0]
        return inputs

    def _answers(self, master: MasterRow, jobs: Sequence[Path]) -> list[dict[str, Any]]:
        """Return what a master has computed of each job; one that ended its process is alone."""
        command = [python_of(master), str(PEERS), master.tool]
        if master.tool == "rockshed":
            command = [sys.executable, str(OURS)]
        answers = self._run(command, jobs)
        if len(jobs) > 1 and any(answer.get("died") for answer in answers):
            answers = [self._run(command, [job])[0] for job in jobs]
        return answers

    def _run(self, command: Sequence[str], jobs: Sequence[Path]) -> list[dict[str, Any]]:
        """Run jobs in one process; those without an answer get its last words."""
        places = [self.place / f"answer {number}.json" for number in range(len(jobs))]
        for place in places:
            place.unlink(missing_ok=True)
        pairs = [str(path) for pair in zip(jobs, places, strict=True) for path in pair]
        limit = LIMIT * len(jobs)
        with TemporaryFolder() as folder:
            try:
                ended = subprocess.run(
                    [*command, *pairs],
                    capture_output=True,
                    text=True,
                    errors="replace",
                    check=False,
                    timeout=limit,
                    preexec_fn=with_parent(),
                    env={**os.environ, "TMPDIR": str(folder)},
                )
                words = _last_words(ended)
            except subprocess.TimeoutExpired:
                words = f"not ready after {limit:g} s"
        return [_answer(place, words) for place in places]

    def _judged(
        self,
        master: str,
        step: float,
        answers: Sequence[Mapping[str, Any]],
        reference: Mapping[str, Any],
    ) -> MasterRun:
        """Return one row of several runs with the same step."""
        system = self.system
        name = (system.name, master, self.variant.name, step, round(system.stop_time / step))
        found = answers[0]
        if "reason" in found:
            return MasterRun(*name, reason=_shortened(found["reason"]))
        values, times = _series(found, system.quantity), np.array(found["times"])
        if not np.isfinite(values).all():
            return MasterRun(*name, reason="values that are no finite numbers")
        return MasterRun(
            *name,
            error=float(np.abs(values - system.truth(times)).max()) / system.scale,
            energy=self._made(found),
            cost=float(np.median([answer["cpu"] for answer in answers])),
            deviation=self._deviation(values, reference),
        )

    def _deviation(self, values: NumberArray, reference: Mapping[str, Any]) -> float | None:
        """Return the largest difference from the reference; some masters show no start."""
        if "values" not in reference:
            return None
        expected = _series(reference, self.system.quantity)
        common = min(len(values), len(expected))
        largest = np.abs(values[-common:] - expected[-common:]).max()
        return float(largest) / self.system.scale

    def _made(self, found: Mapping[str, Any]) -> float | None:
        """Return the energy that the coupling has made, as a part of the impact energy."""
        if not self.system.energies:
            return None
        end = sum(float(found["values"][each][-1]) for each in self.system.energies)
        made = (end - self.system.start_energy) / self.system.impact_energy
        return made if np.isfinite(made) else None


def _answer(place: Path, words: str) -> dict[str, Any]:
    """Return the answer in a file, or the reason why there is none."""
    if not place.is_file():
        return {"reason": words, "died": True}
    found: dict[str, Any] = json.loads(place.read_text(encoding="utf-8"))
    return found


def _series(found: Mapping[str, Any], name: str) -> NumberArray:
    return np.array(found["values"][name], dtype=float)


def _last_words(ended: "subprocess.CompletedProcess[str]") -> str:
    """Return the last line of what a process has printed."""
    if ended.returncode < 0:
        return f"ended by signal {-ended.returncode}"
    lines = [line.strip() for line in (ended.stdout + ended.stderr).splitlines() if line.strip()]
    return lines[-1] if lines else f"exit code {ended.returncode}"


def _shortened(words: str) -> str:
    """Return words without folders, cut where they are many."""
    told = _PATH.sub(lambda found: found[0].rpartition("/")[2], words)
    return told if len(told) <= _MOST_WORDS else told[: _MOST_WORDS - 3] + "..."
