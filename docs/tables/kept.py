"""Results that are kept in the repository: rows of finished reproductions, with their stamps."""

import json
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

from rockshed.core.results.reading import undamaged
from rockshed.papers.kernel_stamps import stamps
from rockshed.papers.reproduction import DATA, PAPERS, studies

FOLDER = Path(__file__).resolve().parents[1] / "results"
_LEFT_OUT = ("model_options", "fmus", "runs", "deviation_from_paper", "deviation_from_experiment")
"""Keys of a row that are long, or follow from others."""


class NotKeptError(Exception):
    """Results that are no table: the reason."""


class Kept:
    """The kept results of a paper.

    Parameters
    ----------
    content : mapping
        As in ``reproduction.json``; ``runs`` is their number.
    """

    def __init__(self, content: Mapping[str, Any]) -> None:
        self.content = content
        self._rows = {
            (study["name"], row["quantity"], row["model"]): row
            for study in content["studies"]
            for row in study["rows"]
        }

    def row(self, study: str, quantity: str, model: str = "") -> Mapping[str, Any]:
        """Return a row; the model may be left out where a single one has the quantity.

        Raises
        ------
        NotKeptError
            There is no such row.
        """
        if not model:
            models = [m for s, q, m in self._rows if (s, q) == (study, quantity)]
            model = models[0] if len(models) == 1 else ""
        found = self._rows.get((study, quantity, model))
        if found is None:
            raise NotKeptError(f"{study}: there is no row {quantity!r} of {model!r}")
        return found

    def value(self, study: str, quantity: str, model: str = "") -> float:
        """Return the computed value of a row.

        Raises
        ------
        NotKeptError
            There is no such row, or no value in it.
        """
        value = self.row(study, quantity, model)["computed"]
        if value is None:
            raise NotKeptError(f"{study}: {quantity!r} of {model!r} has no value")
        return float(value)

    def seeds(self, study: str, quantity: str, model: str = "") -> int:
        """Return the number of different seeds of a row."""
        return len(set(self.row(study, quantity, model)["seeds"]))


def file_of(paper: str) -> Path:
    """Return the file of the kept results of a paper."""
    return FOLDER / f"{paper}.json"


@cache
def kept(paper: str) -> Kept:
    """Return the kept results of a paper."""
    return Kept(json.loads(file_of(paper).read_text(encoding="utf-8")))


def take(folder: Path) -> Path:
    """Keep the results of a reproduction, and return their file.

    Parameters
    ----------
    folder : Path
        Of ``rockshed reproduce``.

    Raises
    ------
    NotKeptError
        The reproduction is none of all studies with all seeds, or has not ended.
    InputRefused
        Its file is damaged.
    """
    paper, text = finished(folder)
    file = file_of(paper)
    file.parent.mkdir(exist_ok=True)
    file.write_text(text, encoding="utf-8")
    kept.cache_clear()
    return file


def finished(folder: Path) -> tuple[str, str]:
    """Return the paper of a finished reproduction, and what is kept of it.

    Parameters
    ----------
    folder : Path
        Of ``rockshed reproduce``.

    Raises
    ------
    NotKeptError
        The reproduction is none of all studies with all seeds, or has not ended.
    InputRefused
        Its file is damaged.
    """
    with undamaged(folder / DATA):
        content = json.loads((folder / DATA).read_text(encoding="utf-8"))
        paper = {title: name for name, title in PAPERS.items()}[content["paper"]]
        text = as_text(content)
        there = [study["name"] for study in content["studies"]]
        statuses = [run["status"] for run in content["runs"]]
    if content["quick"]:
        raise NotKeptError(f"{folder}: is a quick reproduction; tables need all seeds")
    if missing := [study.name for study in studies(paper) if study.name not in there]:
        raise NotKeptError(
            f"{folder}: lacks {', '.join(missing)}; tables are those of one reproduction"
        )
    if "interrupted" in statuses:
        raise NotKeptError(
            f"{folder}: was interrupted; start the same reproduction again to finish it"
        )
    return paper, text


def outdated(paper: str, content: Mapping[str, Any]) -> list[str]:
    """Return why kept results are not those of the present program, a line for each study.

    Parameters
    ----------
    paper : str
        Key of the paper.
    content : mapping
        What is kept of it.
    """
    remedy = f"carry out `rockshed reproduce {paper}`, then `python -m docs.tables results/{paper}`"
    known = {study["name"]: study["stamps"] for study in content["studies"]}
    found = []
    for name, present in stamps(studies(paper)).items():
        if name not in known:
            found.append(f"{paper}/{name}: is not kept; {remedy}")
            continue
        every = sorted({*present, *known[name]})
        if changed := [each for each in every if present.get(each) != known[name].get(each)]:
            found.append(f"{paper}/{name}: {', '.join(changed)}: other than when kept; {remedy}")
    return found


def as_text(content: Mapping[str, Any]) -> str:
    """Return what is kept of a reproduction as JSON, a row a line."""
    facts = {name: content[name] for name in ("format", "paper", "started", "quick", "workers")}
    facts |= {"wall_time": content["wall_time"], "time_of_runs": _time(content)}
    facts |= {"versions": content["versions"], "runs": len(content["runs"])}
    studies = ",\n".join(_study(study) for study in content["studies"])
    return json.dumps(facts, indent=1)[:-2] + f',\n "studies": [\n{studies}\n]}}\n'


def _time(content: Mapping[str, Any]) -> float:
    """Return the time (s) that the runs took, added up."""
    return float(sum(run["wall_time"] for run in content["runs"]))


def _study(study: Mapping[str, Any]) -> str:
    facts = {name: study[name] for name in ("name", "title", "notes", "stamps")}
    rows = ",\n".join(
        json.dumps({k: v for k, v in row.items() if k not in _LEFT_OUT}, ensure_ascii=False)
        for row in study["rows"]
    )
    return json.dumps(facts, indent=1, ensure_ascii=False)[:-2] + f',\n "rows": [\n{rows}\n]}}'
