"""The kept study of convergence of the trial shed: ``python -m docs.tables.convergence FOLDER``.

FOLDER is that of a finished ``rockshed converge orchestrator/examples/trial-shed.toml``. It takes
the place of the study that is kept with the program and told after every run of a project; its
figure goes to ``docs``. Then ``python -m docs.tables`` writes the tables of the page.
"""

import json
import shutil
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from rockshed.analyses.convergence.figures import QUANTITIES
from rockshed.analyses.convergence.files import DATA
from rockshed.metrics.mesh import TRIAL, trial
from rockshed.papers.kernel_stamps import of_run
from rockshed.runs.request import Request

from .forms import number, table
from .kept import NotKeptError

DOCS = Path(__file__).resolve().parents[1]
PROJECT = DOCS.parent / "orchestrator" / "examples" / "trial-shed.toml"
FIGURE = DOCS / "convergence.png"
STAMP = "stamp"
_SHORT = 0.012
"""Time (s) of the start of the run that the stamp is of: after the first contact."""


def stamp() -> str:
    """Return the digest of the start of the trial shed's run, by the present kernels."""
    return of_run(Request(str(PROJECT), options={"stop_time": _SHORT}))


def take(folder: Path) -> None:
    """Keep a finished study and its figure.

    Parameters
    ----------
    folder : Path
        Of ``rockshed converge``.

    Raises
    ------
    NotKeptError
        The study is of another project, or runs of it have failed.
    """
    found = json.loads((folder / DATA).read_text(encoding="utf-8"))
    if Path(found["project_file"]).name != PROJECT.name or found["warnings"]:
        raise NotKeptError(f"{folder}: is no whole study of {PROJECT.name}")
    kept = {key: found[key] for key in ("packings", "meshes", "departures", "remarks")}
    TRIAL.write_text(json.dumps({**kept, STAMP: stamp()}, indent=1) + "\n", encoding="utf-8")
    shutil.copy(folder / "convergence.png", FIGURE)
    trial.cache_clear()


def meshes() -> str:
    """Return the means over the packings of each mesh, with their standard errors."""
    known = [q for q in QUANTITIES if _key(q.name) in trial()["meshes"][0]]
    headings = ["refined", "discs", "radius, mm", "elements"]
    headings += [f"{quantity.name}, {quantity.unit}" for quantity in known]
    lines = [
        [
            mesh["refined"],
            str(mesh["discs"]),
            number(1e3 * mesh["disc_radius"], 1),
            str(mesh["elements"]),
            *(_mean(mesh, _key(q.name), q.scale) for q in known),
        ]
        for mesh in trial()["meshes"]
    ]
    return table(headings, lines)


def departures() -> str:
    """Return how far each figure of the default mesh is from that of the finest one."""
    lines = [
        [
            entry["figure"],
            entry["refined"],
            f"{100.0 * entry['share']:+.1f} ± {100.0 * entry['standard_error']:.1f} %",
            entry["verdict"],
        ]
        for entry in trial()["departures"]
    ]
    return table(("figure", "refined", "default / finest - 1", "verdict"), lines)


def _key(name: str) -> str:
    return name.replace(" ", "_")


def _mean(mesh: Mapping[str, Any], key: str, scale: float) -> str:
    mean, error = mesh[key] / scale, mesh[f"{key}_error"] / scale
    decimals = 0 if error >= 1.0 else 1
    return f"{number(mean, decimals)} ± {number(error, decimals)}"


TABLES: Mapping[str, Callable[[], str]] = {"meshes": meshes, "departures": departures}


if __name__ == "__main__":
    take(Path(sys.argv[1]))
