"""FMUs as people pack them, and the true reason where one cannot be used."""

import re
import shutil
import zipfile

import pytest

from rockshed.core.errors import InputRefused
from rockshed.core.fmu import archive
from rockshed.core.fmu.fmu_slave import FmuFile, UnusableError, read_description


def packed(source, target, name=lambda name: name, **others):
    """Pack an FMU again under other names, and with other contents."""
    with zipfile.ZipFile(source) as old, zipfile.ZipFile(target, "w") as new:
        for entry in old.infolist():
            content = others.get(entry.filename.partition(".")[0], old.read(entry))
            new.writestr(zipfile.ZipInfo(name(entry.filename)), content)
    return target


def said(file):
    """Return the reason why a file is no FMU that can be run."""
    with pytest.raises((InputRefused, UnusableError)) as refusal:
        read_description(FmuFile(file).model_description())
    return str(refusal.value)


@pytest.mark.parametrize(
    "name",
    [
        lambda name: name.replace("/", "\\"),
        lambda name: f"./{name}",
        lambda name: f".\\{name}".replace("/", "\\"),
    ],
    ids=["from Windows", "by hand", "both"],
)
def test_an_archive_with_other_separators_is_read_and_run(rock_fmu, tmp_path, name):
    file = packed(rock_fmu, tmp_path / "X.FMU", name)
    assert b"FallingRock" in FmuFile(file).model_description()
    slave = FmuFile(file).instantiate("rock")
    slave.free()


def test_an_archive_that_would_be_too_large_is_refused_with_the_limit(
    rock_fmu, tmp_path, monkeypatch
):
    monkeypatch.setattr(archive, "MOST_UNPACKED", 10_000_000)
    file = tmp_path / "zeros.fmu"
    shutil.copy(rock_fmu, file)
    with zipfile.ZipFile(file, "a", zipfile.ZIP_DEFLATED) as content:
        content.writestr("resources/zeros", bytes(11_000_000))
    assert file.stat().st_size < 2_000_000
    assert "0.01 GB in 100,000 are taken" in said(file)
    with pytest.raises(InputRefused, match="are taken"):
        FmuFile(file).instantiate("rock")


def test_an_archive_of_too_many_files_is_refused_with_the_limit(rock_fmu, tmp_path, monkeypatch):
    monkeypatch.setattr(archive, "MOST_MEMBERS", 3)
    assert "in 3 are taken" in said(shutil.copy(rock_fmu, tmp_path / "many.fmu"))


@pytest.mark.parametrize(
    ("xml", "reason"),
    [
        ("<fmiModelDescription fmiVersion='2.0'", "no element found|unclosed|not well-formed"),
        (
            "<fmiModelDescription fmiVersion='3.0' modelName='x' instantiationToken='x'>"
            "<ScheduledExecution modelIdentifier='x'/><ModelVariables/><ModelStructure/>"
            "</fmiModelDescription>",
            "scheduled execution",
        ),
        (
            "<fmiModelDescription fmiVersion='2.0' modelName='x' guid='x'>"
            "<ModelExchange modelIdentifier='x'/><ModelVariables/><ModelStructure/>"
            "</fmiModelDescription>",
            "is for model exchange only",
        ),
    ],
)
def test_the_true_reason_is_told_why_an_fmu_cannot_be_run(rock_fmu, tmp_path, xml, reason):
    found = said(packed(rock_fmu, tmp_path / "x.fmu", modelDescription=xml.encode()))
    assert re.search(reason, found), found


def test_an_fmu_that_becomes_another_one_while_it_is_loaded_is_refused(rock_fmu, tmp_path):
    """Its binary would be another one's than the description and the digest of the run."""
    path = packed(rock_fmu, tmp_path / "x.fmu")
    file = FmuFile(path)
    file.model_description()
    with zipfile.ZipFile(path, "a") as archive:
        archive.writestr("resources/other.txt", "built anew")
    with pytest.raises(InputRefused, match=r"x\.fmu: has changed while it was loaded.*run again"):
        file.unpack(tmp_path / "unpacked")
    assert not (tmp_path / "unpacked").exists()
    file.model_description()
    file.unpack(tmp_path / "unpacked")
    assert (tmp_path / "unpacked" / "resources" / "other.txt").is_file()
