"""Corners of the moment-curvature line of a section that yields, as the beam takes them."""

from dataclasses import dataclass

PLASTIC_AT = 2.0
"""Curvature at which a rolled section bears its plastic moment, in units of the yield curvature.

With it the line of two corners encloses the same area with the plastic moment as an H-section of
the usual series does (H-400x400x13x21: 2.1). A rectangle would take 3.
"""
STEEL_HARDENING = 0.01
"""Slope past the plastic moment, as a part of the elastic one: usual for structural steel."""
_CORNERS = 3
"""The most that a beam takes."""


@dataclass(frozen=True)
class Corners:
    """Corners of the moment-curvature line of a section.

    Attributes
    ----------
    moments : tuple of float
        Bending moment at one to three corners (N m); the section is elastic up to the first.
    curvatures : tuple of float
        Curvature there (1/m); the first is the first moment over E I.
    hardening_ratio : float
        Slope past the last corner, as a part of the elastic one.
    hogging_moments : tuple of float
        Moment with tension above at each corner (N m), along slopes as below; empty: alike.
    hogging_curvature : float
        Curvature with tension above that counts as that of the last corner (1/m); 0: alike.
    cracks : bool
        Whether the first corner is cracking, so that unloading leads to the origin.
    """

    moments: tuple[float, ...]
    curvatures: tuple[float, ...]
    hardening_ratio: float = 0.0
    hogging_moments: tuple[float, ...] = ()
    hogging_curvature: float = 0.0
    cracks: bool = False

    def parameters(self, girders: float = 1.0) -> dict[str, float | str]:
        """Return the parameters of the beam that this line gives it.

        Parameters
        ----------
        girders : float
            How many sections act together, may be a fraction.

        Returns
        -------
        dict of str to float or str
            In SI units, by the names of RBSMBeam; corners that are not there are 0.
        """
        missing = (0.0,) * (_CORNERS - len(self.moments))
        moments = [girders * moment for moment in self.moments] + list(missing)
        curvatures = [*self.curvatures, *missing]
        values: dict[str, float | str] = {"section.bending": "yielding"}
        for number, (moment, curvature) in enumerate(zip(moments, curvatures), 1):
            values[f"section.corner{number}.moment"] = moment
            if number > 1:
                values[f"section.corner{number}.curvature"] = curvature
        for number, moment in enumerate(self.hogging_moments, 1):
            values[f"section.corner{number}.hogging_moment"] = girders * moment
        values["section.corner_hogging_curvature"] = self.hogging_curvature
        values["section.corner1.kind"] = "cracking" if self.cracks else "yield"
        return {**values, "section.hardening_ratio": self.hardening_ratio}


@dataclass(frozen=True)
class SteelSection:
    """A steel section, as tables of sections and steels give it.

    Attributes
    ----------
    elastic_modulus : float
        Young's modulus (Pa).
    second_moment : float
        Second moment of area (m4).
    section_modulus, plastic_modulus : float
        Elastic and plastic section modulus (m3); their ratio is the shape factor.
    yield_stress : float
        In Pa.
    """

    elastic_modulus: float
    second_moment: float
    section_modulus: float
    plastic_modulus: float
    yield_stress: float


def steel_corners(
    section: SteelSection,
    hardening_ratio: float = STEEL_HARDENING,
    plastic_at: float = PLASTIC_AT,
) -> Corners:
    """Return the corners of a steel section: yield of the outer fibre, plastic moment, hardening.

    Parameters
    ----------
    section : SteelSection
        One girder.
    hardening_ratio : float
        Slope past the plastic moment, as a part of the elastic one.
    plastic_at : float
        Curvature at the plastic moment, in units of the yield curvature; above 1.

    Returns
    -------
    Corners
        Two; one where the shape factor leaves no slope above that of the hardening between them.
    """
    first = section.yield_stress * section.section_modulus
    curvature = first / (section.elastic_modulus * section.second_moment)
    shape = section.plastic_modulus / section.section_modulus
    if shape - 1.0 <= hardening_ratio * (plastic_at - 1.0):
        return Corners((first,), (curvature,), hardening_ratio)
    return Corners((first, shape * first), (curvature, plastic_at * curvature), hardening_ratio)
