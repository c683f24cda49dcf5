"""Impacts at full scale as tasks: models of the sand, and seeds.

Each model has one assumption more, or another one, than the one before.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from rockshed.components.common.units import cm, kgf, ms, standard_gravity, tf

from ...cases.full_scale import LAYER, ROCK_MASS, ROCK_RADIUS, ROCK_SPEED
from ...cases.sand_models import LATTICE_SHIFT, LOOSE
from ...core.system.fields import Value
from ...metrics.filtering import low_pass
from ...metrics.names import SETTLED_CUT_OFF
from ...runs.batch import COMPLETE, Outcome, Task
from ...runs.job import Request
from ..study import shortened
from .laboratory import ONE_LAW

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@dataclass(frozen=True)
class Model:
    """Model of the sand and of the masses on the girders.

    Attributes
    ----------
    name : str
        For the reader.
    values : mapping of str to Value
        By ``sand.parameter``.
    girders : mapping of str to Value
        By ``beam.parameter``, on girders only.
    pack : bool
        Whether discs are a random pack, of which a seed gives another one; else a seed shifts the
        lattice.
    quick : bool
        Whether a quick reproduction has it.
    law : str, optional
        Model of the sand by name, which says where the rock starts.
    """

    name: str
    values: Mapping[str, Value] = field(default_factory=dict)
    girders: Mapping[str, Value] = field(default_factory=dict)
    pack: bool = True
    quick: bool = False
    law: str | None = None


FREE: Mapping[str, Value] = {
    "sand.rotation": "free",
    "sand.stiffness_factor": 1.0,
    "sand.disc.spread": 0.25,
    "sand.settling.time": 8.0,
}
PACK: Mapping[str, Value] = {**FREE, "sand.packing": "random"}
"""Random pack of discs +-25 % in size that turn, with the stiffness of eq. (1).

Discs of 10 cm need longer to settle.
"""
ROLLING: Mapping[str, Value] = {**PACK, "sand.rolling_resistance": 0.3}
POURED: Mapping[str, Value] = {
    **FREE,
    "sand.packing": "prepared",
    "sand.solid_fraction": 0.74,
    "sand.rolling_resistance": 0.3,
}
"""The same brought to the solid fraction of poured sand: no pack is looser than another."""
BULK: Mapping[str, Value] = {"sand.density_of": "layer"}
"""0.0018 kgf/cm3 as the unit weight of the layer instead of that of a disc."""
UNLOADING: Mapping[str, Value] = {"sand.unloading_ratio": 3.0}
"""Unloading stiffness / loading stiffness of the contacts (Walton and Braun)."""
COHESION: Mapping[str, Value] = {"sand.cohesion": 0.05 * kgf / cm**2}
"""0.05 kgf/cm2, by capillary bridges (Rumpf)."""
DECK_AND_BOX: Mapping[str, Value] = {"beam.deck.mass": 200, "beam.box.mass": 2000}
"""Assumed masses (kg/m, kg); the paper says nothing of them."""

MODELS = (
    Model("calibrated", pack=False, quick=True),
    Model("literal", pack=False, quick=True, law="literal"),
    Model("random pack", PACK),
    Model("random pack, rolling", ROLLING),
    Model("poured", POURED, quick=True),
    Model("poured, bulk weight", {**POURED, **BULK}),
    Model("poured, deck and box", POURED, DECK_AND_BOX),
    Model("poured, unloading 3", {**POURED, **UNLOADING}),
    Model("poured, cohesion", {**POURED, **COHESION}),
    Model("poured, all together", {**POURED, **BULK, **UNLOADING, **COHESION}, DECK_AND_BOX),
    Model("one-law", law=ONE_LAW, quick=True),
    Model("one-law, elastic", {"sand.unloading_ratio": 1.0}, law=ONE_LAW),
    Model("one-law, deck and box", {}, DECK_AND_BOX, law=ONE_LAW),
    Model("one-law, as poured", {"sand.solid_fraction": LOOSE}, law=ONE_LAW),
    Model("one-law, dry", {"sand.cohesion": 0.0}, law=ONE_LAW),
)
"""All models, in the order of the report."""
SEEDS = range(1, 9)

_FREE_HEIGHT = 1.25
"""Height (m) above the base, from which a rock does not start inside a random pack."""


def models(quick: bool, on_girders: bool) -> list[Model]:
    """Return the models of a reproduction.

    Parameters
    ----------
    quick : bool
        Fewest models.
    on_girders : bool
        Else without those that differ in the girders only.
    """
    return [
        model
        for model in MODELS
        if (model.quick or not quick) and (on_girders or not model.girders)
    ]


ONE_SAND = "crushed"
"""Sand on the rigid base with which packings are computed.

