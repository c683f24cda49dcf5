"""All numbers of a shed that follow from others, derived once.

Frame: x to the right from the left support, y upwards from the top of the unloaded roof.
"""

import math
from dataclasses import dataclass

from rockshed.components.common.units import standard_gravity
from rockshed.components.sand_cushion.measures import contact_frequency
from rockshed.components.sand_cushion.models import MODELS, SPREAD

from ..pile.design import PileDesign
from .discretisation import axis_below_top, discs_in, element_length
from .foundation import STIFF_END, SupportRod, impedance, pile_rod
from .site import Numerics, SandMaterial
from .yielding import Corners

DISCS_IN_RADIUS, DISCS_IN_THICKNESS = 9.0, 9.0
"""Disc diameters in a rock diameter and in the thickness, at least: those of the girders of Sonoda
et al. (1993)."""
ELEMENT_IN_DISCS = 2.0
"""Length of a beam element in diameters of sand discs, as there."""
FEWEST_ELEMENTS = 21
CLEARANCE = 1.0
"""Way of the rock above the levelled surface, in diameters of the largest discs, of which the
highest stands out by 0.6 at most."""
WALL_HEIGHT, WALL_THICKNESS = 0.99, 0.5
"""Walls beside the cushion over which rocks come in from a slope: height / thickness of the
cushion, and thickness (m)."""
SAND_STEPS = 4
"""Internal steps of sand and rock in an exchange."""
_STEP_SHARE = 0.25
"""Exchange step / stable step of the sand, at most."""
_CONTACT_SHARE = 0.1
"""Exchange step / stable step of a beam element in contact with the sand, at most."""
_BEAM_SHARE = 0.5
"""Internal step of the beam / its stable step."""
BEAM_DAMPING_RATIO = 0.25
"""Damping of the beam's fastest mode, whose contact forces are held over an exchange; of its first
mode less than 0.1 %."""
_SINKING_PERIODS = 12.0
"""Time that is computed in sqrt(M / E_bar w), the time scale of a rock on sand."""
_BEAM_PERIODS = 1.5
"""Time that is computed in periods of roof and sand, at least."""
_ROWS = 1000
"""Rows of the results."""


@dataclass(frozen=True)
class RockPart:
    """The rock as it strikes.

    Attributes
    ----------
    mass, radius, density : float
        Of the sphere (kg, m, kg/m3).
    velocity_x, velocity_y, spin : float
        At the surface, to the right, downwards (m/s), counter-clockwise (rad/s).
    place : float
        x where it strikes (m).
    """

    mass: float
    radius: float
    density: float
    velocity_x: float
    velocity_y: float
    spin: float
    place: float

    @property
    def speed(self) -> float:
        """Speed at the surface (m/s)."""
        return math.hypot(self.velocity_x, self.velocity_y)

    @property
    def drop_height(self) -> float:
        """Height of the fall that gives this speed (m)."""
        return self.speed**2 / (2.0 * standard_gravity)


@dataclass(frozen=True)
class RoofArrival:
    """A rock from a slope as it is handed over, near the roof, in the frame of the shed.

    Attributes
    ----------
    x, y : float
        Place of its centre (m).
    velocity_y : float
        Upwards (m/s).
    lead : float
        Time (s) from the start of the run to the hand-over.
    delay : float
        Time (s) from the start of the run until it strikes the cushion's surface.
    """

    x: float
    y: float
    velocity_y: float
    lead: float
    delay: float


@dataclass(frozen=True)
class CushionPart:
    """The cushion.

    Attributes
    ----------
    thickness, width, effective_width : float
        Above the roof, along the span, out of the plane (m).
    rule : str
        The rule of the effective width, or ``given``.
    material : str
        Name of the material.
    sand : SandMaterial
        Its values, complete.
    """

    thickness: float
    width: float
    effective_width: float
    rule: str
    material: str
    sand: SandMaterial


