"""XML of system structures: read with care, checked by the schemas of the standard, and kept."""

from functools import cache
from pathlib import Path

from lxml import etree

from ..core.errors import InputRefused, Problem
from ..core.input_text import DEEPEST

SSD = "http://ssp-standard.org/SSP1/SystemStructureDescription"
SSC = "http://ssp-standard.org/SSP1/SystemStructureCommon"
SSV = "http://ssp-standard.org/SSP1/SystemStructureParameterValues"
SSM = "http://ssp-standard.org/SSP1/SystemStructureParameterMapping"
VERSIONS = ("1.0", "2.0")
"""Versions of the standard that are read and written."""
MOST_BYTES = 64 << 20
"""Largest size (bytes) of a document."""
_MOST_FAULTS = 20
"""Faults of a document that are told; of more, how many there are."""
_SCHEMAS = Path(__file__).parent / "schemas"


def read_document(content: bytes, where: str, root: str) -> etree._Element:
    """Read a document of a system structure.

    Neither entities nor anything outside the document are looked at.

    Parameters
    ----------
    content : bytes
        Of the file.
    where : str
        Its name, for messages.
    root : str
        Tag of its outermost element, ``{namespace}name``.

    Returns
    -------
    etree._Element
        The outermost element; the document keeps what this program knows nothing of.

    Raises
    ------
    InputRefused
        It is no XML, too large or too deep, declares a document type, has another outermost
        element, is of another version, or departs from the schemas; with every departure.
    """
    if len(content) > MOST_BYTES:
        what = f"has {len(content) / 1e6:.3g} MB; at most {MOST_BYTES / 1e6:.3g} are read"
        raise InputRefused([Problem(where, what, "leave out what is not needed")])
    if b"<!DOCTYPE" in content:
        remedy = "take it out: no document of SSP has one"
        raise InputRefused([Problem(where, "declares a document type (DOCTYPE)", remedy)])
    found = parsed(content, where)
    expected = etree.QName(root)
    if found.tag != root:
        what = f"begins with <{etree.QName(found).localname}>, and not with <{expected.localname}>"
        more = f" of {expected.namespace}"
        raise InputRefused([Problem(where, what + more, "name a document of SSP 1.0 or 2.0")])
    _check(found, where)
    return found


def parsed(content: bytes, where: str = "") -> etree._Element:
    """Parse XML in UTF-8 without entities and without a network.

    Raises
    ------
    InputRefused
        It is no XML, or nested more than :data:`rockshed.core.input_text.DEEPEST` deep.
    """
    parser = etree.XMLParser(
        encoding="utf-8", resolve_entities=False, no_network=True, load_dtd=False, huge_tree=False
    )
    try:
        found = etree.fromstring(content, parser)
    except (etree.XMLSyntaxError, ValueError) as error:
        what = f"is no XML in UTF-8: {error}"
        raise InputRefused([Problem(where, what, "correct or export it again")]) from error
    level = [found]
    for _ in range(DEEPEST + 1):
        level = [child for element in level for child in element]
    if level:
        what = f"is nested more than {DEEPEST} deep"
        raise InputRefused([Problem(where, what, "put systems side by side")])
    return found


def _check(root: etree._Element, where: str) -> None:
    """Refuse another version than the known ones, and departures from its schemas."""
    version = root.get("version", "")
    if version not in VERSIONS:
        what = f"is of version {version or '(none)'} of SSP; {' and '.join(VERSIONS)} are read"
        raise InputRefused([Problem(where, what, "export it in one of these")])
    if problems := schema_problems(root, where, version):
        raise InputRefused(problems)


def schema_problems(root: etree._Element, where: str, version: str) -> list[Problem]:
    """Return the departures of a document from the schemas of a version.

    Parameters
    ----------
    root : etree._Element
        Outermost element.
    where : str
        Name of the file, for messages.
    version : str
        ``1.0`` or ``2.0``.
    """
    schema = _schema(version)
    if schema.validate(root):
        return []
    faults = [
        Problem(f"{where}, line {entry.line}", _plain(entry.message), "correct the element")
        for entry in schema.error_log
    ]
    if len(faults) > _MOST_FAULTS:
        more = f"and {len(faults) - _MOST_FAULTS} more departures from the schema of {version}"
        faults[_MOST_FAULTS:] = [Problem(where, more)]
    return faults


def _plain(message: str) -> str:
    """Return a message of the schema with names as they stand in the file."""
    for prefix, namespace in (("ssd", SSD), ("ssc", SSC), ("ssv", SSV), ("ssm", SSM)):
        message = message.replace(f"{{{namespace}}}", f"{prefix}:")
    return message.rstrip(".")


@cache
def _schema(version: str) -> etree.XMLSchema:
    parser = etree.XMLParser(no_network=True)
    return etree.XMLSchema(etree.parse(_SCHEMAS / f"systems_{version}.xsd", parser))


def as_bytes(root: etree._Element) -> bytes:
    """Return a document as the content of a file."""
    tree = root.getroottree()
    written: bytes = etree.tostring(tree, xml_declaration=True, encoding="UTF-8")
    return written + b"\n"


def same_xml(one: bytes, other: bytes) -> bool:
    """Tell whether two documents say the same (canonical XML)."""
    return bool(etree.canonicalize(one.decode()) == etree.canonicalize(other.decode()))
