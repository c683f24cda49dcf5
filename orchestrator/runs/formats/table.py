"""Time series as CSV in the form of fmpy: names in quotes, ``time`` first."""

from pathlib import Path

from ...core.results.reading import StoredRun


def write_csv(run: StoredRun, file: Path) -> None:
    """Write the time series; ``fmpy.util.read_csv`` opens it.

    Parameters
    ----------
    run : StoredRun
        The run.
    file : Path
        New file.
    """
    import pyarrow.csv

    pyarrow.csv.write_csv(run.to_arrow(), file)
