"""Forces as slower instruments show them: without spikes, and through a load cell."""

import numpy as np

from .values import Samples

_ORDER = 4
"""Order of the low-pass filter; applied forwards and backwards."""
_LOAD_CELL_ORDER = 2
"""Order of the filter that stands for a load cell."""
LOAD_CELL_ROWS = 5.0
"""Rows for each period of a load cell's cut-off that are needed at least."""


def low_pass(time: Samples, values: Samples, cut_off: float) -> Samples | None:
    """Return values without what is faster than a cut-off.

    A Butterworth low-pass filter run forwards and backwards, so that nothing is delayed: it divides
    the spectrum by 1 + (f/cut_off)^(2 order). Beyond both ends the values are continued by their
    reflection. It works on the spectrum because every run shows it, and to import scipy.signal
    takes as long as a short run.

    Parameters
    ----------
    time : array of float, shape (rows,)
        In s, nearly even.
    values : array of float, shape (rows,)
        In any unit.
    cut_off : float
        In Hz.

    Returns
    -------
    array of float, shape (rows,), or None
        None where the rows are too few or too far apart.
    """
    if time.size < 2:
        return None
    rate = (time.size - 1) / (time[-1] - time[0])
    if time.size * cut_off < rate or rate <= 2.0 * cut_off:
        return None
    even = np.linspace(time[0], time[-1], time.size)
    shown = np.interp(even, time, values)
    period = np.concatenate((shown, shown[-2:0:-1]))
    spectrum = np.fft.rfft(period) / (
        1.0 + (np.fft.rfftfreq(period.size, 1.0 / rate) / cut_off) ** (2 * _ORDER)
    )
    filtered = np.fft.irfft(spectrum, period.size)[: shown.size]
    return np.interp(time, even, filtered)


def load_cell(time: Samples, force: Samples, cut_off: float) -> Samples:
    """Return the reading of a load cell.

    A Butterworth low-pass of second order (scipy.signal), the response of an oscillator with the
    damping ratio 1/sqrt(2). It looks back only, so it is delayed; at the start it is steady.

    Parameters
    ----------
    time : array of float, shape (rows,)
        In s, even.
    force : array of float, shape (rows,)
        In N.
    cut_off : float
        In Hz.

    Returns
    -------
    array of float, shape (rows,)
        In N.

    Raises
    ------
    ValueError
        There are fewer than :data:`LOAD_CELL_ROWS` rows for each period of ``cut_off``.
    """
    from scipy.signal import butter, sosfilt, sosfilt_zi

    rate = (time.size - 1) / float(time[-1] - time[0])
    if cut_off * LOAD_CELL_ROWS > rate * (1.0 + 1e-9):
        raise ValueError(
            f"rows {1.0 / rate:.3g} s apart carry a cut-off of "
            f"{rate / LOAD_CELL_ROWS:.4g} Hz, not {cut_off:g}"
        )
    sections = butter(_LOAD_CELL_ORDER, cut_off, fs=rate, output="sos")
    shown: Samples = sosfilt(sections, force, zi=force[0] * sosfilt_zi(sections))[0]
    return shown
