"""The kept runs of FMUs for other platforms: ``python -m docs.tables.platforms RESULTS.xml ...``.

RESULTS.xml is what ``pytest -m slow tests/fmu/test_other_platforms*.py --junitxml RESULTS.xml``
has written: each of these tests compares an FMU for another platform, run by an emulator, with that
for Linux on x86-64, and tells the :func:`stamp` of the kernels that it has run. Then ``python -m
docs.tables`` writes the table of the page.
"""

import json
import re
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
from lxml import etree

from rockshed.components.catalogue import NAMES, component
from rockshed.papers.kernel_stamps import of_run, of_series
from rockshed.runs.request import Request

from .forms import table
from .kept import FOLDER, NotKeptError

DATA = FOLDER / "platforms.json"
RUNNERS = {"win64": ("wine", "wine64"), "aarch64-linux": ("qemu-aarch64",)}
"""Programs that run each platform; the first one that is installed tells its version."""
TESTS = {"tests.fmu.test_other_platforms": "2.0", "tests.fmu.test_other_platforms_fmi3": "3.0"}
"""Modules of the tests, and the version of FMI of their FMUs."""
STEP, STEPS = 1e-5, 50
"""Communication step (s) and number of steps that an FMU makes."""
OUT_OF_THE_WAY = {"rock.position.x": 0.6, "rock.position.y": 0.2}
"""Inputs of the sand that it does not refuse."""
IMPACT = "the laboratory impact on arm has the bits of a run"
"""Sentence of the test of a system."""
EXCHANGES = 1000
"""Of that system."""
_CLAIMS = ("equal bits", "other bits")
"""Beginnings of results that say something about the kernels."""
_REMEDY = (
    "run `pytest -m slow tests/fmu/test_other_platforms*.py --junitxml RESULTS.xml`, then "
    "`python -m docs.tables.platforms RESULTS.xml`"
)


@cache
def kept() -> Mapping[str, Any]:
    """Return the kept results: versions of the emulators, and a row for each test."""
    found: Mapping[str, Any] = json.loads(DATA.read_text(encoding="utf-8"))
    return found


def take(files: Sequence[Path]) -> None:
    """Keep the results of the tests.

    Raises
    ------
    NotKeptError
        A component or a platform is not among the results, or they are of older kernels.
    """
    rows = [row for file in files for row in _rows(file)]
    if problems := outdated(rows):
        raise NotKeptError("; ".join(problems))
    runners = {platform: _version(programs) for platform, programs in RUNNERS.items()}
    lines = ",\n".join(json.dumps(row) for row in rows)
    facts = json.dumps({"runners": runners}, indent=1)[:-2]
    DATA.write_text(f'{facts},\n "rows": [\n{lines}\n]}}\n', encoding="utf-8")
    kept.cache_clear()


@cache
def stamp(name: str) -> str:
    """Return the digest of a component's run by the present kernels, in this process.

    Parameters
    ----------
    name : str
        Of the component, or :data:`IMPACT`.

    Returns
    -------
    str
        See :mod:`rockshed.papers.kernel_stamps`.
    """
    if name == IMPACT:
        return of_run(Request("lab-impact", options={"stop_time": EXCHANGES * STEP}))
    made = component(name)
    instance = made.instance(**made.with_sizes())
    if name == "SandCushion":
        for variable, value in OUT_OF_THE_WAY.items():
            instance[variable] = value
    instance.initialise()
    outputs = [v.name for v in made.layout.variables if v.causality == "output"]
    rows = []
    for number in range(STEPS):
        instance.step(number * STEP, STEP)
        rows.append(np.concatenate([np.ravel(instance[output]) for output in outputs]))
    return of_series({f"{place}": column for place, column in enumerate(np.transpose(rows))})


def outdated(rows: list[dict[str, str]]) -> list[str]:
    """Return which components were not run on a platform, or by older kernels, with the remedy."""
    there = {(row["name"], row["fmi"], row["platform"]) for row in rows}
    missing = [
        f"{name}, FMI {fmi}, {platform}: was not run; {_REMEDY}"
        for name, fmi, platform in product(NAMES, TESTS.values(), RUNNERS)
        if (name, fmi, platform) not in there
    ]
    return missing + [
        f"{row['name']}, FMI {row['fmi']}, {row['platform'] or 'system'}: other than when it was "
        f"run, by kernels; {_REMEDY}"
        for row in rows
        if row["result"].startswith(_CLAIMS) and row["stamp"] != stamp(row["name"])
    ]


def _rows(file: Path) -> Iterator[dict[str, str]]:
    """Yield component or sentence, platform, result and stamp of each test."""
    for case in etree.parse(file).iter("testcase"):
        fmi = TESTS.get(str(case.get("classname")))
        if fmi is None:
            continue
        name = str(case.get("name"))
        parts = re.fullmatch(rf"test_.*\[(.+)-({'|'.join(RUNNERS)})\]", name)
        sentence = name.removeprefix("test_").replace("_", " ")
        yield {
            "name": parts[1] if parts else sentence,
            "fmi": fmi,
            "platform": parts[2] if parts else "",
            "result": _result(case),
            "stamp": str(case.xpath("string(properties/property[@name='stamp']/@value)")),
        }


def _result(case: Any) -> str:
    """Return how a test has ended, in words."""
    for kind, words in (("failure", "other bits"), ("error", "no"), ("skipped", "not run")):
        found = case.find(kind)
        if found is not None:
            said = (found.get("message") or "").strip().splitlines() or [""]
            return f"{words}: {said[0][:160]}"
    return "equal bits"


def _version(programs: tuple[str, ...]) -> str:
    """Return the version of the first of some programs that is installed."""
    for program in programs:
        if place := shutil.which(program):
            said = subprocess.run([place, "--version"], capture_output=True, text=True, check=False)
            return said.stdout.strip().splitlines()[0]
    return "not installed"


def platforms() -> str:
    """Return which FMU has which result on which platform."""
    rows = kept()["rows"]
    found = {(row["name"], row["fmi"], row["platform"]): row["result"] for row in rows}
    lines = [
        [name, fmi, "native", *(found.get((name, fmi, platform), "-") for platform in RUNNERS)]
        for fmi, name in product(TESTS.values(), NAMES)
    ]
    runners = kept()["runners"]
    heads = [f"{platform} ({runners[platform]})" for platform in RUNNERS]
    others = [f"- {row['name']}: {row['result']}" for row in rows if not row["platform"]]
    shown = table(["FMU", "FMI", "runtime", *heads], lines)
    return "\n".join([shown, "", "Systems:", "", *others]) if others else shown


TABLES: Mapping[str, Callable[[], str]] = {"others": platforms}


if __name__ == "__main__":
    try:
        take([Path(word) for word in sys.argv[1:]])
    except (NotKeptError, OSError, etree.XMLSyntaxError) as reason:
        sys.exit(str(reason))
