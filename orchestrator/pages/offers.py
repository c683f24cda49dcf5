"""The systems that a page has ready: models of the sand, and thicknesses of its layer."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

from rockshed.components.sand_cushion.models import MODELS

from ..cases.sand_models import SandLayer, discs_of
from ..core.errors import InputRefused
from ..runs.chosen import choose
from ..runs.request import Request
from ..runs.system import System
from .impact import SAND, instance_of, kinds_of

_SHARES = (0.5, 0.75, 1.0, 1.25, 1.5, 2.0)
"""Thicknesses that a page offers / that of the case."""
_MOST_DISCS = 6000
"""Discs of an offer, at most: a browser should be done within a minute or two."""
_ROUNDING = 1e-9
_DEFAULT = "calibrated"
"""Model of a case that names none."""


@dataclass(frozen=True)
class Offer:
    """A system that a page has ready.

    Attributes
    ----------
    model : str
        Model of the sand.
    thickness : float
        Of the layer (m).
    system : System
        The system.
    """

    model: str
    thickness: float
    system: System


def offers_of(request: Request) -> list[Offer]:
    """Return the offers of a case or project; the first is what was asked for.

    Parameters
    ----------
    request : Request
        A case or a project; its components run in this process.

    Returns
    -------
    list of Offer
        One alone where the thickness of the layer is no number that can be changed.

    Raises
    ------
    InputRefused
        What was asked for is refused. Other offers that are refused are left out.
    """
    system = System.prepared(request)
    chosen = choose(request, []).case  # of a project: the case that is made of it
    if chosen is None:
        return [Offer("", 0.0, system)]
    if "project" in chosen.facts:
        height = float(chosen.facts["project"]["derived"]["cushion"]["thickness"])
        own = str(chosen.model or "")
        return [Offer(own, height, system), *_of_project(request, own, height)]
    if chosen.layer is None:
        return [Offer("", 0.0, system)]
    own = request.model or chosen.model or _DEFAULT
    return [Offer(own, chosen.layer.height, system), *_of_case(request, own, chosen.layer)]


def _of_project(request: Request, own: str, height: float) -> Iterator[Offer]:
    """Yield a project with other thicknesses of its cushion than its own (m)."""
    for share in _SHARES:
        other = {**request.values, "cushion.thickness": share * height}
        if share != 1.0:
            yield from _prepared(replace(request, values=other), own, share * height)


def _of_case(request: Request, own: str, layer: SandLayer) -> Iterator[Offer]:
    """Yield a case with all models of the sand and thicknesses of its layer but its own."""
    for model in (own, *(name for name in MODELS if name != own)):
        for share in _SHARES:
            height = layer.height if share == 1.0 else _whole_rows(layer, share)
            if (model, share) != (own, 1.0):
                asked = _of_height(request, layer, model, height)
                yield from _prepared(asked, model, height)


def _whole_rows(layer: SandLayer, share: float) -> float:
    """Return a height of whole rows of discs near a share of the layer's (m)."""
    row = 2.0 * layer.disc_radius
    return max(1, round(share * layer.height / row)) * row


def _of_height(request: Request, layer: SandLayer, model: str, height: float) -> Request:
    """Return the request for a case with another model and height of the layer (m)."""
    sizes = {key: size for key, size in request.sizes.items() if key != "sand.discs"}
    if height != layer.height:
        row = 2.0 * layer.disc_radius
        sizes["sand.discs"] = (
            discs_of(replace(layer, height=height), layer.soil.solid_fraction)
            if MODELS[model].prepared
            else math.floor(layer.width / row * (1.0 + _ROUNDING)) * round(height / row)
        )
    return replace(request, model=model, sizes=sizes)


def _prepared(request: Request, model: str, height: float) -> Iterator[Offer]:
    """Yield an offer, unless it is refused or too large for a browser."""
    try:
        system = System.prepared(request)
    except InputRefused:
        return
    sand = next(name for name, kind in kinds_of(system).items() if kind == SAND)
    if instance_of(system, sand).sizes["discs"] <= _MOST_DISCS:
        yield Offer(model, height, system)
