"""Facts of a run whose pictures are damaged, and pictures of an FMU that show nothing."""

import copy
from xml.etree import ElementTree

import pytest

from rockshed.core.fmu.annotations import TOOL, read_annotations
from rockshed.core.results.shape import check

CURVES = {
    "label": "force",
    "unit": "N",
    "second_unit": "",
    "downwards": False,
    "common": False,
    "references": "",
    "curves": [{"variable": "f", "label": "", "factor": 1.0, "from_start": False, "dashed": False}],
}
ENVELOPE = {"label": "moment", "unit": "N", "variable": "m", "along": "x", "ends": ""}


def facts(panel):
    pictures = [{"name": "p", "panels": [panel]}]
    return {"status": "complete", "components": {"a": {"pictures": pictures}}}


def test_panels_of_curves_and_envelopes_are_taken():
    check(facts(CURVES))
    check(facts(ENVELOPE))


@pytest.mark.parametrize("panel", [CURVES, ENVELOPE], ids=["curves", "envelope"])
def test_a_panel_without_something_that_is_drawn_is_refused_with_its_place(panel):
    for name in set(panel) - {"common"}:
        damaged = copy.deepcopy(panel)
        del damaged[name]
        with pytest.raises(ValueError, match=r"components\.a\.pictures\.0\.panels\.0\."):
            check(facts(damaged))


@pytest.mark.parametrize("curves", [[], [{"variable": "f"}], "f"])
def test_curves_that_cannot_be_drawn_are_refused(curves):
    with pytest.raises(ValueError, match="curves"):
        check(facts({**CURVES, "curves": curves}))


def test_a_panel_of_no_curves_in_an_fmu_is_passed_over():
    root = ElementTree.fromstring(
        f'<d><VendorAnnotations><Tool name="{TOOL}"><Component contents=""><Picture name="p">'
        '<Panel label="nothing" unit="N"/>'
        '<Panel label="force" unit="N"><Curve variable="f"/></Panel>'
        "</Picture></Component></Tool></VendorAnnotations></d>"
    )
    ((picture),) = read_annotations(root).pictures
    assert [panel["label"] for panel in picture["panels"]] == ["force"]


def test_a_bond_that_names_no_members_is_passed_over():
    """So they stand in FMUs of older versions, which are connected variable by variable."""
    member = '<Member name="force.y" variable="rock.force.y"/>'
    for inside, found in (("", 0), (member, 1)):
        root = ElementTree.fromstring(
            f'<fmiModelDescription><VendorAnnotations><Tool name="{TOOL}"><Component>'
            f'<Bond name="rock" prefix="rock.">{inside}</Bond></Component></Tool>'
            "</VendorAnnotations></fmiModelDescription>"
        )
        assert len(read_annotations(root).bonds) == found
