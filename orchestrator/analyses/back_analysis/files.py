"""Files of a back-analysis, beside ``run.json``: what its tables and figures are drawn from again.

=====================  ============================================================================
posterior.parquet      a row for each sample: parameters, logarithm of the likelihood
likelihood.parquet     a row for each sample, a column for each measured value
ends.parquet           a row for each rock: slope (fit or forecast), sample, x; infinite if it left
=====================  ============================================================================
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ...core.results.reading import undamaged
from ...core.results.run_folder import RUN
from ..frame import FloatArray
from .endpoints import Observed
from .forecast import Forecast
from .inferred import Inferred
from .parameters import Parameter
from .sampling import Posterior

SAMPLES, LIKELIHOOD, ENDS = "posterior.parquet", "likelihood.parquet", "ends.parquet"
_FIT, _FORECAST = "fit", "forecast"


def inferred_facts(inferred: Inferred) -> dict[str, Any]:
    """Return the entries of ``run.json`` about samples and measured values."""
    posterior = inferred.posterior
    return {
        "sought": {entry.name: [entry.low, entry.high] for entry in inferred.parameters},
        "observed": [
            {**vars(entry), "values": entry.values.tolist()} for entry in inferred.observed
        ],
        "seed": inferred.seed,
        "trials": inferred.trials,
        "accepted": posterior.accepted,
        "correlation": posterior.correlation if np.isfinite(posterior.correlation) else None,
        "steps": posterior.steps,
    }


def write_details(
    folder: Path, inferred: Inferred, fitted: Forecast, forecast: Forecast | None
) -> list[Path]:
    """Write likelihoods and end points, and return the files."""
    import pyarrow
    import pyarrow.parquet

    pointwise = inferred.posterior.pointwise
    columns = {str(i): pointwise[:, i] for i in range(pointwise.shape[1])}
    made = [(_FIT, fitted), *([(_FORECAST, forecast)] if forecast else [])]
    ends = {
        "slope": np.concatenate([np.full(entry.ends.size, name) for name, entry in made]),
        "sample": np.concatenate(
            [np.repeat(entry.numbers, entry.ends.shape[1]) for _, entry in made]
        ),
        "x": np.concatenate([entry.ends.ravel() for _, entry in made]),
    }
    for name, content in ((LIKELIHOOD, columns), (ENDS, ends)):
        table = pyarrow.table(content)
        pyarrow.parquet.write_table(table, folder / name, compression="zstd")
    return [folder / LIKELIHOOD, folder / ENDS]


def read_inferred(folder: Path, content: Mapping[str, Any]) -> Inferred:
    """Read the samples and what they were inferred from.

    Parameters
    ----------
    folder : Path
        Of the results.
    content : mapping
        Of ``run.json`` there.

    Raises
    ------
    InputRefused
        The files are damaged, or do not belong together.
    """
    with undamaged(folder / RUN):
        sought = content["sought"].items()
        parameters = [Parameter(name, float(low), float(high)) for name, (low, high) in sought]
        observed = [
            Observed(**{**entry, "values": np.array(entry["values"], float)})
            for entry in content["observed"]
        ]
        correlation = content["correlation"]
        facts = (
            float(content["accepted"]),
            np.inf if correlation is None else float(correlation),
            int(content["steps"]),
        )
        numbers = int(content["seed"]), int(content["trials"])
    with undamaged(folder / SAMPLES):
        stored = _columns(folder / SAMPLES)
        places = np.column_stack([entry.place(stored[entry.name]) for entry in parameters])
    with undamaged(folder / LIKELIHOOD):
        stored = _columns(folder / LIKELIHOOD)
        pointwise = np.column_stack([stored[str(i)] for i in range(len(stored))])
        measured = sum(len(entry.values) for entry in observed)
        if pointwise.shape != (len(places), measured):
            raise ValueError("it has other samples or measured values")
    return Inferred(parameters, observed, Posterior(places, pointwise, *facts), *numbers)


def read_ends(folder: Path, content: Mapping[str, Any]) -> tuple[Forecast, Forecast | None]:
    """Read the end points that were computed, those of the fit and of the forecast."""
    with undamaged(folder / ENDS):
        stored = _columns(folder / ENDS)
        fitted = _forecast(str(content["name"]), stored, _FIT)
        other = content["forecast"]
        return fitted, None if other is None else _forecast(str(other), stored, _FORECAST)


def _forecast(name: str, stored: Mapping[str, Any], which: str) -> Forecast:
    rows = stored["slope"] == which
    numbers = np.unique(stored["sample"][rows])
    return Forecast(name, numbers, stored["x"][rows].reshape(len(numbers), -1))


def _columns(path: Path) -> dict[str, FloatArray]:
    import pyarrow.parquet

    with pyarrow.parquet.ParquetFile(path) as file:
        table = file.read()
    return {name: table[name].to_numpy() for name in table.column_names}
