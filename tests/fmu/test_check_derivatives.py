"""``rockshed check`` of partial derivatives: right ones pass, each fault is found."""

import shutil
import sys

import pytest

import rockshed
from rockshed.checking.verdicts import Verdict

from .derivative_fmus import XML2, XML3, make

pytestmark = pytest.mark.skipif(
    sys.platform != "linux" or not shutil.which("cc"), reason="needs Linux and a C compiler"
)
BOTH = pytest.mark.parametrize("version", [2, 3])
DIRECTIONAL = ["running", "initial", "undeclared", "linear", "unchanged"]


def checked(folder, version, *probes, xml=None, **parts):
    """Make an FMU and check its derivatives."""
    chosen = [f"derivatives/{name}" for name in probes] or ["derivatives"]
    return rockshed.check_fmu(make(folder, version, xml, **parts), probes=chosen)


@BOTH
def test_right_derivatives_pass(tmp_path, version):
    check = checked(tmp_path, version)
    names = DIRECTIONAL + ["adjoint"] * (version == 3)
    assert {check[f"derivatives/{name}"].verdict for name in names} == {Verdict.PASSED}, str(check)
    # y by u and v, z by u and w, der(s) by v; FMI 3.0 has b by a besides
    assert check["derivatives/running"].what.startswith({2: "5 ", 3: "9 "}[version])


FAULTS = {
    "wrong sign": ("running", {"SUM": "-sum"}),
    "factor of two": ("initial", {"SUM": "2 * sum"}),
    "wrong in the state after a step": (
        "running",
        {"SUM": "t->running && f[k] == Y ? 0.9 * sum : sum"},
    ),
    "right for the start values only": ("running", {"ADDED": "sum += *s * (f[k] == Y ? 0.7 : 1)"}),
    "wrong place": ("undeclared", {"HIDDEN": "x == W ? 1e-9 : 0"}),
    "wrong place in the right row": (
        "running",
        {"ADDED": "sum += *s * partial(t, f[k], i, x[l] == U ? V : x[l] == V ? U : x[l], j)"},
    ),
    "transposed": (
        "running",
        {"ADDED": "sum += *s * partial(t, f[k] == Y ? Z : f[k] == Z ? Y : f[k], i, x[l], j)"},
    ),
    "only the first seed": (
        "linear",
        {"ADDED": "sum += (s == seed) * *s * partial(t, f[k], i, x[l], j)"},
    ),
    "seeds are taken for one": ("linear", {"ADDED": "sum += !!*s * partial(t, f[k], i, x[l], j)"}),
    "error status": ("running", {"STATUS": "3"}),
    "error status while initialising": ("initial", {"STATUS": "t->running ? 0 : 3"}),
    "NaN": ("running", {"SUM": "f[k] == Z ? NAN : sum"}),
    "nothing is written": ("running", {"SUM": "f[k] == Z ? *out : sum"}),
    "not put back": ("unchanged", {"AFTER": "t->s += 1e-12"}),
}


@BOTH
@pytest.mark.parametrize("fault", FAULTS)
def test_each_fault_is_found(tmp_path, version, fault):
    probe, parts = FAULTS[fault]
    finding = checked(tmp_path, version, probe, **parts)[f"derivatives/{probe}"]
    print(f"| {fault} | {finding.what} |")
    assert finding.verdict is Verdict.FAILED, finding
    assert finding.remedy


OF_ADJOINTS = {
    "wrong sign": "sum -= *s * partial(t, f[k], i, x[l], j)",
    "not transposed": "sum += *s * partial(t, x[l], j, f[k], i)",
    "only the first seed": "sum += (s == seed) * *s * partial(t, f[k], i, x[l], j)",
    "vectors transposed": "sum += *s * partial(t, f[k], j, x[l], i)",
    "NaN": "sum = NAN",
}


@pytest.mark.parametrize("alone", [False, True])
@pytest.mark.parametrize("fault", OF_ADJOINTS)
def test_each_fault_of_adjoints_is_found_also_where_they_are_alone(tmp_path, fault, alone):
    xml = XML3.replace(" providesDirectionalDerivatives='true'", "") if alone else XML3
    check = checked(tmp_path, 3, "adjoint", xml=xml, WEIGHED=OF_ADJOINTS[fault])
    assert check["derivatives/adjoint"].verdict is Verdict.FAILED, str(check)


def test_right_adjoints_pass_where_they_are_alone(tmp_path):
    xml = XML3.replace(" providesDirectionalDerivatives='true'", "")
    check = checked(tmp_path, 3, xml=xml)
    verdicts = {f.probe: f.verdict for f in check if f.theme == "derivatives"}
    assert verdicts.pop("adjoint") is verdicts.pop("unchanged") is Verdict.PASSED
    assert set(verdicts.values()) == {Verdict.NOT_APPLICABLE}


@BOTH
@pytest.mark.parametrize(
    ("parts", "verdict"), [({}, Verdict.PASSED), ({"SUM": "-sum"}, Verdict.FAILED)]
)
def test_outputs_that_follow_with_the_next_step_are_compared_after_a_short_one(
    tmp_path, version, parts, verdict
):
    check = checked(tmp_path, version, "running", AT_ONCE="0", **parts)
    assert check["derivatives/running"].verdict is verdict, str(check)


@BOTH
def test_outputs_that_follow_with_a_step_that_cannot_be_repeated_are_not_compared(
    tmp_path, version
):
    state = {2: "canGetAndSetFMUstate", 3: "canGetAndSetFMUState"}[version]
    xml = {2: XML2, 3: XML3}[version].replace(f"{state}='true'", "")
    check = checked(tmp_path, version, "running", xml=xml, AT_ONCE="0")
    found = check["derivatives/running"]  # the derivative of the state follows at once
    assert (found.verdict, found.what.split()[:2]) == (Verdict.PASSED, ["1", "derivative"])


@BOTH
def test_derivatives_that_are_not_provided_are_not_applicable(tmp_path, version):
    xml = {2: XML2, 3: XML3}[version]
    for flag in ("providesDirectionalDerivatives", "providesDirectionalDerivative"):
        xml = xml.replace(f"{flag}='true'", "")
    xml = xml.replace("providesAdjointDerivatives='true'", "")
    check = checked(tmp_path, version, xml=xml)
    found = [f for f in check if f.theme == "derivatives"]
    assert {f.verdict for f in found} == {Verdict.NOT_APPLICABLE}
    assert all("is false" in f.what for f in found)


@pytest.mark.parametrize(
    ("slope", "verdict"),
    [("1", Verdict.PASSED), ("-1", Verdict.PASSED), ("1.1", Verdict.FAILED)],
)
def test_at_a_kink_the_derivative_to_either_side_is_right(tmp_path, slope, verdict):
    kink = {"OF_W": "fabs(t->w - t->p)", "IN_STEP": "t->p = t->w", "BY_W": slope}
    check = checked(tmp_path, 2, "running", **kink)
    assert check["derivatives/running"].verdict is verdict, str(check)
