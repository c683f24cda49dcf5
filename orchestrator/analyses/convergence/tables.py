"""Tables of a convergence study for a person."""

from collections.abc import Sequence

from rockshed.components.common.units import mm

from ...tables import Table, digits
from .figures import QUANTITIES, Departure, Measured, PackingMean, Quantity

_SIZES = ("disc radius (mm)", "discs", "elements", "runs")


def mesh_table(found: Sequence[Measured], refined: str) -> Table:
    """Return the figures over the size of what is refined.

    Parameters
    ----------
    found : sequence of Measured
        Of all meshes.
    refined : str
        ``sand discs`` or ``beam elements``.
    """
    headings = [*_SIZES, *(f"{quantity.name} ({quantity.unit})" for quantity in QUANTITIES)]
    table = Table(headings, right=headings, title=f"finer {refined}")
    for entry in found:
        if entry.mesh.refined == refined:
            mesh = entry.mesh
            sizes = (digits(mesh.disc_radius / mm), str(mesh.discs), str(mesh.elements))
            table.add(*sizes, str(entry.runs), *(_cell(entry, quantity) for quantity in QUANTITIES))
    return table


def _cell(entry: Measured, quantity: Quantity) -> str:
    found: PackingMean | None = entry.estimates.get(quantity.name)
    if found is None:
        return ""
    return f"{digits(found.mean / quantity.scale)} ± {digits(found.error / quantity.scale, 2)}"


def departure_table(found: Sequence[Departure]) -> Table:
    """Return how far the project's own mesh is from the finest one.

    Parameters
    ----------
    found : sequence of Departure
        Of all figures.
    """
    headings = ("figure", "refined", "project / finest - 1", "verdict")
    table = Table(headings, right=headings[2:3], title="the project's own mesh beside the finest")
    for entry in found:
        share = f"{100.0 * entry.share:+.1f} ± {100.0 * entry.error:.1f} %"
        table.add(entry.quantity.name, entry.refined, share, entry.verdict)
    return table
