"""A shed below a slope: the rock of its campaign, and the slope as a component of its system.

The slope stays in the frame of its profile, so that a trial has the bits of its campaign; what the
component puts out counts from the left support and the top of the roof (``frame.x``, ``frame.y``).
"""

import json
from collections import OrderedDict
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockshed.components.catalogue import component
from rockshed.components.common.units import standard_gravity
from rockshed.components.slope_rockfall.records import ARRIVAL

from ..campaigns.arrivals import Receiver, arrivals_of
from ..campaigns.campaign import Campaign, campaign_of
from ..campaigns.chosen_rock import (
    ENERGY,
    PERCENT,
    Choice,
    ChosenRock,
    choice_problems,
    chosen_place,
    in_words,
)
from ..campaigns.replay import set_rock_of
from ..campaigns.roof import CushionOnProfile, bodies_of, receiver_of, strikes_of
from ..core.errors import InputRefused, Problem
from ..core.system.fields import Value
from ..input_files.places import Places
from ..sites.rockfall.preparation import COMPONENT, PreparedSlope
from ..sites.rockfall.preparation import prepare as prepare_slope
from ..sites.shed.geometry import RockPart, RoofArrival
from ..sites.shed.preparation import Cushioned, SlopeRock
from ..sites.shed.site import ShedProject, SlopeAbove
from ..sites.source import SiteSource
from .slope_parameters import site_parameters

LEAD_TIME = 5e-3
"""Time (s) from the start of a run to the hand-over of the rock."""
SHARED = ("mass", "radius", "gravity")
"""Parameters of the slope that other components have too."""
_STANDS_OUT = 0.05
"""Height (m) by which the ground may stand out of the cushion's surface: rounding of a survey."""
_MOST_KEPT = 4
_arrived: "OrderedDict[str, NDArray[np.float64]]" = OrderedDict()
"""Arrivals of the last campaigns: a study of a shed asks for one of them many times."""


def rock_of_slope(
    project: ShedProject, source: SiteSource, cushioned: Cushioned, problems: list[Problem]
) -> SlopeRock | None:
    """Carry out the campaign of a project's slope, and take its rock.

    Parameters
    ----------
    project : ShedProject
        With a slope.
    source : SiteSource
        Of the project.
    cushioned : Cushioned
        Its cushion.
    problems : list of Problem
        What is wrong with slope, roof or choice is appended. No campaign is carried out where
        anything is.

    Returns
    -------
    SlopeRock or None
        None where anything is wrong.
    """
    wanted = project.slope
    slope = None if wanted is None else _prepared(wanted, source, problems)
    if wanted is None or slope is None:
        return None
    campaign = campaign_of(slope)
    cushion = CushionOnProfile(
        wanted.x + cushioned.left,
        wanted.x + cushioned.right,
        wanted.y,
        wanted.y + cushioned.thickness,
    )
    problems += _place_problems(cushion, slope, campaign, source.places)
    largest = float(bodies_of(campaign)[1].max())
    if 2.0 * largest >= cushion.right - cushion.left:
        problems.append(_too_large(largest, cushion, source.places))
    if problems:
        return None
    receiver = receiver_of(cushion, slope.nodes, largest)
    arrived = _arrivals(slope, campaign, receiver)
    strikes = strikes_of(campaign, arrived, cushion)
    choice = Choice(wanted.quantity or ENERGY, wanted.percentile or PERCENT, wanted.trial)
    keys = (("slope", "x"), ("slope", "percentile"), ("slope", "trial"))
    problems += choice_problems(strikes, choice, arrived, [*map(source.places.of, keys)])
    if problems:
        return None
    place = chosen_place(strikes, choice)
    chosen = ChosenRock(slope, campaign, cushion, receiver, arrived, strikes, choice, place)
    warnings = tuple(f"slope: {text}" for text in slope.warnings)
    return SlopeRock(_rock_part(chosen, wanted), _arrival(chosen, wanted), chosen, warnings)


def _prepared(
    wanted: SlopeAbove, source: SiteSource, problems: list[Problem]
) -> PreparedSlope | None:
    """Return the slope of a project; None where its file is refused."""
    file = source.folder / wanted.file
    if not file.is_file():
        text = f"slope.file: there is no file {file}"
        remedy = "it counts from the folder of the project"
        problems.append(Problem(source.places.of(("slope", "file")), text, remedy))
        return None
    try:
        slope = prepare_slope(file, wanted.trials, wanted.seed)
    except InputRefused as refusal:
        problems += refusal.problems
        return None
    gravity = slope.instance["gravity"]
    if gravity != standard_gravity:
        text = f"model.gravity: {gravity:g} m/s2, and a shed has {standard_gravity:g} m/s2"
        place = slope.source.places.of(("model", "gravity"))
        problems.append(Problem(place, text, "leave it out"))
    return slope


def _place_problems(
    cushion: CushionOnProfile, slope: PreparedSlope, campaign: Campaign, where: Places
) -> Iterator[Problem]:
    """Yield a roof that is not on the profile, or lies in the ground."""
    left, right = campaign.left, campaign.right
    if cushion.left < left or cushion.right > right:
        text = (
            f"slope.x: the cushion lies from {cushion.left:.4g} to {cushion.right:.4g} m, and "
            f"trials are computed from {left:.4g} to {right:.4g} m"
        )
        remedy = "correct it; x is that of the left support on the profile"
        yield Problem(where.of(("slope", "x")), text, remedy)
        return
    above = cushion.ground_above(slope.nodes)
    if above > _STANDS_OUT:
        text = (
            f"slope.y: the profile stands {above:.3g} m out of the cushion, whose surface is at "
            f"{cushion.surface:.4g} m"
        )
        remedy = "correct it; y is that of the roof's top, under the cushion"
        yield Problem(where.of(("slope", "y")), text, remedy)


