"""The laboratory of Sonoda et al. (1993), sec. 2 and 4 (2): data of the tests and the system that computes one of them."""

import csv
import math
from bisect import bisect
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Literal

from components.units import cm, kgf

from ..core.schedule import Scheme
from ..core.system import ComponentSpec, Connection, EnergyAlarm, PowerBond, SharedValue, System
from ..headlines import BEAM_ENERGY_FROM_STRAIN, PEAK_TRANSMITTED, PENETRATION, Known, Reference

_DATA = Path(__file__).parent / "data"

STATIC_RATIO = 1.29
"""k (kgf/cm) / E_bar (kgf/cm2) of table 4; gives E_bar for the tests that table 4 leaves out."""

Coupling = Literal["paper", "impulse", "jacobi"]
"""paper: sand first, inputs held, exchange 1e-5 s. impulse: sand first, kinematics extrapolated, mean forces, 1e-4 s.
jacobi: all at once, inputs held, 1e-4 s."""

_COUPLINGS: Mapping[str, tuple[Scheme, float, str, str]] = {
    "paper": ("sequential", 1e-5, "held", "last"),
    "impulse": ("sequential", 1e-4, "linear", "mean"),
    "jacobi": ("jacobi", 1e-4, "held", "last"),
}


@dataclass(frozen=True)
class Test:
    """A row of table 2, with E_bar from table 4 where it is given there."""

    number: int
    sand: str
    box: int
    water_content: float
    """percent of mass"""
    compaction: float
    """Pa"""
    static_stiffness: float
    """secant spring constant k at 4 cm (N/m)"""
    peak_force: float
    """measured peak of the transmitted force (N)"""
    modulus: float
    """fictitious modulus E_bar (Pa)"""
    modulus_in_table_4: bool


def printed_rows(table: str) -> list[dict[str, str]]:
    """Rows of a table of the paper, as printed."""
    lines = (_DATA / f"sonoda1993_{table}.csv").read_text(encoding="utf-8").splitlines()
    return list(csv.DictReader(line for line in lines if not line.startswith("#")))


@cache
def tests() -> dict[int, Test]:
    """The sixteen tests of table 2 by number."""
    printed = {int(row["no"]): float(row["e_bar_kgf_per_cm2"]) for row in printed_rows("table4")}
    found = {}
    for row in printed_rows("table2"):
        number, stiffness = int(row["no"]), float(row["k_kgf_per_cm"])
        found[number] = Test(
            number, row["sand"], int(row["box"]), float(row["water_content_percent"]),
            float(row["compaction_pressure_kgf_per_cm2"]) * kgf / cm**2, stiffness * kgf / cm,
            float(row["peak_transmitted_force_kgf"]) * kgf,
            printed.get(number, stiffness / STATIC_RATIO) * kgf / cm**2, number in printed)
    return found


@dataclass(frozen=True)
class TableFiveRow:
    """A row of table 5: what the paper computed."""

    modulus: float
    """Pa"""
    damping: float
    penetration: float
    """m"""
    peak_force: float
    """N"""


@cache
def table_5() -> list[TableFiveRow]:
    """Influence of the damping constant h, computed in the paper."""
    return [TableFiveRow(float(r["e_bar_kgf_per_cm2"]) * kgf / cm**2, float(r["h"]), float(r["penetration_cm"]) * cm,
                         float(r["peak_transmitted_force_kgf"]) * kgf) for r in printed_rows("table5")]


BALL_MASS = 4.0
BALL_RADIUS = 4.95 * cm
BALL_SPEED = 8.0
SPAN = 120 * cm
ELEMENTS = 24
LAYER = 10 * cm
DISC_RADIUS = 0.5 * cm
BOX_WIDTH = {1: 37 * cm, 2: 45 * cm}
"""Widths of the two sand boxes (fig. 2)."""
_GAP = 0.5e-3
"""Distance (m) between ball and sand at the start."""

DEFAULT_TEST = 4
"""The test that fig. 17 shows, and ``lab-impact`` computes."""
BEAM_ENERGY = {4: 13 * kgf * cm, 10: 40 * kgf * cm}
"""Peak energy of the beam measured by its strain (J), read from figs 17 and 18; the tests that these do not show are missing."""


def case_name(test: int) -> str:
    """Name of the case of a test of table 2."""
    return "lab-impact" if test == DEFAULT_TEST else f"lab-impact-{test}"


def discs_across(box: int) -> int:
    """Number of sand discs of 1 cm side by side."""
    return round(BOX_WIDTH[box] / (2 * DISC_RADIUS))


def discs_in(box: int) -> int:
    """Number of sand discs of 1 cm in a layer of 10 cm (370 in box 1, as in the paper)."""
    return discs_across(box) * round(LAYER / (2 * DISC_RADIUS))


