"""Building: the same bytes each time, nothing half-written, readable refusals."""

import dataclasses
import hashlib
import shutil
import struct
import subprocess
import sys
import zipfile

import pytest

from rockshed.components.catalogue import NAMES, component
from rockshed.components.common.component import ComponentError
from rockshed.fmus.build import (
    BuildError,
    build,
    build_component,
    build_if_needed,
    file_name,
    fmu_files,
)

from .conftest import ROOT

BUILD = (
    "import sys, hashlib; from rockshed.fmus.build import build; print(hashlib.sha256(build(sys.argv[1], destination=sys.argv[2])"
    ".read_bytes()).hexdigest())"
)


@pytest.mark.parametrize("name", NAMES)
def test_builds_are_equal_byte_for_byte_in_other_processes(fmus, python, tmp_path, name):
    expected = hashlib.sha256(fmus[name].read_bytes()).hexdigest()
    for seed in ("1", "2"):
        assert (
            python(BUILD, name, tmp_path / seed, PYTHONHASHSEED=seed, TZ="Asia/Tokyo").strip()
            == expected
        )


def test_a_build_from_another_directory_is_equal(fmus, python, tmp_path):
    copy = tmp_path / "a copy"
    for folder, place in (("orchestrator", ""), ("components", "components"), ("fmus", "fmus")):
        shutil.copytree(
            ROOT / folder,
            copy / "rockshed" / place,
            ignore=shutil.ignore_patterns("__pycache__", "dist"),
        )
    script = (
        f"import sys; sys.path.insert(0, {str(copy)!r})\n"
        f"import rockshed; assert rockshed.__file__.startswith({str(copy)!r})\n" + BUILD
    )
    assert (
        python(script, "FallingRock", tmp_path).strip()
        == hashlib.sha256(fmus["FallingRock"].read_bytes()).hexdigest()
    )


def test_an_fmu_that_is_as_it_should_be_is_left_alone_and_any_other_is_replaced(tmp_path):
    file = build_if_needed("FallingRock", destination=tmp_path)
    content, stamp = file.read_bytes(), file.stat().st_mtime_ns
    assert build_if_needed("FallingRock", destination=tmp_path) == file
    assert file.stat().st_mtime_ns == stamp
    file.write_bytes(content[:-100])
    assert build_if_needed("FallingRock", destination=tmp_path).read_bytes() == content


def test_sizes_that_differ_are_part_of_the_file_name_and_not_of_the_model_name(probe, tmp_path):
    file = build_component(probe, {"tanks": 5}, tmp_path)
    assert file.name == "Probe-tanks5.fmu"
    assert file_name(probe, {"tanks": 3}) == "Probe.fmu"
    with zipfile.ZipFile(file) as archive:
        assert {"binaries/linux64/Probe.so", "binaries/win64/Probe.dll"} <= set(archive.namelist())
        assert b'modelIdentifier="Probe"' in archive.read("modelDescription.xml")


def test_guid_and_module_names_follow_the_content(probe, tmp_path):
    def parts(files):
        (script,) = (
            path
            for path in files
            if path.startswith("resources/rockshed_") and path.count("/") == 1
        )
        library = next(path.split("/")[1] for path in files if path.endswith("/isolation.py"))
        return files["modelDescription.xml"].split(b'guid="')[1][:38], script, library

    copy = tmp_path / "probe"
    shutil.copytree(probe.folder, copy)
    guid, script, library = parts(fmu_files(probe, {"tanks": 3}))
    assert parts(fmu_files(dataclasses.replace(probe, folder=copy), {"tanks": 3})) == (
        guid,
        script,
        library,
    )
    other_size = parts(fmu_files(probe, {"tanks": 4}))
    assert other_size[2] == library  # the same code: compiled once for all sizes
    (copy / "README.md").write_text("# Changed\n")
    other_text = parts(fmu_files(dataclasses.replace(probe, folder=copy), {"tanks": 3}))
    assert other_text[2] == library
    (copy / "kernel.py").write_text((copy / "kernel.py").read_text() + "\n")
    other_code = parts(fmu_files(dataclasses.replace(probe, folder=copy), {"tanks": 3}))
    assert other_code[2] != library
    assert len({guid, other_size[0], other_text[0], other_code[0]}) == 4
    assert len({script, other_size[1], other_text[1], other_code[1]}) == 4


