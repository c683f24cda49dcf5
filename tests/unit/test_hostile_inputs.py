"""Input files that are damaged, or made to do harm: they are read, or refused in words."""

import io
import random
import re
import time
import warnings
from contextlib import chdir
from pathlib import Path

import pytest

import rockshed
from rockshed.analyses.calibration.curve_file import read_curve
from rockshed.campaigns.campaign import campaign_of
from rockshed.core.errors import InputRefused
from rockshed.core.system.reading import load_system
from rockshed.sites.pile.preparation import prepare as prepare_pile
from rockshed.sites.rockfall.preparation import prepare as prepare_slope

EXAMPLES = Path(rockshed.__file__).parent / "examples"
CURVE = "penetration (cm),load (kgf)\n0.5,20\n1,41.5\n2,80\n3,120\n4,155\n"
PROFILE = '"x","y","material"\r\n0,60,"rock"\r\n20,40,"soil"\r\n70,5,"soil"\r\n100,0,\r\n'
WITH_CSV = "profile.csv"
SITE = """\
rock = { radius = 0.5, density = 2600 }
start = { x = 1 }
limit_speed = { mean = 12, deviation = 2 }
profile = { file = "FILE" }
ground = [{ material = "soil" }]
"""
TOKENS = (
    "1e400", "-1e400", "nan", "inf", "5e-324", "1e308", "-1", "0", "9" * 400, "9" * 5000, "true",
    '""', '"\\u0000"', '"../x"', "[]", "{}", "[[{a=1}]]", "[" * 30 + "]" * 30, "[" * 500, "{a=" * 300,
    "1979-05-27", "07:32:00", '"""', "'''", "\x00", "\x1b[2J", "\r", "\ufeff", "é", "#", "=", ",", ";",
    '"', "\t", "0x7fffffffffffffff", "0b1", "[a.b.c]\n", "a.b.c.d = 1\n", "[[line]]\n", "x" * 2000,
)  # fmt: skip
LONGEST = 10.0
"""Seconds of computing that a file may take."""


def mutated(content: bytes, chance: random.Random) -> bytes:
    """Return the content with one to three changes."""
    for _ in range(chance.randint(1, 3)):
        at = chance.randint(0, len(content))
        way = chance.choice((0, 1, 2, 3, 3, 3, 3, 3, 3, 5, 6))
        if way == 0:
            content = content[:at] + bytes([chance.randrange(256)]) + content[at + 1 :]
        elif way == 1:
            content = content[:at] + chance.choice(TOKENS).encode() + content[at:]
        elif way == 2:
            content = content[:at] + content[at + chance.randint(1, 40) :]
        elif way == 3:  # a value becomes another
            values = list(_VALUE.finditer(content))
            if values:
                found = chance.choice(values)
                other = chance.choice(TOKENS).encode()
                content = content[: found.start()] + other + content[found.end() :]
        elif way == 5:
            lines = content.split(b"\n")
            lines.insert(chance.randrange(len(lines)), chance.choice(lines))
            content = b"\n".join(lines)
        else:
            content = content[:at]
    return content


_OF_PYTHON = re.compile("nput should|could not convert|invalid literal|Exceeds the limit|NoneType")
"""Words of a library that no user has asked for."""
_VALUE = re.compile(rb'-?\d[\d.e+-]*|"[^"\n]*"|true|false')


def slope(path: Path) -> None:
    campaign_of(prepare_slope(path))


def profile(path: Path) -> None:
    site = path.with_suffix(".toml")
    site.write_text(SITE.replace("FILE", path.name))
    campaign_of(prepare_slope(site))


def drawing() -> bytes:
    addons = pytest.importorskip("ezdxf.addons")
    stream = io.StringIO()
    with addons.r12writer(stream) as made:
        made.add_polyline([(0, 100), (20, 80), (50, 60)])
        made.add_line((50, 60), (90, 50))
        made.add_arc((90, 60), radius=10, start=270, end=300)
    return stream.getvalue().encode()


def example(name: str) -> bytes:
    return (EXAMPLES / name).read_bytes()


PARSERS = {
    "slope": (slope, lambda: example("slope.toml"), ".toml"),
    "shed": (slope, lambda: example("shed.toml"), ".toml"),
    "profile.csv": (profile, lambda: PROFILE.encode(), ".csv"),
    "profile.dxf": (profile, drawing, ".dxf"),
    "pile": (prepare_pile, lambda: example("pile.toml"), ".toml"),
    "spt": (prepare_pile, lambda: example("spt.toml"), ".toml"),
    "curve": (read_curve, lambda: CURVE.encode(), ".csv"),
    "system": (load_system, lambda: example("rigid_floor.toml"), ".toml"),
}


