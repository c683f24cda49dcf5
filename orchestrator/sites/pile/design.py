"""A pile as it is computed: every value is there, in SI units, whatever it was derived from.

Depths count from the head downwards; those of ground from its surface.
"""

from pydantic import Field

from rockshed.components.common.units import standard_gravity

from ...input_files.form import Data
from .site import Anvil, Gas, Ground, NamedSoil, PileParts, ToeSoil


class Ram(Data):
    """The ram of a hammer with the energy of its stroke.

    Attributes
    ----------
    kind : str
        ``drop``, ``hydraulic`` or ``diesel``.
    mass : float
        Of the ram (kg).
    drop : float
        Height (m) from which it would have to fall for its rated energy.
    efficiency : float
        Part of the energy of the fall, without what compresses gas, with which it strikes.
    ports : float
        Last part of the fall (m), whose energy compresses gas.
    rate : float or None
        Blows in a second.
    anvil : Anvil or None
        Between ram and cushion.
    gas : Gas or None
        Force of the burning gas over time.
    model, source : str
        Name in the table of hammers, and source of its row.
    verified : bool
        Whether that source could be read.
    """

    kind: str = "drop"
    mass: float
    drop: float
    efficiency: float = 1.0
    ports: float = 0.0
    rate: float | None = None
    anvil: Anvil | None = None
    gas: Gas | None = None
    model: str = ""
    source: str = ""
    verified: bool = True

    @property
    def energy(self) -> float:
        """Rated energy m g h (J) of the whole fall."""
        return self.mass * standard_gravity * self.drop

    @property
    def fall(self) -> float:
        """Height (m) of the free fall that gives the ram its velocity."""
        return self.drop - self.ports


class Spring(Data):
    """A cushion: stiffness (N/m), restitution, its material, and the source of that if verified."""

    stiffness: float
    restitution: float = 1.0
    material: str = ""
    source: str = ""
    verified: bool = True


class RodSection(Data):
    """A part of the rod.

    Attributes
    ----------
    length, area, modulus, density : float
        In m, m2, Pa, kg/m3.
    perimeter, outline : float or None
        Perimeter on which friction acts (m), and area within it (m2), where they are known.
    """

    length: float
    area: float
    modulus: float
    density: float
    perimeter: float | None = None
    outline: float | None = None


class Friction(Data):
    """Friction along a part of the rod in one soil, linear in the depth.

    Attributes
    ----------
    top, bottom : float
        Depths below the head (m).
    upper, lower : float
        Ultimate friction at both (N/m).
    quake, damping : float
        After Smith (m, s/m).
    soil : str
        Name of the soil.
    """

    top: float
    bottom: float
    upper: float
    lower: float
    quake: float
    damping: float
    soil: str = ""

    @property
    def resistance(self) -> float:
        """Ultimate resistance of the part (N)."""
        return 0.5 * (self.upper + self.lower) * (self.bottom - self.top)


class PileDesign(PileParts):
    """A pile with everything that its blows need.

    Attributes
    ----------
    hammer : Ram
        Ram and stroke.
    cushion, pile_cushion : Spring or None
        Below the ram, and between helmet and head.
    helmet : float
        Mass of the helmet (kg); 0 without one.
    rod : list of RodSection
        From head to toe.
    toe : ToeSoil
        Under the toe.
    friction : list of Friction
        Along the rod, beside the layers ``shaft``.
    ground : Ground or None
        From which ``friction`` and ``toe`` were derived.
    soil : dict of str to NamedSoil
        Its soils.
    """

    hammer: Ram
    cushion: Spring | None = None
    helmet: float = 0.0
    pile_cushion: Spring | None = None
    rod: list[RodSection]
    toe: ToeSoil
    friction: list[Friction] = Field(default_factory=list)
    ground: Ground | None = None
    soil: dict[str, NamedSoil] = Field(default_factory=dict)

    @property
    def length(self) -> float:
        """Length of the rod (m)."""
        return sum(section.length for section in self.rod)

    @property
    def mass(self) -> float:
        """Mass of the rod (kg)."""
        return sum(section.length * section.area * section.density for section in self.rod)