def test_documentation_has_the_readme_and_all_variables_and_sizes(fmus):
    with zipfile.ZipFile(fmus["Probe"]) as archive:
        page = archive.read("documentation/index.html").decode()
    assert "<h1>Probe</h1>" in page
    assert "<td>y &amp; z</td>" in page  # a table of the README
    assert "<title>Probe: leaky tanks &lt;in a row&gt; &amp; a counter</title>" in page
    assert (
        "<tr><td>limit</td><td>parameter</td><td>m</td><td>10</td><td>≥ 0.1, ≤ 100</td>"
        "<td>highest level allowed, 100 % full</td><td>made up</td></tr>"
    ) in page
    assert "<td>level0[1..3]</td><td>parameter</td><td>m</td><td>0 ... 0.666666667</td>" in page
    assert "<td>linear</td><td>none, linear</td>" in page
    assert "<tr><td>tanks</td><td>3</td><td>number of tanks</td></tr>" in page


def test_the_license_of_pythonfmu_accompanies_its_files(fmus):
    with zipfile.ZipFile(fmus["Probe"]) as archive:
        assert b"Permission is hereby granted" in archive.read(
            "documentation/licenses/pythonfmu.txt"
        )


@pytest.mark.parametrize("name", NAMES)
def test_the_icon_is_a_small_picture(fmus, name):
    with zipfile.ZipFile(fmus[name]) as archive:
        icon = archive.read("model.png")
    assert icon.startswith(b"\x89PNG\r\n\x1a\n")
    assert struct.unpack(">II", icon[16:24]) == (128, 128)


def test_two_builds_at_once_leave_one_whole_file(fmus, tmp_path):
    builds = [
        subprocess.Popen([sys.executable, "-c", BUILD, "FallingRock", str(tmp_path)], cwd=ROOT)
        for _ in range(2)
    ]
    assert [process.wait(120) for process in builds] == [0, 0]
    assert (tmp_path / "FallingRock.fmu").read_bytes() == fmus["FallingRock"].read_bytes()
    assert [path.name for path in tmp_path.iterdir() if not path.name.startswith(".lock")] == [
        "FallingRock.fmu"
    ]


def test_nothing_half_written_is_left_when_a_build_is_interrupted(monkeypatch, tmp_path):
    def interrupt(*_):
        raise KeyboardInterrupt

    file = build("FallingRock", destination=tmp_path)
    before = file.read_bytes()
    monkeypatch.setattr("rockshed.files.os.replace", interrupt)
    with pytest.raises(KeyboardInterrupt):
        build("FallingRock", destination=tmp_path)
    assert file.read_bytes() == before
    assert [path.name for path in tmp_path.iterdir() if not path.name.startswith(".lock")] == [
        "FallingRock.fmu"
    ]


def test_a_folder_that_cannot_be_written_is_refused_with_a_remedy(monkeypatch, tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(BuildError, match=r"FallingRock: cannot write .*name another folder"):
        build("FallingRock", destination=tmp_path / "file" / "folder")
    monkeypatch.setenv("ROCKSHED_FMU_DIR", str(tmp_path / "file"))
    with pytest.raises(BuildError, match=r"cannot write .*ROCKSHED_FMU_DIR"):
        build("FallingRock")


def test_the_environment_variable_moves_the_folder(monkeypatch, tmp_path):
    monkeypatch.setenv("ROCKSHED_FMU_DIR", str(tmp_path / "elsewhere"))
    assert build("FallingRock") == tmp_path / "elsewhere" / "python" / "FallingRock.fmu"


@pytest.mark.parametrize(
    ("sizes", "reason"),
    [
        ({"tanks": 0}, "tanks = 0: allowed is 1 to 50"),
        ({"tanks": 51}, "tanks = 51"),
        ({"discs": 3}, "has no size 'discs'"),
    ],
)
def test_sizes_out_of_range_and_unknown_ones_are_refused(probe, tmp_path, sizes, reason):
    with pytest.raises(ComponentError, match=reason):
        build_component(probe, sizes, tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_an_unknown_component_is_refused():
    with pytest.raises(KeyError, match="there is no component 'Rock'; there are FallingRock"):
        build("Rock")


def test_catalogue_names_are_fmu_names():
    assert all(component(name).name == name for name in NAMES)