def refused_or_read(parse, path: Path) -> None:
    """Any other end of the parser than these two is an error of the test."""
    began = time.process_time()
    told = []
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            parse(path)
    except InputRefused as refusal:
        told = refusal.problems or [None]
    assert all(problem.where and problem.what for problem in told)
    assert sum(len(str(problem)) for problem in told) < 20_000
    assert not any(_OF_PYTHON.search(problem.what) for problem in told)
    assert time.process_time() - began < LONGEST


def fuzz(parser: tuple, name: str, numbers: range, folder: Path) -> None:
    """Read mutations of a file; nothing else is written."""
    parse, content, ending = parser
    original = content()
    before = {path.name for path in folder.iterdir()}
    file = folder / f"input{ending}"
    file.write_bytes(original)
    parse(file)  # kernels are compiled here
    here = folder / "here"
    here.mkdir()
    with chdir(here):
        for number in numbers:
            file.write_bytes(mutated(original, random.Random(f"{name} {number}")))
            try:
                refused_or_read(parse, file)
            except BaseException as error:
                error.add_note(f"mutation {number} of {name}")
                raise
    here.rmdir()
    assert {path.name for path in folder.iterdir()} - before <= {file.name, "input.toml"}


@pytest.mark.parametrize("name", PARSERS)
def test_a_mutated_file_is_read_or_refused_in_words(name, tmp_path):
    fuzz(PARSERS[name], name, range(150), tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize("name", PARSERS)
def test_20_000_mutated_files_are_read_or_refused_in_words(name, tmp_path):
    fuzz(PARSERS[name], name, range(150, 2650), tmp_path)


HEAD = "rock = { radius = 0.5, density = 2600 }\nstart = { x = 1 }\n"
LIMITS = "limit_speed = { mean = 12, deviation = 2 }\n"


@pytest.mark.parametrize(
    ("lines", "words"),
    [
        ("seed = " + "9" * 5000, "an integer of thousands of digits"),
        ("trials = " + "9" * 400, "trials: must be"),
        ("trials = 1e400", "trials: must be a"),
        ("line = " + "[" * 3000 + "]" * 3000, "is nested more than 40 deep"),
        ("line = " + "[" * 60 + "]" * 60, "is nested more than 40 deep"),
        (".".join("a" * 3000) + " = 1", "is nested more than 40 deep"),
        ("material = [[{a=1}]]", "material: must be a table"),
        ('profile = { file = "a\\u0000.csv" }', "neither a CSV nor|there is no file"),
        ("profile = { points = [[0, 1], [" + "9" * 400 + ", 0]] }", "is no point"),
        ("stations = 1e9", "stations: must be less than or equal to 100000"),
    ],
)
def test_values_that_no_computer_can_hold_are_refused_in_words(tmp_path, lines, words):
    file = tmp_path / "site.toml"
    points = "" if "profile" in lines else 'profile = { points = [[0, 9, "soil"], [9, 0]] }\n'
    file.write_text(lines + "\n" + HEAD + LIMITS + points)
    with pytest.raises(InputRefused, match=words):
        slope(file)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("length = ", "length = 5e-324 # "),
        ("area = ", "area = 1e-40 # "),
        ("mass = ", "mass = 1e300 # "),
    ],
)
def test_lengths_and_masses_that_nothing_has_are_refused(tmp_path, old, new):
    file = tmp_path / "pile.toml"
    file.write_text(example("pile.toml").decode().replace(old, new))
    with pytest.raises(InputRefused, match=r"must be (1e-30 or more|less than or equal to 1e\+30)"):
        prepare_pile(file)


def test_a_field_of_a_csv_file_of_131_kilobytes_is_refused(tmp_path):
    for parse, text in ((read_curve, CURVE), (profile, PROFILE)):
        file = tmp_path / "long.csv"
        file.write_text(text + "x" * 140_000 + ",1\n")
        with pytest.raises(InputRefused, match="a field of 140000 letters, and 1000 are the most"):
            parse(file)


@pytest.mark.parametrize(
    ("code", "old", "new"),
    [(40, "10", "1e20"), (40, "10", "1e9"), (10, "90", "1e20"), (51, "300", "1e308")],
)
def test_a_curve_of_which_no_division_comes_to_an_end_is_refused(tmp_path, code, old, new):
    file = tmp_path / "profile.dxf"
    text = drawing().decode()
    assert f"{code}\n{old}\n" in text
    file.write_text(text.replace(f"{code}\n{old}\n", f"{code}\n{new}\n"))
    with pytest.raises(InputRefused, match=r"has a coordinate beyond 1e\+08 m|is no DXF|begins at"):
        profile(file)
