"""Results of analyses that have been saved, of whichever analysis they are."""

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ..core.results.reading import undamaged
from ..core.results.run_folder import RUN
from .frame import Result


def saved_result(folder: str | Path) -> Result | None:
    """Read the results of an analysis.

    Parameters
    ----------
    folder : path
        Of the results.

    Returns
    -------
    Result or None
        None where there are no results of an analysis.

    Raises
    ------
    InputRefused
        The files are damaged.
    """
    folder = Path(folder)
    if not os.path.isfile(folder / RUN):
        return None
    with undamaged(folder / RUN):
        content = json.loads((folder / RUN).read_text(encoding="utf-8"))
    if not isinstance(content, dict):
        return None  # what it is no run for is told by whoever reads a run
    kind = content.get("kind")
    if kind == "rockfall":
        from .rockfall.reading import read_campaign

        return read_campaign(folder, content)
    if kind == "study":
        from .study.reading import read_study

        return read_study(folder, content)
    if kind == "rockfall-calibration":
        from .back_analysis.reading import read_back_analysis

        return read_back_analysis(folder, content)
    return _blows(folder, content) if kind == "pile" else None


def _blows(folder: Path, content: Mapping[str, Any]) -> Result:
    """Compute the blows of a pile again, which takes less time than the reading of many traces."""
    from .pile.run import pile

    with undamaged(folder / RUN):
        site = {**content["site"], "name": content["name"]}
    return pile(site)
