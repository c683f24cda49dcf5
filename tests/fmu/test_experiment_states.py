"""The state of settled sand inside the FMU: experiments begin with it, and one that lies is refused in words."""

import hashlib
import lzma
import shutil
import zipfile
import zlib
from io import BytesIO

import pytest
from fmpy.fmi2 import FMU2Slave

from rockshed.checking.experiments.manifest import FOLDER, MANIFEST
from rockshed.checking.probes import experiments
from rockshed.checking.subject import subject as subjects
from rockshed.checking.subject.subject import Subject
from rockshed.checking.verdicts import Verdict
from rockshed.components.catalogue import component
from rockshed.fmus.build import fmu_content
from rockshed.fmus.experiments.files import experiment_files
from rockshed.fmus.experiments.recorded import DATA, recorded_state
from rockshed.platforms import PLATFORMS

STATE = "settled-sand.state"
SEAL = 12
"""Bytes of mark and checksum at the begin of a state."""


def sealed(content):
    """A state whose checksum is right."""
    return content[:8] + zlib.crc32(content[SEAL:]).to_bytes(4, "little") + content[SEAL:]


@pytest.fixture(scope="module")
def unpacked(native_fmus, fmi3_fmus, tmp_path_factory):
    """Folders of the sand's FMU by version of FMI."""
    folders = {}
    for version, built in ((2, native_fmus), (3, fmi3_fmus)):
        folders[version] = tmp_path_factory.mktemp("sand") / str(version)
        with zipfile.ZipFile(built["SandCushion"]) as archive:
            archive.extractall(folders[version])
    return folders


@pytest.fixture
def sand(unpacked, tmp_path):
    """The FMU under check with another state or manifest; a state's checksum is told anew."""

    def subject(state=None, version=2, is_told=True, **swaps):
        folder = tmp_path / "fmu"
        shutil.copytree(unpacked[version], folder)
        own = folder / FOLDER
        manifest = (own / MANIFEST).read_text()
        if state is not None:
            old = hashlib.sha256((own / STATE).read_bytes()).hexdigest()
            (own / STATE).write_bytes(state)
            new = hashlib.sha256(state).hexdigest()
            manifest = manifest.replace(old, new) if is_told else manifest
        for old, new in swaps.items():
            assert old in manifest
            manifest = manifest.replace(old, new)
        (own / MANIFEST).write_text(manifest)
        return Subject(tmp_path / "x.fmu", folder, tmp_path, tmp_path / "trail")

    return subject


@pytest.fixture(scope="module")
def content():
    made = component("SandCushion")
    return recorded_state("settled-sand", made.with_sizes()).content


@pytest.mark.parametrize("version", [2, 3])
def test_experiments_from_the_state_have_the_bits_of_those_that_settle(sand, version):
    seen = experiments.state(sand(version=version))
    assert seen.verdict is Verdict.PASSED, seen.what
    assert seen.what == (
        "1 taken; rock-into-settled-sand, settled-sand: the bits of its parameters"
    )


def test_the_role_of_the_state_has_the_platforms_name_in_its_version_of_fmi(unpacked):
    for version, name in ((2, "linux64"), (3, "x86_64-linux")):
        manifest = (unpacked[version] / FOLDER / MANIFEST).read_text()
        assert manifest.count(f'role="serialized-state/{name}"') == 1


def state_of(folder, name):
    """State of an FMU with start values, initialised."""
    guid = (folder / "modelDescription.xml").read_text().partition('guid="')[2].partition('"')[0]
    slave = FMU2Slave(
        guid=guid, unzipDirectory=str(folder), modelIdentifier=name, instanceName="other"
    )
    slave.instantiate()
    slave.setupExperiment(startTime=0.0)
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    state = slave.getFMUState()
    found = slave.serializeFMUState(state)
    slave.freeFMUState(state)
    slave.freeInstance()
    return bytes(found)


FOREIGN = "this is no serialized state of this component with these sizes"
DAMAGED = "this is no serialized state of a rockshed FMU, or it is damaged"


