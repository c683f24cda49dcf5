"""Results, states and archives that are damaged, or made to do harm: they are read, or refused in words."""

import json
import os
import random
import shutil
import time
import zipfile
from contextlib import suppress
from hashlib import sha256
from pathlib import Path

import numpy as np
import pytest

import rockshed
from docs.tables.kept import NotKeptError, finished
from rockshed import pictures
from rockshed.analyses.calibration import files as calibration
from rockshed.analyses.calibration.fit import fit
from rockshed.analyses.calibration.measurement import of_stiffness
from rockshed.analyses.calibration.search import Calibration
from rockshed.analyses.frame import shared_folder, whole_folder
from rockshed.analyses.saved import saved_result
from rockshed.core.errors import InputRefused
from rockshed.core.fmu.fmu_slave import FmuFile
from rockshed.core.loop.journal import FILE, LEGEND, last_entry
from rockshed.core.results.own_files import refuse_foreign
from rockshed.core.results.run_folder import RunFolder
from rockshed.core.system.reading import system_from
from rockshed.files import write_json
from rockshed.fmus.build import Fmi, Runtime, build
from rockshed.metrics.contents import ForeignStateError, decoded
from rockshed.metrics.headlines import headlines
from rockshed.papers.reproduction import DATA, PAGE
from rockshed.runs.inspection import describe_fmu, describe_system
from rockshed.runs.job import Request, prepare
from rockshed.runs.kept import FINISHED, KeptRuns
from rockshed.runs.outcome import Outcome
from tests.docs.test_tables import reproduction
from tests.unit.test_calibration import pushes
from tests.unit.test_hostile_inputs import EXAMPLES, mutated

DESCRIPTION = "modelDescription.xml"
LONGEST = 20.0
"""Seconds of computing that results may take."""
MANY = int(os.environ.get("ROCKSHED_DAMAGES", "400"))
"""Damages of each kind of the long test."""
TERMINALS = "terminalsAndIcons/terminalsAndIcons.xml"
MINE = "notes.txt"
"""File of the user's beside results."""
SYSTEM = """
name = "one"
exchange_step = 0.01
stop_time = 0.1
[components.rock]
fmu = "a.fmu"
"""


JOURNALLED = {
    "components": ["a", "b"],
    "start": 0,
    "exchange": 10**10,
    "period": 1,
    "operations": [["a", 1, 0, 10**10]],
}


def damaged(content: bytes, chance: random.Random) -> bytes:
    """Return binary content with one to three changes."""
    for _ in range(chance.randint(1, 3)):
        at, length = chance.randrange(len(content) + 1), chance.choice((1, 2, 4, 8, 64, 1024))
        changes = {
            "bits": bytes(byte ^ 1 << chance.randrange(8) for byte in content[at : at + 1]),
            "numbers": chance.choice((b"\xff", b"\0", b"\x7f", b"\x80")) * length,
            "noise": chance.randbytes(length),
            "repeated": content[max(0, at - length) : at],
        }
        new = changes[chance.choice(tuple(changes))]
        replaced = chance.choice((len(new), len(new), 0, length))
        content = content[:at] + new + content[at + replaced :]
        if not chance.randrange(8):
            content = content[:at]
    return content


# --- what is read, and how: a function of the folder of what was made once for all


def run_read(folder: Path) -> None:
    """Everything of a run but the drawing itself, which takes a second."""
    assert saved_result(folder) is None
    run = rockshed.read_run(folder)
    assert repr(run) + run._repr_html_()
    assert [run.status, run.error, run.warnings]
    assert headlines(run) is not None
    for picture in pictures.pictures_of(run):
        picture.missing(run)
    for component in run.provenance["components"]:
        for _, state in run.states(component):
            with suppress(ForeignStateError):
                decoded(run, component, state)


def run_drawn(folder: Path) -> None:
    """As `rockshed plot` draws."""
    rockshed.read_run(folder).figures(folder / "figures")


def analysis_read(folder: Path) -> None:
    result = saved_result(folder)
    if result is None:  # it says that it is a run
        rockshed.read_run(folder)
        return
    assert [result.tables(), result.notes, result.warnings, repr(result)]


def inspected(folder: Path) -> None:
    describe_fmu(folder / "a.fmu")
    request = Request(str(folder / "system.toml"))
    describe_system(prepare(request))


def unpacked(folder: Path) -> None:
    inside = folder / "unpacked"
    inside.mkdir()
    try:
        FmuFile(folder / "a.fmu").unpack(inside)
    finally:
        shutil.rmtree(inside)
    inspected(folder)


def journal_read(folder: Path) -> None:
    assert last_entry(folder, "SIGSEGV")


