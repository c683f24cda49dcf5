"""Carry out the blows on a pile."""

import time
from contextlib import ExitStack
from pathlib import Path

from rockshed.components.catalogue import component

from ...runs.first_compilation import tell_first_compilation
from ...sites.pile.preparation import prepare
from ...sites.source import SiteLike
from ..frame import StageProgress, counter, no_progress
from .blows import bearing_graph, drive
from .drivability import drivability
from .result import PileResult
from .rods import rod_blows


def pile(
    site: SiteLike,
    *,
    blows: int | None = None,
    folder: str | Path | None = None,
    pictures: bool = False,
    progress: StageProgress | None = None,
) -> PileResult:
    """Compute blows on a driven pile or rod by the exact scheme of characteristics.

    Parameters
    ----------
    site : path, mapping or PileSite
        Hammer, cushion, rod, soil, bearing graph: a site file (TOML), or its content.
    blows : int, optional
        Number of blows, in the place of the site's.
    folder : path, optional
        Where the results are saved; it appears as a whole or not at all.
    pictures : bool
        Whether figures are drawn and saved too.
    progress : callable, optional
        Called with a stage, and the numbers of its pieces that are done and of all.

    Returns
    -------
    PileResult
        Blows with traces, tables, metrics and figures.

    Raises
    ------
    InputRefused
        Everything that is wrong with the site; nothing was computed.

    Examples
    --------
    >>> import rockshed
    >>> rod = {"length": 10.0, "area": 5.8e-4, "modulus": 2.06e11, "density": 7850.0}
    >>> result = rockshed.pile(
    ...     {
    ...         "segments": 20,
    ...         "hammer": {"mass": 63.5, "drop": 0.75},
    ...         "rod": [rod],
    ...         "toe": {"resistance": 20e3},
    ...     }
    ... )
    >>> result.metrics["blow_1_set"].unit
    'm'
    >>> round(result.metrics["blow_1_set"].value, 4)
    0.0086
    """
    show = progress or no_progress
    prepared = prepare(site, blows)
    with ExitStack() as opened:
        place = opened.enter_context(PileResult.opened(folder)) if folder else None
        tell_first_compilation([component("Hammer"), component("PileRod")])
        began = time.perf_counter()
        struck = drive(prepared, counter(show, "blows"))
        graph = bearing_graph(prepared, counter(show, "bearing graph, resistances"))
        stages = drivability(prepared, counter(show, "drivability, penetrations"))
        rods = rod_blows(prepared, counter(show, "penetration test, rods"))
        wall_time = time.perf_counter() - began
        result = PileResult(prepared, struck, graph, stages, wall_time, rods)
        if place is not None:
            result.write(place, pictures, show)
    result.folder = Path(folder) if folder else None
    return result