def _too_large(radius: float, cushion: CushionOnProfile, where: Places) -> Problem:
    """Refuse rocks that are larger than the cushion."""
    text = (
        f"slope.file: the largest rock of the campaign, {2.0 * radius:.4g} m, does not fit on the "
        f"cushion, {cushion.right - cushion.left:.4g} m wide"
    )
    return Problem(where.of(("slope", "file")), text, "widen it, or limit the rocks: to = ...")


def _arrivals(slope: PreparedSlope, campaign: Campaign, receiver: Receiver) -> NDArray[np.float64]:
    """Return the rocks of a campaign at the box; those of the last campaigns are kept."""
    content = [slope.site.model_dump(mode="json"), repr(slope.nodes), repr(receiver)]
    key = json.dumps([*content, campaign.w.tobytes().hex()])
    if key not in _arrived:
        _arrived[key] = arrivals_of(campaign, receiver)
    _arrived.move_to_end(key)
    while len(_arrived) > _MOST_KEPT:
        _arrived.popitem(last=False)
    return _arrived[key]


def _rock_part(chosen: ChosenRock, wanted: SlopeAbove) -> RockPart:
    """Return the rock as it strikes: a sphere of its mass and of the radius of the campaign."""
    strikes, i = chosen.strikes, chosen.place
    mass, radius = float(strikes.mass[i]), float(strikes.radius[i])
    return RockPart(
        mass,
        radius,
        mass / (4.0 / 3.0 * np.pi * radius**3),
        float(strikes.velocity_x[i]),
        float(strikes.velocity_y[i]),
        float(strikes.omega[i]),
        float(strikes.x[i]) - wanted.x,
    )


def _arrival(chosen: ChosenRock, wanted: SlopeAbove) -> RoofArrival:
    """Return the rock as it is handed over."""
    row = chosen.arrived[chosen.trial]
    lead = min(LEAD_TIME, float(row[ARRIVAL.time]))
    return RoofArrival(
        float(row[ARRIVAL.x]) - wanted.x,
        float(row[ARRIVAL.y]) - wanted.y,
        float(row[ARRIVAL.vy]),
        lead,
        lead + float(chosen.strikes.delay[chosen.place]),
    )


# --- the component ---


def cells(chosen: ChosenRock) -> int:
    """Return the number of cells of the profile."""
    return len(chosen.slope.nodes) - 1


def slope_values(chosen: ChosenRock, wanted: SlopeAbove) -> dict[str, Value]:
    """Return the parameters of the slope in a shed's system, but those that others have too.

    Parameters
    ----------
    chosen : ChosenRock
        The rock.
    wanted : SlopeAbove
        Where the roof stands.

    Returns
    -------
    dict of str to Value
        By the name of the parameter of SlopeRockfall.
    """
    instance = component(COMPONENT).instance(cells=cells(chosen))
    instance.w[:] = chosen.campaign.w
    set_rock_of(chosen.campaign, chosen.trial, instance)
    own = site_parameters(instance)
    box = chosen.receiver
    return {
        **{name: value for name, value in own.items() if name not in SHARED},
        "trial": chosen.trial,
        "lead_time": LEAD_TIME,
        "frame.x": wanted.x,
        "frame.y": wanted.y,
        "receiver.present": True,
        "receiver.left": box.left,
        "receiver.bottom": box.bottom,
        "receiver.right": box.right,
        "receiver.top": box.top,
    }


# --- what is told ---


def told(chosen: ChosenRock, wanted: SlopeAbove) -> dict[str, Any]:
    """Return campaign and choice as the provenance of a run keeps them, in SI units.

    Parameters
    ----------
    chosen : ChosenRock
        The rock.
    wanted : SlopeAbove
        Where the roof stands.
    """
    strikes, found = chosen.strikes, chosen.percentile
    share, low, high = chosen.share
    interval = {"low": found.low, "high": found.high} if found else {}
    percent = {"percent": chosen.choice.percent, **interval} if found else {}
    return {
        "name": chosen.slope.name,
        "file": wanted.file,
        "nodes": [[node.x, node.y] for node in chosen.slope.nodes],
        "trajectory": chosen.trajectory(),
        "roof": {
            "x": wanted.x,
            "y": wanted.y,
            "left": chosen.cushion.left,
            "right": chosen.cushion.right,
            "surface": chosen.cushion.surface,
        },
        "barriers": _barriers(chosen),
        "trials": strikes.trials,
        "seed": chosen.campaign.seed,
        "strikes": len(strikes.number),
        "share": {"value": share, "low": low, "high": high},
        "rocks": in_words(strikes),
        "trial": chosen.trial,
        "quantity": chosen.choice.quantity,
        "value": float(chosen.values[chosen.place]),
        **percent,
    }


def _barriers(chosen: ChosenRock) -> list[dict[str, Any]]:
    """Return name, foot and height of the barriers of a slope."""
    lines: Sequence[Any] = chosen.slope.site.barrier
    first = len(chosen.slope.site.line)
    feet = chosen.campaign.lines[first:, :2]
    return [
        {"name": barrier.name, "x": float(x), "y": float(y), "height": barrier.height}
        for barrier, (x, y) in zip(lines, feet, strict=True)
    ]
