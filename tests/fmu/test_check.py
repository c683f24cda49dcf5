"""``rockshed check``: verdicts on FMUs of any origin, whatever they do to their process."""

import json
import os
import shutil
import stat
import subprocess
import sys
import zipfile
from xml.etree import ElementTree

import pytest
from typer.testing import CliRunner

import rockshed
from rockshed.checking.junit import junit
from rockshed.checking.table import PROBES
from rockshed.checking.verdicts import Check, Finding, Verdict
from rockshed.commands.app import app
from rockshed.core.errors import InputRefused
from tests.cosim.odd_fmus import XML, make

needs_compiler = pytest.mark.skipif(
    sys.platform != "linux" or not shutil.which("cc"), reason="needs Linux and a C compiler"
)


@pytest.mark.slow
@pytest.mark.parametrize("version", ["native_fmus", "fmi3_fmus"])
@pytest.mark.parametrize(
    "name",
    [
        "FallingRock",
        "SandCushion",
        "RBSMBeam",
        "SlopeRockfall",
        "ImpulsiveGround",
        "Hammer",
        "PileRod",
    ],
)
def test_there_is_nothing_to_say_about_our_native_fmus(request, version, name):
    check = rockshed.check_fmu(request.getfixturevalue(version)[name])
    assert check.silent, str(check)


@pytest.mark.slow
def test_of_our_fmus_with_python_only_what_the_binary_of_pythonfmu_does_is_said(python_fmus):
    check = rockshed.check_fmu(python_fmus["FallingRock"])
    said = {f.name for f in check if f.verdict not in (Verdict.PASSED, Verdict.NOT_APPLICABLE)}
    assert said == {"library/token", "library/letters"}, str(check)


def test_our_states_and_conduct_pass(native_fmus):
    check = rockshed.check_fmu(native_fmus["FallingRock"], probes=["state/rollback", "conduct"])
    assert check.silent, str(check)
    assert {f.theme for f in check} == {
        "archive",
        "description",
        "library",
        "life",
        "conduct",
        "state",
    }


@needs_compiler
@pytest.mark.parametrize(
    ("code", "verdict", "what"),
    [
        ("*(volatile int *)8 = 1", Verdict.CRASHED, "crashed (SIGSEGV) in fmi2DoStep from t = 0 s"),
        ("exit(0)", Verdict.CRASHED, "ended the process with exit code 0 in fmi2DoStep"),
        ("for (;;)", Verdict.TIMED_OUT, "fmi2DoStep from t = 0 s by 0.01 s has not returned"),
    ],
)
def test_a_crash_an_exit_and_a_hang_are_verdicts_with_the_call(tmp_path, code, verdict, what):
    make(tmp_path, IN_STEP=code)
    check = rockshed.check_fmu(tmp_path / "Odd.fmu", probes=["life/simulation"], time_limit=1.0)
    assert check["life/simulation"].verdict is verdict
    assert what in check["life/simulation"].what
    assert not check.ok


@needs_compiler
def test_what_needs_a_probe_that_has_failed_is_not_applicable(tmp_path):
    make(tmp_path, STATUS="3")
    check = rockshed.check_fmu(tmp_path / "Odd.fmu", probes=["life/reset"])
    assert check["life/simulation"].verdict is Verdict.FAILED
    assert check["life/reset"].verdict is Verdict.NOT_APPLICABLE
    assert "life/simulation" in check["life/reset"].what


@needs_compiler
def test_what_an_fmu_prints_does_not_reach_the_results(tmp_path):
    make(tmp_path, IN_STEP='puts("hello")')
    done = CliRunner().invoke(
        app, ["check", str(tmp_path / "Odd.fmu"), "--json", "-q", "--probe", "environment/printing"]
    )
    data = json.loads(done.stdout)
    (printing,) = [f for f in data["findings"] if f["probe"] == "printing"]
    assert printing["verdict"] == "warning"
    assert "hello" in printing["what"]


@pytest.mark.parametrize("name", ["../outside.txt", "/outside.txt", "C:\\outside.txt", "a/../../b"])
def test_an_archive_that_leads_out_of_its_folder_is_not_unpacked(tmp_path, name):
    file = tmp_path / "x.fmu"
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr("modelDescription.xml", XML)
        archive.writestr(name, "content")
    check = rockshed.check_fmu(file, probes=["archive", "library/loads"])
    assert check["archive/names"].verdict is Verdict.FAILED
    assert check["library/loads"].verdict is Verdict.NOT_APPLICABLE
    assert sorted(os.listdir(tmp_path)) == ["x.fmu"]


def test_a_link_in_an_archive_fails(tmp_path):
    file = tmp_path / "x.fmu"
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr("modelDescription.xml", XML)
        link = zipfile.ZipInfo("resources/passwd")
        link.external_attr = (stat.S_IFLNK | 0o777) << 16
        archive.writestr(link, "/etc/passwd")
    check = rockshed.check_fmu(file, probes=["archive/names"])
    assert "symbolic link" in check["archive/names"].what


def written(file, xml=XML):
    """Write an FMU that has a library for another machine."""
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr("modelDescription.xml", xml)
        archive.writestr("binaries/vax/Odd.exe", "")
    return file


