"""Rolled sections by name: JIS H, European IPE and HE; all in SI units."""

import csv
import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from rockshed.components.common.units import cm2, cm3, cm4, mm

from ...core.errors import Problem
from ...core.system.names import nearest

_DATA = Path(__file__).parent / "data"
_TABLES = {
    "jis_h_sections.csv": "JIS G 3192",
    "european_sections.csv": "EN 10365",
}
"""Files of sections and their sources."""


@dataclass(frozen=True)
class RolledSection:
    """A rolled section, bent about its strong axis.

    Attributes
    ----------
    name, source : str
        Name in the table, and the standard.
    height, width, web, flange, fillet : float
        Dimensions: height, flange width, web and flange thickness, radius of the fillets (m).
    area, second_moment, section_modulus, plastic_modulus : float
        Of the section (m2, m4, m3, m3).
    mass : float
        By length (kg/m).
    """

    name: str
    source: str
    height: float
    width: float
    web: float
    flange: float
    fillet: float
    area: float
    second_moment: float
    section_modulus: float
    plastic_modulus: float
    mass: float


@cache
def sections() -> Mapping[str, RolledSection]:
    """Return all sections by name."""
    found: dict[str, RolledSection] = {}
    for file, source in _TABLES.items():
        lines = (_DATA / file).read_text(encoding="utf-8").splitlines()
        rows = csv.DictReader(line for line in lines if not line.startswith("#"))
        found |= {row["section"]: _section(row, source) for row in rows}
    return found


def _section(row: Mapping[str, str], source: str) -> RolledSection:
    height, width, web, flange, fillet = (
        float(row[f"{key}_mm"]) * mm for key in ("h", "b", "tw", "tf", "r")
    )
    printed = row["plastic_modulus_cm3"]
    plastic = plastic_modulus(height, width, web, flange, fillet)
    return RolledSection(
        row["section"],
        source,
        height,
        width,
        web,
        flange,
        fillet,
        area=float(row["area_cm2"]) * cm2,
        second_moment=float(row["second_moment_cm4"]) * cm4,
        section_modulus=float(row["section_modulus_cm3"]) * cm3,
        plastic_modulus=float(printed) * cm3 if printed else plastic,
        mass=float(row["mass_kg_per_m"]),
    )


_CORNER = 0.2146018366025517
"""Area of the corner between a circle and its tangents, 1 - pi/4, in r2."""
_CENTRE = 0.2233917650848937
"""Distance of its centre of gravity from either tangent, in r."""


def plastic_modulus(height: float, width: float, web: float, flange: float, fillet: float) -> float:
    """Return the plastic section modulus of an I-section with fillets.

    Parameters
    ----------
    height, width, web, flange, fillet : float
        Dimensions (m), as in :class:`RolledSection`.

    Returns
    -------
    float
        Twice the first moment of the upper half (m3).
    """
    clear = height - 2.0 * flange
    corner = 4.0 * _CORNER * fillet**2 * (0.5 * clear - _CENTRE * fillet)
    return width * flange * (height - flange) + 0.25 * web * clear**2 + corner


def section(name: str, where: str, problems: list[Problem]) -> RolledSection | None:
    """Return a section by its name, however it is written.

    Parameters
    ----------
    name : str
        ``H-400x400x13x21``, ``HE 300 B``, ``HEB300``, ``IPE 300``.
    where : str
        Place of the name, for messages.
    problems : list of Problem
        An unknown name is appended, with the nearest ones.

    Returns
    -------
    RolledSection or None
        None if there is none of this name.
    """
    by_key = {_key(known): entry for known, entry in sections().items()}
    found = by_key.get(_key(name))
    if found is None:
        begins = [known for known in sections() if _key(known).startswith(_key(name))]
        remedy = _nearest_size(name) or nearest(name, sections())
        if begins and _key(name):
            remedy = f"there is {', '.join(begins[:5])}"
        text = f"there is no section {name!r} in the tables"
        problems.append(Problem(where, text, f"{remedy}; or give area, second_moment and height"))
    return found


_NUMBER = re.compile(r"\d{1,6}")


def _nearest_size(name: str) -> str:
    """Offer the sections of a series whose sizes come nearest; nothing of an unknown series."""
    series, sizes = _NUMBER.sub("#", _key(name)), list(map(int, _NUMBER.findall(_key(name))))
    alike = [known for known in sections() if _NUMBER.sub("#", _key(known)) == series]
    far = {
        known: sum(abs(int(n) - size) for n, size in zip(_NUMBER.findall(_key(known)), sizes))
        for known in alike
    }
    close = sorted(alike, key=far.__getitem__)[:3]
    return f"did you mean {' or '.join(close)}?" if close else ""


def _key(name: str) -> str:
    """Return a name without what is written in one way or another."""
    plain = re.sub(r"[\s_-]", "", name.upper().replace("×", "X"))
    european = re.fullmatch(r"HE([ABM])(\d+)", plain)
    return f"HE{european.group(2)}{european.group(1)}" if european else plain
