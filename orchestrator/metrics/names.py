"""Names of the metrics of a run in words; their identifiers follow from them and stay."""

PEAK_TRANSMITTED = "peak transmitted force"
PEAK_TRANSMITTED_AT = "peak transmitted force at"
PEAK_ROCK = "peak force on the rock"
PEAK_ROCK_AT = "peak force on the rock at"
PEAK_LOAD_CELL = "peak transmitted force through the load cell"
LOAD_CELL_CUT_OFF = "cut-off frequency of the load cell"
RATIO = "peak transmitted force / peak force on the rock"
SETTLED_TRANSMITTED = "settled maximum of the transmitted force"
SETTLED_ROCK = "settled maximum of the force on the rock"
SETTLED_RATIO = "settled transmitted force / settled force on the rock"
SETTLED_CUT_OFF = "cut-off frequency of the settled forces"
PENETRATION = "penetration"
CLEARANCE = "least distance of rock and base"
DEFLECTION = "peak midspan deflection"
PEAK_MOMENT = "peak bending moment"
PEAK_MOMENT_AT = "peak bending moment at"
PEAK_SAGGING = "peak sagging moment"
PEAK_HOGGING = "peak hogging moment"
"""Both as amounts; of a section whose capacities differ."""
PEAK_MOMENT_PLACE = "peak bending moment at the place"
PEAK_SHEAR = "peak shear force"
PEAK_SHEAR_AT = "peak shear force at"
PEAK_SHEAR_PLACE = "peak shear force at the place"
RESIDUAL_DEFLECTION = "residual midspan deflection"
PLASTIC_WORK = "plastic work in the beam"
CURVATURE_RATIO = "largest curvature / curvature of the last corner"
PEAK_STRESS = "peak bending stress"
"""Moment over section modulus, as if the section were elastic."""
PEAK_REACTION = "peak support reaction"
PEAK_REACTION_AT = "peak support reaction at"
BEAM_ENERGY = "peak beam energy"
"""Largest elastic energy less that at the start, under dead load."""
BEAM_ENERGY_FROM_STRAIN = "peak beam energy from the midspan strain"
BEAM_SHARE = "peak beam energy / impact energy"
BEAM_SHARE_FROM_STRAIN = "peak beam energy from the midspan strain / impact energy"
IMPULSE_ROCK = "impulse on the rock"
IMPULSE_TRANSMITTED = "transmitted impulse"
DURATION = "duration of the force on the rock"
RISE_ROCK = "rise time of the force on the rock"
"""From 10 to 90 % of the settled maximum, as is that of the transmitted force."""
RISE_TRANSMITTED = "rise time of the transmitted force"
SHAPE = "shape factor of the force on the rock"
"""Impulse / (peak x duration)."""
PENETRATION_SHARE = "penetration / thickness of the cushion"
PEAK_PRESSURE = "peak pressure on the roof"
PEAK_PRESSURE_AT = "peak pressure on the roof at"
PEAK_PRESSURE_PLACE = "peak pressure on the roof at the place"
LOAD_HALF = "half of the load on the roof within"
"""Distance from the load's centre along the roof, in the row of the largest load until the rock
turns."""
LOAD_MOST = "90 % of the load on the roof within"
SPREAD_ANGLE = "spread angle of the load on the roof"
"""From the rock's edge at the surface to where 90 % of the load end, from the vertical."""
IMPACT_ENERGY = "impact energy"
DISSIPATED_SHARE = "dissipated energy at the end / impact energy"
GRAVITY_SHARE = "energy given by gravity until the end / impact energy"
"""Fall of rock, sand and structure since the start: with it, more than the impact energy may be
dissipated."""
REBOUND_SHARE = "kinetic energy of the rock at the end / impact energy"
RESIDUAL = "largest energy residual of the system"
RESIDUAL_SHARE = "largest energy residual of the system / impact energy"
STATIC_LOAD = "load at 4 cm"
STATIC_STIFFNESS = "secant spring constant k"
STATIC_DEPARTURE = "departure of the load from the secant line / largest load"
MACHINE_WORK = "work of the machine"
RESIDUAL_WORK_SHARE = "largest energy residual of the system / work of the machine"

_SEPARATOR = ": "
_UTILISATION = "utilisation by "


def utilisation(criterion: str) -> str:
    """Return the name of the metric that compares a run with a criterion.

    Parameters
    ----------
    criterion : str
        Name of the criterion: ``stress``.
    """
    return _UTILISATION + criterion


def criterion_of(name: str) -> str:
    """Return the criterion of a utilisation; empty for another metric.

    Parameters
    ----------
    name : str
        Name of a metric without that of its component.
    """
    return name.removeprefix(_UTILISATION) if name.startswith(_UTILISATION) else ""


def of_component(component: str, name: str) -> str:
    """Return the name of a metric of one component among several.

    Parameters
    ----------
    component : str
        Name of the component in the system.
    name : str
        Name of the metric.
    """
    return f"{component}{_SEPARATOR}{name}"


def without_component(name: str) -> str:
    """Return the name of a metric without that of its component.

    Parameters
    ----------
    name : str
        Name of a metric, with or without a component.
    """
    return name.rpartition(_SEPARATOR)[2]