@dataclass(frozen=True)
class RoofPart:
    """One girder of the roof, or a strip of a slab as wide as the effective width.

    Attributes
    ----------
    kind, section : str
        ``girders`` or ``concrete``, and the name of the section.
    area, second_moment, section_modulus, plastic_modulus, height : float
        Of the section (m2, m4, m3, m3, m).
    density, elastic_modulus : float
        Of the material (kg/m3, Pa).
    yield_stress : float or None
        Of the material (Pa).
    span, spacing : float
        Distance of the supports and of the girders (m).
    deck_mass : float
        Mass of the slab on it, by area (kg/m2).
    supports : str
        ``simple``, ``fixed`` or ``elastic``.
    support_stiffness : float
        Of the spring under each of its ends (N/m); 0 where the supports are not elastic.
    corners : Corners or None
        Of the moment-curvature line; None for an elastic section.
    hogging_capacity : float
        Moment that a strip of concrete bears with tension above (N m).
    cracking_moment : float
        Moment that cracks a strip of concrete (N m).
    """

    kind: str
    section: str
    area: float
    second_moment: float
    section_modulus: float
    plastic_modulus: float
    height: float
    density: float
    elastic_modulus: float
    yield_stress: float | None
    span: float
    spacing: float
    deck_mass: float = 0.0
    supports: str = "simple"
    support_stiffness: float = 0.0
    corners: Corners | None = None
    hogging_capacity: float = 0.0
    cracking_moment: float = 0.0


@dataclass(frozen=True)
class ShedLayout:
    """A shed with everything that follows from its parts.

    Attributes
    ----------
    rock, cushion, roof : RockPart, CushionPart, RoofPart
        The parts.
    girders : float
        Number of girders in the effective width, a fraction too.
    disc_radius : float
        Mean radius of the sand discs (m).
    discs, elements : int
        Numbers of sand discs and beam elements.
    box_left, axis_y, element : float
        Left end of the cushion, axis of the beam, length of an element (m).
    clearance : float
        Distance of the rock from the surface at the start (m).
    start_x, start_y, start_velocity_y : float
        Rock at the start (m, m, m/s upwards).
    exchange_step, sand_step, beam_step, beam_damping : float
        Steps, and Rayleigh damping of the beam's stiffness (s).
    stop_time, output_interval, state_interval : float
        Times (s).
    seed : int
        Number of the packing.
    rod : SupportRod or None
        Piles under each end of the roof; None where there are none.
    arrival : RoofArrival or None
        Of a rock from a slope, whose clearance and start are those at the hand-over.
    """

    rock: RockPart
    cushion: CushionPart
    roof: RoofPart
    girders: float
    disc_radius: float
    discs: int
    elements: int
    box_left: float
    axis_y: float
    element: float
    clearance: float
    start_x: float
    start_y: float
    start_velocity_y: float
    exchange_step: float
    sand_step: float
    beam_step: float
    beam_damping: float
    stop_time: float
    output_interval: float
    state_interval: float
    seed: int
    rod: SupportRod | None = None
    arrival: RoofArrival | None = None


def girders_in(cushion: CushionPart, roof: RoofPart) -> float:
    """Return the number of girders in the effective width.

    Parameters
    ----------
    cushion, roof : CushionPart, RoofPart
        The parts.

    Returns
    -------
    float
        Of girders 1 or more: a strip narrower than a bay lies on one girder, and all of it bends.
    """
    number = cushion.effective_width / roof.spacing
    return max(1.0, number) if roof.kind == "girders" else number


def centred(span: float, width: float) -> float:
    """Return the left end of a box in the middle of a span (m)."""
    return 0.5 * (span - width)


def layout(
    rock: RockPart,
    cushion: CushionPart,
    roof: RoofPart,
    numerics: Numerics,
    pile: PileDesign | None = None,
    arrival: RoofArrival | None = None,
) -> ShedLayout:
    """Derive everything that follows from the parts of a shed.

    Parameters
    ----------
    rock, cushion, roof : RockPart, CushionPart, RoofPart
        The parts.
    numerics : Numerics
        Those of the rest that are given.
    pile : PileDesign, optional
        Under each end of each girder.
    arrival : RoofArrival, optional
        Of a rock from a slope.

    Returns
    -------
    ShedLayout
    """
    radius = numerics.disc_radius or disc_radius(rock, cushion)
    elements = numerics.elements or beam_elements(roof.span, radius)
    girders = girders_in(cushion, roof)
    element = element_length(roof.span, elements)
    exchange = numerics.exchange_step or min(
        exchange_step(cushion, roof, girders, radius, elements),
        support_exchange(pile, roof, girders, element),
    )
    ratio = BEAM_DAMPING_RATIO if pile is None else 0.0
    damping, beam_step = beam_steps(roof, element, ratio)
    start = start_of(rock, cushion, numerics.clearance or clearance_of(radius), arrival)
    stop = numerics.stop_time or stop_time(rock, cushion, roof, girders, start.delay)
    interval = numerics.output_interval or _round_down(stop / _ROWS)
    return ShedLayout(
        *(rock, cushion, roof, girders, radius),
        discs_in(cushion.width, cushion.thickness, radius, solid_fraction(cushion)),
        elements,
        centred(roof.span, cushion.width),
        axis_below_top(roof.span, elements),
        element,
        *(start.y - cushion.thickness - rock.radius, start.x, start.y, start.velocity_y),
        *(exchange, exchange / SAND_STEPS, min(beam_step, exchange), damping),
        stop,
        _multiple(interval, exchange),
        _multiple(10.0 * interval, exchange),
        numerics.seed,
        None if pile is None else pile_rod(pile, girders, exchange),
        arrival,
    )