To a law with a modulus of its own all three are one.
"""


def sands(model: Model, all_sands: Sequence[str]) -> Sequence[str]:
    """Return the sands on the rigid base that are computed with a model."""
    return [ONE_SAND] if model.pack else all_sands


def impacts(case: str, model: Model, quick: bool, stop_time: float) -> list[Task]:
    """Return one impact for each seed.

    Parameters
    ----------
    case : str
        Name of the case.
    model : Model
        Model of the sand.
    quick : bool
        One run, on the undisturbed lattice or a single pack.
    stop_time : float
        End of the runs (s).
    """
    on_girders = case.startswith("girders")

    def task(seed: int | None) -> Task:
        values = dict(model.values)
        if on_girders:
            values |= model.girders
        if model.pack and not model.law:
            values |= _above_pack()
        if seed is not None:
            values["sand.seed"] = seed
        if seed is not None and not model.pack:
            values["sand.lattice_shift"] = LATTICE_SHIFT
        request = Request(
            case, values, coupling="impulse", options={"stop_time": stop_time}, model=model.law
        )
        return Task(request, model.name, seed)

    if quick:
        return [task(SEEDS[0] if model.pack else None)]
    return [task(seed) for seed in SEEDS]


def _short(case: str) -> dict[str, Request]:
    """Return beginnings of an impact with models that together have everything of the others."""
    names = ("calibrated", "literal", "poured, all together", "one-law")
    chosen = {model.name: model for model in MODELS if model.name in names}
    return {
        f"{case}, {name}": shortened(impacts(case, model, False, 1.0)[0], 0.03)
        for name, model in chosen.items()
    }


def _above_pack() -> dict[str, Value]:
    """Return a start above every pack, from which the rock has its speed at the lattice."""
    fallen = 2.0 * standard_gravity * (_FREE_HEIGHT - LAYER)
    return {
        "rock.position0.y": _FREE_HEIGHT + ROCK_RADIUS,
        "rock.velocity0.y": -math.sqrt(ROCK_SPEED**2 - fallen),
    }


SHORT_RIGID = _short(f"rigid-base-{ONE_SAND}")
SHORT_GIRDERS = _short("girders-8")
"""Beginnings of impacts, which studies at full scale stand on."""


IMPACT_ENERGY = 0.5 * ROCK_MASS * ROCK_SPEED**2
"""Kinetic energy (J) of the rock where it meets the sand, wherever it started."""


def share(figure: str) -> Callable[[Outcome], float]:
    """Return the function of a peak energy of the girders as a part of the impact's."""
    return lambda outcome: outcome.metrics[figure] / IMPACT_ENERGY


def plot_forces(axes: "Axes", outcome: Outcome) -> None:
    """Draw transmitted and rock force (tf) over time (ms): as computed, thin, and settled."""
    from ...pictures.style import ROCK, TRANSMITTED

    for column, colour, name in (
        ("transmitted_force", TRANSMITTED, "transmitted"),
        ("rock.force.y", ROCK, "on the rock"),
    ):
        if outcome.status == COMPLETE:
            time, force = outcome.series["time"], outcome.series[f"sand.{column}"]
            smooth = low_pass(time, force, outcome.metrics[SETTLED_CUT_OFF])
            axes.plot(time / ms, force / tf, color=colour, linewidth=0.5, alpha=0.55)
            if smooth is not None:
                axes.plot(time / ms, smooth / tf, color=colour, linewidth=1.4, label=name)
    axes.set_xlim(0.0, None)


SEED_NOTE = (
    f"Mean and standard deviation over {len(SEEDS)} seeds: random packs, or a lattice shifted by "
    f"{LATTICE_SHIFT:g} diameters. In a quick reproduction one run, and fewer models."
)
STEP_NOTE = (
    "Sand first, kinematics extrapolated, mean forces. Rigid base: exchange every 0.2 ms, sand "
    "every 0.05 ms. Girders: exchange every 0.1 ms, sand every 0.0125 ms, girders every 0.01 ms. "
    "With calibrated sand forces are within 0.1 % of those with an exchange at every step of the "
    "sand; packs are chaotic, their seeds tell how much."
)
