"""pyrockfall on the slope of the rockfall benchmark.

Run as a script: answers lines with a number of trials with CPU seconds. Its model is another one
(coefficients of restitution and friction instead of DRSP's penetration), with values of the usual
size for rock and soil; the price of a trial on this profile is compared.
"""

import sys
import time

import numpy as np

POINTS = (
    (0, 100),
    (6, 96),
    (12, 84),
    (20, 76),
    (26, 64),
    (34, 58),
    (40, 50),
    (47, 45),
    (54, 36),
    (62, 31),
    (70, 24),
    (78, 19),
    (88, 13),
    (98, 9),
    (110, 5),
    (140, 4),
)
ROCK_CELLS = 9


def prepared(trials: int):
    """Return an analysis of so many trials."""
    import pyrockfall as pr

    normal = pr.stats.Normal
    rock = pr.Material("rock", normal(0.45, 0.04), normal(0.85, 0.04), 30.0)
    soil = pr.Material("soil", normal(0.30, 0.04), normal(0.80, 0.04), 30.0)
    cells = len(POINTS) - 1
    slope = pr.Slope(
        pr.Geometry(np.array(POINTS, float)),
        [rock, soil],
        [0] * ROCK_CELLS + [1] * (cells - ROCK_CELLS),
    )
    seeder = pr.Seeder(np.array([[1.0], [102.0]]), [pr.Rock("rock", mass=1361.0, density=2600.0)])
    seeder.translationalVelocity = (1.5, 0.0)
    analysis = pr.Analysis()
    seeder.numberOfRocks = trials
    analysis.slope = slope
    analysis.seeders = [seeder]
    return analysis


def main() -> None:
    """Answer lines until the input ends."""
    if sys.argv[1:] == ["probe"]:
        prepared(2).run()
        return
    for line in sys.stdin:
        analysis = prepared(int(line))
        began = time.process_time()
        analysis.run()
        print(time.process_time() - began, flush=True)


if __name__ == "__main__":
    main()
