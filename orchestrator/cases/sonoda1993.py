"""The laboratory of Sonoda et al. (1993), sec. 2 and 4 (2).

Data of the tests, and the system that computes one of them.
"""

import csv
import math
from bisect import bisect
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from rockshed.components.common.units import cm, kgf, mm, standard_gravity

from ..core.system.fields import Value
from ..core.system.parts import ComponentSpec, Connection, EnergyAlarm, PowerBond, SharedValue
from ..core.system.schedule import Scheme
from ..core.system.system import SystemSpec
from ..references import Known, Reference, References
from .sand_models import DENSE, LOOSE, SandLayer, Soil

_DATA = Path(__file__).parent / "data"

_PEAK = "peak transmitted force"
_PEAK_LOAD_CELL = "peak transmitted force through the load cell"
_PENETRATION = "penetration"
_BEAM_ENERGY = "peak beam energy from the midspan strain"
"""Names of the metrics that the paper has values for."""

STATIC_RATIO = 1.29
"""k (kgf/cm) / E_bar (kgf/cm2) of table 4; gives E_bar for the tests that table 4 leaves out."""

_COUPLINGS: Mapping[str, tuple[Scheme, float, str, str]] = {
    "paper": ("sequential", 1e-5, "held", "last"),
    "impulse": ("sequential", 1e-4, "linear", "mean"),
    "jacobi": ("jacobi", 1e-4, "held", "last"),
}
"""Master, exchange step (s), kinematics and forces of the sand by scheme of exchange.

paper: sand first, inputs held, exchange 1e-5 s. impulse: sand first, kinematics extrapolated, mean
forces, 1e-4 s. jacobi: all at once, inputs held, 1e-4 s.
"""


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

    @property
    def state(self) -> str:
        """The sand as it lay in the box."""
        how = (
            f"compacted at {self.compaction / (kgf / cm**2):g} kgf/cm²"
            if self.compaction
            else "as poured"
        )
        return f"sand {self.sand}, {how}, water content {self.water_content:g} %, box {self.box}"


def printed_rows(table: str) -> list[dict[str, str]]:
    """Return the rows of a table of the paper, or of the soil.

    Parameters
    ----------
    table : str
        ``table1``, ``table2``, ``table4``, ``table5``, ``table6`` or ``soil``.

    Returns
    -------
    list of dict of str to str
        Cells as printed, by the title of the column.
    """
    lines = (_DATA / f"sonoda1993_{table}.csv").read_text(encoding="utf-8").splitlines()
    return list(csv.DictReader(line for line in lines if not line.startswith("#")))


@cache
def tests() -> dict[int, Test]:
    """Return the sixteen tests of table 2 by number."""
    printed = {int(row["no"]): float(row["e_bar_kgf_per_cm2"]) for row in printed_rows("table4")}
    found = {}
    for row in printed_rows("table2"):
        number, stiffness = int(row["no"]), float(row["k_kgf_per_cm"])
        found[number] = Test(
            number,
            row["sand"],
            int(row["box"]),
            float(row["water_content_percent"]),
            float(row["compaction_pressure_kgf_per_cm2"]) * kgf / cm**2,
            stiffness * kgf / cm,
            float(row["peak_transmitted_force_kgf"]) * kgf,
            printed.get(number, stiffness / STATIC_RATIO) * kgf / cm**2,
            number in printed,
        )
    return found


@dataclass(frozen=True)
class Sand:
    """A row of table 1. Diameters (m) that 10, 30 and 60 percent of the mass are finer than."""

    name: str
    specific_gravity: float
    uniformity: float
    curvature: float
    d10: float
    d30: float
    d60: float


@cache
def sands() -> dict[str, Sand]:
    """Return the two sands of table 1 by their letter."""
    return {
        row["sand"]: Sand(
            row["name"],
            float(row["specific_gravity"]),
            float(row["uniformity_coefficient"]),
            float(row["curvature_coefficient"]),
            *(float(row[f"{d}_mm"]) * mm for d in ("d10", "d30", "d60")),
        )
        for row in printed_rows("table1")
    }


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
    """Return the rows of table 5: the influence of the damping constant h, as computed."""
    return [
        TableFiveRow(
            float(r["e_bar_kgf_per_cm2"]) * kgf / cm**2,
            float(r["h"]),
            float(r["penetration_cm"]) * cm,
            float(r["peak_transmitted_force_kgf"]) * kgf,
        )
        for r in printed_rows("table5")
    ]


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

