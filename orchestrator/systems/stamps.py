"""Stamps of the impact systems: what their measurements follow from, as digests kept with them."""

import numpy as np

from rockshed.fmus.in_process import InProcess

from ..core.fmu.slave import Source
from ..core.run import simulate
from ..papers.kernel_stamps import of_series
from ..runs.subsystem import whole_sizes
from ..temporary import TemporaryFolder
from .system import ImpactSystem


def in_process(system: ImpactSystem) -> dict[str, Source]:
    """Return the components of a system without FMUs, by name, with the bits of its FMUs."""
    return {
        name: InProcess(part.component, whole_sizes(part.component, part.sizes))
        for name, part in system.parts.items()
    }


def stamp(system: ImpactSystem) -> str:
    """Return the digest of a system by the present kernels.

    Parameters
    ----------
    system : ImpactSystem
        Run in this process, all at once, with the step at which its tolerance is stated; the bits
        are those of its FMUs.

    Returns
    -------
    str
        SHA-256 of the quantity, its truth and the energies; see
        :func:`rockshed.papers.kernel_stamps.of_series`.
    """
    made = system.make(dict.fromkeys(system.parts, ""), system.step, "jacobi")
    names = [system.quantity, *system.energies]
    with TemporaryFolder() as folder:
        spec = made.model_copy(update={"record": names, "output_interval": system.step})
        run = simulate(spec, folder / "run", sources=in_process(system), allow_unstable=True)
        columns = {name: np.array(run.series[name]) for name in names}
    return of_series({**columns, "truth": system.truth(system.times(system.step))})
