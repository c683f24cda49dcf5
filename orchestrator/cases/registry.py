"""The ready-made cases by name: their components, sizes, couplings and references."""

import math
from collections.abc import Callable, Collection, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cache, partial
from pathlib import Path
from typing import Any, cast

from rockshed.components.catalogue import component
from rockshed.components.common.units import ms

from ..core.errors import InputRefused, Problem
from ..core.system.fields import Value
from ..core.system.names import nearest
from ..core.system.system import SystemSpec
from ..references import References
from . import full_scale, shed_on_piles, slope_to_cushion, sonoda1993, spt
from . import static_loading as static_test
from .iterated import AS_IMPULSE, IteratedTimes, couplings_with_implicit, deriving, making
from .sand_models import Changes, SandLayer, Soil, changes, sand_model
from .together import ComponentSizes, declared_value, described, moved


def _as_it_is(own: SystemSpec, system: SystemSpec, sizes: ComponentSizes) -> str:
    """Return the description that a system has, whatever its values."""
    return system.description


@dataclass(frozen=True)
class Case:
    """A ready-made system.

    Attributes
    ----------
    name, summary : str
        Name of the case, and its content in a line.
    models : mapping of str to str
        Component of the catalogue that the FMU of each component of the system is built from.
    sizes : mapping of str to mapping of str to int
        Sizes of the FMUs that differ from the defaults, by component.
    couplings : mapping of str to str
        Schemes of exchange by name, the default first, with a description.
    make : callable
        ``make(fmus, sizes, coupling)`` returns the system; ``fmus`` are the files of the FMUs by
        component.
    one_size : tuple of str
        Sizes, ``component.size``, that are one number for all of them.
    derived : callable
        ``derived(system, sizes)`` returns values, by ``component.parameter``, that follow from
        others where they are not given.
    layer : SandLayer or None
        The sand, for the models of it.
    references : callable
        ``references(changed)`` returns what others found, for a run with other values or sizes by
        ``component.name``.
    model : str or None
        Model of the sand that fits the case best, where none is asked for; None for the case as
        it is.
    coupling : str or None
        Scheme of exchange where none is asked for; None for the first.
    other_names : tuple of str
        Further names of the case.
    follows : mapping of str to str
        Values, by ``component.parameter`` or name of a shared value, that cannot be set apart from
        what they follow from.
    described : callable
        ``described(own, system, sizes)`` returns the description of a run from its values; ``own``
        is the system of the case.
    facts : mapping
        For the provenance of its runs: ``design``, ``project``.
    warnings : tuple of str
        Of its values.
    files : callable or None
        Writes further files into the folder of a run.
    """

    name: str
    summary: str
    models: Mapping[str, str]
    sizes: ComponentSizes
    couplings: Mapping[str, str]
    make: Callable[[Mapping[str, str], ComponentSizes, str], SystemSpec]
    one_size: tuple[str, ...] = ()
    derived: Callable[[SystemSpec, ComponentSizes], Mapping[str, Value]] = lambda system, sizes: {}
    layer: SandLayer | None = None
    references: Callable[[Mapping[str, Value]], References] = lambda changed: References()
    model: str | None = None
    coupling: str | None = None
    other_names: tuple[str, ...] = ()
    follows: Mapping[str, str] = field(default_factory=dict)
    described: Callable[[SystemSpec, SystemSpec, ComponentSizes], str] = _as_it_is
    facts: Mapping[str, Any] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()
    files: Callable[[Path], None] | None = None


@cache
def cases() -> dict[str, Case]:
    """Return all cases by name, ``lab-impact`` first."""
    found = [_laboratory(test) for test in sonoda1993.tests().values()]
    found.sort(key=lambda case: case.name != sonoda1993.case_name(sonoda1993.DEFAULT_TEST))
    listed = [
        *found,
        _static_test(),
        *map(_full_scale, full_scale.impacts().values()),
        _slope_to_cushion(),
    ]
    return {
        case.name: case
        for case in [
            *map(with_implicit, listed),
            with_implicit(_shed_on_piles(), shed_on_piles.WINDOW),
            _spt(),
        ]
    }


def with_implicit(chosen: Case, window: IteratedTimes = AS_IMPULSE) -> Case:
    """Return a case that can be run by the scheme ``implicit`` too.

    Parameters
    ----------
    chosen : Case
        Its coupling ``impulse`` is what is iterated.
    window : IteratedTimes
        Times that are other than there.
    """
    rods = [name for name, made in chosen.models.items() if made == "PileRod"]
    return replace(
        chosen,
        couplings=couplings_with_implicit(chosen.couplings, window),
        make=making(chosen.make, rods, window),
        derived=deriving(chosen.derived),
    )


