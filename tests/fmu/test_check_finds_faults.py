"""The check finds faults that are seeded one by one into a copy of our slave, shim and kernels."""

import pytest

import rockshed
from rockshed.checking.verdicts import Verdict
from rockshed.fmus.build import Fmi

from .seeded import SEEDS, seeded

FOUND = (Verdict.FAILED, Verdict.WARNING, Verdict.CRASHED, Verdict.TIMED_OUT)
CHEAP = ("GUID not compared", "ends the process")
"""Faults that are looked for in every run of the tests."""


@pytest.mark.parametrize(
    "fault",
    [pytest.param(each, marks=[] if each.name in CHEAP else [pytest.mark.slow]) for each in SEEDS],
    ids=lambda fault: fault.name.replace(" ", "_"),
)
def test_a_seeded_fault_is_found_by_the_probe_that_looks_for_it(
    fault, native_fmus, fmi3_fmus, tmp_path
):
    fmu = (native_fmus if fault.fmi is Fmi.TWO else fmi3_fmus)[fault.model]
    probes = (fault.probe,) if fault.name in CHEAP else ()
    check = rockshed.check_fmu(seeded(fault, fmu, tmp_path), probes=probes, time_limit=5.0)
    finding = check[fault.probe]
    others = ", ".join(f.name for f in check if f.verdict in FOUND and f.name != fault.probe)
    print(f"| {fault.name} | {finding.name} | {finding.verdict} | {finding.what} | {others} |")
    assert finding.verdict in FOUND, str(check)
