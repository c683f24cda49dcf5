"""Figure 7: coefficient of restitution over the normal speed, and what the paper reads from it. Equations (26)-(28) as the
component computes them; the parameters of the printed curves are not legible, so the curves stand for typical ground.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from rockshed.components.common.units import kN
from rockshed.components.slope_rockfall.declarations import CONSISTENT, NONE, PRINTED
from rockshed.components.slope_rockfall.restitution import restitution

from ..study import Outcomes, Row, Study, verdict

GRAVITY, DENSITY, AREA_FACTOR = 9.80665, 2600.0, 0.25
TREATMENTS = {"printed": PRINTED, "none": NONE, "consistent": CONSISTENT}
"""Gravity during the penetration, by name; see the README of the component."""
SPEEDS = np.linspace(0.02, 20.0, 1000)
FAST = 10.0
"""Normal speed (m/s) at which curves are compared."""
SLOW = 1e-3
"""Normal speed (m/s) that stands for v1 = 0."""
HARDLY = 0.10
"""Part by which curves may differ and still differ hardly."""


@dataclass(frozen=True)
class Impact:
    """What e depends on besides the speed: q_d (Pa), k (N/m3), epsilon, r (m), inclination (rad)."""

    strength: float = 3000.0 * kN
    stiffness: float = 30000.0 * kN
    hardening: float = 0.6
    radius: float = 0.5
    angle: float = math.radians(40.0)

    def restitution(self, speed: float, treatment: int) -> float:
        """Coefficient of restitution e at this normal speed (m/s)."""
        mass = DENSITY * 4.0 / 3.0 * math.pi * self.radius**3
        area = AREA_FACTOR * math.pi * self.radius**2
        return float(
            restitution(
                speed,
                mass,
                self.radius,
                GRAVITY * math.cos(self.angle),
                self.strength,
                self.stiffness,
                self.hardening,
                area,
                treatment,
            )[0]
        )


BASE = Impact()
VARIATIONS: dict[str, tuple[str, list[tuple[str, Impact]]]] = {
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
"""What is varied, each from weak to strong decay; the last is not drawn in the paper."""


def rows(found: Outcomes) -> list[Row]:
    """The paper's reading of its figure, for every treatment of gravity."""
    return [row for name, treatment in TREATMENTS.items() for row in _rows(name, treatment)]


def _rows(model: str, treatment: int) -> list[Row]:
    def kept(impact: Impact) -> float:
        return impact.restitution(FAST, treatment) / math.sqrt(impact.hardening)

    def claim(text: str, holds: bool, note: str, computed: float | None = None) -> Row:
        return Row(text, "1", computed=computed, model=model, verdict=verdict(holds), note=note)

    curve = [BASE.restitution(v, treatment) for v in SPEEDS]
    peak = int(np.argmax(curve))
    falls = bool(np.all(np.diff(curve[peak:]) < 0.0)) and curve[-1] < 0.5 * curve[peak]
    made = [
        claim(
            "from its largest value on, e falls with v1, and to less than half",
            falls,
            f"from {curve[peak]:.2f} at {SPEEDS[peak]:.2f} m/s to {curve[-1]:.2f} at {SPEEDS[-1]:g} m/s",
            curve[-1],
        )
    ]
    for key, text in (
        ("strength", "the smaller q_d, the stronger the decay"),
        ("ratio", "the larger k / q_d, the stronger the decay"),
        ("radius", "the larger the rock, the stronger the decay"),
    ):
        values = [kept(impact) for _, impact in VARIATIONS[key][1]]
        made.append(
            claim(
                text,
                values == sorted(values, reverse=True) and len(set(values)) == len(values),
                _kept(key, values),
            )
        )
    start = BASE.restitution(SLOW, treatment)
    made.append(
        claim(
            "ε is about e at v1 ≈ 0",
            abs(start / BASE.hardening - 1.0) < HARDLY,
            f"e = {start:.3f} at {SLOW:g} m/s for ε = {BASE.hardening:g}; √ε = {math.sqrt(BASE.hardening):.3f}, "
            f"largest e = {curve[peak]:.3f}",
            start,
        )
    )
    values = [impact.restitution(FAST, treatment) for _, impact in VARIATIONS["angle"][1]]
    made.append(
        claim(
            "the inclination hardly matters",
            max(values) / min(values) - 1.0 < HARDLY,
            f"e at {FAST:g} m/s: {_listed('angle', values)}",
        )
    )
    return made


def _kept(key: str, values: Sequence[float]) -> str:
    return f"e / √ε at {FAST:g} m/s: {_listed(key, values)}"


def _listed(key: str, values: Sequence[float]) -> str:
    return ", ".join(
        f"{value:.3f} for {label}"
        for (label, _), value in zip(VARIATIONS[key][1], values, strict=True)
    )


def draw(found: Outcomes, listed: Sequence[Row], folder: Path) -> list[Path]:
    """The four panels; solid: consistent gravity, dashed: as printed."""
    from ...pictures.style import INK, ROCK, TRANSMITTED, WIDTH, captioned

    file = folder / "figure7.png"
    words = (
        f"Figure 7 of Ushiro: equations (26)-(28). Where not varied: q_d = 3000 kN/m², k = 30 MN/m³, ε = {BASE.hardening:g}, "
        f"r = {BASE.radius:g} m, {DENSITY:g} kg/m³, θ = {math.degrees(BASE.angle):.0f}°. Solid: gravity counted on the way in "
        "and out; dashed: as printed, on the way out only."
    )
    with captioned([words], file, WIDTH, 5.4) as made:
        for axes, key in zip(
            made.subplots(2, 2, sharex=True, sharey=True).ravel(),
            ("strength", "ratio", "hardening", "radius"),
        ):
            title, variants = VARIATIONS[key]
            for (label, impact), colour in zip(variants, (TRANSMITTED, INK, ROCK), strict=True):
                for treatment, dashes in ((CONSISTENT, "-"), (PRINTED, "--")):
                    axes.plot(
                        SPEEDS,
                        [impact.restitution(v, treatment) for v in SPEEDS],
                        dashes,
                        color=colour,
                        linewidth=1.1,
                        label=label if treatment == CONSISTENT else None,
                    )
            axes.legend(title=title, title_fontsize=8.5)
            axes.label_outer()
        made.supylabel("coefficient of restitution e", fontsize=9.0)
        for axes in made.axes[2:]:
            axes.set(xlabel="normal speed v1 (m/s)", xlim=(0.0, SPEEDS[-1]), ylim=(0.0, 1.0))
    return [file]


STUDY = Study(
    "figure7",
    "Figure 7: restitution against normal velocity",
    7.0,
    rows,
    draw=draw,
    notes=(
        "The parameters of the printed curves are not legible: ground and rock are typical ones, and what the paper says of the curves "
        "is checked.",
        "Models: gravity during the penetration, see components/slope_rockfall/README.md.",
    ),
)