def written_again(folder: Path) -> None:
    """As `rockshed calibrate` and `rockshed run` write over what is there."""
    with suppress(InputRefused), shared_folder(folder, calibration.NAMES) as place:
        (place / calibration.DATA).write_text("{}")
    assert (folder / MINE).read_text() == MINE
    with suppress(InputRefused), whole_folder(folder) as place:
        (place / "run.json").write_text("{}")
    assert (folder / MINE).read_text() == MINE


def reproduction_read(folder: Path) -> None:
    """As `rockshed reproduce` and the tables of the documentation take it."""
    with suppress(InputRefused):
        refuse_foreign(folder, (DATA, PAGE), "take another folder")
    with suppress(NotKeptError):
        finished(folder)
    assert (folder / MINE).read_text() == MINE


def kept_run_read(folder: Path) -> None:
    runs = KeptRuns(folder / FINISHED)
    found = runs.find("task", a_system(), False)
    if found is not None:
        assert found.status + found.error + "".join(found.fmus.values()) is not None
        assert np.isfinite([*found.metrics.values(), found.wall_time]).all()
        assert all(np.isfinite(column).all() for column in found.series.values())
        assert len({column.shape for column in found.series.values()}) <= 1
        assert dict(found.options) is not None
    runs.clear()
    assert {file.name for file in runs.folder.iterdir()} == {MINE, "run-of-mine.npz"}


# --- what is made once


def a_run(place: Path) -> None:
    case = rockshed.case("lab-impact", in_process=True, stop_time=0.0005, state_interval=0.0002)
    rockshed.simulate(case, place)


def a_killed_run(place: Path) -> None:
    a_run(place)
    run = rockshed.read_run(place)
    states = list(run.states("sand"))
    with RunFolder(place.with_name("killed")) as results:
        results.begin(run.columns[1:], {**run.provenance, "status": "running"})
        results.rows(run.time, np.column_stack([run.series[c.name] for c in run.columns[1:]]))
        for at, state in states:
            results.frame("sand", at, state)
        shutil.rmtree(place)
        shutil.copytree(results.running, place)


def a_campaign(place: Path) -> None:
    rockshed.rockfall(EXAMPLES / "slope.toml", trials=50, folder=place, pictures=False)


def a_pile(place: Path) -> None:
    rockshed.pile(EXAMPLES / "spt.toml", folder=place, pictures=False)


def an_fmu(place: Path, runtime=Runtime.PYTHON, fmi=Fmi.TWO) -> None:
    place.mkdir()
    file = build("FallingRock", destination=place / "built", runtime=runtime, fmi=fmi)
    shutil.copy(file, place / "a.fmu")
    shutil.rmtree(place / "built")
    (place / "system.toml").write_text(SYSTEM)


def an_fmu_3(place: Path) -> None:
    an_fmu(place, Runtime.NATIVE, Fmi.THREE)


def a_journal(place: Path) -> None:
    """The journal of a process that has died in a component's second step."""
    place.mkdir()
    write_json(place / LEGEND, JOURNALLED)
    np.array([1, 0]).tofile(place / FILE)


def a_calibration(place: Path) -> None:
    place.mkdir()
    made = Calibration("locked", {}, [fit(of_stiffness(57e3, "k"), pushes())], pushes())
    calibration.write_files([made], ["a remark"], place)
    (place / MINE).write_text(MINE)


def a_reproduction(place: Path) -> None:
    reproduction(place)
    (place / PAGE).write_text("a page")
    (place / MINE).write_text(MINE)


def a_system():
    """A system whose FMU is any file: it is not run."""
    components = {"sand": {"fmu": __file__}}
    return system_from(
        {"name": "kept", "components": components, "exchange_step": 1.0, "stop_time": 1.0}
    )


def a_kept_run(place: Path) -> None:
    series = {name: np.linspace(0.0, 1.0, 50) for name in ("time", "sand.force")}
    kinds = {
        "metrics": {"peak": 2.0},
        "options": {"packing": "square"},
        "fmus": {"sand": sha256(Path(__file__).read_bytes()).hexdigest()},
    }
    outcome = Outcome("task", "complete", series=series, **kinds, wall_time=3.0)
    KeptRuns(place / FINISHED).keep(a_system(), False, outcome)
    for name in (MINE, "run-of-mine.npz"):
        (place / FINISHED / name).write_text(MINE)


# --- what is damaged: a file of what was made, or a member of an archive


def whole(folder: Path, name: str, chance: random.Random) -> None:
    """Damage a file."""
    change = mutated if name.endswith((".json", ".csv", ".toml")) else damaged
    (folder / name).write_bytes(change((folder / name).read_bytes(), chance))