def test_an_fmu_without_a_library_for_this_machine_is_described_all_the_same(tmp_path):
    check = rockshed.check_fmu(
        written(tmp_path / "x.fmu"), probes=["archive/layout", "description", "conduct"]
    )
    assert "it has vax" in check["archive/layout"].what
    assert check["description/schema"].verdict is Verdict.PASSED
    assert check["library/loads"].verdict is Verdict.FAILED
    assert check["conduct/step-first"].verdict is Verdict.NOT_APPLICABLE


def test_probes_that_are_passed_over_take_one_line_and_are_all_in_json_and_junit(tmp_path):
    check = rockshed.check_fmu(written(tmp_path / "x.fmu"))
    passed_over = [f for f in check if f.verdict is Verdict.NOT_APPLICABLE and f.passed_over]
    ran = [f.name for f in check if not f.passed_over]
    assert len(passed_over) > 40
    rows = list(check.table())
    assert [row["probe"] for row in rows] == [*ran, f"{len(passed_over)} more"]
    assert rows[-1]["seen"] == "cannot be looked at: library/loads has not passed"
    assert len(check.as_data()["findings"]) == len(ran) + len(passed_over)
    suite = ElementTree.fromstring(junit(check).encode())
    assert len(suite.findall("testcase/skipped")) >= len(passed_over)
    assert len(suite.findall("testcase")) == len(check.findings)


def test_junit_of_an_fmu_without_a_library_for_this_machine_is_written(tmp_path):
    words = ["check", str(written(tmp_path / "x.fmu")), "--probe", "archive"]
    done = CliRunner().invoke(app, [*words, "--junit", str(tmp_path / "j.xml")])
    assert done.exit_code == 3
    assert (tmp_path / "j.xml").is_file()


def test_a_description_that_contradicts_itself_is_a_finding(tmp_path):
    file = written(tmp_path / "x.fmu", XML.replace("index='1'", "index='7'"))
    check = rockshed.check_fmu(file, probes=["description", "library/loads"])
    assert check["description/readable"].verdict is Verdict.FAILED
    assert check["library/loads"].verdict is Verdict.NOT_APPLICABLE


@pytest.mark.parametrize(
    ("content", "what"),
    [
        (None, "there is no such file"),
        (b"no zip", "is no FMU"),
        ({"a.txt": ""}, "there is no modelDescription.xml in it"),
        ({"modelDescription.xml": "<a"}, "cannot be read"),
        ({"modelDescription.xml": XML.replace("2.0", "1.0")}, "is FMI 1.0"),
        (
            {"modelDescription.xml": XML.replace("CoSimulation", "ModelExchange")},
            "no co-simulation",
        ),
    ],
)
def test_what_is_no_fmu_for_co_simulation_is_refused(tmp_path, content, what):
    file = tmp_path / "x.fmu"
    if isinstance(content, bytes):
        file.write_bytes(content)
    elif content:
        with zipfile.ZipFile(file, "w") as archive:
            for name, text in content.items():
                archive.writestr(name, text)
    with pytest.raises(InputRefused, match=what):
        rockshed.check_fmu(file)
    assert CliRunner().invoke(app, ["check", str(file)]).exit_code == 2


def test_a_probe_that_does_not_exist_is_refused_with_the_nearest_one(tmp_path):
    with pytest.raises(InputRefused, match="state/rollback"):
        rockshed.check_fmu(tmp_path / "x.fmu", probes=["state/rolback"])


def test_exit_code_and_junit_tell_the_verdicts(tmp_path):
    file = tmp_path / "x.fmu"
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr("modelDescription.xml", XML)
    words = ["check", str(file), "--probe", "archive", "--junit", str(tmp_path / "j.xml")]
    assert CliRunner().invoke(app, words).exit_code == 3
    suite = ElementTree.parse(tmp_path / "j.xml").getroot()
    assert suite.get("failures") == "1"
    assert suite.find("testcase[@name='layout']/failure").get("message")


@pytest.mark.parametrize("place", ["nowhere/check.xml", "mine.txt"])
def test_a_place_for_junit_is_refused_before_the_check(tmp_path, monkeypatch, place):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.txt").write_text("mine")
    file = tmp_path / "x.fmu"
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr("modelDescription.xml", XML)
    done = CliRunner().invoke(app, ["check", str(file), "--junit", place])
    assert done.exit_code == 2
    assert "probes" not in done.output
    assert ("is no folder" in done.output) == (place != "mine.txt")
    assert (tmp_path / "mine.txt").read_text() == "mine"


def test_junit_holds_whatever_an_fmu_says(tmp_path):
    odd = Finding("state", "rollback", Verdict.CRASHED, "says \x00 <b> ä \ud800", "")
    ElementTree.fromstring(junit(Check(tmp_path / "x.fmu", "", "2.0", "", (odd,))).encode())


def test_the_table_fits_on_80_columns(native_fmus):
    command = [sys.executable, "-m", "rockshed", "check", native_fmus["FallingRock"], "-q"]
    environment = {**os.environ, "COLUMNS": "80"}
    options = {"env": environment, "capture_output": True, "text": True, "check": True}
    done = subprocess.run([*command, "--probe", "archive"], **options)
    assert max(map(len, done.stdout.splitlines())) <= 80


def test_every_probe_has_a_name_of_its_own_and_what_it_needs_comes_before_it():
    names = [probe.name for probe in PROBES]
    assert len(set(names)) == len(names)
    for place, probe in enumerate(PROBES):
        assert not probe.needs or probe.needs in names[:place]
