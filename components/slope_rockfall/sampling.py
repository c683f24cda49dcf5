"""Random variates: equation (32) and other distributions.

Each is a monotonic function of one uniform number. One number per variate keeps every trial
reproducible by its counter, and lets an analysis use stratified numbers.
"""

import math

from ..common.kernels import kernel
from .declarations import LOGNORMAL, TRIANGULAR, UNIFORM

_ROOT_3, _ROOT_6 = math.sqrt(3.0), math.sqrt(6.0)
_CENTRE_TOP = (
    2.5090809287301226727e3,
    3.3430575583588128105e4,
    6.7265770927008700853e4,
    4.5921953931549871457e4,
    1.3731693765509461125e4,
    1.9715909503065514427e3,
    1.3314166789178437745e2,
    3.3871328727963666080,
)
_CENTRE_BOTTOM = (
    5.2264952788528545610e3,
    2.8729085735721942674e4,
    3.9307895800092710610e4,
    2.1213794301586595867e4,
    5.3941960214247511077e3,
    6.8718700749205790830e2,
    4.2313330701600911252e1,
    1.0,
)
_TAIL_TOP = (
    7.74545014278341407640e-4,
    2.27238449892691845833e-2,
    2.41780725177450611770e-1,
    1.27045825245236838258,
    3.64784832476320460504,
    5.76949722146069140550,
    4.63033784615654529590,
    1.42343711074968357734,
)
_TAIL_BOTTOM = (
    1.05075007164441684324e-9,
    5.47593808499534494600e-4,
    1.51986665636164571966e-2,
    1.48103976427480074590e-1,
    6.89767334985100004550e-1,
    1.67638483018380384940,
    2.05319162663775882187,
    1.0,
)
"""Coefficients of AS 241, highest first: numerators and denominators of the two rational functions,
around the median and in the tails."""


@kernel
def normal_tail(truncation):
    """Return the probability that a standard normal variate lies below -truncation.

    Parameters
    ----------
    truncation : float
        Standard deviations at which the normal distribution is cut off.

    Returns
    -------
    float
        Probability.
    """
    return 0.5 * math.erfc(truncation / math.sqrt(2.0))


@kernel
def normal_quantile(p):
    """Return the inverse of the standard normal distribution, relative error 1e-15.

    Source: Wichura 1988, algorithm AS 241, PPND16.

    Parameters
    ----------
    p : float
        Probability, 3e-12 < p < 1 - 3e-12.

    Returns
    -------
    float
        The variate below which another lies with this probability.
    """
    q = p - 0.5
    if abs(q) <= 0.425:
        r = 0.180625 - q * q
        return q * polynomial(_CENTRE_TOP, r) / polynomial(_CENTRE_BOTTOM, r)
    r = math.sqrt(-math.log(min(p, 1.0 - p))) - 1.6
    return math.copysign(polynomial(_TAIL_TOP, r) / polynomial(_TAIL_BOTTOM, r), q)


@kernel
def polynomial(coefficients, r):
    """Return the value at r of a polynomial, its highest coefficient first.

    Parameters
    ----------
    coefficients : tuple of float
        Of the powers of r, highest first.
    r : float
        Place.

    Returns
    -------
    float
        Value.
    """
    value = 0.0
    for coefficient in coefficients:
        value = value * r + coefficient
    return value


@kernel
def variate(distribution, mean, deviation, tail, u):
    """Return the value of a distribution at a uniform number.

    The deviation is that before the truncation, as in the paper.

    Parameters
    ----------
    distribution : int
        NORMAL, UNIFORM, LOGNORMAL or TRIANGULAR.
    mean, deviation : float
        Mean and standard deviation, in the unit of the variate.
    tail : float
        Of :func:`normal_tail`; the normal variate, and that in the exponent of the lognormal one,
        is truncated there.
    u : float
        Uniform number in [0, 1).

    Returns
    -------
    float
        The variate.
    """
    if deviation == 0.0:
        return mean
    if distribution == UNIFORM:
        return mean + deviation * _ROOT_3 * (2.0 * u - 1.0)
    if distribution == TRIANGULAR:
        side = math.sqrt(2.0 * u) - 1.0 if u < 0.5 else 1.0 - math.sqrt(2.0 - 2.0 * u)
        return mean + deviation * _ROOT_6 * side
    z = normal_quantile(tail + u * (1.0 - 2.0 * tail))
    if distribution == LOGNORMAL:
        variance = math.log1p(deviation * deviation / (mean * mean))
        return mean * math.exp(math.sqrt(variance) * z - 0.5 * variance)
    return mean + deviation * z


@kernel
def widest(distribution, mean, deviation, truncation):
    """Return the largest value that :func:`variate` can have.

    Parameters
    ----------
    distribution : int
        NORMAL, UNIFORM, LOGNORMAL or TRIANGULAR.
    mean : float
        Mean, in the unit of the variate.
    deviation : float
        Standard deviation, likewise.
    truncation : float
        Standard deviations at which the normal distribution is cut off.

    Returns
    -------
    float
        In the unit of the variate.
    """
    if distribution == UNIFORM:
        return mean + deviation * _ROOT_3
    if distribution == TRIANGULAR:
        return mean + deviation * _ROOT_6
    if distribution == LOGNORMAL and deviation > 0.0:
        variance = math.log1p(deviation * deviation / (mean * mean))
        return mean * math.exp(math.sqrt(variance) * truncation - 0.5 * variance)
    return mean + deviation * truncation