_DAMPING = 0.2
"""Damping constant h of the sand in the paper's analysis of the tests (table 3)."""

LOAD_CELL = 1000.0
"""Up to here (Hz) the load cells under the beam respond, whose natural frequency is 3200 Hz."""

DEFAULT_TEST = 4
"""The test that fig. 17 shows, and ``lab-impact`` computes."""
BEAM_ENERGY = {4: 13 * kgf * cm, 10: 40 * kgf * cm}
"""Peak energy of the beam measured by its strain (J), read from figs 17 and 18, by test.

The tests that these do not show are missing.
"""


def case_name(test: int) -> str:
    """Return the name of the case of a test of table 2.

    Parameters
    ----------
    test : int
        Number of the test.

    Returns
    -------
    str
        Name of the case.
    """
    return "lab-impact" if test == DEFAULT_TEST else f"lab-impact-{test}"


def discs_across(box: int) -> int:
    """Return the number of sand discs of 1 cm side by side.

    Parameters
    ----------
    box : int
        Number of the sand box, 1 or 2.

    Returns
    -------
    int
        Number of discs.
    """
    return round(BOX_WIDTH[box] / (2 * DISC_RADIUS))


def discs_in(box: int) -> int:
    """Return the number of sand discs of 1 cm in a layer of 10 cm: 370 in box 1, as in the paper.

    Parameters
    ----------
    box : int
        Number of the sand box, 1 or 2.

    Returns
    -------
    int
        Number of discs.
    """
    return discs_across(box) * round(LAYER / (2 * DISC_RADIUS))


def lab_system(
    fmus: Mapping[str, str],
    test: Test,
    coupling: str = "paper",
    discs: int | None = None,
    elements: int = ELEMENTS,
) -> SystemSpec:
    """Return the laboratory impact of fig. 14 as a co-simulation of rock, sand and beam.

    Parameters
    ----------
    fmus : mapping of str to str
        Files of the FMUs by component.
    test : Test
        The test.
    coupling : str
        ``paper``, ``impulse`` or ``jacobi``.
    discs, elements : int, optional
        Sizes that sand and beam were built with, by default :func:`discs_in` and 24; the rock
        starts above the layer that so many discs make, and the beam's discs share the span.

    Returns
    -------
    SystemSpec
        The co-simulation.
    """
    master, exchange, kinematics, forces = _COUPLINGS[coupling]
    spacing = SPAN / elements
    return SystemSpec(
        name=case_name(test.number),
        description=f"Sonoda et al. 1993, test {test.number}: 4 kgf ball at 8 m/s on 10 cm of sand "
        f"on an H-100x50x7 beam of 120 cm; {test.state}",
        components={
            "sand": _sand(fmus["sand"], test, kinematics, forces),
            "rock": _ball(fmus["rock"], test, discs or discs_in(test.box)),
            "beam": ComponentSpec(
                fmu=fmus["beam"], parameters={"span": SPAN, "axis.y": -0.5 * spacing}
            ),
        },
        shared=_shared(spacing),
        connections=impact_connections(("rock", "beam")),
        bonds=impact_bonds(("rock", "beam")),
        energy_alarm=EnergyAlarm(reference="rock.energy.kinetic"),
        master=master,
        order=["sand", "rock", "beam"],
        stop_time=0.04,
        exchange_step=exchange,
        output_interval=1e-4,
        state_interval=5e-4,
        watch=list(_WATCHED),
    )


_WATCHED = (
    "sand.transmitted_force",
    "sand.rock.force.y",
    "sand.penetration",
    "sand.clearance",
    "beam.midspan.deflection",
    "beam.energy.elastic",
    "beam.energy.strain_estimate",
)


def _shared(spacing: float) -> dict[str, SharedValue]:
    """Return the values that several components take; spacing: length of an element (m)."""
    return {
        "gravity": SharedValue(value=standard_gravity, targets=["rock.gravity", "sand.gravity"]),
        "rock_radius": SharedValue(value=BALL_RADIUS, targets=["rock.radius", "sand.rock.radius"]),
        "rock_mass": SharedValue(value=BALL_MASS, targets=["rock.mass", "sand.rock.mass"]),
        "beam_radius": SharedValue(value=0.5 * spacing, targets=["sand.beam.radius"]),
    }


