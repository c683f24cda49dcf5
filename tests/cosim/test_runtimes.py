"""Which FMUs a command builds and runs: native ones or those with Python inside."""

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from rockshed.commands.app import app
from rockshed.components.catalogue import NAMES as CATALOGUE
from rockshed.core.results.reading import read_run
from rockshed.fmus.build import BuildError
from rockshed.fmus.native.fmu import compiler, own_platform

NAMES = [f"{name}.fmu" for name in CATALOGUE]
SHORT = ["--stop-time", "0.001", "--no-figures"]


@pytest.fixture
def rockshed(tmp_path, monkeypatch):
    """Run a command in an empty folder, with FMUs of its own."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "500")
    monkeypatch.setenv("ROCKSHED_FMU_DIR", str(tmp_path / "dist"))
    return lambda *arguments: CliRunner().invoke(app, [str(a) for a in arguments])


@pytest.fixture
def needs_compiler():
    try:
        compiler(own_platform())
    except BuildError as error:
        pytest.skip(str(error))


def runtime_of(folder):
    """The runtime that a run says it had, and the folders of its FMUs."""
    facts = read_run(folder).provenance
    return facts["runtime"], {
        Path(part["fmu"]).parent.name for part in facts["components"].values()
    }


def test_both_runtimes_are_built_side_by_side(rockshed, needs_compiler, tmp_path):
    result = rockshed("build", "--runtime", "both")
    assert result.exit_code == 0, result.stderr
    assert [line.split()[0] for line in result.stdout.splitlines()] == [
        str(tmp_path / "dist" / runtime / name)
        for runtime in ("python", "native")
        for name in NAMES
    ]


def test_native_fmus_are_run_when_they_are_there_and_up_to_date(rockshed, needs_compiler, tmp_path):
    first = rockshed("run", "lab-impact", *SHORT, "--output-dir", "a")
    assert "python FMUs (there are no native ones; --runtime native makes them)" in first.stderr
    assert rockshed("build", "--runtime", "native").exit_code == 0
    second = rockshed("run", "lab-impact", *SHORT, "--output-dir", "b")
    assert "native FMUs (they are up to date)" in second.stderr
    (tmp_path / "dist/native/RBSMBeam.fmu").write_bytes(b"something old")
    third = rockshed("run", "lab-impact", *SHORT, "--output-dir", "c")
    assert "python FMUs (native beam out of date; --runtime native makes them)" in third.stderr
    fourth = rockshed("run", "lab-impact", *SHORT, "--output-dir", "d", "--runtime", "native")
    assert f"built {tmp_path}/dist/native/RBSMBeam.fmu" in fourth.stderr
    fifth = rockshed("run", "lab-impact", *SHORT, "--output-dir", "e", "--runtime", "python")
    assert fifth.exit_code == 0
    assert [runtime_of(tmp_path / name) for name in "abcde"] == [
        (runtime, {runtime}) for runtime in ("python", "native", "python", "native", "python")
    ]
    series = [read_run(tmp_path / name).series for name in "abcde"]
    assert all((series[0][name] == other[name]).all() for name in series[0] for other in series[1:])


def test_a_compiler_that_fails_leaves_nothing(rockshed, tmp_path, monkeypatch):
    monkeypatch.setenv("CC", "false")
    built = rockshed("build", "--runtime", "both")
    assert built.exit_code == 2
    assert (
        "FallingRock: the compiler failed for linux64, no native FMU was built: false"
        in built.stderr
    )
    assert not (tmp_path / "dist").exists()
    run = rockshed("run", "lab-impact", "--runtime", "native", *SHORT)
    assert run.exit_code == 2
    assert "FMUs with Python inside, --runtime python, need no compiler" in " ".join(
        run.stderr.split()
    )


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (
            ["build", "--runtime", "java"],
            ["'java' is unknown", "choose one of python, native, both"],
        ),
        (
            ["build", "--runtime", "native", "--platform", "beos"],
            ["--platform beos", "no such platform", "linux64"],
        ),
        (
            ["build", "--platform", "win64"],
            ["--platform: is for native FMUs", "add --runtime native"],
        ),
        (
            ["build", "--fmi", "3", "--runtime", "python"],
            ["--runtime python: FMUs with Python inside are for FMI 2.0 only"],
        ),
        (
            ["build", "--fmi", "3", "--runtime", "both"],
            ["--runtime both: FMUs with Python", "add --runtime native"],
        ),
        (
            ["build", "--fmi", "4"],
            ["--fmi 4: there is no such version of FMI here", "choose 2 or 3"],
        ),
        (["run", "lab-impact", "--runtime", "both"], ["'both' is unknown", "auto, native, python"]),
        (
            ["run", "lab-impact", "--runtime", "native", "--in-process"],
            ["--runtime: is for FMUs", "leave one of them out"],
        ),
        (
            ["run", "some.toml", "--runtime", "native"],
            ["--runtime: is for cases only", "a system file names FMU files"],
        ),
    ],
)
def test_what_does_not_fit_is_refused(rockshed, tmp_path, arguments, said):
    result = rockshed(*arguments)
    assert result.exit_code == 2
    assert all(part in result.stderr for part in said), result.stderr
    assert list(tmp_path.iterdir()) == []


def test_an_exported_system_of_both_runtimes_keeps_all_its_fmus(rockshed, needs_compiler, tmp_path):
    assert rockshed("build", "FallingRock", "--runtime", "both").exit_code == 0
    (tmp_path / "two.toml").write_text("""
        name = "two"
        stop_time = 0.001
        exchange_step = 1e-4
        connections = []
        [components]
        one = { fmu = "dist/python/FallingRock.fmu" }
        other = { fmu = "dist/native/FallingRock.fmu" }
    """)
    assert rockshed("export", "two.toml", "away").exit_code == 0
    result = rockshed("run", "away/system.toml", "--json", "--quiet")
    assert json.loads(result.stdout)["status"] == "complete"
    run = read_run(tmp_path / "results/two")
    assert len({part["sha256"] for part in run.provenance["components"].values()}) == 2
    assert (run.series["one.position.y"] == run.series["other.position.y"]).all()


def test_fmus_of_fmi_3_are_built_shown_and_run(rockshed, needs_compiler, tmp_path):
    built = rockshed(
        "build", "SandCushion", "--fmi", "3", "--size", "discs=20", "--size", "elements=3"
    )
    assert built.exit_code == 0, built.stderr
    file = tmp_path / "dist/native-fmi3/SandCushion-discs20-elements3.fmu"
    assert built.stdout.split()[0] == str(file)
    seen = " ".join(rockshed("info", file).stdout.split())
    assert "FMI 3.0 " in seen
    assert "beam.force.y[1..3] N" in seen
    assert "rotation locked 1 = free | 2 = locked" in seen
    assert "rock rock.position.x, rock.position.y, rock.angle," in seen
    (tmp_path / "alone.toml").write_text(f"""
        name = "alone"
        stop_time = 0.001
        exchange_step = 1e-4
        connections = []
        [components]
        sand = {{ fmu = "{file}", parameters = {{ base = "floor" }} }}
    """)
    result = rockshed("run", "alone.toml", "--json", "--quiet")
    assert json.loads(result.stdout)["status"] == "complete"
    assert "sand.beam.force.y[3]" in read_run(tmp_path / "results/alone")