def case(name: str) -> Case:
    """Return a case by one of its names.

    Parameters
    ----------
    name : str
        Name of the case.

    Returns
    -------
    Case
        The case.

    Raises
    ------
    InputRefused
        There is no such case.
    """
    found = _found(name)
    if found is None:
        raise InputRefused([Problem(name, "there is no case of this name", nearest(name, cases()))])
    return found


def is_case(name: str) -> bool:
    """Tell whether there is a case of this name."""
    return _found(name) is not None


def _found(name: str) -> Case | None:
    every = cases().values()
    return next((case for case in every if name in (case.name, *case.other_names)), None)


def model_changes(chosen: Case, name: str | None, values: Mapping[str, Value]) -> Changes:
    """Return what is other in a case with a model of the sand.

    Parameters
    ----------
    chosen : Case
        The case.
    name : str or None
        Name of the model; None for the case as it is.
    values : mapping of str to Value
        Values by ``component.parameter`` that are asked for; those of the soil count.

    Returns
    -------
    Changes
        Values, sizes and keys of the system.

    Raises
    ------
    InputRefused
        There is no such model, or the case has no sand.
    """
    if name is None:
        return Changes()
    model = sand_model(name)
    layer = chosen.layer
    if layer is None:
        raise InputRefused(
            [
                Problem(
                    f"model {name}",
                    f"{chosen.name} has no sand that takes a model",
                    "leave it out",
                )
            ]
        )
    with suppress(ValueError):  # a value that is no number: the FMU says so
        cohesion, solid = (
            float(values.get(f"sand.{key}", own)) for key, own in vars(layer.soil).items()
        )
        return changes(model, layer, Soil(cohesion, solid))
    return changes(model, layer)


def differences(
    chosen: Case,
    base: SystemSpec,
    given: Mapping[str, Value],
    sizes: ComponentSizes,
    own: ComponentSizes,
) -> dict[str, Value]:
    """Return what a run has other than its case.

    Parameters
    ----------
    chosen : Case
        The case that is run.
    base : SystemSpec
        The system of the case in the sizes of the run, before any value is changed.
    given : mapping of str to Value
        Values by ``component.parameter`` or name of a shared value, and keys of the system.
    sizes, own : mapping of str to sizes
        Sizes by component: those of the run, and those of the case.

    Returns
    -------
    dict of str to Value
        Values, keys of the system and sizes, by ``component.name``, that differ.
    """
    values = {
        name: value
        for name, value in given.items()
        if not _same(value, _own_value(chosen, base, name))
    }
    others: dict[str, Value] = {
        f"{owner}.{size}": number
        for owner, built in sizes.items()
        for size, number in built.items()
        if number != own.get(owner, {}).get(size)
    }
    return values | others


def told_once(
    chosen: Case, base: SystemSpec, differing: Mapping[str, Value], asked: Collection[str]
) -> dict[str, Value]:
    """Return differences in which a value that several components take stands once.

    Parameters
    ----------
    chosen : Case
        The case that is run.
    base : SystemSpec
        The system of the case.
    differing : mapping of str to Value
        From :func:`differences`.
    asked : collection of str
        Names that were given; the first of them stands for the others.
    """
    groups = [{key, *entry.targets} for key, entry in base.shared.items()]
    left_out: set[str] = set()
    for group in [*groups, {*chosen.one_size}]:
        names = [name for name in differing if name in group]
        first = [*(name for name in asked if name in names), *names][:1]
        left_out |= {*names} - {*first}
    return {name: value for name, value in differing.items() if name not in left_out}


def references(chosen: Case, differing: Mapping[str, Value]) -> References:
    """Return what others found for a case, as far as a run is theirs.

    Parameters
    ----------
    chosen : Case
        The case that is run.
    differing : mapping of str to Value
        What the run has other than the case, from :func:`differences`.

    Returns
    -------
    references : References
        What is known, and why something is not compared.
    """
    keys = {*SystemSpec.model_fields} - {"scenario"}  # how a case is run; a scenario disturbs it
    return chosen.references({name: value for name, value in differing.items() if name not in keys})


def _own_value(chosen: Case, system: SystemSpec, name: str) -> Value | None:
    """Return the value of a parameter or a shared value in a case; None if there is none."""
    if name in SystemSpec.model_fields:
        return cast(Value | None, getattr(system, name))
    for key, entry in system.shared.items():
        if name == key or name in entry.targets:
            return entry.value
    owner, _, port = name.partition(".")
    if owner not in chosen.models:
        return None
    if port in system.components[owner].parameters:
        return system.components[owner].parameters[port]
    return declared_value(component(chosen.models[owner]), port)


