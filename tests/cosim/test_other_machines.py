"""Runs on machines of other processors: as far as FMUs can tell, this one is made to be one."""

import zipfile

import pytest
from typer.testing import CliRunner

import rockshed
from rockshed import platforms
from rockshed.cases.registry import case
from rockshed.checking.probes import archive as probes
from rockshed.checking.probes.archive import layout
from rockshed.checking.subject.subject import Subject
from rockshed.checking.verdicts import Verdict
from rockshed.commands.app import app
from rockshed.core.errors import InputRefused
from rockshed.fmus import build
from rockshed.fmus.build import BuildError
from rockshed.fmus.native.fmu import compiler, own_platform
from rockshed.platforms import PLATFORMS, Platform, this_machine
from rockshed.runs import building
from rockshed.runs.building import case_fmus, own_sizes, silent

ARM = PLATFORMS["aarch64-linux"]
HERE = this_machine()
pytestmark = pytest.mark.skipif(
    HERE.in_fmi3 != "x86_64-linux", reason="moves libraries of x86-64 under Linux"
)


@pytest.fixture
def on_arm(monkeypatch):
    """Let this be an ARM machine for whoever looks for a library."""
    for module in (platforms, build, building, probes):
        monkeypatch.setattr(module, "this_machine", lambda: ARM)


@pytest.fixture(scope="module")
def rock(tmp_path_factory):
    """A native FMU for this machine."""
    try:
        compiler(own_platform())
    except BuildError as error:
        pytest.skip(str(error))
    folder = tmp_path_factory.mktemp("rock")
    return rockshed.build_fmu("FallingRock", folder=folder, runtime="native")


def fall(fmu):
    system = rockshed.System.new("fall", exchange_step=1e-3, stop_time=0.01)
    return system.add("rock", fmu, {"velocity0.y": -1.0})


def moved(fmu, target, folder):
    """Write the FMU with its library in another folder."""
    with zipfile.ZipFile(fmu) as source, zipfile.ZipFile(target, "w") as copy:
        for name in source.namelist():
            place = name.replace("binaries/linux64/", f"binaries/{folder}/")
            copy.writestr(place, source.read(name))
    return target


def test_on_arm_an_fmu_for_x86_64_alone_is_refused_with_what_it_has(on_arm, rock, rock_fmu):
    for fmu, others in ((rock, ""), (rock_fmu, ", win64")):
        with pytest.raises(InputRefused) as refusal:
            rockshed.simulate(fall(fmu))
        (problem,) = refusal.value.problems
        assert problem.what.endswith(
            f"(aarch64-linux); it has linux64 (code for x86_64-linux){others}"
        )
        assert problem.remedy.startswith("export it for aarch64-linux, as binaries/aarch64-linux/")


def test_the_command_says_it_too(on_arm, rock_fmu):
    done = CliRunner().invoke(app, ["simulate", str(rock_fmu)], env={"COLUMNS": "300"})
    assert done.exit_code == 2
    assert "has no binary for this machine (aarch64-linux); it has linux64" in done.stderr


def test_info_shows_an_fmu_that_cannot_run_here(on_arm, rock_fmu):
    done = CliRunner().invoke(app, ["info", str(rock_fmu)], env={"COLUMNS": "300"})
    assert done.exit_code == 0, done.output
    shown = " ".join(done.stdout.split())
    assert "platforms linux64, win64" in shown
    assert "experiments 1 smoke-test, 2 validation" in shown
    assert "mass kg" in shown
    assert "warning: cannot run here: it has no binary for this machine (aarch64-linux)" in shown


def test_systems_and_ssps_with_it_are_shown_and_exported_and_not_run(on_arm, rock_fmu, tmp_path):
    def invoked(*words):
        return CliRunner().invoke(app, [str(word) for word in words], env={"COLUMNS": "300"})

    fall(rock_fmu).save(tmp_path / "system")
    system, ssp = tmp_path / "system" / "system.toml", tmp_path / "fall.ssp"
    drawn = tmp_path / "fall.svg"
    assert invoked("export", system, ssp).exit_code == 0
    assert invoked("export", ssp, tmp_path / "again.ssp").exit_code == 0
    for target in (system, ssp):
        done = invoked("info", target)
        assert done.exit_code == 0, done.output
        assert "warning: rock cannot run here" in done.stdout
        done = invoked("run", target, "--output-dir", tmp_path / "results")
        assert done.exit_code == 2
        assert "has no binary for this machine (aarch64-linux)" in done.stderr
    assert invoked("info", system, "--diagram", drawn).exit_code == 0
    assert drawn.is_file()


def test_isolated_ones_are_told_too(on_arm, rock_fmu, tmp_path):
    fall(rock_fmu).save(tmp_path / "system")
    system = tmp_path / "system" / "system.toml"
    system.write_text('isolate = ["rock"]\n' + system.read_text())
    done = CliRunner().invoke(app, ["info", str(system)], env={"COLUMNS": "300"})
    assert "warning: rock cannot run here" in done.stdout, done.output


def test_a_library_in_the_folder_of_older_tools_runs_with_the_same_bits(
    monkeypatch, rock, tmp_path
):
    # as on ARM: the standard's folder is another one, and linux64 has code for this processor
    like_arm = Platform(HERE.in_fmi3, HERE.in_fmi3, "linux64")
    before = rockshed.simulate(fall(rock))
    monkeypatch.setattr(platforms, "this_machine", lambda: like_arm)
    for fmu in (rock, moved(rock, tmp_path / "moved.fmu", HERE.in_fmi3)):
        run = rockshed.simulate(fall(fmu))
        assert (run["rock.position.y"] == before["rock.position.y"]).all()


def test_check_warns_of_a_library_in_the_folder_of_older_tools(on_arm, monkeypatch, rock, tmp_path):
    def seen():
        return layout(Subject(rock, tmp_path / "fmu", tmp_path, tmp_path / "trail"))

    with zipfile.ZipFile(rock) as archive:
        archive.extractall(tmp_path / "fmu")
    assert seen().verdict is Verdict.FAILED
    assert "it has linux64 (code for x86_64-linux)" in seen().what
    monkeypatch.setattr(platforms, "platforms_of", lambda head: frozenset({"aarch64-linux"}))
    assert seen().verdict is Verdict.WARNING
    assert "its library for aarch64-linux is in binaries/linux64" in seen().what


def test_on_arm_a_case_takes_native_fmus_as_those_with_python_have_no_binary(
    on_arm, monkeypatch, tmp_path
):
    monkeypatch.setenv("ROCKSHED_FMU_DIR", str(tmp_path))
    built = []
    monkeypatch.setattr(building, "_build_if_needed", lambda name, *_: built.append(name))
    chosen = case("lab-impact")
    fmus = case_fmus(chosen, own_sizes(chosen, {}), silent)
    assert fmus.runtime == "native"
    assert fmus.reason == "those with Python inside have no binary for aarch64-linux"
    assert sorted(built) == sorted(chosen.models)
