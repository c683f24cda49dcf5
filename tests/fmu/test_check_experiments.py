"""``rockshed check`` carries out the experiments of anyone's FMU, and follows no manifest that lies."""

import zipfile
from hashlib import sha256

import pytest

import rockshed
from rockshed.checking.experiments import manifest as reading
from rockshed.checking.verdicts import Verdict
from rockshed.fmus.experiments.files import FOLDER, MANIFEST


def rewritten(fmu, folder, **edits):
    """A copy of an FMU with edits of its members: a function of the content, or None to leave it out.

    Their checksums in the manifest are those of the new content.
    """
    copy = folder / "copy.fmu"
    with zipfile.ZipFile(fmu) as source:
        files = {name: source.read(name) for name in source.namelist()}
    sums = {}
    for name, edit in edits.items():
        path = f"{FOLDER}/{name}"
        old = files.pop(path)
        if edit is not None:
            files[path] = edit(old)
            sums[sha256(old).hexdigest().encode()] = sha256(files[path]).hexdigest().encode()
    for old, new in sums.items():
        if MANIFEST in files:
            files[MANIFEST] = files[MANIFEST].replace(old, new)
    with zipfile.ZipFile(copy, "w") as target:
        for name, content in files.items():
            target.writestr(name, content)
    return copy


def swapped(old, new):
    def edit(content):
        assert old.encode() in content
        return content.replace(old.encode(), new.encode())

    return edit


def check(fmu):
    return rockshed.check_fmu(fmu, probes=["experiments"])


@pytest.mark.parametrize("version", ["native_fmus", "fmi3_fmus"])
def test_experiments_of_our_fmus_pass(request, version):
    found = check(request.getfixturevalue(version)["ImpulsiveGround"])
    assert found.silent, str(found)
    assert found["experiments/validation"].what.startswith("3 of 3; ")
    assert found["experiments/smoke-test"].verdict is Verdict.PASSED


@pytest.fixture
def rock(native_fmus):
    return native_fmus["FallingRock"]


def test_a_wrong_reference_fails_with_output_deviation_and_tolerance(rock, tmp_path):
    wrong = rewritten(rock, tmp_path, **{"free-fall_ref.csv": swapped("-8.0980665", "-8.0990665")})
    finding = check(wrong)["experiments/smoke-test"]
    assert finding.verdict is Verdict.FAILED
    assert finding.what.startswith(
        "0 of 1; free-fall: velocity.y deviates by 0.001, allowed is 8.2e-09"
    )


@pytest.mark.parametrize(
    ("edits", "verdict", "said"),
    [
        ({"free-fall_ref.csv": None}, "failed", "free-fall_ref.csv is not in the FMU"),
        (
            {"fmi-ls-manifest.xml": swapped('"smoke-test.exp"', '"../../../../etc/passwd"')},
            "failed",
            "../../../../etc/passwd leads out of the FMU",
        ),
        (
            {"fmi-ls-manifest.xml": swapped('"smoke-test.exp"', '"https://example.org/a.exp"')},
            "failed",
            "https://example.org/a.exp is no file inside the FMU",
        ),
        (
            {"fmi-ls-manifest.xml": swapped('role="other"', 'role="stimulus"')},
            "warning",
            "'stimulus'",
        ),
        (
            {
                "fmi-ls-manifest.xml": swapped("application/x-ma-hs-experiments", "text/x"),
                "smoke-test.exp": None,
            },
            "failed",
            "smoke-test.exp is not in the FMU",
        ),
        ({"fmi-ls-manifest.xml": lambda _: b"<fmiReferences"}, "failed", "is no XML"),
        (
            {"smoke-test.exp": lambda _: b'<Experiments name="x"><Experiment/></Experiments>'},
            "warning",
            "smoke-test.exp line 1",
        ),
    ],
)
def test_a_manifest_that_lies_is_told_and_not_followed(rock, tmp_path, edits, verdict, said):
    finding = check(rewritten(rock, tmp_path, **edits))["experiments/manifest"]
    assert (finding.verdict, said in finding.what) == (verdict, True), finding.what


def test_a_file_that_is_not_what_the_manifest_says_is_told(rock, tmp_path):
    wrong = swapped('source="free-fall_ref.csv"', 'source="push-and-turn_ref.csv"')
    finding = check(rewritten(rock, tmp_path, **{"fmi-ls-manifest.xml": wrong}))[
        "experiments/manifest"
    ]
    assert finding.verdict is Verdict.FAILED
    assert "push-and-turn_ref.csv is not what the manifest says: its SHA-256 is" in finding.what