def _sand(fmu: str, test: Test, kinematics: str, forces: str) -> ComponentSpec:
    width = BOX_WIDTH[test.box]
    parameters: dict[str, Value] = {
        "modulus": test.modulus,
        "box.left": 0.5 * (SPAN - width),
        "box.width": width,
        "kinematics": kinematics,
        "forces": forces,
    }
    return ComponentSpec(fmu=fmu, record_states=True, parameters=parameters)


def _ball(fmu: str, test: Test, discs: int) -> ComponentSpec:
    """Return the ball above the layer that so many discs make on a square lattice."""
    rows = math.ceil(discs / discs_across(test.box))
    parameters: dict[str, Value] = {
        "position0.x": 0.5 * SPAN,
        "position0.y": rows * 2 * DISC_RADIUS + BALL_RADIUS + _GAP,
        "velocity0.y": -BALL_SPEED,
    }
    return ComponentSpec(fmu=fmu, parameters=parameters)


def layer(test: Test) -> SandLayer:
    """Return the sand of a test, for the models of it.

    Parameters
    ----------
    test : Test
        The test.

    Returns
    -------
    SandLayer
        The layer.
    """
    return SandLayer(
        BOX_WIDTH[test.box],
        LAYER,
        DISC_RADIUS,
        BALL_RADIUS,
        BALL_SPEED,
        soil(test),
        0.04,
        on_beam=True,
    )


def soil(test: Test) -> Soil:
    """Return the state of a test's soil.

    Parameters
    ----------
    test : Test
        The test.

    Returns
    -------
    Soil
        Solid fraction from the compaction, cohesion from the static spring constant.
    """
    return Soil(_cohesions()[test.number], DENSE if test.compaction else LOOSE)


@cache
def _cohesions() -> dict[int, float]:
    """Return the cohesion (Pa) by the number of the test."""
    return {
        int(row["no"]): float(row["cohesion_kgf_per_cm2"]) * kgf / cm**2
        for row in printed_rows("soil")
    }


_MOTION = ("position.x", "position.y", "angle", "velocity.x", "velocity.y", "angular_velocity")
_FORCES = ("force.x", "force.y", "torque")


def impact_connections(partners: Iterable[str]) -> list[Connection]:
    """Return the connections of a sand cushion: kinematics to the sand, contact forces back.

    Parameters
    ----------
    partners : iterable of str
        ``rock`` and ``beam``, or one of them.

    Returns
    -------
    list of Connection
        For all discs of a beam.
    """
    ends = [(name, "[*]" if name == "beam" else "") for name in partners]
    return [
        Connection(source=f"{name}.{q}{all_}", target=f"sand.{name}.{q}{all_}")
        for name, all_ in ends
        for q in _MOTION
    ] + [
        Connection(source=f"sand.{name}.{q}{all_}", target=f"{name}.{q}{all_}")
        for name, all_ in ends
        for q in _FORCES
    ]


def impact_bonds(partners: Iterable[str]) -> dict[str, PowerBond]:
    """Return the interfaces of a sand cushion.

    Parameters
    ----------
    partners : iterable of str
        ``rock`` and ``beam``, or one of them.

    Returns
    -------
    dict of str to PowerBond
        By name, ``sand_rock`` and ``sand_beam``.
    """
    return {
        f"sand_{name}": PowerBond(
            giver="sand",
            force=[f"{name}.{q}{all_}" for q in _FORCES],
            taker=name,
            position=[f"{q}{all_}" for q in _MOTION[:3]],
            work=f"energy.work.{name}",
        )
        for name, all_ in ((name, "[*]" if name == "beam" else "") for name in partners)
    }


def known_of(test: Test) -> dict[str, Known]:
    """Return what the paper gives to compare with the computation of a test.

    Parameters
    ----------
    test : Test
        The test.

    Returns
    -------
    dict of str to Known
        By the name of the metric.
    """
    measured, computed = BEAM_ENERGY.get(test.number), _analysis(test.modulus, _DAMPING)
    return {
        _PEAK: Known(computed[_PEAK].paper, Reference(test.peak_force)),
        _PEAK_LOAD_CELL: Known(experiment=Reference(test.peak_force)),
        _PENETRATION: computed[_PENETRATION],
        _BEAM_ENERGY: Known(
            experiment=Reference(measured, "read from fig. 17 or 18") if measured else None
        ),
    }


