"""Draw the pictures of pages that show runs anew: ``python -m docs.tables.pictures``.

A picture stands on the kernels as a table does: the digest of a short run of its case is kept in
``docs/results/pictures.json``, and a test refuses a picture whose digest is that of an older one.
"""

import json
import shutil
import sys
from collections.abc import Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

from rockshed import Run, shed, simulate
from rockshed.papers.kernel_stamps import of_run
from rockshed.runs.request import Request

from .filling import ROOT


class Shown(NamedTuple):
    """Which figure of which run a page shows.

    Attributes
    ----------
    target : str
        Name of the case, or project file of the examples.
    figure : str
        Name of the figure of its run, without ending.
    short : float
        Time (s) of the start of the run that the digest is of: after the first contact.
    """

    target: str
    figure: str
    short: float


PICTURES: Mapping[str, Shown] = {
    "lab-impact.png": Shown("lab-impact", "overview", 0.004),
    "shed-on-piles.png": Shown("shed-on-piles", "piles", 0.02),
    "trial-shed.png": Shown("trial-shed.toml", "overview", 0.012),
}
"""Figures of pages by their file in ``docs``."""
EXAMPLES = ROOT / "orchestrator" / "examples"
STAMPS = ROOT / "docs" / "results" / "pictures.json"


def stamp(shown: Shown) -> str:
    """Return the digest of the start of the run that a picture shows, by the present kernels."""
    return of_run(Request(_target(shown), options={"stop_time": shown.short}))


def _target(shown: Shown) -> str:
    """Return the case, or the path of the project."""
    file = EXAMPLES / shown.target
    return str(file) if file.is_file() else shown.target


def _run(shown: Shown, place: Path) -> Run:
    """Carry out the run that a picture shows."""
    target = _target(shown)
    return simulate(shed(target) if target.endswith(".toml") else target, place / shown.target)


def main() -> int:
    """Carry the runs out, put their figures into ``docs``, and keep the stamps."""
    with TemporaryDirectory() as place:
        for name, shown in PICTURES.items():
            shutil.copy(_run(shown, Path(place)).figures()[shown.figure], ROOT / "docs" / name)
            print(f"drawn: docs/{name}")
    stamps = {name: stamp(shown) for name, shown in PICTURES.items()}
    STAMPS.write_text(json.dumps(stamps, indent=2) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
