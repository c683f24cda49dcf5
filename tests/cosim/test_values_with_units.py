"""Values and times with units, whatever kind of system they are for; and tables of variants."""

import json

import pytest
from typer.testing import CliRunner

from rockshed.commands.app import app
from rockshed.commands.options import _duration
from rockshed.commands.variants import read_variants
from rockshed.core.errors import InputRefused, Problem
from rockshed.runs.job import prepare
from rockshed.runs.request import Request

FALL = """\
name = "fall"
exchange_step = 1e-3
stop_time = 0.01

[components.rock]
fmu = "{}"

[shared]
weight = {{value = 9.8, targets = ["rock.gravity"]}}
"""


@pytest.fixture
def rockshed(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return lambda *arguments: CliRunner().invoke(app, [*map(str, arguments)])


@pytest.fixture
def fall(rock_fmu, tmp_path):
    file = tmp_path / "fall.toml"
    file.write_text(FALL.format(rock_fmu))
    return file


def in_use(folder):
    rock = json.loads((folder / "run.json").read_text())["components"]["rock"]["parameters"]
    return {name: rock[name]["value"] for name in ("mass", "radius", "gravity")}


def test_values_of_a_system_file_have_units(rockshed, fall, tmp_path):
    given = ("rock.mass=2t", "rock.radius=50 cm", "weight=981 cm/s2")
    options = [word for value in given for word in ("--set", value)]
    done = rockshed("run", fall, *options, "--no-figures", "--output-dir", "run")
    assert done.exit_code == 0, done.output
    assert in_use(tmp_path / "run") == {"mass": 2000.0, "radius": 0.5, "gravity": 9.81}
    assert "rock.mass = 2000" in done.output


def test_what_is_exported_has_the_values_in_si(rockshed, fall, tmp_path):
    assert rockshed("export", fall, "fall.ssp", "--set", "rock.mass=2t").exit_code == 0
    more = ("--set", "rock.radius=50cm", "--set", "weight=9.81", "--no-figures")
    done = rockshed("run", "fall.ssp", *more, "--output-dir", "run")
    assert done.exit_code == 0, done.output
    assert in_use(tmp_path / "run") == {"mass": 2000.0, "radius": 0.5, "gravity": 9.81}


def test_a_unit_of_another_kind_is_refused_with_both_kinds(rockshed, fall):
    said = " ".join(rockshed("run", fall, "--set", "rock.mass=2 m").output.split())
    assert "rock.mass: '2 m': must be a mass, in kg (given: '2 m', which is a length)" in said
    said = " ".join(rockshed("run", fall, "--set", "weight=2 m").output.split())
    assert "must be an acceleration, in m/s2" in said
    assert "must be a number in m" in rockshed("run", fall, "--set", "rock.radius=wide").output


def test_a_shared_value_of_a_case_has_a_unit():
    job = prepare(Request("lab-impact", {"rock_mass": "0.005 t"}, in_process=True))
    assert job.system.shared["rock_mass"].value == 5.0
    assert job.facts["differences"] == {"rock_mass": 5.0}
    same = prepare(Request("lab-impact", {"rock_mass": "4000 g"}, in_process=True))
    assert same.facts["differences"] == {}
    with pytest.raises(InputRefused, match="must be a mass, in kg"):
        prepare(Request("lab-impact", {"rock_mass": "5 m"}, in_process=True))


def test_start_values_of_one_fmu_have_units(rockshed, rock_fmu, tmp_path):
    asked = ("--start-values", "mass=2 t", "--start-values", "radius=50cm")
    asked = (*asked, "--start-values", "gravity=9.81", "--stop-time", "1ms", "--step-size", "0.1ms")
    done = rockshed("simulate", rock_fmu, *asked, "--no-figures", "--output-dir", "run")
    assert done.exit_code == 0, done.output
    run = json.loads((tmp_path / "run" / "run.json").read_text())
    rock = run["components"]["FallingRock"]["parameters"]
    assert (rock["mass"]["value"], rock["radius"]["value"]) == (2000.0, 0.5)
    refused = rockshed("simulate", rock_fmu, "--start-values", "mass=2 m")
    assert "--start-values mass: must be a mass" in refused.output


@pytest.mark.parametrize(
    ("text", "seconds"), [("20ms", 0.02), ("1e-5", 1e-5), ("1/60", 1 / 60), ("10us", 1e-5)]
)
def test_every_time_of_the_command_line_may_have_a_unit(text, seconds):
    assert _duration(text) == seconds


@pytest.mark.parametrize(
    "words",
    [
        ("run", "fall.toml", "--stop-time"),
        ("run", "fall.toml", "--time-limit"),
        ("simulate", "rock.fmu", "--step-size"),
        ("check", "rock.fmu", "--step-size"),
        ("check", "rock.fmu", "--time-limit"),
        ("study", "fall.toml", "--vary", "rock.mass=1,2", "--stop-time"),
        ("converge", "fall.toml", "--stop-time"),
    ],
)
def test_a_time_of_another_kind_is_refused_in_the_same_words(rockshed, words):
    done = rockshed(*words, "20kg")
    assert done.exit_code == 2
    assert "must be a time, in s (given: '20kg', which is a mass)" in done.output


def test_a_time_limit_that_limits_nothing_is_told(rockshed, fall):
    alone = rockshed("run", fall, "--time-limit", "5s", "--no-figures", "--output-dir", "run")
    assert "none is isolated: it limits nothing" in " ".join(alone.output.split())


def variants(tmp_path, text):
    file = tmp_path / "variants.csv"
    file.write_text(text)
    return read_variants(file)


def test_variants_with_decimal_commas_keep_their_units(tmp_path):
    found = variants(tmp_path, "rock.mass;rock.radius\n2,5 t;0,5\n1.5;50 cm\n")
    assert found.values == [
        {"rock.mass": "2.5 t", "rock.radius": "0.5"},
        {"rock.mass": "1.5", "rock.radius": "50 cm"},
    ]


def test_a_value_of_a_variant_is_refused_with_file_and_line(tmp_path):
    found = variants(tmp_path, "rock.mass,rock.radius\n1,1\n2 m,nan\n")
    told = [
        Problem("in design 2 (rock.mass = 2 m, rock.radius = nan): rock.radius", "must be finite"),
        Problem("vary rock.mass", "must be a mass (given: '2 m')"),
        Problem("vary rock.radius", "is no value of this system"),
        Problem("--workers", "must be whole"),
    ]
    with pytest.raises(InputRefused) as refused, found.placed():
        raise InputRefused(told)
    file = tmp_path / "variants.csv"
    assert [problem.where for problem in refused.value.problems] == [
        f"{file}, line 3: rock.radius",
        f"{file}, line 3, column 1: rock.mass",
        f"{file}, line 1, column 11: rock.radius",
        "--workers",
    ]
