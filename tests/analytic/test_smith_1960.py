"""A blow with cap block, pile cap and toe soil, against Smith's scheme written here anew.

The example is of the kind of E. A. L. Smith, Pile-driving analysis by the wave equation (1960): a ram
of 5,000 lb, a cap block of 2,000,000 lb/in, a cap of 700 lb, a steel pile of 100 ft, soil at the toe with
Q = 0.1 in and J = 0.15 s/ft. **His printed results could not be read**, so nothing here compares with
the publication: it is an independent computation of his explicit scheme, displacement by displacement.
"""

import numpy as np
import pytest

import rockshed

POUND, INCH, FOOT = 0.45359237, 0.0254, 0.3048
LBF = POUND * 9.80665
RAM, CAP = 5000.0 * POUND, 700.0 * POUND
BLOCK, RESTITUTION = 2e6 * LBF / INCH, 0.5
LENGTH, AREA, MODULUS, DENSITY = 100.0 * FOOT, 15.58 * INCH**2, 30e6 * LBF / INCH**2, 7850.0
QUAKE, DAMPING = 0.1 * INCH, 0.15 / FOOT
SPEED = 12.4 * FOOT


def smith(resistance, elements, fraction=0.5):
    """Smith's explicit scheme: set, largest force in a spring of the pile (m, N).

    D, C, F, R and V stand for what they stand for in his paper. Ram and cap have their weights in
    the blow, as in the program.
    """
    size = LENGTH / elements
    mass = np.array([RAM, CAP, *[DENSITY * AREA * size] * elements])
    k = np.array([BLOCK, *[MODULUS * AREA / size] * elements])
    step = fraction * size / np.sqrt(MODULUS / DENSITY)
    D, V = np.zeros(elements + 2), np.zeros(elements + 2)
    gravity = np.array([9.80665, 9.80665, *[0.0] * elements])
    V[0] = SPEED
    largest, plastic, peak = 0.0, 0.0, 0.0
    for _ in range(int(0.06 / step)):
        D += step * V
        C = D[:-1] - D[1:]
        F = k * C
        largest = max(largest, C[0])
        if C[0] < largest:  # the cap block unloads along k / e^2
            F[0] = BLOCK * largest - BLOCK / RESTITUTION**2 * (largest - C[0])
        F[0] = max(F[0], 0.0)
        F[1] = max(F[1], 0.0)  # the cap lies on the pile
        plastic = max(plastic, D[-1] - QUAKE)
        static = resistance / QUAKE * (D[-1] - plastic)
        R = max(static, 0.0) * (1.0 + DAMPING * V[-1])
        above, below = np.append(0.0, F), np.append(F, R)
        V += step * ((above - below) / mass + gravity)
        peak = max(peak, F[1:].max())
    return plastic, peak


def computed(resistance, segments):
    """The same blow by the exact scheme of the program."""
    site = {
        "segments": segments,
        "time": 0.06,
        "gravity": 0.0,
        "hammer": {"mass": RAM, "drop": SPEED**2 / (2.0 * 9.80665)},
        "cushion": {"stiffness": BLOCK, "restitution": RESTITUTION},
        "helmet": {"mass": CAP},
        "rod": [{"length": LENGTH, "area": AREA, "modulus": MODULUS, "density": DENSITY}],
        "toe": {"resistance": resistance, "quake": QUAKE, "damping": DAMPING},
    }
    (blow,) = rockshed.pile(site).blows
    return blow.set, blow.compression.max() * AREA


@pytest.mark.parametrize("kips", [100.0, 200.0, 300.0])
def test_set_and_largest_force_are_those_of_smiths_scheme(kips):
    resistance = 1e3 * kips * LBF
    permanent, peak = smith(resistance, 200)
    own, own_peak = computed(resistance, 200)
    assert own == pytest.approx(permanent, rel=0.02)
    assert own_peak == pytest.approx(peak, rel=0.02)


def test_ten_feet_elements_as_smith_advises_are_within_a_few_percent():
    resistance = 200e3 * LBF
    coarse = smith(resistance, 10)
    fine = smith(resistance, 200)
    np.testing.assert_allclose(coarse, fine, rtol=0.08)
