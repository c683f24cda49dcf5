"""Cases, projects and commands with the scheme of exchange ``implicit``, and with keys of tables."""

import json

import pytest
from typer.testing import CliRunner

import rockshed
from rockshed.cases.registry import cases
from rockshed.commands.app import app
from rockshed.core.errors import InputRefused
from rockshed.core.results.reading import read_run
from rockshed.core.system.planning import make_plan
from rockshed.runs.request import Request
from rockshed.runs.system import System

SHORT = 2e-3


def prepared(name, coupling="implicit", **options):
    system = rockshed.case(name, coupling=coupling, in_process=True)
    return system.with_options(stop_time=SHORT, **options) if options else system


KINDS = ("lab-impact", "static-test", "rigid-base-crushed", "slope-to-cushion", "shed-on-piles")


def test_all_cases_with_the_scheme_impulse_have_implicit():
    for case in cases().values():
        assert ("implicit" in case.couplings) is ("impulse" in case.couplings)


@pytest.mark.parametrize("name", KINDS)
def test_the_scheme_changes_master_moments_times_and_ports_alone(name):
    one, other = (prepared(name, coupling).spec for coupling in ("impulse", "implicit"))
    assert other.master == "implicit"
    assert other.connections == one.connections
    assert other.bonds == one.bonds
    sand = other.components["sand"].parameters
    assert (sand["kinematics"], sand["forces"]) == ("linear", "mean")
    plan = make_plan(other, prepared(name).job.sources)
    assert plan.iteration is not None
    moments = {e.name: m for e, m in zip(plan.inputs, plan.iteration.moments, strict=True)}
    assert moments["sand.rock.position.y"] == "begin"
    assert moments["sand.rock.velocity.y"] == "middle"
    assert moments["rock.force.y"] == "end"


def test_rods_have_ports_of_kinematics_and_refuse_no_step():
    spec = prepared("shed-on-piles").spec
    for side in ("left", "right"):
        assert spec.components[f"rod_{side}"].parameters["toe.port"] == "kinematics"
        assert spec.components[f"ground_{side}"].parameters["port"] == "kinematics"
        assert not spec.components[f"rod_{side}"].parameters.get("head.partner.stiffness")
    assert spec.iteration.window == 40 * spec.exchange_step


def test_an_iterated_impact_comes_to_the_values_of_a_short_exchange_step(tmp_path):
    """With 0.1 ms nearly as with 0.02 ms; the scheme ``impulse`` is farther from that."""
    found = {}
    for name, coupling, step in (
        ("coarse", "implicit", 1e-4),
        ("fine", "implicit", 2e-5),
        ("explicit", "impulse", 1e-4),
    ):
        system = prepared("lab-impact", coupling, exchange_step=step, output_interval=1e-3)
        found[name] = rockshed.simulate(system, tmp_path / name)["rock.velocity.y"][-1]
    error = {name: abs(found[name] - found["fine"]) for name in found}
    assert error["coarse"] < 0.2 * error["explicit"]


def test_a_case_without_the_scheme_says_which_there_are():
    with pytest.raises(InputRefused, match="choose one of waves, plain"):
        prepared("spt")


PROJECT = """
[rock]
mass = "1 t"
drop_height = "10 m"
[cushion]
thickness = "0.9 m"
material = "compacted sand"
[roof]
span = "8 m"
section = "H-400x400x13x21"
steel = "SS400"
spacing = "1.7 m"
"""


@pytest.mark.parametrize(
    ("numerics", "asked", "master"),
    [
        ("", {}, "sequential"),
        ('[numerics]\ncoupling = "implicit"\n', {}, "implicit"),
        ("", {"coupling": "implicit"}, "implicit"),
        ('[numerics]\ncoupling = "implicit"\n', {"coupling": "impulse"}, "sequential"),
    ],
)
def test_a_project_says_how_it_is_coupled_and_who_runs_it_may_say_otherwise(
    tmp_path, numerics, asked, master
):
    file = tmp_path / "shed.toml"
    file.write_text(PROJECT + numerics)
    assert System.prepared(Request(str(file), in_process=True, **asked)).spec.master == master


def command(*arguments):
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "500")
    return tmp_path


def test_the_command_iterates_a_case_with_keys_of_the_table(folder):
    """Those that are not named stay those of the case."""
    asked = (
        "--coupling",
        "implicit",
        "--iteration",
        "window=4e-4",
        "--iteration",
        "tolerance=1e-5",
    )
    times = ("--stop-time", SHORT, "--output-interval", "1e-3", "--no-figures")
    done = command("run", "lab-impact", "--in-process", *asked, *times, "--output-dir", "out")
    assert done.exit_code == 0, done.output
    run = read_run(folder / "out")
    table = run.provenance["system"]["iteration"]
    assert (table["window"], table["tolerance"]) == (4e-4, 1e-5)
    assert {"begin", "middle"} == {entry["input"] for entry in table["connections"]}
    assert run.provenance["iteration"]["window"] == 4
    assert run.provenance["coupling"] == "implicit"


def test_the_command_has_the_keys_of_an_adaptive_exchange_step(folder):
    keys = [f"--adaptive={key}" for key in ("tolerance=1e-3", "largest_step=6.4e-4")]
    times = ("--stop-time", "2.56e-3", "--output-interval", "1.28e-3", "--no-figures")
    arguments = (*keys, "--adaptive", "control=ledger", *times, "--output-dir", "out", "--json")
    done = command("run", "lab-impact", "--in-process", *arguments)
    assert done.exit_code == 0, done.output
    assert read_run(folder / "out").provenance["system"]["adaptive"] == {
        "tolerance": 1e-3,
        "largest_step": 6.4e-4,
        "control": "ledger",
    }
    names = [metric["name"] for metric in json.loads(done.stdout)["metrics"]]
    assert names
    assert "coupling.step" in read_run(folder / "out").series


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--adaptive", "tolernce=1"), "--adaptive tolernce"),
        (("--adaptive", "tolerance=1e-3"), "--adaptive largest_step"),
        (("--adaptive", "1e-3"), "write --adaptive key=value"),
        (("--iteration", "window=abc"), "--iteration window"),
        (("--iteration", "method=newton"), "--iteration method"),
        (("--coupling", "implicit", "--iteration", "window=1.5e-4"), "--iteration window"),
        (("--coupling", "implicit", "--adaptive=tolerance=1e-3", "--adaptive=largest_step=2e-4"),
         "is for the other masters"),
    ],
)  # fmt: skip
def test_wrong_keys_are_refused_as_options(folder, arguments, said):
    done = command("run", "lab-impact", "--in-process", *arguments)
    assert done.exit_code == 2
    assert said in " ".join(done.stderr.split())


def test_tables_of_a_system_keep_what_is_not_named():
    system = prepared("lab-impact").with_options(iteration={"method": "anderson"})
    again = system.with_options(iteration={"most": 7})
    assert again.spec.iteration.method == "anderson"
    assert again.spec.iteration.most == 7
    assert again.spec.iteration.connections == prepared("lab-impact").spec.iteration.connections