def clearance_of(radius: float) -> float:
    """Return the way of the rock above the surface (m) where none is given.

    Parameters
    ----------
    radius : float
        Mean radius of the sand discs (m).
    """
    return CLEARANCE * 2.0 * radius * (1.0 + SPREAD)


def start_of(
    rock: RockPart, cushion: CushionPart, clearance: float, arrival: RoofArrival | None
) -> RoofArrival:
    """Return where and how fast the rock starts: in free fall above the surface, or from a slope.

    Parameters
    ----------
    rock, cushion : RockPart, CushionPart
        The parts.
    clearance : float
        Of a rock that falls (m).
    arrival : RoofArrival or None
        Of a rock from a slope.
    """
    if arrival is not None:
        return arrival
    speed = speed_at_start(rock, clearance)
    delay = (rock.velocity_y - speed) / standard_gravity
    x = rock.place - rock.velocity_x * delay
    return RoofArrival(x, cushion.thickness + clearance + rock.radius, -speed, 0.0, delay)


def speed_at_start(rock: RockPart, clearance: float) -> float:
    """Return the speed downwards at the start, above the surface (m/s); 0 if it is too high.

    Parameters
    ----------
    rock : RockPart
        As it strikes.
    clearance : float
        Distance from the surface (m).
    """
    return math.sqrt(max(rock.velocity_y**2 - 2.0 * standard_gravity * clearance, 0.0))


def end_stiffness(roof: RoofPart, girders: float, element: float) -> float:
    """Return the stiffness of the end of the roof (N/m), 4 EI/R3 of its half-bar.

    Parameters
    ----------
    roof : RoofPart
        One girder.
    girders : float
        Number of girders that take part.
    element : float
        Length of an element (m).
    """
    return 4.0 * girders * roof.elastic_modulus * roof.second_moment / element**3


def support_exchange(
    pile: PileDesign | None, roof: RoofPart, girders: float, element: float
) -> float:
    """Return the longest exchange step that the supports allow (s).

    Parameters
    ----------
    pile : PileDesign or None
        Under them; without piles they allow any.
    roof : RoofPart
        One girder.
    girders : float
        Number of girders that take part.
    element : float
        Length of an element (m).
    """
    if pile is None:
        return math.inf
    limit = girders * impedance(pile) / end_stiffness(roof, girders, element)
    return _round_down(limit / STIFF_END)


def line_mass(cushion: CushionPart, roof: RoofPart, girders: float) -> float:
    """Return the mass of roof and sand by length (kg/m).

    Parameters
    ----------
    cushion, roof : CushionPart, RoofPart
        The parts.
    girders : float
        Number of girders that take part.
    """
    sand = cushion.thickness * float(cushion.sand.density or 0.0)
    deck = cushion.effective_width * (roof.deck_mass + sand)
    return girders * roof.density * roof.area + deck


def solid_fraction(cushion: CushionPart) -> float:
    """Return the solid fraction of a cushion's material."""
    return float(cushion.sand.solid_fraction or 0.0)


def disc_radius(rock: RockPart, cushion: CushionPart) -> float:
    """Return the mean radius of the sand discs where none is given (m), of two digits.

    Parameters
    ----------
    rock : RockPart
        The rock.
    cushion : CushionPart
        The cushion.
    """
    largest = min(rock.radius / DISCS_IN_RADIUS, 0.5 * cushion.thickness / DISCS_IN_THICKNESS)
    return _digits_down(min(largest, cushion.width / 8.0))


def beam_elements(span: float, radius: float) -> int:
    """Return the number of beam elements where none is given, an odd one.

    A point load at midspan meets a disc then.

    Parameters
    ----------
    span : float
        Distance of the supports (m).
    radius : float
        Mean radius of the sand discs (m).
    """
    wanted = max(span / (ELEMENT_IN_DISCS * 2.0 * radius), FEWEST_ELEMENTS)
    return 2 * round(0.5 * (wanted - 1.0)) + 1