def _same(one: Value, other: Value | None) -> bool:
    """Tell whether two values are equal as numbers, or else as texts."""
    try:
        return other is not None and math.isclose(float(one), float(other), rel_tol=1e-9)
    except (TypeError, ValueError, OverflowError):  # an integer of hundreds of digits
        return str(one) == str(other)


def _laboratory(test: sonoda1993.Test) -> Case:
    def make(fmus: Mapping[str, str], sizes: ComponentSizes, coupling: str) -> SystemSpec:
        return sonoda1993.lab_system(
            fmus,
            test,
            coupling,
            sizes["sand"]["discs"],
            sizes["beam"]["elements"],
        )

    name = sonoda1993.case_name(test.number)
    numbered = f"lab-impact-{test.number}"
    return Case(
        name,
        f"Sonoda et al. 1993, laboratory, test {test.number}: {test.state}",
        models={"sand": "SandCushion", "rock": "FallingRock", "beam": "RBSMBeam"},
        sizes={
            "sand": {"discs": sonoda1993.discs_in(test.box), "elements": sonoda1993.ELEMENTS},
            "beam": {"elements": sonoda1993.ELEMENTS},
        },
        couplings={
            "paper": "sand first, inputs held, exchange every 0.01 ms",
            "impulse": "sand first, kinematics extrapolated, mean forces, exchange every 0.1 ms",
            "jacobi": "all at once, inputs held, exchange every 0.1 ms",
        },
        make=make,
        one_size=("sand.elements", "beam.elements"),
        references=partial(sonoda1993.references, test),
        layer=sonoda1993.layer(test),
        derived=partial(moved, sonoda1993.layer(test)),
        described=partial(described, sonoda1993.layer(test)),
        other_names=(numbered,) if numbered != name else (),
    )


def _static_test() -> Case:
    def make(fmus: Mapping[str, str], sizes: ComponentSizes, coupling: str) -> SystemSpec:
        return static_test.static_system(fmus, coupling, sizes["sand"]["discs"])

    return Case(
        static_test.NAME,
        "Sonoda et al. 1993, static test: a disc of 9.9 cm pushed 4 cm into the sand at 1 cm/s, "
        "rigid floor",
        models={"sand": "SandCushion", "rock": "FallingRock"},
        sizes={"sand": {"discs": static_test.DISCS, "elements": 1}},
        couplings={
            "impulse": "sand first, kinematics extrapolated, mean forces, exchange every 1 ms",
            "paper": "sand first, inputs held, exchange every 0.01 ms",
        },
        make=make,
        references=static_test.references,
        layer=static_test.LAYER_OF_SAND,
        derived=partial(moved, static_test.LAYER_OF_SAND),
    )


_RODS = tuple(f"rod_{side}" for side in shed_on_piles.SIDES)


def _shed_on_piles() -> Case:
    def make(fmus: Mapping[str, str], sizes: ComponentSizes, coupling: str) -> SystemSpec:
        return shed_on_piles.shed_system(
            fmus, sizes["sand"]["discs"], sizes["sand"]["elements"], sizes["rod_left"]["segments"]
        )

    def derived(system: SystemSpec, sizes: ComponentSizes) -> Mapping[str, Value]:
        values = moved(layer, system, sizes)
        with suppress(ValueError, ArithmeticError):  # no number, or 0: the FMU says so
            counts = sizes["sand"]["discs"], sizes["beam"]["elements"]
            values |= shed_on_piles.derived(system, *counts)
        return values

    impact = full_scale.impacts()[shed_on_piles.GIRDERS]
    layer = full_scale.layer(impact)
    elements = {"elements": impact.elements}
    return Case(
        shed_on_piles.NAME,
        "the girders of 8 m on two piles in the ground, assumed",
        models={
            **{"sand": "SandCushion", "rock": "FallingRock", "beam": "RBSMBeam"},
            **dict.fromkeys(_RODS, "PileRod"),
            **{f"ground_{side}": "ImpulsiveGround" for side in shed_on_piles.SIDES},
        },
        sizes={
            "sand": {"discs": impact.discs, **elements},
            "beam": elements,
            **{rod: {"segments": shed_on_piles.PILE.segments} for rod in _RODS},
        },
        couplings={"impulse": shed_on_piles.COUPLING},
        make=make,
        one_size=("sand.elements", "beam.elements"),
        derived=derived,
        described=partial(described, layer),
        layer=layer,
        facts=_designed(impact),
    )


