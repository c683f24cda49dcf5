"""Draw `docs/residuals.png`: `python -m docs.residuals` runs all systems of it, some minutes."""

from collections.abc import Sequence
from pathlib import Path

from matplotlib.figure import Figure

from rockshed.analyses.drawing import drawn
from rockshed.bench.residuals import LADDERS, MASTERS, ResidualAndError, measured, of_logarithms
from rockshed.pictures.style import BEAM, INK, ROCK, SAND, WIDTH


def picture(pairs: Sequence[ResidualAndError]) -> Figure:
    """Draw the errors over the residuals, both logarithmic.

    Parameters
    ----------
    pairs : sequence of ResidualAndError
        Of :func:`measured`.
    """
    told = f"{len(pairs)} runs; correlation of the logarithms {of_logarithms(pairs):.3f}"
    with drawn([told], WIDTH, 4.0) as made:
        axes = made.subplots()
        colours = dict(zip(LADDERS, (ROCK, SAND, BEAM, INK), strict=True))
        for case, colour in colours.items():
            for master, marker in zip(MASTERS, "o^", strict=True):
                of_both = [p for p in pairs if (p.case, p.master) == (case, master)]
                axes.loglog(
                    [pair.residual for pair in of_both],
                    [pair.error for pair in of_both],
                    marker,
                    color=colour,
                    mfc="none" if master == "jacobi" else colour,
                    label=f"{case}, {master}",
                )
        for axis in (axes.xaxis, axes.yaxis):
            axis.set_major_formatter(lambda value, place: f"{100.0 * value:g} %")
        axes.set_xlabel("largest energy residual, part of the impact energy")
        axes.set_ylabel("error of the peak transmitted force")
        axes.legend(frameon=False, fontsize="small")
    return made


if __name__ == "__main__":
    picture(measured()).savefig(Path(__file__).with_name("residuals.png"), dpi=100)
