"""The command line as a user meets it: exit codes, messages, files."""

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from importlib import import_module
from pathlib import Path

import pytest
from typer.testing import CliRunner

from rockshed.commands.analysis import options_named
from rockshed.commands.app import COMMANDS, app
from rockshed.commands.screen import Screen, spoken
from rockshed.core.errors import InputRefused, Problem
from rockshed.core.results.reading import read_run
from rockshed.core.system.reading import load_system

EXAMPLES = Path(__file__).parents[2] / "orchestrator" / "examples"
PICTURES = {
    "overview.png",
    "sand.png",
    "forces.png",
    "penetration.png",
    "beam.png",
    "moment.png",
    "shear.png",
    "pressure.png",
    "energy.png",
}
SHORT = ["--stop-time", "0.001", "--no-figures"]


@pytest.fixture(scope="module", autouse=True)
def fmu_folder(tmp_path_factory):
    """FMUs of these tests, apart from those of the user."""
    folder = tmp_path_factory.mktemp("dist")
    before = os.environ.get("ROCKSHED_FMU_DIR")
    os.environ["ROCKSHED_FMU_DIR"] = str(folder)
    yield folder
    del os.environ["ROCKSHED_FMU_DIR"]
    if before is not None:
        os.environ["ROCKSHED_FMU_DIR"] = before