def _spt() -> Case:
    def make(fmus: Mapping[str, str], sizes: ComponentSizes, coupling: str) -> SystemSpec:
        return spt.spt_system(fmus, coupling)

    def derived(system: SystemSpec, sizes: ComponentSizes) -> Mapping[str, Value]:
        with suppress(
            ValueError, ZeroDivisionError
        ):  # a value that is no number, or 0: its FMU says so
            return spt.partner_stiffness(system)
        return {}

    return Case(
        spt.NAME,
        "Uto et al., table 1: standard penetration test, hammer, rod and ground",
        models={"hammer": "Hammer", "rod": "PileRod", "ground": "ImpulsiveGround"},
        sizes={"rod": {"segments": spt.SEGMENTS}},
        couplings={
            "waves": "rod last, waves at head and toe, exchange every 0.1 ms",
            "plain": "rod last, waves at the head, motion and held force at the toe, exchange "
            "every 0.01 ms",
        },
        make=make,
        derived=derived,
    )


def _full_scale_couplings(impact: full_scale.Impact) -> Mapping[str, str]:
    paper, impulse = (f"{impact.steps[name] / ms:g} ms" for name in ("paper", "impulse"))
    return {
        "paper": f"sand first, inputs held, exchange every {paper}",
        "impulse": f"sand first, kinematics extrapolated, mean forces, exchange every {impulse}",
    }


def weight_on_beam(system: SystemSpec, sizes: ComponentSizes) -> Mapping[str, Value]:
    """Return the weight of the sand, under which a beam starts bent.

    Parameters
    ----------
    system : SystemSpec
        With sand, and a beam or none.
    sizes : mapping of str to sizes
        Sizes by component.

    Returns
    -------
    mapping of str to Value
        By ``component.parameter``; empty without a beam.
    """
    with suppress(ValueError):  # a value of the sand that is no number: its FMU says so
        return (
            {"beam.cushion.weight": full_scale.cushion_weight(system, sizes["sand"]["discs"])}
            if "beam" in sizes
            else {}
        )
    return {}


def _full_scale(impact: full_scale.Impact) -> Case:
    def make(fmus: Mapping[str, str], sizes: ComponentSizes, coupling: str) -> SystemSpec:
        return full_scale.full_scale_system(
            fmus,
            impact,
            coupling,
            sizes["sand"]["discs"],
            sizes["sand"]["elements"],
        )

    def derived(system: SystemSpec, sizes: ComponentSizes) -> Mapping[str, Value]:
        return {**weight_on_beam(system, sizes), **moved(layer, system, sizes)}

    layer = full_scale.layer(impact)
    beam = {"beam": "RBSMBeam"} if impact.span else {}
    elements = {"elements": impact.elements}
    return Case(
        impact.name,
        f"Sonoda et al. 1993, full scale: {impact.summary}",
        models={"sand": "SandCushion", "rock": "FallingRock", **beam},
        sizes={"sand": {"discs": impact.discs, **elements}, **dict.fromkeys(beam, elements)},
        couplings=_full_scale_couplings(impact),
        make=make,
        one_size=("sand.elements", "beam.elements") if beam else (),
        derived=derived,
        references=partial(full_scale.references, impact),
        layer=layer,
        described=partial(described, layer),
        model=full_scale.GIRDERS_MODEL if impact.span else None,
        facts=_designed(impact),
    )


def _designed(impact: full_scale.Impact) -> Mapping[str, Any]:
    """Return the design of girders as facts of a case, none on a rigid base."""
    found = full_scale.design(impact)
    return {"design": found} if found else {}


def _slope_to_cushion() -> Case:
    def make(fmus: Mapping[str, str], sizes: ComponentSizes, coupling: str) -> SystemSpec:
        return slope_to_cushion.slope_system(
            fmus,
            coupling,
            sizes["sand"]["discs"],
            sizes["sand"]["elements"],
        )

    impact = slope_to_cushion.IMPACT
    elements = {"elements": impact.elements}
    return Case(
        impact.name,
        f"Slope, sand and girders: {impact.summary}",
        models={"sand": "SandCushion", "rock": "SlopeRockfall", "beam": "RBSMBeam"},
        sizes={
            "sand": {"discs": impact.discs, **elements},
            "beam": elements,
            "rock": {"cells": slope_to_cushion.cells()},
        },
        couplings=_full_scale_couplings(impact),
        make=make,
        one_size=("sand.elements", "beam.elements"),
        derived=weight_on_beam,
        layer=slope_to_cushion.sand_layer(),
        follows=dict.fromkeys(
            ("beam.span", "beam.axis.x", "box_left", "sand.box.left", "beam.box.left"),
            "the slope of this case, on which the roof stands",
        ),
        facts=_designed(impact),
    )
