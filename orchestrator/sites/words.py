"""Masses and lengths in words, for titles and captions."""

from rockshed.components.common.units import cm, tonne


def mass_in_words(mass: float) -> str:
    """Return a mass (kg) in t or kg."""
    return f"{mass / tonne:.3g} t" if mass >= 0.1 * tonne else f"{mass:.3g} kg"


def length_in_words(length: float) -> str:
    """Return a length (m) in m or cm."""
    return f"{length:.3g} m" if length >= 1.0 else f"{length / cm:.3g} cm"