def lab_system(fmus: Mapping[str, str], test: Test, coupling: Coupling = "paper", discs: int | None = None,
               elements: int = ELEMENTS) -> System:
    """The laboratory impact of fig. 14 as a co-simulation of three FMUs.

    fmus: files of the FMUs ``rock``, ``sand`` and ``beam``.
    discs, elements: sizes that ``sand`` and ``beam`` were built with, by default :func:`discs_in` and 24; the rock starts above
        the layer that so many discs make, and the beam's discs share the span.
    """
    master, exchange, kinematics, forces = _COUPLINGS[coupling]
    width, spacing = BOX_WIDTH[test.box], SPAN / elements
    rows = math.ceil((discs or discs_in(test.box)) / discs_across(test.box))
    return System(
        name=case_name(test.number),
        description=f"Sonoda et al. 1993, test {test.number}: 4 kgf ball at 8 m/s on 10 cm of sand on an H-100x50x7 beam of 120 cm",
        components={
            "sand": ComponentSpec(fmu=fmus["sand"], record_states=True, parameters={
                "modulus": test.modulus, "box.left": 0.5 * (SPAN - width), "box.width": width,
                "kinematics": kinematics, "forces": forces}),
            "rock": ComponentSpec(fmu=fmus["rock"], parameters={
                "position0.x": 0.5 * SPAN, "position0.y": rows * 2 * DISC_RADIUS + BALL_RADIUS + _GAP,
                "velocity0.y": -BALL_SPEED}),
            "beam": ComponentSpec(fmu=fmus["beam"], parameters={"span": SPAN, "axis.y": -0.5 * spacing}),
        },
        shared={
            "rock_radius": SharedValue(value=BALL_RADIUS, targets=["rock.radius", "sand.rock.radius"]),
            "rock_mass": SharedValue(value=BALL_MASS, targets=["rock.mass", "sand.rock.mass"]),
            "beam_radius": SharedValue(value=0.5 * spacing, targets=["sand.beam.radius"]),
        },
        connections=impact_connections(("rock", "beam")),
        bonds=impact_bonds(("rock", "beam")),
        energy_alarm=EnergyAlarm(share=0.005, reference="rock.energy.kinetic"),
        master=master,
        order=["sand", "rock", "beam"],
        stop_time=0.04,
        exchange_step=exchange,
        output_interval=1e-4,
        state_interval=5e-4,
        watch=["sand.transmitted_force", "sand.rock.force.y", "sand.penetration", "beam.midspan.deflection", "beam.energy.elastic",
               "beam.energy.strain_estimate"],
    )


_MOTION = ("position.x", "position.y", "angle", "velocity.x", "velocity.y", "angular_velocity")
_FORCES = ("force.x", "force.y", "torque")


def impact_connections(partners: Iterable[str]) -> list[Connection]:
    """Kinematics of ``partners``, of rock and beam, to the sand; contact forces back."""
    ends = [(name, "[*]" if name == "beam" else "") for name in partners]
    return ([Connection(source=f"{name}.{q}{all_}", target=f"sand.{name}.{q}{all_}") for name, all_ in ends for q in _MOTION]
            + [Connection(source=f"sand.{name}.{q}{all_}", target=f"{name}.{q}{all_}") for name, all_ in ends for q in _FORCES])


def impact_bonds(partners: Iterable[str]) -> dict[str, PowerBond]:
    """The interfaces of the cushion with ``partners``, of rock and beam."""
    return {f"sand_{name}": PowerBond(
        giver="sand", force=[f"{name}.{q}{all_}" for q in _FORCES], taker=name, position=[f"{q}{all_}" for q in _MOTION[:3]],
        work=f"energy.work.{name}") for name, all_ in ((name, "[*]" if name == "beam" else "") for name in partners)}


def known_of(test: Test) -> dict[str, Known]:
    """What the paper gives to compare with the computation of a test, by the name of the figure."""
    measured = BEAM_ENERGY.get(test.number)
    return {
        PEAK_TRANSMITTED: Known(_trend(test.modulus, lambda row: row.peak_force), Reference(test.peak_force)),
        PENETRATION: Known(_trend(test.modulus, lambda row: row.penetration)),
        BEAM_ENERGY_FROM_STRAIN: Known(experiment=Reference(measured, "read from fig. 17 or 18") if measured else None),
    }


def _trend(modulus: float, value: Callable[[TableFiveRow], float], damping: float = 0.2) -> Reference:
    """The paper's own result for another modulus: a power law through the two nearest rows of table 5."""
    rows = sorted((row for row in table_5() if row.damping == damping), key=lambda row: row.modulus)
    above = min(max(1, bisect([row.modulus for row in rows], modulus)), len(rows) - 1)
    low, high = rows[above - 1], rows[above]
    exponent = math.log(value(high) / value(low)) / math.log(high.modulus / low.modulus)
    inside = rows[0].modulus <= modulus <= rows[-1].modulus
    return Reference(value(low) * (modulus / low.modulus) ** exponent,
                     f"the paper's table 5, h = {damping:g}, {'interpolated' if inside else 'extrapolated'} to "
                     f"E_bar = {modulus / kgf * cm ** 2:.1f} kgf/cm2")
