"""Resistances by dynamic formulas for the sets that have been computed."""

from dataclasses import dataclass

from ...formulas.pile_driving import Stroke, gates, hiley
from ...sites.pile.preparation import PreparedPile
from .blows import Blow


@dataclass(frozen=True)
class Formulas:
    """Ultimate resistances by formulas (N); None where a formula has no value."""

    hiley: float
    gates: float | None


def stroke_of(pile: PreparedPile) -> Stroke:
    """Return the stroke of a pile's hammer as dynamic formulas see it.

    Parameters
    ----------
    pile : PreparedPile
        With hammer, cushions and rod.

    Returns
    -------
    Stroke
        With the restitution of the softest cushion.
    """
    site = pile.site
    springs = [spring for spring in (site.cushion, site.pile_cushion) if spring]
    softest = min(springs, key=lambda spring: spring.stiffness, default=None)
    rod = sum(section.length / (section.area * section.modulus) for section in site.rod)
    anvil = site.hammer.anvil.mass if site.hammer.anvil else 0.0
    return Stroke(
        rated_energy=pile.rated_energy,
        efficiency=site.hammer.efficiency,
        ram=site.hammer.mass,
        pile=site.mass + site.helmet + anvil,
        restitution=softest.restitution if softest else 1.0,
        compliance=rod + sum(1.0 / spring.stiffness for spring in springs),
        quake=site.toe.quake,
    )


def by_formulas(pile: PreparedPile, blow: Blow) -> Formulas:
    """Return what the formulas make of the set of a blow.

    Parameters
    ----------
    pile : PreparedPile
        That was struck.
    blow : Blow
        With its set.

    Returns
    -------
    Formulas
        Hiley, and Gates where something stays.
    """
    stroke = stroke_of(pile)
    permanent = max(blow.set, 0.0)
    return Formulas(hiley(stroke, permanent), gates(stroke, permanent) if permanent else None)