SAND = ("sand.modulus", "sand.damping")
"""Parameters that the paper varies in table 5 for the system of the tests."""
_TESTED = ("box.", "rock.", "beam.", "base.y", "thickness", "disc.radius", "density", "gravity")
"""Beginnings of the sand's parameters that describe the test.

Those of :data:`_SUPPORT` are whole names. The others are choices of the model.
"""
_SUPPORT = ("base", "walls")
_READINGS = ("beam.disc_mass", "density_of")
"""Parameters that read the paper in another way, whatever they begin with."""


def references(test: Test, changed: Mapping[str, Value]) -> References:
    """Return what is known of a test that is computed with other values or sizes.

    Steps and choices of the sand's model leave it that test. Another sand is no longer the
    experiment's, but in table 5 if its damping constant is. With anything else another system is
    computed.

    Parameters
    ----------
    test : Test
        The test.
    changed : mapping of str to Value
        Values and sizes that differ, by ``component.name``.

    Returns
    -------
    references : References
        What is known, and why something is not compared.
    """
    if others := [name for name in changed if of_the_test(name)]:
        return References(remarks=[f"not compared: {differs(others)}"])
    varied = [name for name in SAND if name in changed]
    if not varied:
        return References(known_of(test))
    modulus, damping = (
        float(changed.get(SAND[0], test.modulus)),
        float(changed.get(SAND[1], _DAMPING)),
    )
    remarks = [f"not compared with the experiment: {differs(varied)}"]
    given = sorted({row.damping for row in table_5()})
    if damping not in given:
        return References(
            remarks=[
                *remarks,
                f"not compared with the paper: its table 5 has damping constants h of "
                f"{', '.join(map(str, given))}, not {damping:g}",
            ]
        )
    return References(_analysis(modulus, damping), remarks)


def of_the_test(name: str) -> bool:
    """Tell whether a value belongs to what was tested: not to the steps or the sand's model.

    Parameters
    ----------
    name : str
        ``component.name``.

    Returns
    -------
    bool
        Whether another one makes another test.
    """
    owner, _, port = name.partition(".")
    if port in ("internal_step", *_READINGS) or name in SAND:
        return False
    return owner != "sand" or port in (*_SUPPORT, "discs", "elements") or port.startswith(_TESTED)


def differs(names: Sequence[str]) -> str:
    """Say that values differ from the test.

    Parameters
    ----------
    names : sequence of str
        Their names.

    Returns
    -------
    str
        Part of a sentence.
    """
    return f"{', '.join(names)} {'differs' if len(names) == 1 else 'differ'} from the test"


def _analysis(modulus: float, damping: float) -> dict[str, Known]:
    """Return what the paper computed, or would have, by the name of the metric."""
    return {
        _PEAK: Known(_trend(modulus, damping, lambda row: row.peak_force)),
        _PENETRATION: Known(_trend(modulus, damping, lambda row: row.penetration)),
    }


def _trend(modulus: float, damping: float, value: Callable[[TableFiveRow], float]) -> Reference:
    """Return the paper's own result for a modulus (Pa) and a damping constant.

    For a modulus that is not in table 5, from a power law through the two nearest rows.
    """
    rows = sorted((row for row in table_5() if row.damping == damping), key=lambda row: row.modulus)
    if (
        printed := next(
            (row for row in rows if math.isclose(row.modulus, modulus, rel_tol=1e-3)), None
        )
    ) is not None:
        return Reference(value(printed))
    above = min(max(1, bisect([row.modulus for row in rows], modulus)), len(rows) - 1)
    low, high = rows[above - 1], rows[above]
    exponent = math.log(value(high) / value(low)) / math.log(high.modulus / low.modulus)
    inside = rows[0].modulus <= modulus <= rows[-1].modulus
    return Reference(
        value(low) * (modulus / low.modulus) ** exponent,
        f"the paper's table 5, h = {damping:g}, {'interpolated' if inside else 'extrapolated'} to "
        f"E_bar = {modulus / kgf * cm**2:.1f} kgf/cm2",
    )
