"""The ready-made cases by name: which components they need, in which sizes, and how the system is made from their FMUs."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cache
from typing import Any, cast

from ..core.errors import InputRefused, Problem
from ..core.names import nearest
from ..core.system import System
from ..headlines import Known
from . import full_scale, sonoda1993

Sizes = Mapping[str, Mapping[str, int]]
"""Sizes by component of the system: ``{"sand": {"discs": 370}}``. What is not named has its default."""


@dataclass(frozen=True)
class Case:
    """A ready-made system.

    models: component of the system -> component of the catalogue that its FMU is built from.
    sizes: what the FMUs are built with. one_size: sizes, ``component.size``, that are one number for all of them.
    couplings: schemes of exchange by name, the default first, with a description.
    make(fmus, sizes, coupling): the system; ``fmus`` are the files of the FMUs by component.
    known: what others found, by the name of the figure.
    """

    name: str
    summary: str
    models: Mapping[str, str]
    sizes: Sizes
    couplings: Mapping[str, str]
    make: Callable[[Mapping[str, str], Sizes, str], System]
    one_size: tuple[str, ...] = ()
    known: Mapping[str, Known] = field(default_factory=dict)


_OTHER_NAMES = {"lab-impact-4": "lab-impact"}


@cache
def cases() -> dict[str, Case]:
    """All cases by name."""
    found = [_laboratory(test) for test in sonoda1993.tests().values()]
    found.sort(key=lambda case: case.name != sonoda1993.case_name(sonoda1993.DEFAULT_TEST))
    return {case.name: case for case in [*found, *map(_full_scale, full_scale.impacts().values())]}


def case(name: str) -> Case:
    """The case of this name.

    Raises:
        InputRefused: there is none.
    """
    found = cases().get(_OTHER_NAMES.get(name, name))
    if found is None:
        raise InputRefused([Problem(name, "there is no case of this name", nearest(name, cases()))])
    return found


def known_of(facts: Mapping[str, Any]) -> Mapping[str, Known]:
    """What others found for the case that a run's provenance names; nothing if it names none."""
    found = cases().get(facts.get("case", ""))
    return found.known if found else {}


def _laboratory(test: sonoda1993.Test) -> Case:
    def make(fmus: Mapping[str, str], sizes: Sizes, coupling: str) -> System:
        return sonoda1993.lab_system(fmus, test, cast(sonoda1993.Coupling, coupling), sizes["sand"]["discs"],
                                     sizes["beam"]["elements"])

    state = f"sand {test.sand}, {'compacted' if test.compaction else 'as poured'}, w = {test.water_content:g} %, box {test.box}"
    return Case(
        sonoda1993.case_name(test.number),
        f"Sonoda et al. 1993, laboratory, test {test.number}: {state}",
        models={"sand": "SandCushion", "rock": "FallingRock", "beam": "RBSMBeam"},
        sizes={"sand": {"discs": sonoda1993.discs_in(test.box), "elements": sonoda1993.ELEMENTS},
               "beam": {"elements": sonoda1993.ELEMENTS}},
        couplings={"paper": "sand first, inputs held, exchange every 0.01 ms",
                   "impulse": "sand first, kinematics extrapolated, mean forces, exchange every 0.1 ms",
                   "jacobi": "all at once, inputs held, exchange every 0.1 ms"},
        make=make, one_size=("sand.elements", "beam.elements"), known=sonoda1993.known_of(test))


def _full_scale(impact: full_scale.Impact) -> Case:
    def make(fmus: Mapping[str, str], sizes: Sizes, coupling: str) -> System:
        return full_scale.full_scale_system(fmus, impact, cast(full_scale.Coupling, coupling), sizes["sand"]["discs"],
                                            sizes["sand"]["elements"])

    beam = {"beam": "RBSMBeam"} if impact.span else {}
    elements = {"elements": impact.elements}
    return Case(
        impact.name, f"Sonoda et al. 1993, full scale: {impact.summary}",
        models={"sand": "SandCushion", "rock": "FallingRock", **beam},
        sizes={"sand": {"discs": impact.discs, **elements}, **dict.fromkeys(beam, elements)},
        couplings={"paper": "sand first, inputs held, exchange every 0.05 ms",
                   "impulse": "sand first, kinematics extrapolated, mean forces, exchange every 0.2 ms"},
        make=make, one_size=("sand.elements", "beam.elements") if beam else (), known=full_scale.known_of(impact))
