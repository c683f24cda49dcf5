"""Figure 7: coefficient of restitution over the normal speed, and the paper's reading of it.

Equations (26)-(28) as the component computes them; the parameters of the printed curves are not
legible, so the curves stand for typical ground.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from rockshed.components.common.units import kN, standard_gravity
from rockshed.components.slope_rockfall.declarations import CONSISTENT, NONE, PRINTED
from rockshed.components.slope_rockfall.restitution import restitution

from ..study import Outcomes, Row, Study, verdict

if TYPE_CHECKING:
    from matplotlib.axes import Axes

DENSITY = 2600.0
"""Density of the rock (kg/m3)."""
AREA_FACTOR = 0.25
"""Contact area over the cross-section of the rock."""
TREATMENTS = {"printed": PRINTED, "none": NONE, "consistent": CONSISTENT}
"""Gravity during the penetration, by name; see the README of the component."""
SPEEDS = np.linspace(0.02, 20.0, 1000)
"""Normal speeds (m/s) of the curves."""
FAST = 10.0
"""Normal speed (m/s) at which curves are compared."""
SLOW = 1e-3
"""Normal speed (m/s) that stands for v1 = 0."""
HARDLY = 0.10
"""Part by which curves may differ and still differ hardly."""


@dataclass(frozen=True)
class SlopeImpact:
    """Ground and rock, on which e depends besides the speed.

    Attributes
    ----------
    strength : float
        q_d (Pa).
    stiffness : float
        k (N/m3).
    hardening : float
        Epsilon.
    radius : float
        r (m).
    angle : float
        Inclination (rad).
    """

    strength: float = 3000.0 * kN
    stiffness: float = 30000.0 * kN
    hardening: float = 0.6
    radius: float = 0.5
    angle: float = math.radians(40.0)

    def restitution(self, speed: float, treatment: int) -> float:
        """Return the coefficient of restitution e at a normal speed (m/s)."""
        mass = DENSITY * 4.0 / 3.0 * math.pi * self.radius**3
        area = AREA_FACTOR * math.pi * self.radius**2
        return float(
            restitution(
                speed,
                mass,
                self.radius,
                standard_gravity * math.cos(self.angle),
                self.strength,
                self.stiffness,
                self.hardening,
                area,
                treatment,
            )[0]
        )


BASE = SlopeImpact()
VARIATIONS: dict[str, tuple[str, list[tuple[str, SlopeImpact]]]] = {
    "strength": (
        "q_d, k = 30 MN/m³",
        [(f"{q} kN/m²", replace(BASE, strength=q * kN)) for q in (6000, 3000, 1500)],
    ),
    "ratio": (
        "k / q_d, q_d = 3000 kN/m²",
        [(f"{n} 1/m", replace(BASE, stiffness=n * BASE.strength)) for n in (5, 10, 20)],
    ),
    "hardening": (
        "ε",
        [(f"{value:g}", replace(BASE, hardening=value)) for value in (0.9, 0.6, 0.3)],
    ),
    "radius": ("r", [(f"{value:g} m", replace(BASE, radius=value)) for value in (0.25, 0.5, 1.0)]),
    "angle": (
        "θ",
        [(f"{value}°", replace(BASE, angle=math.radians(value))) for value in (0, 30, 60)],
    ),
}
"""Variations, each from weak to strong decay; the last is not drawn in the paper."""


def rows(outcomes: Outcomes) -> list[Row]:
    """Return the paper's reading of its figure, for every treatment of gravity."""
    return [row for name, treatment in TREATMENTS.items() for row in _rows(name, treatment)]


def _rows(model: str, treatment: int) -> list[Row]:
    """Return the claims for one treatment of gravity."""
    curve = np.array([BASE.restitution(speed, treatment) for speed in SPEEDS])
    made = [_falls(curve), *_decays(treatment), _at_rest(curve, treatment), _inclination(treatment)]
    return [replace(row, model=model) for row in made]


def _falls(curve: np.ndarray) -> Row:
    peak = int(np.argmax(curve))
    falls = bool(np.all(np.diff(curve[peak:]) < 0.0)) and curve[-1] < 0.5 * curve[peak]
    return Row(
        "from its largest value on, e falls with v1, and to less than half",
        "1",
        computed=float(curve[-1]),
        verdict=verdict(falls),
        note=f"from {curve[peak]:.2f} at {SPEEDS[peak]:.2f} m/s to {curve[-1]:.2f} at "
        f"{SPEEDS[-1]:g} m/s",
    )


