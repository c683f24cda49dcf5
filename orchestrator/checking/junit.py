"""The result of a check as JUnit's XML, which servers of continuous integration show."""

import re
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from .verdicts import BAD, Check, Finding, Verdict

_NOT_IN_XML = re.compile(r"[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""Characters that no XML can hold."""


def junit(check: Check) -> str:
    """Return the XML of a check: a suite with a case for each probe.

    Parameters
    ----------
    check : Check
        The result.

    Returns
    -------
    str
        Failures and crashes are ``failure`` and ``error``, what is not applicable ``skipped``, and
        what was seen otherwise stands in ``system-out``.
    """
    seconds = sum(finding.seconds for finding in check)
    suite = Element("testsuite", name=_clean(check.fmu.name), tests=str(len(check.findings)))
    suite.set("failures", str(sum(f.verdict is Verdict.FAILED for f in check)))
    suite.set("errors", str(sum(f.verdict in BAD[1:] for f in check)))
    suite.set("skipped", str(sum(f.verdict is Verdict.NOT_APPLICABLE for f in check)))
    suite.set("time", f"{seconds:.3f}")
    for finding in check:
        _add(suite, finding)
    indent(suite)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + tostring(suite, encoding="unicode") + "\n"


_TAGS = {
    Verdict.FAILED: "failure",
    Verdict.CRASHED: "error",
    Verdict.TIMED_OUT: "error",
    Verdict.NOT_APPLICABLE: "skipped",
}


def _add(suite: Element, finding: Finding) -> None:
    case = SubElement(suite, "testcase", classname=finding.theme, name=finding.probe)
    case.set("time", f"{finding.seconds:.3f}")
    told = _clean("; ".join(filter(None, (finding.what, finding.remedy))))
    if finding.verdict in _TAGS:
        SubElement(case, _TAGS[finding.verdict], message=told)
    else:
        SubElement(case, "system-out").text = f"{finding.verdict}: {told}"


def _clean(text: str) -> str:
    return _NOT_IN_XML.sub("?", text)