def member(folder: Path, name: str, chance: random.Random) -> None:
    """Damage a member of the archive alone."""
    file = folder / "a.fmu"
    with zipfile.ZipFile(file) as archive:
        content = {entry: archive.read(entry) for entry in archive.namelist()}
    content[name] = mutated(content[name], chance)
    with zipfile.ZipFile(file, "w") as archive:
        for entry, data in content.items():
            archive.writestr(entry, data)


def request(folder: Path, name: str, chance: random.Random) -> None:
    """Damage the request that a run keeps, and leave the rest."""
    content = json.loads((folder / name).read_text())
    asked = content["request"] | {"values": {"sand.modulus": 3e6}, "sizes": {"sand.discs": 360}}
    while True:
        with suppress(ValueError, RecursionError):
            content["request"] = json.loads(mutated(json.dumps(asked).encode(), chance))
            break
    write_json(folder / name, content)


def inside(folder: Path, name: str, chance: random.Random) -> None:
    """Damage the facts in a kept run, in an archive that is whole."""
    (file,) = (path for path in (folder / FINISHED).glob("run-*.npz") if len(path.name) > 30)
    with np.load(file) as stored:
        arrays = dict(stored)
    if name == "facts":
        facts = mutated(arrays["facts"].tobytes(), chance)
        arrays["facts"] = np.frombuffer(facts, np.uint8)
    else:
        others = (
            np.zeros(50, complex),
            np.zeros((2, 3)),
            np.array(["a"] * 50),
            np.full(50, np.nan),
        )
        arrays[f"column-{chance.randrange(2)}"] = chance.choice(others)
    np.savez(file, **arrays)


def kept_whole(folder: Path, name: str, chance: random.Random) -> None:
    (file,) = (path for path in (folder / FINISHED).glob("run-*.npz") if len(path.name) > 30)
    file.write_bytes(damaged(file.read_bytes(), chance))


KINDS = {
    "request of a run": (a_run, run_read, request, ("run.json",)),
    "calibration": (a_calibration, written_again, whole, (calibration.DATA,)),
    "reproduction": (a_reproduction, reproduction_read, whole, (DATA,)),
    "kept run": (a_kept_run, kept_run_read, kept_whole, ("",)),
    "content of a kept run": (a_kept_run, kept_run_read, inside, ("facts", "columns")),
    "run": (a_run, run_read, whole, ("run.json", "summary.json", "columns.csv")),
    "binary files of a run": (a_run, run_read, whole, ("timeseries.parquet", "states.h5")),
    "killed run": (a_killed_run, run_read, whole, ("timeseries.arrows", "states.arrows")),
    "campaign": (a_campaign, analysis_read, whole, ("run.json",)),
    "binary files of a campaign": (
        *(a_campaign, analysis_read, whole),
        ("trials.parquet", "envelopes.parquet"),
    ),
    "pile": (a_pile, analysis_read, whole, ("run.json",)),
    "archive": (an_fmu, unpacked, whole, ("a.fmu",)),
    "description": (an_fmu, inspected, member, (DESCRIPTION,)),
    "description and terminals of FMI 3": (
        *(an_fmu_3, inspected, member),
        (DESCRIPTION, TERMINALS),
    ),
    "journal": (a_journal, journal_read, whole, (FILE, LEGEND)),
}


@pytest.fixture(scope="module", params=KINDS)
def kind(request, tmp_path_factory):
    """What was made once, and how it is read and damaged."""
    make, read, damage, names = KINDS[request.param]
    place = tmp_path_factory.mktemp("made") / "whole"
    make(place)
    return request.param, place, read, damage, names


def attack(kind, numbers: range, folder: Path) -> None:
    name, made, read, damage, names = kind
    place = folder / "place"
    for number in numbers:
        shutil.copytree(made, place)
        damage(place, names[number % len(names)], random.Random(f"{name} {number}"))
        began = time.process_time()
        try:
            told(read, place)
            assert time.process_time() - began < LONGEST
            assert [entry.name for entry in folder.iterdir()] == ["place"]
        except BaseException as error:
            error.add_note(f"mutation {number} of {name}")
            raise
        shutil.rmtree(place)


def told(read, place: Path) -> None:
    """Read what is damaged. Any other end than these two is an error of the test."""
    problems = []
    try:
        read(place)
    except InputRefused as refusal:
        problems = refusal.problems or [None]
    assert all(problem.where and problem.what for problem in problems)
    assert sum(len(str(problem)) for problem in problems) < 40_000


def test_what_is_damaged_is_read_or_refused_in_words(kind, tmp_path):
    attack(kind, range(20), tmp_path)


@pytest.mark.slow
def test_thousands_of_damages_are_read_or_refused_in_words(kind, tmp_path):
    attack(kind, range(20, 20 + MANY), tmp_path)