@pytest.mark.parametrize(
    ("lie", "said"),
    [
        (lambda state: state[:-8], DAMAGED),
        (lambda state: sealed(state[:-8]), FOREIGN),
        (lambda state: sealed(state + bytes(8)), FOREIGN),
        (lambda state: b"", DAMAGED),
        (lambda state: bytes(len(state)), DAMAGED),
        (lambda state: bytes(range(256)) * 2000, DAMAGED),
        (lambda state: sealed(state[:40] + b"\xff" + state[41:]), FOREIGN),
        (lambda state: sealed(state[:SEAL] + b"\x63" + state[SEAL + 1 :]), "its phase is 99"),
    ],
    ids=["cut", "cut-and-sealed", "longer", "empty", "zeros", "garbage", "other-kernel", "phase"],
)
@pytest.mark.parametrize("version", [2, 3])
def test_a_state_that_lies_is_refused_in_words(sand, content, lie, said, version):
    seen = experiments.state(sand(lie(content), version))
    assert seen.verdict is Verdict.FAILED
    assert seen.what.startswith(f"{STATE}: fmi{version}"), seen.what
    assert said in seen.what


def test_the_state_of_another_component_is_refused_in_words(sand, native_fmus, tmp_path):
    with zipfile.ZipFile(native_fmus["FallingRock"]) as archive:
        archive.extractall(tmp_path / "rock")
    seen = experiments.state(sand(state_of(tmp_path / "rock", "FallingRock")))
    assert (seen.verdict, FOREIGN in seen.what) == (Verdict.FAILED, True), seen.what


def test_a_state_of_other_parameters_is_seen(sand, unpacked):
    seen = experiments.state(sand(state_of(unpacked[2], "SandCushion")))
    assert seen.verdict is Verdict.FAILED
    assert seen.what.startswith("rock-into-settled-sand: at 0.0001 s ")
    assert " instead of " in seen.what


def test_a_state_with_a_wrong_checksum_begins_no_experiment(sand, content):
    subject = sand(content[:-1] + b"x", is_told=False)
    assert f"{STATE} is not what the manifest says: its SHA-256 is" in (
        experiments.manifest(subject).what
    )
    seen = experiments.state(subject)
    assert (seen.verdict, "is not what the manifest says" in seen.what) == (Verdict.FAILED, True)
    assert experiments.validation(subject).verdict is Verdict.PASSED


def test_a_state_that_is_missing_is_told(sand):
    subject = sand()
    (subject.folder / FOLDER / STATE).unlink()
    assert f"{STATE} is not in the FMU" in experiments.manifest(subject).what
    seen = experiments.state(subject)
    assert (seen.verdict, seen.what) == (Verdict.FAILED, f"{STATE} is not in the FMU")


def test_what_the_manifest_does_not_call_a_state_begins_no_experiment(sand):
    subject = sand(**{"serialized-state/linux64": "other"})
    assert f"settled-sand: {STATE} is no state in the manifest" in (
        experiments.manifest(subject).what
    )
    assert experiments.state(subject).what == "the FMU carries no serialized states"
    assert experiments.validation(subject).verdict is Verdict.PASSED


@pytest.mark.parametrize("machine", ["aarch64-linux", "x86_64-windows"])
def test_on_another_machine_the_state_is_passed_over_with_the_reason(sand, machine, monkeypatch):
    for module in (subjects, experiments):
        monkeypatch.setattr(module, "this_machine", lambda: PLATFORMS[machine])
    seen = experiments.state(sand())
    assert seen.verdict is Verdict.NOT_APPLICABLE
    assert seen.what == f"its states are for linux64; this machine is {machine}"


def test_the_state_makes_an_fmu_little_larger():
    made = component("SandCushion")
    sizes = made.with_sizes()
    files = experiment_files(made, sizes)
    assert len(zlib.compress(files[f"{FOLDER.as_posix()}/{STATE}"])) < 35_000
    with zipfile.ZipFile(BytesIO(fmu_content(made, sizes))) as archive:
        assert archive.getinfo(f"{FOLDER.as_posix()}/{STATE}").compress_size < 35_000
    other = experiment_files(made, made.with_sizes({"discs": 111}))
    assert not any(path.endswith(".state") for path in other)


@pytest.mark.slow
def test_the_recorded_state_is_what_settling_gives(content):
    """Where it is not, a kernel has changed: ``python -m tests.fmu.record``."""
    from .record import STATES, state

    owner, parameters = STATES["settled-sand"]
    assert state(owner, parameters) == content
    assert lzma.decompress((DATA / "settled-sand.state.xz").read_bytes()) == content


@pytest.mark.slow
def test_an_fmu_with_python_takes_the_same_state(python_fmus, tmp_path):
    """In a process of its own, as such an FMU brings its Python."""
    import rockshed

    found = rockshed.check_fmu(
        python_fmus["SandCushion"], probes=["experiments/state"], time_limit=300.0
    )
    assert found["experiments/state"].verdict is Verdict.PASSED, str(found)
