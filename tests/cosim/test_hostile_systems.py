"""FMUs, SSPs and system files that are damaged, or made to do harm: read, or refused in words, and nothing is written outside."""

import json
import os
import random
import shutil
import stat
import tempfile
import time
import warnings
import zipfile
from contextlib import chdir
from pathlib import Path

import pytest
from lxml import etree

from rockshed.core.fmu.fmu_slave import FmuFile
from rockshed.fmus.build import Fmi, Runtime, build
from rockshed.runs.inspection import describe_fmu, describe_system
from rockshed.runs.job import Request, prepare
from rockshed.runs.system import System
from tests.cosim.test_hostile_results import DESCRIPTION, LONGEST, TERMINALS, damaged, told
from tests.unit.test_hostile_inputs import TOKENS, mutated

MANY = int(os.environ.get("ROCKSHED_HOSTILE", "600"))
"""Damages of each kind of the long test."""
NAMES = (
    *("../outside", "a/../../outside", "/tmp/rockshed-outside", "C:\\outside", "..\\outside"),
    *("resources/" * 60 + "deep", "x" * 300, "a\nb", "résumé", "con", ".", "resources", "a//b"),
    *(DESCRIPTION, "SystemStructure.ssd", "modeldescription.xml"),
)
"""Names that a member of an archive may get."""
MOST_COPIES, MOST_BYTES = 40, 400_000
"""Copies of an element, and their length."""
SYSTEM = """name = "two"
description = "a rock that hangs on another one"
exchange_step = 1e-3
stop_time = 0.05
output_interval = 2e-3
state_interval = 0.01
master = "sequential"
order = ["b", "upper.a"]
watch = ["b.velocity.y"]
record = ["*.position.y", "b.energy.*"]
connections = [
    {{ source = "b.position.y", target = "upper.a.force.y", factor = 3.0, offset = -0.1 }},
    {{ source = "upper.a.position.x", target = "b.force.y", factor = 2.0, offset = 0.0 }},
]
[components."upper.a"]
fmu = {fmu}
step = 5e-4
parameters = {{ mass = 0.1, shape = "sphere" }}
[components.b]
fmu = {fmu}
record_states = true
[components.b.parameters]
mass = 0.3
[shared.size]
value = 0.05
targets = ["upper.a.radius", "b.radius"]
[scenario]
inputs = "push.csv"
[[scenario.set]]
port = "upper.a.torque"
value = 4.0
when = "b.position.y < 0.9"
[[scenario.fault]]
port = "b.force.y"
kind = "noise"
from = 0.01
to = 0.02
deviation = 2.0
seed = 1
"""
PUSH = "time,b.force.x\n0.0,0.0\n0.01,20.0\n0.05,-3.5\n"


# --- what is damaged


def member(file: Path, name: str, chance: random.Random) -> None:
    """Damage one member of an archive."""
    content = members(file)
    change = mutated_xml if chance.randrange(3) else mutated
    content[name] = change(content[name], chance)
    rewritten(file, content)


def members(file: Path) -> dict[str, bytes]:
    with zipfile.ZipFile(file) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def rewritten(file: Path, content) -> None:
    with zipfile.ZipFile(file, "w") as archive:
        for name, data in content.items():
            archive.writestr(name, data)


