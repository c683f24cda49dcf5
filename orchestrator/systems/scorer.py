"""Compare results of any master with the truth of an impact system. Needs numpy alone.

    python score.py SYSTEM RESULT ...

SYSTEM is a folder of this suite. RESULT is a CSV with a column ``time`` (s) and one of the name
that the system's page tells, each with its unit in brackets behind or not, or an answer of
``run.py``. Exit code 0: all within the tolerance, 3:
some are not, 2: a file is not in order.
"""

import csv
import json
import re
import sys
from pathlib import Path
from typing import Any

import numpy as np

SAME_TIME = 1e-6
"""Two times are the same if they differ by less than this part of the truth's step."""
UNIT = re.compile(r"\s+\[[^\]]*\]$")
"""Unit behind a name, as in ``time [s]``; a place in an array has no space in front."""


class NotInOrderError(Exception):
    """A file that cannot be compared: the reason."""


def read_csv(file: Path) -> dict[str, Any]:
    """Return the columns of a CSV by name."""
    with file.open(encoding="utf-8-sig", newline="") as opened:
        rows = [row for row in csv.reader(opened) if row and not row[0].startswith("#")]
    try:
        values = np.array([[float(cell) for cell in row] for row in rows[1:]]).T
    except ValueError as reason:
        raise NotInOrderError(f"{file}: {reason}") from None
    if not rows or len(values) != len(rows[0]):
        raise NotInOrderError(f"{file}: is no table with a head and rows of numbers")
    return dict(zip([UNIT.sub("", name.strip()) for name in rows[0]], values, strict=True))


def read_result(file: Path) -> dict[str, Any]:
    """Return the columns of a result, a CSV or an answer of ``run.py``."""
    if file.suffix != ".json":
        return read_csv(file)
    found = json.loads(file.read_text(encoding="utf-8"))
    if "reason" in found:
        raise NotInOrderError(f"{file}: {found['reason']}")
    return {"time": np.array(found["times"])} | {
        name: np.array(values) for name, values in found["values"].items()
    }


def error(system: Path, facts: dict[str, Any], result: dict[str, Any], name: str) -> float:
    """Return the largest error of a result, as a part of the largest true value."""
    truth = read_csv(system / "truth.csv")
    quantity = facts["quantity"]
    if missing := [column for column in ("time", quantity) if column not in result]:
        raise NotInOrderError(f"{name}: has no column {' and no column '.join(missing)}")
    step = truth["time"][1] - truth["time"][0]
    places = np.rint(result["time"] / step).astype(int)
    known = (places >= 0) & (places < len(truth["time"]))
    known[known] &= abs(truth["time"][places[known]] - result["time"][known]) < SAME_TIME * step
    if not known.any():
        raise NotInOrderError(f"{name}: has no time of the truth, multiples of {step:g} s")
    if result["time"][known].max() < truth["time"][-1] * (1.0 - SAME_TIME):
        raise NotInOrderError(f"{name}: ends at {result['time'][known].max():g} s, too early")
    values = result[quantity][known]
    if not np.isfinite(values).all():
        raise NotInOrderError(f"{name}: has values that are no finite numbers")
    apart = abs(values - truth[quantity][places[known]])
    return float(apart.max() / abs(truth[quantity]).max())


def main(words: list[str]) -> int:
    """Print a line for each result, and return the exit code."""
    if len(words) < 2:
        print(__doc__, file=sys.stderr)
        return 2
    system = Path(words[0])
    code = 0
    try:
        facts = json.loads((system / "system.json").read_text(encoding="utf-8"))
        for name in words[1:]:
            found = error(system, facts, read_result(Path(name)), name)
            is_within = found <= facts["tolerance"]
            verdict = "within" if is_within else "beyond"
            print(f"{name}: {found:.3g}, {verdict} the tolerance {facts['tolerance']:g}")
            code = code if is_within else 3
    except (NotInOrderError, OSError, ValueError, KeyError) as reason:
        print(reason, file=sys.stderr)
        return 2
    return code


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
