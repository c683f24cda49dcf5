"""The program itself as a master, in a process of its own: ``ours.py JOB.json ANSWER.json ...``."""

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np

from rockshed.core.errors import InputRefused, RunFailed
from rockshed.core.results.reading import StoredRun
from rockshed.core.run import simulate
from rockshed.core.system.system import SystemSpec
from rockshed.temporary import TemporaryFolder


def run(job: dict[str, Any]) -> dict[str, Any]:
    """Run one job; steps that a component calls unstable are made, as other tools make them."""
    system = SystemSpec.model_validate(job["system"])
    with TemporaryFolder() as folder:
        try:
            found = simulate(system, folder / "run", allow_unstable=True)
        except (InputRefused, RunFailed) as reason:
            return {"reason": " ".join(str(reason).split())}
        return {
            "times": list(found.series["time"]),
            "values": {name: list(found.series[name]) for name in map(".".join, job["watch"])},
            "cpu": found.provenance["cpu_time"]["exchanges"],
            "exchanges": exchanges(found),
        }


def exchanges(run: StoredRun) -> int:
    """Return the number of exchanges whose values were kept, of a run with a row after each step.

    With an adaptive exchange step there are several of them between two rows.
    """
    between = np.diff(run.series["time"])
    if "coupling.step" not in run.series:
        return len(between)
    return round(float((between / run.series["coupling.step"][1:]).sum()))


def main() -> None:
    """Run some jobs one after the other."""
    for job, answer in zip(sys.argv[1::2], sys.argv[2::2], strict=True):
        found = run(json.loads(Path(job).read_text(encoding="utf-8")))
        Path(answer).write_text(json.dumps(found), encoding="utf-8")


if __name__ == "__main__":
    main()
