"""The table of claims of Ushiro, of Uto et al. and of Mogami and Tamura."""

from collections.abc import Callable, Mapping, Sequence

from .forms import number, table
from .kept import kept

AREAS = (100, 200, 300, 400)
"""Areas of Mogami's plates (cm2)."""


def claims() -> str:
    """Return what was printed and what was found."""
    headings = ("paper", "claim", "printed", "found")
    return table(headings, [*_ushiro(), *_uto(), *_mogami()])


def _ushiro() -> list[Sequence[str]]:
    at_rest = {
        model: kept("ushiro").value("figure7", "ε is about e at v1 ≈ 0", model)
        for model in ("none", "printed")
    }
    return [
        (
            "Ushiro",
            "restitution at small normal velocity (fig. 7)",
            '"e is about eps"',
            f"e = sqrt(eps) without gravity ({number(at_rest['none'], 2)} for eps = 0.6); as "
            f"printed e is {number(at_rest['printed'])} below a critical speed",
        ),
        (
            "",
            "equations (21), (22)",
            "",
            "can raise the kinetic energy; with the tilt capped at arctan(u/((1+e)v)) there is no "
            "gain in 1,000,000 random collisions (`tests/analytic/test_slope_impact.py`)",
        ),
    ]


def _uto() -> list[Sequence[str]]:
    uto = kept("uto1974")
    overshoot = "a step smaller than dx/c oscillates: overshoot of the front at dx/c / 5"
    energy = [
        uto.value("figures10-11", f"total energy with {words}")
        for words in ("10 segments", "100 segments, less than")
    ]
    limit = uto.value("figures10-11", "largest k2/k1 that is stable at dt = dx/c")
    return [
        (
            "Uto et al.",
            "Smith's scheme at a fifth of the critical step",
            '"oscillates"',
            f"overshoots by {number(100.0 * uto.value('claims', overshoot))} %; at the critical "
            "step not at all",
        ),
        (
            "",
            "total energy with 10 / 100 segments",
            "+20 % / < 1 %",
            f"{energy[0]:+.1f} % / {energy[1]:+.1f} %, an artefact of the account: the half-step "
            "energy is conserved to rounding",
        ),
        (
            "",
            "reflection at a stiff toe (fig. 10)",
            "five times, then divergence",
            "kappa = k2/k1 times, so five times needs alpha = -2/3; diverges above kappa = "
            f"{number(limit, 1)}",
        ),
        (
            "",
            "a defect of the displacement scheme",
            "fundamental",
            "refuted: with the mass (m1 + m2)/2 at the interface kappa = 1/3, 1 and 3 are free of "
            "ripples",
        ),
        (
            "",
            "St. Venant's closed form, 1,000 segments, characteristics",
            "",
            "within 4e-7 of the first stress, rebound within 7e-8; separation within 1e-6 at 250 "
            "to 1,001 segments; all of second order (`tests/analytic/test_rod_waves.py`)",
        ),
    ]


def _mogami() -> list[Sequence[str]]:
    mogami = kept("mogami1973")
    square = mogami.value("mass", "number before r² in (1)")
    too_large = [
        mogami.value("mass", f"printed mass: v0 and settlement (7) too large, 96 tests, {end}")
        for end in ("least", "largest")
    ]
    ratio = mogami.value("fits", "slope of (12), largest / smallest plate")
    rise = mogami.value("fits", "2 M/K of (5) to (7) with (11), largest / smallest plate")
    implied = [
        mogami.row("fits", f"mass that (11) and (12) imply, plate of {area} cm²")["paper"]
        for area in AREAS
    ]
    return [
        (
            "Mogami, Tamura",
            "virtual soil mass, equation (1)",
            "3 r²",
            f"{number(square)} r² (momentum of the frustum): the printed form gives settlements "
            f"{number(too_large[0], 1)} to {number(too_large[1], 1)} % too large in the 96 tests",
        ),
        (
            "",
            "settlement, equation (7)",
            "I²/((R0 + R1) M)",
            "exact for R0 = R1; integrated exactly 4/3 of it for R0 = 0, 2/3 for R1 = 0",
        ),
        (
            "",
            "fits (11) and (12)",
            "",
            f"contradict each other: the slope of (12) falls to {number(ratio, 2)} over the plates "
            f"where (7) with (11) rises by {number(rise, 1)}; they imply a moving mass of "
            f"{number(min(implied), 1)} to {number(max(implied))} kg whatever fell, where by (1) "
            "the sand alone has 61 to 91 kg",
        ),
    ]


TABLES: Mapping[str, Callable[[], str]] = {"claims": claims}
"""Functions that write a block, by its name."""