def exchange_step(
    cushion: CushionPart, roof: RoofPart, girders: float, radius: float, elements: int
) -> float:
    """Return the time between two exchanges where none is given (s).

    Parameters
    ----------
    cushion, roof : CushionPart, RoofPart
        The parts.
    girders : float
        Number of girders that take part.
    radius : float
        Mean radius of the sand discs (m).
    elements : int
        Number of beam elements.

    Returns
    -------
    float
        1, 2 or 5 times a power of 10.
    """
    model = MODELS["one-law"].parameters
    modulus = float(cushion.sand.modulus or 0.0)
    of_disc = {
        **model,
        "modulus": modulus,
        "density": float(cushion.sand.density or 0.0),
        "solid_fraction": solid_fraction(cushion),
        "disc.radius": radius,
    }
    unloading = float(model["unloading_ratio"])
    omega = 2.0 * math.pi * contact_frequency(of_disc) / (1.0 - SPREAD)
    sand = 1.2 / (omega * math.sqrt(6.0 * (unloading + 0.25)))  # dashpots take 0.4 of 2 / omega
    mass = girders * (roof.density * roof.area) + cushion.effective_width * roof.deck_mass
    stiffness = 2.0 * unloading * modulus * cushion.effective_width
    beam = 2.0 * math.sqrt(mass * element_length(roof.span, elements) / stiffness)
    return _round_down(min(_STEP_SHARE * sand, _CONTACT_SHARE * beam))


def beam_steps(roof: RoofPart, element: float, ratio: float) -> tuple[float, float]:
    """Return Rayleigh damping of the stiffness and internal step of the beam.

    The chain's highest frequency is the larger of 4/R2 sqrt(EI/mu) and 2/R sqrt(EA/mu); on fixed
    supports 5.54/R2 sqrt(EI/mu), on springs sqrt(24 EI/R4 + 2 k/R)/sqrt(mu) at most (README of the
    beam).

    Parameters
    ----------
    roof : RoofPart
        One girder.
    element : float
        Length of an element (m).
    ratio : float
        Damping ratio of the fastest mode.

    Returns
    -------
    damping, step : float
        Both in s.
    """
    mass = roof.density * roof.area
    factor = {"fixed": 5.54**2, "elastic": 24.0}.get(roof.supports, 16.0)
    spring = 2.0 * roof.support_stiffness / element
    bending = factor * roof.elastic_modulus * roof.second_moment / element**4
    omega = max(
        math.sqrt((bending + spring) / mass),
        2.0 / element * math.sqrt(roof.elastic_modulus * roof.area / mass),
    )
    damping = 2.0 * ratio / omega
    rate = damping * omega**2
    stable = 4.0 / (rate + math.sqrt(rate**2 + 4.0 * omega**2))
    return damping, _digits_down(_BEAM_SHARE * stable)


def stop_time(
    rock: RockPart, cushion: CushionPart, roof: RoofPart, girders: float, approach: float
) -> float:
    """Return the end of the run where none is given (s), in whole hundredths.

    Parameters
    ----------
    rock, cushion, roof : RockPart, CushionPart, RoofPart
        The parts.
    girders : float
        Number of girders that take part.
    approach : float
        Time until the rock strikes (s).
    """
    stiffness = float(cushion.sand.modulus or 0.0) * cushion.effective_width
    sinking = _SINKING_PERIODS * math.sqrt(rock.mass / stiffness)
    load = line_mass(cushion, roof, girders)
    bending = girders * roof.elastic_modulus * roof.second_moment
    period = 2.0 * roof.span**2 / math.pi * math.sqrt(load / bending)
    if roof.support_stiffness > 0.0:
        on_springs = math.sqrt(0.5 * load * roof.span / (girders * roof.support_stiffness))
        period = math.hypot(period, 2.0 * math.pi * on_springs)
    return math.ceil(100.0 * (approach + max(sinking, _BEAM_PERIODS * period))) / 100.0


def _digits_down(value: float) -> float:
    """Return a value, rounded down to two digits."""
    unit = 10.0 ** (math.floor(math.log10(value)) - 1)
    return float(f"{math.floor(value / unit * (1.0 + 1e-9)) * unit:.6g}")


def _round_down(value: float) -> float:
    """Return a value, rounded down to 1, 2 or 5 times a power of 10."""
    power = 10.0 ** math.floor(math.log10(value))
    digit = max(d for d in (1.0, 2.0, 5.0) if d * power <= value * (1.0 + 1e-9))
    return float(f"{digit * power:.6g}")


def _multiple(interval: float, step: float) -> float:
    """Return an interval as a whole number of steps (s)."""
    return float(f"{max(1, round(interval / step)) * step:.12g}")
