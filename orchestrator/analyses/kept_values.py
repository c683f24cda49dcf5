"""Values of costly functions, kept until a search has ended: what is killed goes on there.

A search that takes the same steps from the same values needs nothing else to go on: it begins
again, and finds what it had computed.
"""

from collections.abc import Callable
from pathlib import Path
from threading import Lock
from types import TracebackType
from typing import Self

import numpy as np

from ..kept_parts import Arrays, KeptParts, digest_of
from ..versions import sources_digest, versions
from .frame import FloatArray

Function = Callable[[FloatArray], FloatArray]
"""Returns values, as many for each place, that follow from the place alone."""
_PLACES, _VALUES = "places", "values"
_PROGRAM = ("analyses", "campaigns", "sites")
"""Rooms of the package from which values follow, besides the components."""


class KeptValues:
    """Values that have been computed, in a folder. A context manager.

    What waits is written down every few seconds, and when the block is left early; at its end
    everything that is kept is removed.

    Parameters
    ----------
    folder : Path or None
        Is made with the first values that are kept; None keeps nothing.
    """

    def __init__(self, folder: Path | None) -> None:
        self._parts = KeptParts(folder, "values") if folder else None
        self._functions: list[_Kept] = []

    def of(self, function: Function, *about: object) -> Function:
        """Return a function that computes only values that are not kept.

        Parameters
        ----------
        function : callable
            May be called by several threads at once.
        *about
            Everything that its values follow from but the place, see
            :func:`~rockshed.kept_parts.digest_of`.

        Returns
        -------
        callable
            With the same values, to the bit.
        """
        if self._parts is None:
            return function
        stamp = (sources_digest(*_PROGRAM), versions("numpy", "numba"))
        kept = _Kept(function, self._parts, digest_of(stamp, *about))
        self._functions.append(kept)
        return kept

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, _: BaseException | None, __: TracebackType | None
    ) -> None:
        if kind is not None:
            for function in self._functions:
                function.write()
        elif self._parts is not None:
            self._parts.clear()


class _Kept:
    """A function whose values are kept.

    Parameters
    ----------
    function : callable
        Computes them.
    parts : KeptParts
        In which they are kept.
    digest : str
        Of what they follow from.
    """

    def __init__(self, function: Function, parts: KeptParts, digest: str) -> None:
        self._function, self._parts, self._digest = function, parts, digest
        self._known: dict[bytes, FloatArray] = {}
        self._waiting: list[tuple[FloatArray, FloatArray]] = []
        self._lock = Lock()
        parts.read(digest, self._take)

    def _take(self, _number: int, content: Arrays) -> None:
        """Take the values of a file.

        Raises
        ------
        ValueError
            It has none, or not one for each place.
        """
        places, values = content[_PLACES], content[_VALUES]
        if any(array.dtype != np.float64 or array.ndim != 2 for array in (places, values)):
            raise ValueError("it has values of another kind")
        pairs = list(zip(places, values, strict=True))
        self._known |= {place.tobytes(): value for place, value in pairs}

    def __call__(self, place: FloatArray) -> FloatArray:
        """Return the values at a place."""
        known = self._known.get(place.tobytes())
        if known is not None:
            return known
        value = self._function(place)
        with self._lock:
            self._known[place.tobytes()] = value
            self._waiting.append((place.copy(), value))
            if self._parts.is_due:
                self._write()
        return value

    def write(self) -> None:
        """Write down the values that wait."""
        with self._lock:
            self._write()

    def _write(self) -> None:
        if not self._waiting:
            return
        places, values = map(np.array, zip(*self._waiting, strict=True))
        self._waiting = []
        number = self._parts.next_number(self._digest)
        self._parts.write(self._digest, {number: {_PLACES: places, _VALUES: values}})