def mutated_xml(content: bytes, chance: random.Random) -> bytes:
    """Change elements and attributes of a document, which stays one."""
    root = etree.fromstring(content)
    for _ in range(chance.randint(1, 3)):
        every = [element for element in root.iter() if isinstance(element.tag, str)]
        chosen, other = chance.choice(every), chance.choice(every)
        attributes = list(chosen.attrib)
        way = chance.randrange(7)
        if way == 0 and chosen is not root:
            chosen.getparent().remove(chosen)
        elif way == 1:
            copied = etree.tostring(chosen)
            most = min(MOST_COPIES, max(1, MOST_BYTES // len(copied)))
            for _ in range(chance.randint(1, most)):
                other.append(etree.fromstring(copied))
        elif way == 2 and attributes:
            del chosen.attrib[chance.choice(attributes)]
        elif way == 3 and attributes:
            chosen.set(chance.choice(attributes), printable(chance.choice(TOKENS)))
        elif way == 4 and other.attrib and attributes:
            chosen.set(chance.choice(attributes), chance.choice(list(other.attrib.values())))
        elif way == 5:
            chosen.tag = other.tag
        else:
            chosen.text = printable(chance.choice(TOKENS))
    return etree.tostring(root, xml_declaration=True, encoding="UTF-8")


def printable(token: str) -> str:
    return "".join(letter for letter in token if letter.isprintable())


def archive(file: Path, name: str, chance: random.Random) -> None:
    """Damage an archive: its bytes, names of its members, what they are and say that they are."""
    ways = (bytes_changed, bytes_changed, renamed, linked, doubled, blown_up, cut_off)
    chance.choice(ways)(file, chance)


def bytes_changed(file: Path, chance: random.Random) -> None:
    file.write_bytes(damaged(file.read_bytes(), chance))


def renamed(file: Path, chance: random.Random) -> None:
    content = members(file)
    old, new = chance.choice(list(content)), chance.choice(NAMES)
    if chance.randrange(2):  # the others stay
        content[new] = content[old]
    else:
        content = {new if name == old else name: data for name, data in content.items()}
    rewritten(file, content)


def linked(file: Path, chance: random.Random) -> None:
    content = members(file)
    chosen = chance.choice(list(content))
    with zipfile.ZipFile(file, "w") as made:
        for name, data in content.items():
            entry = zipfile.ZipInfo(name)
            if name == chosen:
                kind = chance.choice((stat.S_IFLNK, stat.S_IFIFO, stat.S_IFCHR, stat.S_IFDIR))
                entry.external_attr = (kind | 0o777) << 16
                data = chance.choice((b"../../outside", b"/etc/passwd", data))
            made.writestr(entry, data)


def doubled(file: Path, chance: random.Random) -> None:
    """Let names stand twice, or many members."""
    content = members(file)
    name = chance.choice(list(content))
    with zipfile.ZipFile(file, "a") as made, warnings.catch_warnings():
        warnings.simplefilter("ignore")  # zipfile tells of the double name
        for _ in range(chance.choice((1, 2, 50))):
            made.writestr(name, chance.choice((b"", content[name], b"other")))


def blown_up(file: Path, chance: random.Random) -> None:
    """Let a member say that it is larger, smaller or of another kind than it is."""
    data = bytearray(file.read_bytes())
    signature, fields = chance.choice(
        ((b"PK\x01\x02", (8, 10, 20, 24, 28)), (b"PK\x03\x04", (6, 8, 18, 22)))
    )
    places = [at for at in range(len(data) - 46) if data[at : at + 4] == signature]
    at = chance.choice(places) + chance.choice(fields)
    data[at : at + 4] = chance.choice(
        (b"\xff\xff\xff\x7f", b"\xff\xff\xff\xff", b"\0\0\0\0", b"\1\0\0\0")
    )
    file.write_bytes(data)


def cut_off(file: Path, chance: random.Random) -> None:
    data = file.read_bytes()
    file.write_bytes(
        chance.choice((data[: chance.randrange(len(data))], data[chance.randrange(len(data)) :]))
    )


def text(file: Path, name: str, chance: random.Random) -> None:
    file.write_bytes(mutated(file.read_bytes(), chance))


# --- how it is read


def described(place: Path) -> None:
    """As `rockshed info` and `rockshed run` read an FMU."""
    describe_fmu(place / "a.fmu")
    planned(place / "one.toml")


def unpacked(place: Path) -> None:
    """As `rockshed run` unpacks an FMU."""
    inside = place / "unpacked"
    inside.mkdir()
    try:
        FmuFile(place / "a.fmu").unpack(inside)
    finally:
        shutil.rmtree(inside)
    described(place)


def planned(file: Path) -> None:
    """As `rockshed info` and `rockshed run` read a system."""
    describe_system(prepare(Request(str(file))))


def read_system(place: Path) -> None:
    planned(place / "two.toml")


def read_ssp(place: Path) -> None:
    planned(place / "two.ssp")


# --- what is made once


def an_fmu(place: Path, fmi=Fmi.TWO) -> None:
    place.mkdir()
    made = build("FallingRock", destination=place / "built", runtime=Runtime.NATIVE, fmi=fmi)
    content = members(made)
    shutil.rmtree(place / "built")
    binaries = {name: b"not loaded" for name in content if name.startswith("binaries/")}
    rewritten(place / "a.fmu", content | binaries)
    one = 'name = "one"\nexchange_step = 0.01\nstop_time = 0.1\n[components.rock]\nfmu = "a.fmu"\n'
    (place / "one.toml").write_text(one)


def an_fmu_3(place: Path) -> None:
    an_fmu(place, Fmi.THREE)


def a_system(place: Path) -> None:
    an_fmu(place)
    (place / "two.toml").write_text(SYSTEM.format(fmu=json.dumps("a.fmu")))
    (place / "push.csv").write_text(PUSH)


def an_ssp(place: Path) -> None:
    a_system(place)
    own = (place / "two.toml").read_text()
    (place / "two.toml").write_text(own[: own.index("[scenario]")])  # an SSP has none
    System.load(place / "two.toml").save(place / "two.ssp")
    assert "SystemStructure.ssd" in members(place / "two.ssp")


KINDS = {
    "archive": (an_fmu, unpacked, archive, (("a.fmu", ""),)),
    "description": (an_fmu, described, member, (("a.fmu", DESCRIPTION),)),
    "description of FMI 3": (
        *(an_fmu_3, described, member),
        (("a.fmu", DESCRIPTION), ("a.fmu", TERMINALS)),
    ),
    "archive of an SSP": (an_ssp, read_ssp, archive, (("two.ssp", ""),)),
    "description of an SSP": (an_ssp, read_ssp, member, (("two.ssp", "SystemStructure.ssd"),)),
    "system file": (
        a_system,
        read_system,
        text,
        (("two.toml", ""), ("two.toml", ""), ("push.csv", "")),
    ),
}
"""What is made, how it is read, what damages it, and what is damaged: file and member."""
FOUND = {"system file": (511, 522, 7653), "description of an SSP": (428,)}
"""Damages that ended in something else than a refusal once."""


@pytest.fixture(scope="module", params=KINDS)
def kind(request, tmp_path_factory):
    place = tmp_path_factory.mktemp("made") / "whole"
    KINDS[request.param][0](place)
    KINDS[request.param][1](place)  # it can be read
    return request.param, place


def attack(kind, numbers, folder: Path, monkeypatch) -> None:
    """Damage, read and look around; any other end than a reading or a refusal is an error."""
    name, made = kind
    _, read, damage, targets = KINDS[name]
    around = {"place", "here", "cache", "tmp"}
    for empty in around - {"place"}:
        (folder / empty).mkdir(mode=0o700)
    monkeypatch.setenv("ROCKSHED_CACHE_DIR", str(folder / "cache"))
    monkeypatch.setattr(tempfile, "tempdir", str(folder / "tmp"))
    place = folder / "place"
    for number in numbers:
        shutil.copytree(made, place)
        file, inside = targets[number % len(targets)]
        damage(place / file, inside, random.Random(f"{name} {number}"))
        before = sorted(path.name for path in place.iterdir())
        began = time.process_time()
        try:
            with chdir(folder / "here"):
                told(read, place)
            assert time.process_time() - began < LONGEST
            assert {entry.name for entry in folder.iterdir()} == around
            assert sorted(path.name for path in place.iterdir()) == before
            assert not [*(folder / "here").iterdir(), *(folder / "tmp").iterdir()]
            assert {entry.name for entry in (folder / "cache").iterdir()} <= {"ssp"}
        except BaseException as error:
            error.add_note(f"mutation {number} of {name}")
            raise
        shutil.rmtree(place)
        shutil.rmtree(folder / "cache" / "ssp", ignore_errors=True)


def test_a_damaged_system_is_read_or_refused_in_words(kind, tmp_path, monkeypatch):
    attack(kind, [*range(20), *FOUND.get(kind[0], ())], tmp_path, monkeypatch)


@pytest.mark.slow
def test_thousands_of_damaged_systems_are_read_or_refused_in_words(kind, tmp_path, monkeypatch):
    attack(kind, range(20, 20 + MANY), tmp_path, monkeypatch)