@pytest.mark.parametrize(
    ("edits", "said"),
    [
        (
            {"driven.ssv": swapped('name="velocity0.x"', 'name="nothing"')},
            "sets nothing, which is no variable",
        ),
        (
            {
                "push-and-turn.ssv": lambda c: c.replace(b'"position0.x"', b'"mass"').replace(
                    b'"0.2"', b'"-4.0"'
                )
            },
            "sets mass = -4, beyond its range of 1e-06 to inf",
        ),
        (
            {"driven_in.csv": swapped("force.x", "velocity.x")},
            "has stimuli for velocity.x, which is no input",
        ),
        (
            {"driven_in.csv": swapped("0.0,-40.0", "0.0,minus forty")},
            "'minus forty' is no value of force.x",
        ),
        ({"driven_ref.csv": swapped("0.002,", "-0.002,")}, "its times do not ascend"),
        (
            {"validation.exp": swapped('stepSize="0.001"', 'stepSize="1e-12"')},
            "asks for 5e+10 steps",
        ),
        (
            {"validation.exp": swapped('stopTime="0.02"', 'stopTime="0.01"')},
            "and its references at 0.02 s",
        ),
        ({"validation.exp": swapped('stopTime="0.02"', 'stopTime="nan"')}, "goes from 0 to nan s"),
    ],
)
def test_an_experiment_beyond_the_fmu_is_told_and_not_followed(rock, tmp_path, edits, said):
    finding = check(rewritten(rock, tmp_path, **edits))["experiments/validation"]
    assert finding.verdict is Verdict.FAILED
    assert said in finding.what, finding.what


def test_a_huge_table_is_not_read(rock, tmp_path, monkeypatch):
    monkeypatch.setattr(reading, "_MOST_BYTES", 100)
    file = tmp_path / "large.csv"
    file.write_bytes(b"x" * 101)
    with pytest.raises(reading.Untrue, match=r"at most 0\.0001 are read"):
        reading.content_of(file)


OLD = """<Experiments name="old"><Experiment name="fall" startTime="0" stopTime="0.02" stepSize="0.001"
 tolerance="1e-4"><References source="free-fall_ref.csv"/></Experiment></Experiments>"""


def test_times_among_the_attributes_of_an_experiment_are_read_too(rock, tmp_path):
    """So they stood in the draft. Without tolerances for outputs that of the experiment counts, relative to the largest value."""
    found = check(rewritten(rock, tmp_path, **{"smoke-test.exp": lambda _: OLD.encode()}))
    assert found["experiments/manifest"].verdict is Verdict.WARNING
    assert found["experiments/smoke-test"].what.startswith("1 of 1; fall: ")


BARE = """<fmiReferences xmlns:fmi-ls="http://fmi-standard.org/fmi-ls-manifest"
 fmi-ls:fmi-ls-name="org.fmi-standard.fmi-ls-ref" fmi-ls:fmi-ls-version="1.0.0-alpha.1">
<Related type="text/csv" source="free-fall_ref.csv" role="result"/></fmiReferences>"""


def test_a_result_without_an_experiment_is_that_of_the_default_experiment(rock, tmp_path):
    """As the Reference FMUs have it. Their manifest lacks what the schema requires."""
    found = check(rewritten(rock, tmp_path, **{"fmi-ls-manifest.xml": lambda _: BARE.encode()}))
    assert found["experiments/manifest"].verdict is Verdict.WARNING
    assert "fmi-ls-description" in found["experiments/manifest"].what
    assert found["experiments/smoke-test"].what.startswith("1 of 1; default experiment: ")
    assert found["experiments/smoke-test"].what.endswith("as none is told")
    assert found["experiments/validation"].verdict is Verdict.NOT_APPLICABLE


def test_an_fmu_without_a_manifest_has_none(rock, tmp_path):
    with zipfile.ZipFile(rock) as source:
        names = [n.removeprefix(f"{FOLDER}/") for n in source.namelist() if n.startswith(FOLDER)]
    found = check(rewritten(rock, tmp_path, **dict.fromkeys(names)))
    assert MANIFEST.endswith("fmi-ls-manifest.xml")
    assert {f.verdict for f in found if f.theme == "experiments"} == {Verdict.NOT_APPLICABLE}
