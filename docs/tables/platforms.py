"""The kept runs of FMUs for other platforms: ``python -m docs.tables.platforms RESULTS.xml ...``.

RESULTS.xml is what ``pytest -m slow tests/fmu/test_other_platforms*.py --junitxml RESULTS.xml``
has written: each of these tests compares an FMU for another platform, run by an emulator, with that
for Linux on x86-64. Then ``python -m docs.tables`` writes the table of the page.
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

from lxml import etree

from rockshed.components.catalogue import NAMES

from .forms import table
from .kept import FOLDER, NotKeptError

DATA = FOLDER / "platforms.json"
RUNNERS = {"win64": ("wine", "wine64"), "aarch64-linux": ("qemu-aarch64",)}
"""Programs that run each platform; the first one that is installed tells its version."""
TESTS = {"tests.fmu.test_other_platforms": "2.0", "tests.fmu.test_other_platforms_fmi3": "3.0"}
"""Modules of the tests, and the version of FMI of their FMUs."""
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
        A component or a platform is not among the results.
    """
    rows = [row for file in files for row in _rows(file)]
    if missing := outdated(rows):
        raise NotKeptError("; ".join(missing))
    runners = {platform: _version(programs) for platform, programs in RUNNERS.items()}
    lines = ",\n".join(json.dumps(row) for row in rows)
    facts = json.dumps({"runners": runners}, indent=1)[:-2]
    DATA.write_text(f'{facts},\n "rows": [\n{lines}\n]}}\n', encoding="utf-8")
    kept.cache_clear()


def outdated(rows: list[dict[str, str]]) -> list[str]:
    """Return which components were not run on a platform, with the remedy."""
    there = {(row["name"], row["fmi"], row["platform"]) for row in rows}
    return [
        f"{name}, FMI {fmi}, {platform}: was not run; {_REMEDY}"
        for name, fmi, platform in product(NAMES, TESTS.values(), RUNNERS)
        if (name, fmi, platform) not in there
    ]


def _rows(file: Path) -> Iterator[dict[str, str]]:
    """Yield component or sentence, platform and result of each test."""
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