def _decays(treatment: int) -> Iterator[Row]:
    """Yield whether strength, stiffness and size of the rock make e decay faster."""
    for key, text in (
        ("strength", "the smaller q_d, the stronger the decay"),
        ("ratio", "the larger k / q_d, the stronger the decay"),
        ("radius", "the larger the rock, the stronger the decay"),
    ):
        values = [
            impact.restitution(FAST, treatment) / math.sqrt(impact.hardening)
            for _, impact in VARIATIONS[key][1]
        ]
        holds = values == sorted(values, reverse=True) and len(set(values)) == len(values)
        yield Row(text, "1", verdict=verdict(holds), note=_kept(key, values))


def _at_rest(curve: np.ndarray, treatment: int) -> Row:
    start = BASE.restitution(SLOW, treatment)
    return Row(
        "ε is about e at v1 ≈ 0",
        "1",
        computed=start,
        verdict=verdict(abs(start / BASE.hardening - 1.0) < HARDLY),
        note=f"e = {start:.3f} at {SLOW:g} m/s for ε = {BASE.hardening:g}; √ε = "
        f"{math.sqrt(BASE.hardening):.3f}, largest e = {curve.max():.3f}",
    )


def _inclination(treatment: int) -> Row:
    values = [impact.restitution(FAST, treatment) for _, impact in VARIATIONS["angle"][1]]
    return Row(
        "the inclination hardly matters",
        "1",
        verdict=verdict(max(values) / min(values) - 1.0 < HARDLY),
        note=f"e at {FAST:g} m/s: {_listed('angle', values)}",
    )


def _kept(key: str, values: Sequence[float]) -> str:
    return f"e / √ε at {FAST:g} m/s: {_listed(key, values)}"


def _listed(key: str, values: Sequence[float]) -> str:
    return ", ".join(
        f"{value:.3f} for {label}"
        for (label, _), value in zip(VARIATIONS[key][1], values, strict=True)
    )


def draw(outcomes: Outcomes, listed: Sequence[Row], folder: Path) -> list[Path]:
    """Draw the four panels; solid: consistent gravity, dashed: as printed."""
    from ...pictures.style import WIDTH, captioned

    file = folder / "figure7.png"
    words = (
        "Figure 7 of Ushiro: equations (26)-(28). Where not varied: q_d = 3000 kN/m², k = 30 "
        f"MN/m³, ε = {BASE.hardening:g}, r = {BASE.radius:g} m, {DENSITY:g} kg/m³, θ = "
        f"{math.degrees(BASE.angle):.0f}°. Solid: gravity counted on the way in and out; dashed: "
        "as printed, on the way out only."
    )
    with captioned([words], file, WIDTH, 5.4) as made:
        panels = made.subplots(2, 2, sharex=True, sharey=True).ravel()
        keys = ("strength", "ratio", "hardening", "radius")
        for axes, key in zip(panels, keys, strict=True):
            _draw_variation(axes, key)
        made.supylabel("coefficient of restitution e", fontsize=9.0)
        for axes in panels[2:]:
            axes.set(xlabel="normal speed v1 (m/s)", xlim=(0.0, SPEEDS[-1]), ylim=(0.0, 1.0))
    return [file]


def _draw_variation(axes: "Axes", key: str) -> None:
    """Draw e over the normal speed for one variation."""
    from ...pictures.style import INK, ROCK, TRANSMITTED

    title, variants = VARIATIONS[key]
    for (label, impact), colour in zip(variants, (TRANSMITTED, INK, ROCK), strict=True):
        for treatment, dashes, shown in ((CONSISTENT, "-", label), (PRINTED, "--", None)):
            curve = [impact.restitution(speed, treatment) for speed in SPEEDS]
            axes.plot(SPEEDS, curve, dashes, color=colour, linewidth=1.1, label=shown)
    axes.legend(title=title, title_fontsize=8.5)
    axes.label_outer()


STUDY = Study(
    "figure7",
    "Figure 7: restitution against normal velocity",
    7.0,
    rows,
    draw=draw,
    notes=(
        "The parameters of the printed curves are not legible: ground and rock are typical ones, "
        "and the claims of the paper about the curves are checked.",
        "Models: gravity during the penetration, see components/slope_rockfall/README.md.",
    ),
)
