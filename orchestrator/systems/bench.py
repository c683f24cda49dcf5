"""A system with FMUs of one kind, made ready to be run by every master in a process of its own."""

import json
import os
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ..core.errors import InputRefused
from ..temporary import TemporaryFolder
from .children import Children
from .jobs import FmuKind, as_data, build_parts, planned, watched, write_job
from .judging import judged
from .masters.table import CANNOT_BE_HAD, MASTERS, OURS, PEERS, MasterRow, python_of
from .measured import MasterRun
from .system import ExchangeOrder, ImpactSystem

REFERENCE = "rockshed, jacobi"
"""ExchangeOrder that the values of others are compared with."""
LIMIT = 120.0
"""Time (s) that a run may take."""


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
    installed : mapping of str to str or None
        Versions of packages, None of those that are not installed.
    children : Children
        Processes of the measurement.
    """

    def __init__(
        self,
        system: ImpactSystem,
        variant: FmuKind,
        place: Path,
        installed: Mapping[str, str | None],
        children: Children,
    ) -> None:
        self.system, self.variant, self.place = system, variant, place
        self.installed, self.children = installed, children
        self.files = build_parts(system, place / "fmus", variant)
        self._jobs: dict[tuple[str, float], Path] = {}
        self._reference: dict[float, Mapping[str, Any]] = {}
        self._inputs: dict[str, dict[str, float]] = {}

    def run(
        self, masters: Sequence[MasterRow], steps: Sequence[float]
    ) -> dict[str, list[MasterRun]]:
        """Let masters of one tool run the system with each of some exchange steps (s).

        Returns
        -------
        dict of str to list of MasterRun
            By the name of the master, a row for each step.
        """
        runs = [(master, step) for master in masters for step in steps]
        answers = dict(zip(((m.name, step) for m, step in runs), self._answers(runs), strict=True))
        for (name, step), answer in answers.items():
            if name == REFERENCE:
                self._reference[step] = answer
        found: dict[str, list[MasterRun]] = {}
        for (name, step), answer in answers.items():
            names = (name, self.variant.name, step)
            row = judged(self.system, names, answer, self._reference.get(step, {}))
            found.setdefault(name, []).append(row)
        return found

    def know_reference(self, steps: Sequence[float]) -> None:
        """Let the reference master run, unless its values are known."""
        if not self._reference:
            self.run([master for master in MASTERS if master.name == REFERENCE], steps)

    def _answers(self, runs: Sequence[tuple[MasterRow, float]]) -> list[dict[str, Any]]:
        """Return what masters of one tool have computed, in one process as long as it lives."""
        told = [self._told(master, step) for master, step in runs]
        jobs = [job for job in told if isinstance(job, Path)]
        answers = iter(self._in_processes(runs[0][0], jobs) if jobs else [])
        return [next(answers) if isinstance(job, Path) else {"reason": job} for job in told]

    def _told(self, master: MasterRow, step: float) -> Path | str:
        """Return the job of a run, or the reason why there is none."""
        if master.tool in CANNOT_BE_HAD:
            return CANNOT_BE_HAD[master.tool]
        if self.installed[master.package] is None:
            return "not installed"
        try:
            return self._job(master, step)
        except InputRefused as refusal:
            return "; ".join(f"{each.where}: {each.what}" for each in refusal.problems)

    def _in_processes(self, master: MasterRow, jobs: Sequence[Path]) -> list[dict[str, Any]]:
        """Run jobs of one tool in one process, or, if that has died, each in one of its own."""
        command = [python_of(master), str(PEERS), master.tool]
        if master.tool == "rockshed":
            command = [sys.executable, str(OURS)]
        answers = self._run(command, jobs)
        if len(jobs) > 1 and any(answer.get("died") for answer in answers):
            answers = [self._run(command, [job])[0] for job in jobs]
        return answers

    def _job(self, master: MasterRow, step: float) -> Path:
        """Return the file of what a master needs for one exchange step."""
        if (master.name, step) not in self._jobs:
            folder = self.place / f"{master.given}-{step:g}"
            folder.mkdir(parents=True, exist_ok=True)
            file = folder / f"job of {master.name}.json"
            content = self._own(master, step)
            if master.tool != "rockshed":
                content = {**self._shared(master.given, step, folder), "scheme": master.scheme}
                content |= {"fmpy": sys.executable, "inputs": self._inputs or self._first_inputs()}
            file.write_text(json.dumps(content), encoding="utf-8")
            self._jobs[master.name, step] = file
        return self._jobs[master.name, step]

    def _own(self, master: MasterRow, step: float) -> dict[str, Any]:
        """Return a job for this program."""
        options = master.options(self.system, step)
        plan = planned(self.system, self.files, step, master.given, options)
        data = plan.system.model_dump(mode="json", exclude_defaults=True)
        return {"system": data, "watch": watched(self.system)}

    def _shared(self, given: ExchangeOrder, step: float, folder: Path) -> dict[str, Any]:
        """Return a job for other tools, whose files are written once for all of them."""
        file = folder / "job.json"
        if not file.exists():
            plan = planned(self.system, self.files, step, given)
            write_job(self.system, plan, self.files, folder)
        content: dict[str, Any] = json.loads(file.read_text(encoding="utf-8"))
        return content

    def _first_inputs(self) -> dict[str, dict[str, float]]:
        """Return inputs after the initialisation, by component, for masters that are told them."""
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
        self._inputs = inputs
        return inputs

    def _run(self, command: Sequence[str], jobs: Sequence[Path]) -> list[dict[str, Any]]:
        """Run jobs in one process; those without an answer get its last words."""
        places = [self.place / f"answer {number}.json" for number in range(len(jobs))]
        for place in places:
            place.unlink(missing_ok=True)
        pairs = [str(path) for pair in zip(jobs, places, strict=True) for path in pair]
        limit = LIMIT * len(jobs)
        with TemporaryFolder() as folder:
            environment = {**os.environ, "TMPDIR": str(folder)}
            try:
                words = _last_words(*self.children.run([*command, *pairs], limit, environment))
            except subprocess.TimeoutExpired:
                words = f"not ready after {limit:g} s"
        return [_answer(place, words) for place in places]


def _answer(place: Path, words: str) -> dict[str, Any]:
    """Return the answer in a file, or the reason why there is none, or none that is whole."""
    try:
        found: dict[str, Any] = json.loads(place.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {"reason": words, "died": True}
    return found


def _last_words(code: int, said: str) -> str:
    """Return how a process has ended: the last line that it has printed."""
    if code < 0:
        return f"ended by signal {-code}"
    lines = [line.strip() for line in said.splitlines() if line.strip()]
    return lines[-1] if lines else f"exit code {code}"
