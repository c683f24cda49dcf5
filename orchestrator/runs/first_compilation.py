"""A note to who waits for kernels that are compiled for the first time."""

import logging
from collections.abc import Iterable

from rockshed.components.common.cache import has_kernels
from rockshed.components.common.component import Component

_LOG = logging.getLogger("rockshed")
_told: set[str] = set()
"""Components of which it was said in this process."""


def tell_first_compilation(components: Iterable[Component]) -> None:
    """Say once that kernels are about to be compiled, which takes a minute or two.

    It is a message of the logger ``rockshed``: where nobody has set up logging, in a script or a
    notebook, it appears on stderr. The command line says it in its own way and keeps this one off.

    Parameters
    ----------
    components : iterable of Component
        Components that are about to be computed in this process.
    """
    cold = [made.name for made in components if not has_kernels(made.folder)]
    names = [name for name in dict.fromkeys(cold) if name not in _told]
    if names:
        _told.update(names)
        text = "compiling kernels of %s, once on this machine (a minute or two)"
        _LOG.warning(text, ", ".join(names))