@pytest.fixture
def rockshed(tmp_path, monkeypatch):
    """Run a command in an empty folder; the result has exit_code, stdout and stderr in one line each."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "500")
    return lambda *arguments: CliRunner().invoke(app, [str(a) for a in arguments])


def in_one_line(text):
    return " ".join(text.split())


@pytest.fixture(scope="module")
def finished(fmu_folder, tmp_path_factory):
    """A short run with pictures, and what it printed."""
    folder = tmp_path_factory.mktemp("finished") / "run"
    result = CliRunner().invoke(
        app, ["run", "lab-impact", "--stop-time", "0.004", "--output-dir", str(folder)]
    )
    assert result.exit_code == 0, result.output
    return folder, result


# ------------------------------------------------------------------ help and information


def test_help_is_there_without_the_heavy_libraries():
    script = (
        "import sys; from rockshed.commands.app import app; from typer.testing import CliRunner\n"
        "assert CliRunner().invoke(app, ['--help']).exit_code == 0\n"
        "print({'numba', 'numpy', 'fmpy', 'matplotlib', 'pydantic'} & set(sys.modules))"
    )
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == "set()"


def test_help_tells_every_command_in_one_line_and_the_exit_codes(rockshed):
    commands = rockshed("--help").stdout.partition("Commands")[2].partition("`rockshed run")[0]
    lines = [line.strip() for line in commands.splitlines()]
    for command in ("list", "build", "info", "export", "run", "plot", "bench", "reproduce"):
        (line,) = (line for line in lines if line.startswith(f"{command} "))
        assert line.endswith(".")
        assert "..." not in line
    assert "2 refused (nothing was computed or left behind)" in in_one_line(
        rockshed("--help").stdout
    )


def test_the_list_of_commands_says_what_each_of_them_says_itself():
    for name, line in COMMANDS.items():
        module = import_module(f"rockshed.commands.{name}")
        assert getattr(module, "command", module).__doc__.splitlines()[0] == line


def test_the_package_is_the_command():
    done = subprocess.run(
        [sys.executable, "-m", "rockshed", "--version"], capture_output=True, text=True
    )
    assert done.stdout.startswith("rockshed 0.")


def test_help_tells_every_option_and_flags_take_no_value(rockshed):
    text = in_one_line(rockshed("run", "--help").stdout)
    assert "--json Print" in text
    assert "--no-figures Draw" in text
    assert "--coupling paper|impulse|jacobi|implicit Scheme" in text


def test_list_names_every_case_and_component(rockshed):
    text = rockshed("list").stdout
    for number in (*range(1, 4), *range(5, 17)):
        assert f"lab-impact-{number} " in text
    assert all(
        name in text
        for name in (
            "lab-impact = lab-impact-4 ",
            "FallingRock",
            "SandCushion",
            "RBSMBeam",
            "discs = 370",
        )
    )


def test_a_terminal_that_knows_few_letters_shows_what_it_can(finished):
    for command, said in (
        (["list"], "kgf/cm?"),
        (["plot", str(finished[0]), "--output-dir", str(finished[0].parent / "ü")], ""),
    ):
        done = subprocess.run(
            [sys.executable, "-m", "rockshed.commands.app", *command],
            capture_output=True,
            cwd=Path(__file__).parents[2],
            env={**os.environ, "PYTHONIOENCODING": "ascii"},
        )
        assert done.returncode == 0, done.stderr
        assert said in done.stdout.decode("ascii")


def test_version(rockshed):
    result = rockshed("--version")
    assert result.exit_code == 0
    assert result.stdout.startswith("rockshed 0.")


def test_build_in_another_size_and_look_into_it(rockshed, tmp_path):
    built = rockshed(
        "build",
        "SandCushion",
        "--size",
        "discs=20",
        "--size",
        "elements=3",
        "--output-dir",
        tmp_path / "here",
    )
    assert built.exit_code == 0
    file = Path(built.stdout.split()[0])
    assert file.parent == tmp_path / "here/python"
    seen = in_one_line(rockshed("info", file).stdout)
    assert "beam.force.y[1..3] N" in seen
    assert "modulus Pa 2.98122e+06 1e-06 .." in seen
    assert "rotation locked 1 = free | 2 = locked" in seen
    assert "canGetAndSetFMUstate" in seen
    assert "GUID {" in seen


def test_info_of_a_case(rockshed):
    seen = in_one_line(rockshed("info", "lab-impact").stdout)
    assert "order sand, rock, beam; exchange every 1e-05 s" in seen
    assert "rock.position0.y 0.15 m 1 position of the centre" in seen
    assert "rock_mass 4 rock.mass, sand.rock.mass" in seen


def test_test_4_is_found_under_its_number_too(rockshed):
    assert rockshed("info", "lab-impact-4").stdout == rockshed("info", "lab-impact").stdout


def test_a_load_cell_that_was_asked_for_is_in_the_results(rockshed, tmp_path):
    arguments = [
        "run",
        "lab-impact",
        "--coupling",
        "impulse",
        "--stop-time",
        "0.012",
        "--no-figures",
        "--json",
    ]
    made = rockshed(*arguments, "--load-cell", "1000", "--output-dir", tmp_path / "run")
    metrics = {entry["name"]: entry for entry in json.loads(made.stdout)["metrics"]}
    peak, seen = (
        metrics[f"peak transmitted force{through}"]["value"]
        for through in ("", " through the load cell")
    )
    assert 0.98 * peak < seen < peak
    assert read_run(tmp_path / "run").provenance["load_cell"] == 1000.0
    refused = rockshed(*arguments, "--load-cell", "9999", "--output-dir", tmp_path / "none")
    assert refused.exit_code == 2
    assert "up to 2000 Hz" in in_one_line(refused.stderr)
    assert not (tmp_path / "none").exists()


# ------------------------------------------------------------------ runs


def test_a_run_leaves_results_and_pictures(finished):
    folder, result = finished
    assert {path.name for path in folder.iterdir()} == {
        "run.json",
        "summary.json",
        "timeseries.parquet",
        "timeseries.csv",
        "columns.csv",
        "states.h5",
        "figures",
    }
    assert {path.name for path in (folder / "figures").iterdir()} == PICTURES
    assert all(path.read_bytes().startswith(b"\x89PNG") for path in (folder / "figures").iterdir())
    assert "peak transmitted force" in result.stdout
    assert "calibrated sand: rotation locked" in result.stdout
    assert (
        "sand A, compacted at 0.4 kgf/cm², water content 6.98 %, box 1"
        in result.stdout.splitlines()[0]
    )


def test_the_table_compares_with_paper_and_experiment_when_the_impact_is_over(rockshed):
    result = rockshed("run", "lab-impact-10", "--coupling", "impulse", "--no-figures")
    rows = [line.split() for line in result.stdout.splitlines()]
    peak = next(row for row in rows if row[:3] == ["peak", "transmitted", "force"])
    assert peak[3] == "kN"
    assert peak[-3] == "6.60"  # 673.2 kgf
    assert peak[5] == "≈"
    assert float(peak[-2]) == pytest.approx(100 * (float(peak[4]) / 6.60 - 1), abs=1.0)
    assert "extrapolated to E_bar = 70.3" in result.stdout


def test_fmus_that_are_missing_are_built_and_others_left_alone(rockshed, tmp_path, monkeypatch):
    monkeypatch.setenv("ROCKSHED_FMU_DIR", str(tmp_path / "dist"))
    built = ["SandCushion.fmu", "FallingRock.fmu", "RBSMBeam.fmu"]
    first = rockshed("run", "lab-impact", *SHORT)
    assert [
        Path(line.split()[1]).name
        for line in first.stderr.splitlines()
        if line.startswith("built ")
    ] == built
    assert "built" not in rockshed("run", "lab-impact", *SHORT).stderr
    (tmp_path / "dist/python/RBSMBeam.fmu").write_bytes(b"something old")
    assert (
        f"built {tmp_path / 'dist/python/RBSMBeam.fmu'}\n"
        in rockshed("run", "lab-impact", *SHORT).stderr
    )


def test_box_2_has_its_own_number_of_discs(rockshed, tmp_path):
    assert rockshed("run", "lab-impact-13", *SHORT).exit_code == 0
    facts = read_run(tmp_path / "results" / "lab-impact-13").provenance
    assert facts["sizes"]["sand"]["discs"] == 450
    assert facts["components"]["sand"]["parameters"]["box.width"]["value"] == pytest.approx(0.45)


def test_json_is_the_summary_with_references(rockshed, tmp_path):
    result = rockshed(
        "run",
        "lab-impact",
        "--json",
        "--quiet",
        "--coupling",
        "impulse",
        "--stop-time",
        "0.025",
        "--no-figures",
    )
    content = json.loads(result.stdout)
    assert content["status"] == "complete"
    by_name = {metric["name"]: metric for metric in content["metrics"]}
    peak = by_name["peak transmitted force"]
    measured, computed = peak["references"]["experiment"], peak["references"]["paper"]
    assert measured == {
        "value": pytest.approx(519.1 * 9.80665),
        "note": "",
        "deviation": pytest.approx(peak["value"] / (519.1 * 9.80665) - 1.0),
    }
    assert "interpolated to E_bar" in computed["note"]
    assert "references" not in by_name["impact energy"]
    assert (
        json.loads((tmp_path / "results/lab-impact/summary.json").read_text()) == content["metrics"]
    )
    read = read_run(tmp_path / "results/lab-impact").metrics["peak_transmitted_force"]
    assert (read.references["paper"].value, read.references["paper"].note) == (
        computed["value"],
        computed["note"],
    )
    assert result.stderr == ""


def test_a_value_that_is_shared_reaches_all_its_targets(rockshed, tmp_path):
    assert (
        rockshed(
            "run", "lab-impact", "--set", "rock.mass=8", "--set", "sand.rotation=free", *SHORT
        ).exit_code
        == 0
    )
    parts = read_run(tmp_path / "results/lab-impact").provenance["components"]
    assert parts["rock"]["parameters"]["mass"]["value"] == 8.0
    assert parts["sand"]["parameters"]["rock.mass"]["value"] == 8.0
    assert parts["sand"]["parameters"]["rotation"]["value"] == "free"


def test_in_process_gives_the_same_as_fmus(rockshed, tmp_path):
    for folder, *options in (("fmu",), ("here", "--in-process")):
        assert (
            rockshed("run", "lab-impact", "--output-dir", folder, *SHORT, *options).exit_code == 0
        )
    one, other = (read_run(tmp_path / folder).series for folder in ("fmu", "here"))
    assert all((one[name] == other[name]).all() for name in one)


def test_an_exported_system_runs_elsewhere_with_the_same_result(rockshed, tmp_path):
    assert (
        rockshed("export", "lab-impact", tmp_path / "away", "--set", "sand.damping=0.3").exit_code
        == 0
    )
    assert (
        load_system(tmp_path / "away/system.toml").components["sand"].parameters["damping"] == 0.3
    )
    assert rockshed("run", tmp_path / "away/system.toml", *SHORT).exit_code == 0
    assert rockshed("run", "lab-impact", "--set", "sand.damping=0.3", *SHORT).exit_code == 0
    one, other = (
        read_run(tmp_path / "results" / name).series for name in ("lab-impact", "lab-impact-2")
    )
    assert all((one[name] == other[name]).all() for name in one)


def test_toml_of_a_case_is_the_system_of_the_case(rockshed, tmp_path):
    (tmp_path / "lab.toml").write_text(rockshed("info", "lab-impact", "--toml").stdout)
    assert rockshed("info", "lab.toml").stdout == rockshed("info", "lab-impact").stdout


def test_the_example_of_a_system_file_runs_and_is_drawn_without_a_beam(rockshed, tmp_path):
    example = Path(__file__).parents[2] / "orchestrator/examples/rigid_floor.toml"
    (tmp_path / "a/b").mkdir(parents=True)
    copy = tmp_path / "a/b/rigid_floor.toml"
    copy.write_bytes(example.read_bytes())
    assert rockshed("build", "--output-dir", tmp_path / "fmus/dist").exit_code == 0
    result = rockshed("run", copy, "--stop-time", "0.004")
    assert result.exit_code == 0, result.stderr
    assert {
        path.name for path in (tmp_path / "results/rigid-floor/figures").iterdir()
    } == PICTURES - {"beam.png", "moment.png", "shear.png", "pressure.png"}


def test_a_system_of_strangers_has_its_summary_and_no_pictures(rockshed, tmp_path, foreign):
    (tmp_path / "strange.toml").write_text(f"""
        name = "strange"
        stop_time = 0.1
        exchange_step = 0.01
        watch = ["a.force"]
        connections = ["a.next_level -> b.level"]
        [components]
        a = {{ fmu = "{foreign}", parameters = {{ speed = 3.0 }} }}
        b = {{ fmu = "{foreign}" }}
    """)
    result = rockshed("run", "strange.toml")
    assert result.exit_code == 0, result.stderr
    assert "a.force maximum" in result.stdout
    assert "exchanges 10" in in_one_line(result.stdout)
    assert "pictures" not in result.stdout
    assert not (tmp_path / "results/strange/figures").exists()
    seen = in_one_line(rockshed("info", foreign).stdout)
    assert "generated by PythonFMU" in seen
    assert "enabled true Boolean" in seen


# ------------------------------------------------------------------ refused

REFUSED = [
    (["lab-inpact"], ["no case of this name", "did you mean lab-impact"]),
    (
        ["lab-impact", "--set", "rock.mass=-4"],
        ["rock.mass: -4", "sand.rock.mass: -4", "1e-06", "kg"],
    ),
    (["lab-impact", "--set", "rock.radius=-0.1"], ["rock.radius: -0.1", "1e-06", " m"]),
    (
        [
            "lab-impact",
            "--set",
            "sand.modulus=nan",
            "--set",
            "rock.mass=-1",
            "--set",
            "rock.velocity0=3",
        ],
        ["sand.modulus: nan: must be a finite number", "rock.mass: -1", "did you mean velocity0."],
    ),
    (
        ["lab-impact", "--set", "rok.mass=3", "--set", "sand.modulus=-1"],
        ["rok.mass", "did you mean rock", "sand.modulus: -1", "1e-06"],
    ),
    (["lab-impact", "--set", "sand.rotation=loose"], ["choose one of free, locked"]),
    (
        ["lab-impact", "--set", "rock.mass"],
        ["'rock.mass' is no assignment", "--set component.name=value"],
    ),
    (
        ["lab-impact", "--set", "rock.mass=3", "--set", "sand.rock.mass=4"],
        ["rock_mass", "give one of them"],
    ),
    (["lab-impact", "--size", "sand.discs=0"], ["discs = 0: allowed is 1 to"]),
    (["lab-impact", "--size", "sand.disks=9"], ["--size sand.disks", "did you mean sand.discs"]),
    (
        ["lab-impact", "--size", "sand.elements=12", "--size", "beam.elements=24"],
        ["one number", "give one of them"],
    ),
    (
        ["lab-impact", "--set", "rock.position0.y=0.1"],
        ["inside the sand", "raise the rock's position0.y"],
    ),
    (
        ["lab-impact", "--set", "beam.span=0.3"],
        ["narrower than the cushion", "make the beam longer"],
    ),
    (
        ["lab-impact", "--set", "beam.internal_step=1e-5"],
        ["1e-05 s", "stable_step = 6.14", "beam.internal_step"],
    ),
    (
        ["lab-impact", "--exchange-step", "3e-5"],
        [
            "output_interval: 0.0001 s is no whole number of steps of 3e-05 s",
            "nearest are 9e-05 s",
            "exchange_step = 3e-05, output_interval = 9e-05, state_interval = 0.00048, stop_time = 0.03999",
        ],
    ),
    (
        ["lab-impact", "--exchange-step", "1e-20"],
        ["refused: --exchange-step: 1e-20 s is no", "→ round it to 1e-12 s"],
    ),
    (
        ["lab-impact", "--exchange-step", "1e-3"],
        ["exchange_step = 0.001, output_interval = 0.001, state_interval = 0.001"],
    ),
    (
        ["lab-impact", "--set", "sand.internal_step=1e-12"],
        ["steps of 1e-12 s are 1e+07 in each communication step of 1e-05 s", "raise it to 1e-10 s"],
    ),
    (
        ["lab-impact", "--stop-time", "1e9"],
        ["--stop-time: 1e+09 s is beyond the longest time, 4.61e+06 s", "make it shorter"],
    ),
    (
        ["lab-impact", "--stop-time", "1e6"],
        [
            "output_interval: 10,000,000,001 rows of 371 columns are 3.7e+12 values",
            "5 s or more will do",
            "state_interval: 2,000,000,001 states would be recorded",
            "100 s or more will do",
        ],
    ),
    (["lab-impact", "--stop-time", "-1"], ["--stop-time", "is not after start_time"]),
    (["lab-impact", "--stop-time", "nan"], ["--stop-time", "finite"]),
    (["lab-impact", "--coupling", "magic"], ["'magic' is unknown", "paper, impulse, jacobi"]),
    (["lab-impact", "--master", "boss"], ["'sequential', 'jacobi' or 'implicit'"]),
    (["missing.toml"], ["missing.toml", "cannot be read"]),
]


def test_times_that_a_refusal_proposes_together_are_accepted(rockshed):
    said = in_one_line(rockshed("run", "lab-impact", "--exchange-step", "3e-5").stderr).partition(
        "this will do: "
    )[2]
    options = [
        part
        for text in said.split(", ")
        for part in ("--" + text.split(" = ")[0].replace("_", "-"), text.split(" = ")[1])
    ]
    assert options[:2] == ["--exchange-step", "3e-05"]
    assert rockshed("run", "lab-impact", *options, "--no-figures").exit_code == 0


def test_the_interval_that_a_refusal_proposes_is_accepted(rockshed):
    from rockshed.core.run import sources_of
    from rockshed.core.system.planning import make_plan
    from rockshed.runs.job import Request, prepare

    system = prepare(
        Request(
            "lab-impact",
            options={"stop_time": 1e6, "output_interval": 5.0, "state_interval": 100.0},
        )
    ).system
    assert make_plan(system, sources_of(system)).timing.exchanges == 10**11


@pytest.mark.parametrize(
    ("encoding", "said"),
    [
        ("utf-16", "is written in UTF-16, and TOML is UTF-8"),
        ("latin-1", "is no text in UTF-8"),
        ("utf-8-sig", ""),
    ],
)
def test_the_encoding_of_a_system_file(rockshed, tmp_path, encoding, said):
    text = rockshed("info", "lab-impact", "--toml").stdout
    (tmp_path / "lab.toml").write_bytes(f"# Größe\n{text}".encode(encoding))
    result = rockshed("info", "lab.toml")
    assert result.exit_code == (2 if said else 0)
    assert said in in_one_line(result.stderr)


def test_a_long_run_tells_how_long_it_will_take(capsys):
    from rockshed.commands.screen import Estimate

    now = [0.0]
    estimate = Estimate(lambda: now[0])
    assert estimate.left(0.0, 10.0) == ""
    for now[0], reached, said in (
        (1.0, 0.1, ""),
        (3.0, 0.5, "about 57 s left"),
        (10.0, 0.6, "about 2.6 min left"),
    ):
        assert estimate.left(reached, 10.0) == said
    show = Screen()._told(estimate)
    for now[0] in (4.0, 6.0, 8.0, 11.0, 12.5):
        show(now[0] / 1e3, 10.0)
    told = [line.split(",")[0] for line in capsys.readouterr().err.splitlines()]
    assert told == ["reached 6.0 of 10000 ms", "reached 12.5 of 10000 ms"]
    assert [spoken(seconds) for seconds in (3.21, 600.0, 12345.0, 6.6e9)] == [
        "3.2 s",
        "10 min",
        "3.4 h",
        "210 years",
    ]


@pytest.mark.parametrize(("arguments", "said"), REFUSED, ids=lambda value: " ".join(value)[:60])
def test_refused_with_reason_and_remedy_and_nothing_left_behind(
    rockshed, tmp_path, arguments, said
):
    result = rockshed("run", *arguments, "--no-figures")
    assert result.exit_code == 2
    text = in_one_line(result.stderr)
    assert all(part in text for part in said), text
    assert result.stdout == ""
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (
            ["run", "lab-impact", "--runtime", "native", "--in-process"],
            "--runtime: is for FMUs, and --in-process runs without them",
        ),
        (["run", "lab-impact", "--load-cell", "1e9"], "or --output-interval 2e-10 or less"),
        (["run", "lab-impact", "--load-cell", "1e9"], "--load-cell: 1e+09 Hz"),
        (["run", "lab-impact", "--size", "sand.discs=2.5"], "--size sand.discs: 2.5 is no whole"),
        (["run", "system.toml", "--size", "sand.discs=9"], "--size: is for cases only"),
        (["run", "spt", "--model", "literal"], "--model literal: spt has no sand"),
        (["info", "spt", "--model", "literal"], "--model literal: spt has no sand"),
        (["export", "spt", "x", "--coupling", "magic"], "--coupling: 'magic' is unknown"),
        (["page", "lab-impact", "--size", "beam.xx=3"], "--size beam.xx: there is no such size"),
        (["page", "lab-impact", "--coupling", "magic"], "--coupling: 'magic' is unknown"),
        (["page", "lab-impact", "--model", "magic"], "--model magic: there is no such model"),
        (["build", "--platform", "win65"], "--platform win65: there is no such platform"),
        (["build", "--platform", "win64"], "→ add --runtime native"),
        (["build", "--fmi", "3", "--runtime", "python"], "--runtime python: FMUs with Python"),
        (["reproduce", "ushiro", "--only", "fig9"], "--only fig9: there is no such study"),
        (["reproduce", "ushiro", "--output-dir", "file/x"], "name another folder: --output-dir"),
        (["rockfall", "slope.toml", "--scheduler", "tls://h:1"], "--tls-ca, --tls-cert and --tls"),
    ],
)
def test_a_command_names_its_options_where_the_library_names_arguments(
    rockshed, tmp_path, arguments, said
):
    (tmp_path / "file").write_text("mine")
    (tmp_path / "slope.toml").write_bytes((EXAMPLES / "slope.toml").read_bytes())
    result = rockshed(*arguments)
    assert result.exit_code == 2
    assert said in in_one_line(result.stderr)


def test_a_text_of_the_user_that_looks_like_an_argument_stays_as_it_is(capsys):
    told = "'runtime=\"x\"' is no word, nor is sand.runtime=3 in a/runtime=3", "runtime=true"
    problem = Problem("folder", *told)
    with pytest.raises(InputRefused) as refusal, options_named(("runtime", "folder"), given=()):
        raise InputRefused([problem])
    assert refusal.value.problems == [problem]
    Screen().refuse([problem])
    shown = in_one_line(capsys.readouterr().err)
    assert all(text in shown for text in told)


def test_a_refusal_as_json(rockshed):
    result = rockshed("run", "lab-impact", "--set", "rock.mass=-4", "--json")
    content = json.loads(result.stdout)
    assert content["status"] == "refused"
    assert {problem["where"] for problem in content["problems"]} == {"rock.mass", "sand.rock.mass"}


@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        ("RBSMBeam.fmu", None, "there is no such file"),
        ("RBSMBeam.fmu", b"not a zip", "is not an FMU"),
    ],
)
def test_missing_and_broken_fmus(rockshed, tmp_path, name, content, said):
    rockshed("export", "lab-impact", tmp_path / "away")
    (tmp_path / "away" / name).unlink()
    if content is not None:
        (tmp_path / "away" / name).write_bytes(content)
    result = rockshed("run", tmp_path / "away/system.toml", *SHORT)
    assert result.exit_code == 2
    assert f"beam: {tmp_path / 'away' / name}" in result.stderr
    assert said in result.stderr
    assert not (tmp_path / "results").exists()


def test_a_strangers_fmu_in_the_place_of_the_beam(rockshed, tmp_path, foreign):
    rockshed("export", "lab-impact", tmp_path / "away")
    (tmp_path / "away/RBSMBeam.fmu").write_bytes(foreign.read_bytes())
    result = rockshed("run", tmp_path / "away/system.toml", *SHORT)
    assert result.exit_code == 2
    assert "beam has no variable" in result.stderr
    assert not (tmp_path / "results").exists()


def test_arrays_of_different_length_in_a_system_file(rockshed, tmp_path):
    rockshed("export", "lab-impact", tmp_path / "away")
    built = rockshed(
        "build", "RBSMBeam", "--size", "elements=12", "--output-dir", tmp_path / "other"
    ).stdout.split()[0]
    Path(built).replace(tmp_path / "away/RBSMBeam.fmu")
    result = rockshed("run", tmp_path / "away/system.toml", *SHORT)
    assert result.exit_code == 2
    assert "connects 12 outputs with 24 inputs" in in_one_line(result.stderr)


@pytest.mark.parametrize("place", ["file/results", "file", "others"])
def test_output_that_cannot_be_written(rockshed, tmp_path, place):
    (tmp_path / "file").write_text("mine")
    (tmp_path / "others").mkdir()
    (tmp_path / "others/thesis.txt").write_text("mine too")
    result = rockshed("run", "lab-impact", "--output-dir", place, *SHORT)
    assert result.exit_code == 2
    assert "choose another folder" in result.stderr
    assert sorted(p.name for p in tmp_path.rglob("*")) == ["file", "others", "thesis.txt"]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["build", "SandCushun"], "did you mean SandCushion"),
        (["build", "SandCushion", "--size", "discs=0"], "allowed is 1 to"),
        (["build", "FallingRock", "--size", "discs=9"], "FallingRock has no such size"),
        (["build", "FallingRock", "--output-dir", "file/x"], "name another folder"),
        (["export", "lab-impact", "file"], "is a file"),
        (["run", "file.fmu"], "is an FMU, and a run takes a case of"),
        (["run", "lab-impact", "--output-dir", "/"], "is no folder of a run"),
        (["plot", "/"], "is no folder of a run"),
        (["plot", "file"], "is no folder of a run"),
        (["info", "nothing.fmu"], "there is no such file"),
        (["info", "file.fmu"], "is not an FMU"),
        (["export", "lab-impact", "full"], "is not empty"),
        (["plot", "full"], "no folder of a run"),
        (["run"], "Missing argument"),
    ],
)
def test_other_commands_refuse_too(rockshed, tmp_path, arguments, said):
    for name in ("file", "file.fmu"):
        (tmp_path / name).write_text("text")
    (tmp_path / "full").mkdir()
    (tmp_path / "full/file").write_text("text")
    result = rockshed(*arguments)
    assert result.exit_code == 2
    assert said in in_one_line(result.stderr)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["file", "file.fmu", "full"]


# ------------------------------------------------------------------ ended before the end


def test_an_unstable_run_fails_with_component_and_time(rockshed, tmp_path):
    result = rockshed("run", "lab-impact", "--allow-unstable", "--set", "beam.internal_step=1e-5")
    assert result.exit_code == 1
    assert "failed: beam at t = 0.0" in in_one_line(result.stderr)
    assert "peak transmitted force" not in result.stdout
    assert read_run(tmp_path / "results/lab-impact").status == "failed"
    assert (tmp_path / "results/lab-impact/figures/energy.png").is_file()


@pytest.fixture
def impatient(monkeypatch):
    """Ctrl-C as soon as drawing begins."""

    def stop(*arguments):
        raise KeyboardInterrupt

    monkeypatch.setattr("rockshed.pictures.draw_all", stop)


def test_ctrl_c_while_a_failed_run_is_drawn_does_not_hide_why_it_failed(rockshed, impatient):
    result = rockshed(
        "run",
        "lab-impact",
        "--allow-unstable",
        "--set",
        "beam.internal_step=1e-5",
        "--output-dir",
        "my run",
    )
    assert result.exit_code == 1
    said = in_one_line(result.stderr)
    assert (
        0
        <= said.index("failed: beam at t = 0.0")
        < said.index("drawing was interrupted; `rockshed plot 'my run'")
    )


def test_ctrl_c_while_a_run_is_drawn_leaves_its_figures(rockshed, impatient, tmp_path):
    result = rockshed("run", "lab-impact", "--stop-time", "0.001")
    assert result.exit_code == 130
    assert "peak transmitted force" in result.stdout
    assert read_run(tmp_path / "results/lab-impact").status == "complete"


def test_pictures_can_be_drawn_again(rockshed, finished, tmp_path):
    folder, _ = finished
    result = rockshed("plot", folder, "--output-dir", tmp_path / "again", "--quiet")
    assert result.exit_code == 0
    assert {Path(line).name for line in result.stdout.splitlines()} == PICTURES
    for name in PICTURES:
        assert (tmp_path / "again" / name).read_bytes() == (folder / "figures" / name).read_bytes()


def test_pictures_of_the_sand_have_a_scale_and_one_unit_of_length(finished):
    from matplotlib.figure import Figure
    from matplotlib.text import Annotation, Text

    from rockshed.pictures import sand

    run, made = read_run(finished[0]), Figure()
    panels = list(made.subplots(1, 2))
    sand.draw(run, "sand", sand.frames(run, "sand", [0.0, 0.004]), made, panels)
    words = [text.get_text() for text in made.findobj(Text) if text.get_text()]
    assert "0 ms: rock 0.1 cm above, 0.05 kN transmitted" in words
    assert any(text.startswith("4 ms: rock 3.0 cm deep, ") for text in words)
    assert not [text for text in words if " mm" in text or "P =" in text]
    bars = [text for text in panels[0].texts if isinstance(text, Annotation) and text.arrow_patch]
    assert [abs(bar.xy[0] - bar.xyann[0]) for bar in bars] == [
        pytest.approx(5.0)
    ]  # the axes are in cm
    assert "5 cm" in words


@pytest.mark.parametrize("content", ["{", "[]", "{}", ""])
def test_plot_names_a_damaged_file(rockshed, finished, tmp_path, content):
    shutil.copytree(finished[0], tmp_path / "run")
    (tmp_path / "run/run.json").write_text(content)
    result = rockshed("plot", tmp_path / "run")
    assert result.exit_code == 2
    assert f"{tmp_path / 'run/run.json'}: cannot be read" in in_one_line(result.stderr)


@pytest.mark.parametrize(
    "content",
    ["[1]", '[{"name": "a", "value": 1, "references": [1]}]', '{"a": 1}', '[{"value": 1}]'],
)
def test_plot_names_a_damaged_summary(rockshed, finished, tmp_path, content):
    shutil.copytree(finished[0], tmp_path / "run")
    (tmp_path / "run/summary.json").write_text(content)
    result = rockshed("plot", tmp_path / "run")
    assert result.exit_code == 2
    assert f"{tmp_path / 'run/summary.json'}: cannot be read" in in_one_line(result.stderr)


@pytest.mark.parametrize(
    ("name", "left", "status"),
    [("states.h5", PICTURES - {"overview.png", "sand.png"}, 0), ("timeseries.parquet", set(), 2)],
)
def test_plot_draws_what_a_damaged_file_leaves(rockshed, finished, tmp_path, name, left, status):
    shutil.copytree(finished[0], tmp_path / "run", ignore=shutil.ignore_patterns("figures"))
    os.truncate(tmp_path / "run" / name, 1000)
    result = rockshed("plot", tmp_path / "run")
    assert result.exit_code == status
    assert f"{tmp_path / 'run' / name}: cannot be read" in in_one_line(result.stderr)
    assert {Path(line).name for line in result.stdout.splitlines()} == left


@pytest.mark.parametrize("command", ["plot", "report", "verify", "resume"])
@pytest.mark.parametrize("name", ["timeseries.parquet", "summary.json", "columns.csv"])
def test_a_file_that_a_complete_run_lacks_is_named(rockshed, finished, tmp_path, command, name):
    shutil.copytree(finished[0], tmp_path / "run", ignore=shutil.ignore_patterns("figures"))
    (tmp_path / "run" / name).unlink()
    result = rockshed(command, tmp_path / "run")
    assert result.exit_code == 2
    told = f"{tmp_path / 'run' / name}: is missing, and the run is complete"
    assert told in in_one_line(result.stderr)


@pytest.mark.parametrize("command", ["report", "verify", "resume"])
@pytest.mark.parametrize("content", ["{", "[]", "{}", ""])
def test_every_command_names_a_damaged_run(rockshed, finished, tmp_path, command, content):
    shutil.copytree(finished[0], tmp_path / "run", ignore=shutil.ignore_patterns("figures"))
    (tmp_path / "run/run.json").write_text(content)
    result = rockshed(command, tmp_path / "run")
    assert result.exit_code == 2
    said = in_one_line(result.stderr)
    assert f"{tmp_path / 'run/run.json'}: cannot be read" in said
    assert "attribute" not in said


def test_a_place_where_nothing_can_be_made_is_not_called_busy(rockshed):
    result = rockshed("run", "lab-impact", "--output-dir", "/proc/x", *SHORT)
    assert result.exit_code == 2
    assert "cannot be written" in in_one_line(result.stderr)


def test_plot_into_a_folder_that_takes_no_file(rockshed, finished):
    result = rockshed("plot", finished[0], "--output-dir", "/proc/self")
    assert result.exit_code == 2
    assert "cannot be written" in in_one_line(result.stderr)


def test_plot_into_a_folder_that_cannot_be_written(rockshed, finished, tmp_path):
    (tmp_path / "file").write_text("mine")
    result = rockshed("plot", finished[0], "--output-dir", tmp_path / "file/x")
    assert result.exit_code == 2
    assert "cannot be written" in in_one_line(result.stderr)


@pytest.fixture
def long_run(tmp_path):
    """Start a run that would take minutes, in a process of its own; returns it when it has written rows."""
    processes = []

    def start(folder):
        command = [
            "run",
            "lab-impact",
            "--stop-time",
            "9",
            "--output-dir",
            str(folder),
            "--no-figures",
        ]
        process = subprocess.Popen(
            [sys.executable, "-m", "rockshed.commands.app", *command],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            cwd=Path(__file__).parents[2],
        )
        processes.append(process)
        stream, until = (
            folder.with_name(f"{folder.name}.running") / "timeseries.arrows",
            time.monotonic() + 120,
        )
        header = None
        while process.poll() is None and time.monotonic() < until:
            size = stream.stat().st_size if stream.is_file() else None
            header = size if header is None else header
            if header is not None and size is not None and size > header:
                return process
            time.sleep(0.1)
        raise AssertionError(process.communicate(timeout=10))

    yield start
    for process in processes:
        if process.poll() is None:
            process.kill()
        process.communicate()


def test_ctrl_c_keeps_what_was_computed(rockshed, long_run, tmp_path):
    process = long_run(tmp_path / "run")
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=60)
    assert process.returncode == 130, err
    assert "interrupted at t = " in err
    assert "peak transmitted force" in out
    run = read_run(tmp_path / "run")
    assert run.status == "interrupted"
    assert run.series["time"][-1] == pytest.approx(run.metrics["simulated_time"].value)
    assert not (tmp_path / "run.running").exists()
    assert rockshed("plot", tmp_path / "run").exit_code == 0


def test_a_killed_run_can_be_drawn_and_a_second_run_waits_for_nobody(rockshed, long_run, tmp_path):
    process = long_run(tmp_path / "run")
    beside = rockshed("run", "lab-impact", "--output-dir", tmp_path / "run", *SHORT)
    assert beside.exit_code == 2
    assert "another run is writing there" in in_one_line(beside.stderr)
    assert (
        rockshed("run", "lab-impact", "--output-dir", tmp_path / "elsewhere", *SHORT).exit_code == 0
    )
    process.kill()
    process.wait()
    result = rockshed("plot", tmp_path / "run")
    assert result.exit_code == 0
    assert "not complete (running)" in in_one_line(result.stderr)
    assert {Path(line).name for line in result.stdout.splitlines()} == PICTURES
    assert rockshed("run", "lab-impact", "--output-dir", tmp_path / "run", *SHORT).exit_code == 0
    assert read_run(tmp_path / "run").status == "complete"
    assert not (tmp_path / "run.running").exists()


def test_info_shows_a_component_by_its_name_and_an_unknown_name_is_answered_with_the_nearest(
    rockshed,
):
    shown = in_one_line(rockshed("info", "RBSMBeam").stdout)
    assert "elements = 24, support_count = 2" in shown
    assert "section.area m2 0.001185" in shown
    assert "moment[1..24] N.m" in shown
    wrong = rockshed("info", "RBSMBeem")
    assert wrong.exit_code == 2
    assert "RBSMBeem: is no FMU, no component, no case" in in_one_line(wrong.stderr)
    assert "did you mean RBSMBeam?" in in_one_line(wrong.stderr)
