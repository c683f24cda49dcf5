"""Random numbers from a counter.

Number i of stream ``seed`` is a function of the two, so any of them can be had in any order.
SplitMix64 (Steele, Lea and Flood 2014) serves as a hash of seed and counter.
"""

import numpy as np

from .kernels import kernel

_STREAM = np.uint64(0x9E3779B97F4A7C15)
_MIX_1 = np.uint64(0xBF58476D1CE4E5B9)
_MIX_2 = np.uint64(0x94D049BB133111EB)
_30, _27, _31, _11 = np.uint64(30), np.uint64(27), np.uint64(31), np.uint64(11)
_ONE = np.uint64(1)
_UNIT = 1.0 / (1 << 53)
_TURNS = 4


@kernel
def mix(z):
    """Scatter a 64-bit number with the finaliser of SplitMix64, which is a bijection.

    Parameters
    ----------
    z : uint64
        The number.

    Returns
    -------
    uint64
    """
    z = (z ^ (z >> _30)) * _MIX_1
    z = (z ^ (z >> _27)) * _MIX_2
    return z ^ (z >> _31)


@kernel
def stream(seed, number):
    """Return the start of the stream ``number`` among those of ``seed``, for :func:`draw`.

    Parameters
    ----------
    seed : int
        Number that chooses the streams.
    number : int
        Number of the stream.

    Returns
    -------
    uint64
    """
    return mix(mix((np.uint64(seed) + _ONE) * _STREAM) + (np.uint64(number) + _ONE) * _STREAM)


@kernel
def draw(start, counter):
    """Return number ``counter`` of the stream that begins with ``start``, uniform in [0, 1).

    Parameters
    ----------
    start : uint64
        Of :func:`stream`.
    counter : int
        Place in the stream, from 0.

    Returns
    -------
    float
        In [0, 1).
    """
    return float(mix(start + (np.uint64(counter) + _ONE) * _STREAM) >> _11) * _UNIT


@kernel
def shuffled(number, count, key):
    """Return the place of a number in a permutation of 0 ... count - 1 that depends on a key.

    A Feistel network of four rounds permutes 0 ... 4^n - 1, n as small as possible; places beyond
    ``count`` are walked over (Black and Rogaway 2002).

    Parameters
    ----------
    number : int
        From 0 to count - 1.
    count : int
        How many numbers there are.
    key : uint64
        Chooses the permutation.

    Returns
    -------
    int
        From 0 to count - 1.
    """
    half = np.uint64(1)
    while np.uint64(1) << (half + half) < np.uint64(count):
        half += _ONE
    mask = (_ONE << half) - _ONE
    place = np.uint64(number)
    while True:
        left, right = place >> half, place & mask
        for turn in range(_TURNS):
            scattered = mix(np.uint64(key) + right * _STREAM + np.uint64(turn)) & mask
            left, right = right, left ^ scattered
        place = (left << half) | right
        if place < np.uint64(count):
            return int(place)


@kernel
def uniform(seed, counter):
    """Return number ``counter`` of stream ``seed``, uniform in [0, 1).

    Parameters
    ----------
    seed : int
        Number that chooses the streams.
    counter : int
        Place in the stream, from 0.

    Returns
    -------
    float
        In [0, 1).
    """
    return draw(mix((np.uint64(seed) + _ONE) * _STREAM), counter)
