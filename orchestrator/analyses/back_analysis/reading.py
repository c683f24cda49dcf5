"""A back-analysis that has been saved, read from its folder to be looked at and drawn again."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ...core.results.reading import undamaged
from ...core.results.run_folder import RUN
from ..rockfall.reading import stored_slope
from .files import read_ends, read_inferred
from .result import BackAnalysisResult


def read_back_analysis(folder: Path, content: Mapping[str, Any]) -> BackAnalysisResult:
    """Read a back-analysis.

    Parameters
    ----------
    folder : Path
        Of its results.
    content : mapping
        Of ``run.json`` there.

    Returns
    -------
    BackAnalysisResult
        As it was saved.

    Raises
    ------
    InputRefused
        The files are damaged, or do not belong together.
    """
    inferred = read_inferred(folder, content)
    fitted, forecast = read_ends(folder, content)
    with undamaged(folder / RUN):
        wall_time = float(content["wall_time"])
    slope = stored_slope(folder, content)
    result = BackAnalysisResult(slope, inferred, fitted, forecast, wall_time)
    result.folder = folder
    return result
