"""Designs: the combinations of values that a study runs."""

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ...core.errors import Problem
from ...core.system.fields import Value
from ..frame import FloatArray
from .factors import Factor

GRID, ONE_AT_A_TIME, RANDOM, HYPERCUBE, SOBOL = "grid", "oat", "random", "lhs", "sobol"
LISTED = "listed"
DESIGNS: Mapping[str, str] = {
    GRID: "every combination of the levels",
    ONE_AT_A_TIME: "each factor alone through its levels, the others as they are",
    LISTED: "the first values of all factors, the second ones, ...",
    RANDOM: "independent random samples",
    HYPERCUBE: "a Latin hypercube",
    SOBOL: "a Sobol sequence, with the runs that Sobol indices need",
}
"""Meaning of each design by name."""
SAMPLED = (RANDOM, HYPERCUBE, SOBOL)
"""Designs that draw values."""
BASE, FIRST, SECOND, MIXED = "base", "A", "B", "AB"
"""Roles of points: nothing varied; the two samples of a Sobol design, and those mixed of both."""
MOST_POINTS = 100_000
"""Points of a study, at most."""


@dataclass(frozen=True)
class DesignPoint:
    """One combination of values.

    Attributes
    ----------
    values : mapping of str to Value
        By the name of the factor, in SI.
    role : str
        Of a design whose points are not alike: :data:`BASE`, :data:`FIRST`, ... ; of a mixed one
        with the number of the factor that is mixed, ``AB0``.
    """

    values: Mapping[str, Value]
    role: str = ""


def design_problems(design: str, factors: Sequence[Factor], samples: int | None) -> list[Problem]:
    """Return what is wrong with a design.

    Parameters
    ----------
    design : str
        Key of :data:`DESIGNS`.
    factors : sequence of Factor
        That vary.
    samples : int, optional
        Number of samples.
    """
    if design not in DESIGNS:
        return [Problem(f"design {design}", "is unknown", f"choose one of {', '.join(DESIGNS)}")]
    problems = []
    if design in SAMPLED:
        if samples is None or samples < 2:
            text = f"a design {design} needs a number of samples, two at least"
            problems.append(Problem("samples", text, "give it: samples=200"))
        if design == SOBOL and samples and samples & (samples - 1):
            text = f"{samples} is no power of 2, which a Sobol sequence needs to be balanced"
            problems.append(Problem("samples", text, f"give {_power_near(samples)}"))
    elif samples is not None:
        text = f"a design {design} has as many points as its levels make"
        problems.append(Problem("samples", text, 'leave it out, or choose design="lhs"'))
    problems += [_level_problem(design, f) for f in factors if _misfit(design, f)]
    if design == LISTED and len(lengths := {len(factor.levels()) for factor in factors}) > 1:
        told = " and ".join(map(str, sorted(lengths)))
        text = f"{told} values do not go together: a design {design} has one of each in a run"
        problems.append(Problem("vary", text, "give as many of all"))
    if not problems and (count := _count(design, factors, samples or 0)) > MOST_POINTS:
        text = f"makes {count:,} points, and {MOST_POINTS:,} are allowed"
        problems.append(Problem(f"design {design}", text, "give fewer levels or samples"))
    return problems


def _misfit(design: str, factor: Factor) -> bool:
    """Tell whether a factor has no levels for a design that needs them, or some for no use."""
    has = bool(getattr(factor.varied, "levels", None))
    return has if design in SAMPLED else not factor.levels()


def _level_problem(design: str, factor: Factor) -> Problem:
    where = f"vary {factor.name}"
    if design in SAMPLED:
        text = f"a design {design} draws from the range, and has no use for a number of levels"
        return Problem(where, text, 'leave the number of levels out, or choose design="grid"')
    if factor.is_distribution:
        text = f"is a distribution, and a design {design} has levels only"
        return Problem(where, text, 'draw samples, with design="lhs" and samples=...')
    text = f"a design {design} needs the number of levels of a range"
    return Problem(where, text, 'give it, LOW..HIGH:4 for four, or choose design="lhs"')


def _power_near(samples: int) -> str:
    below = 1 << (samples.bit_length() - 1)
    return f"{below} or {2 * below}"


def _count(design: str, factors: Sequence[Factor], samples: int) -> int:
    levels = [len(factor.levels()) for factor in factors]
    return {
        GRID: int(np.prod(levels, dtype=np.float64)),
        ONE_AT_A_TIME: 1 + sum(levels),
        LISTED: max(levels, default=0),
        SOBOL: samples * (len(factors) + 2),
    }.get(design, samples)


def points(design: str, factors: Sequence[Factor], samples: int, seed: int) -> list[DesignPoint]:
    """Return the points of a design, in the order in which they are numbered.

    Parameters
    ----------
    design : str
        Key of :data:`DESIGNS`.
    factors : sequence of Factor
        That vary.
    samples : int
        Of a design that draws them; of a Sobol design, of each of its two samples.
    seed : int
        Of the random numbers.

    Returns
    -------
    list of DesignPoint
        The same for the same arguments.
    """
    names = [factor.name for factor in factors]
    if design == GRID:
        combined = itertools.product(*(factor.levels() for factor in factors))
        return [DesignPoint(dict(zip(names, values, strict=True))) for values in combined]
    if design == LISTED:
        together = zip(*(factor.levels() for factor in factors), strict=True)
        return [DesignPoint(dict(zip(names, values, strict=True))) for values in together]
    if design == ONE_AT_A_TIME:
        alone = [DesignPoint({f.name: value}) for f in factors for value in f.levels()]
        return [DesignPoint({}, BASE), *alone]
    if design == SOBOL:
        return _sobol(factors, samples, seed)
    return _drawn(factors, _probabilities(design, samples, len(factors), seed))


def _probabilities(design: str, samples: int, count: int, seed: int) -> FloatArray:
    """Return probabilities, one row for each sample and a column for each factor."""
    from scipy.stats import qmc

    if design == HYPERCUBE:
        found: FloatArray = qmc.LatinHypercube(count, seed=seed).random(samples)
        return found
    return np.random.default_rng(seed).random((samples, count))


def _drawn(
    factors: Sequence[Factor], probabilities: FloatArray, role: str = ""
) -> list[DesignPoint]:
    columns = {f.name: f.at(probabilities[:, i]) for i, f in enumerate(factors)}
    return [
        DesignPoint({name: column[row] for name, column in columns.items()}, role)
        for row in range(len(probabilities))
    ]


def _sobol(factors: Sequence[Factor], samples: int, seed: int) -> list[DesignPoint]:
    """Return the samples A and B, and for each factor A with the values of B for this factor.

    Source: Saltelli et al. 2010, Computer Physics Communications 181, 259-270, table 2 and the
    radial design of the text.
    """
    from scipy.stats import qmc

    count = len(factors)
    both = qmc.Sobol(2 * count, scramble=True, seed=seed).random(samples)
    first, second = both[:, :count], both[:, count:]
    found = [*_drawn(factors, first, FIRST), *_drawn(factors, second, SECOND)]
    for i in range(count):
        mixed = first.copy()
        mixed[:, i] = second[:, i]
        found += _drawn(factors, mixed, f"{MIXED}{i}")
    return found
