"""Meanings of the rows of a run's table: how a number is found, and what its sign says."""

from collections.abc import Mapping

from . import names

MEANINGS: Mapping[str, str] = {
    names.PEAK_TRANSMITTED: "largest force of the cushion on what it lies on, its weight included",
    names.PEAK_ROCK: "largest upward force of the cushion on the rock",
    names.RATIO: "peak transmitted force / peak force on the rock; both are at other times",
    names.SETTLED_TRANSMITTED: "largest transmitted force without the spikes of single discs",
    names.SETTLED_ROCK: "largest force on the rock without the spikes of single discs",
    names.SETTLED_CUT_OFF: "settled forces have nothing faster than this: half of the frequency "
    "of a disc on one contact. The filter looks ahead too, so that nothing is delayed: a settled "
    "force begins before contact, and a short peak is lower than it was",
    names.IMPULSE_TRANSMITTED: "transmitted force beyond that at rest, over the time of the run",
    names.IMPULSE_ROCK: "force on the rock over the time of the run: mass times change of velocity "
    "and what gravity adds meanwhile",
    names.DURATION: "time for which the force on the rock is above 1 % of its peak",
    names.RISE_ROCK: "from 10 to 90 % of the settled maximum",
    names.SHAPE: "impulse / (peak times duration): 0.64 for half a sine, 0.50 for a triangle; "
    "less where a short peak is followed by a long weak force",
    names.PENETRATION: "depth of the rock's lowest point below the surface as it was",
    names.PENETRATION_SHARE: "penetration / thickness below the mean surface as the sand has "
    "settled, which differs from the given one by some discs; the utilisation takes the given one",
    names.PEAK_PRESSURE: "largest mean pressure on an element of the beam over the effective width",
    names.LOAD_HALF: "distance from the load's centre along the roof within which half of the load "
    "lies that the impact adds, when it is largest",
    names.LOAD_MOST: "the same of 90 % of the load",
    names.SPREAD_ANGLE: "from the rock's edge at the surface down to where 90 % of the load end, "
    "from the vertical; below 0 the load ends nearer to its centre than the rock's edge",
    names.DEFLECTION: "largest deflection at midspan, with that under dead load",
    names.RESIDUAL_DEFLECTION: "deflection at midspan that would stay without loads and weights: "
    "of yielded girders or bars, and of faces of concrete that broke without bars; cracks alone "
    "close",
    names.PEAK_MOMENT: "largest bending moment of all that takes part, with that of dead load; "
    "above 0 with tension below, below 0 with tension above, as at fixed ends",
    names.PEAK_SHEAR: "largest shear force of all that takes part, with that of dead load; "
    "above 0 where the part on its left pushes the other up",
    names.PEAK_SAGGING: "largest moment with tension below, of a section whose capacities differ",
    names.PEAK_HOGGING: "largest moment with tension above, as an amount",
    names.PEAK_STRESS: "bending moment / elastic section modulus, W, as if the section were "
    "elastic, also where it has yielded; concrete that may crack has none",
    names.PEAK_REACTION: "largest force on one support, of all that takes part, with that of dead "
    "load; above 0 where the roof presses down",
    names.CURVATURE_RATIO: "largest curvature / that of the last corner of the moment-curvature "
    "line: of steel the plastic moment, of concrete its crushing, or cracking where no bars cross; "
    "above 1 of concrete what comes after means nothing",
    names.PLASTIC_WORK: "energy that the section has dissipated by yielding and cracking",
    names.IMPACT_ENERGY: "kinetic energy of the rock in the first row, a little above the surface: "
    "less than mass times g times height by that way",
    names.BEAM_ENERGY: "largest elastic energy of the beam less that under dead load; (5), (6) "
    "are the equations of Sonoda et al. (1993)",
    names.BEAM_ENERGY_FROM_STRAIN: "the same from the strain at midspan, equation (7) there, as if "
    "the beam were elastic",
    names.GRAVITY_SHARE: "energy that gravity gives to rock, sand and roof from the start to the "
    "end / E0",
    names.DISSIPATED_SHARE: "energy lost in sand and roof / E0; above 100 % where gravity, as rock "
    "and sand sink, has given more than still moves at the end",
    names.REBOUND_SHARE: "kinetic energy that the rock has at the end / E0",
    names.RESIDUAL_SHARE: "error of the balance of energy of all components / E0",
}
"""Sentences by the name of the metric."""
COUPLING_ROW = "coupling A-B / E0"
COUPLING_MEANING = "energy that the exchange between two components has made or lost / E0"
UTILISATION_ROW = "utilisation"
UTILISATION_MEANING = "largest value of the run / the limit of the criterion; above 1 it is passed"
