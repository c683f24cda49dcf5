"""The virtual mass of the sand in (1): derived and printed, and the difference in the 96 tests."""

import math
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
from scipy.integrate import quad

from rockshed.components.common.units import cm
from rockshed.components.impulsive_ground.settlement import (
    PRINTED,
    initial_velocity,
)

from ..study import Outcomes, Row, Study, verdict
from .plate_tests import (
    AREAS,
    BOX,
    DENSITY,
    DEPTH,
    MIDDLE,
    SPREAD,
    mass,
    plate_tests,
    radius,
    sand_mass,
)


def momentum(r: float) -> float:
    """Return the momentum (kg m/s) of the frustum of sand under a plate that moves with 1 m/s.

    Parameters
    ----------
    r : float
        Radius of the plate (m).

    Returns
    -------
    float
        By quadrature; the velocity falls linearly from the plate to 0 at the depth of the frustum.
    """

    def density(z: float) -> float:
        return DENSITY * math.pi * (r + z * math.tan(SPREAD)) ** 2 * (1.0 - z / DEPTH)

    return float(quad(density, 0.0, DEPTH, epsabs=0.0, epsrel=1e-13)[0])


def square_coefficient() -> float:
    """Return the number before r2 in the bracket of (1).

    It is the second difference of the momentum over the radius.
    """
    r = 0.1
    second = (momentum(2.0 * r) - 2.0 * momentum(r) + momentum(0.0)) / r**2
    return 12.0 / math.pi / DENSITY / DEPTH * second


def rows(outcomes: Outcomes) -> list[Row]:
    """Return the printed mass beside the derived one."""
    return [
        _number_before_square(),
        *(_virtual_mass(area) for area in AREAS),
        *_excesses(),
        _foot(),
    ]


def _number_before_square() -> Row:
    number = square_coefficient()
    return Row(
        "number before r² in (1)",
        "1",
        paper=3.0,
        computed=number,
        verdict=verdict(abs(number - 3.0) < 1e-6),
        note="momentum of the frustum by quadrature; printed four times",
    )


def _virtual_mass(area: float) -> Row:
    return Row(
        f"mass of (1), plate of {area:g} cm²",
        "kg",
        paper=mass(area, MIDDLE[0], PRINTED),
        computed=mass(area, MIDDLE[0]),
        note=f"paper: with 3 r²; sand by quadrature {momentum(radius(area)):.3f} kg, plate, and "
        f"the body of {MIDDLE[0]:g} kg that stays on it",
    )


def _excess(area: float) -> list[float]:
    """Return by how much the printed mass makes the velocity too large, in each test of a plate."""
    return [
        initial_velocity(t.impulse, mass(area, t.weight, PRINTED))
        / initial_velocity(t.impulse, mass(area, t.weight))
        - 1.0
        for t in plate_tests()
        if t.area == area
    ]


def _excesses() -> Iterator[Row]:
    """Yield by how much the velocity is too large, for each plate and over all tests."""
    every = [value for area in AREAS for value in _excess(area)]
    for end, value in (("least", min(every)), ("largest", max(every))):
        yield Row(
            f"printed mass: v0 and settlement (7) too large, 96 tests, {end}",
            "%",
            computed=100.0 * value,
        )
    for area in AREAS:
        values = _excess(area)
        yield Row(
            f"v0 and settlement (7) too large, plate of {area:g} cm²",
            "%",
            computed=100.0 * max(values),
            note=f"lightest body; {100.0 * min(values):.1f} % with the heaviest",
        )


def _foot() -> Row:
    """Return the width of the frustum's foot beside that of the box."""
    foot = [2.0 * (radius(area) + DEPTH * math.tan(SPREAD)) / cm for area in AREAS]
    return Row(
        "width of the frustum's foot, smallest plate",
        "cm",
        paper=BOX[0] / cm,
        computed=foot[0],
        verdict=verdict(foot[0] <= BOX[0] / cm),
        note="paper: width of the box it must fit into; the walls must have "
        f"carried some of it; {foot[-1]:.0f} cm under the largest plate",
    )


def draw(outcomes: Outcomes, listed: Sequence[Row], folder: Path) -> list[Path]:
    """Draw both masses over the plate's area."""
    from ...pictures.style import GREY, INK, ROCK, WIDTH, captioned, legend

    file = folder / "mass.png"
    areas = np.linspace(20.0, 450.0, 200)
    words = (
        f"Mass that moves, the bracket of (1): sand, plate and the body of {MIDDLE[0]:g} kg that "
        f"fell on it. Depth 45 cm, 45°, {DENSITY:g} kg/m³ and plates of 2 cm of steel assumed. "
        "Circles: quadrature of the frustum's momentum, "
        "for the paper's plates."
    )
    with captioned([words], file, WIDTH, 3.4) as made:
        axes = made.subplots()
        derived = [mass(area, MIDDLE[0]) for area in areas]
        printed = [mass(area, MIDDLE[0], PRINTED) for area in areas]
        axes.plot(areas, derived, color=INK, label="derived, 12 r²")
        axes.plot(areas, printed, "--", color=ROCK, label="printed, 3 r²")
        axes.plot(AREAS, [_by_quadrature(a) for a in AREAS], "o", color=GREY, fillstyle="none")
        axes.set(xlabel="area of the plate (cm²)", ylabel="mass (kg)")
        axes.set_ylim(bottom=0.0)
        legend(axes)
    return [file]


def _by_quadrature(area: float) -> float:
    """Return the mass (kg) that moves, the sand's by quadrature."""
    return momentum(radius(area)) + mass(area, MIDDLE[0]) - sand_mass(area)


STUDY = Study(
    "mass",
    "Mass that moves, (1)",
    1.0,
    rows,
    draw=draw,
    notes=(
        "Density of the sand and mass of the plates are not printed: 1600 kg/m³ and 2 cm of steel "
        "are assumed.",
    ),
)
