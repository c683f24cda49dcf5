"""The impact of a page as plain data: components, start values, exchanges, what sliders change."""

import re
from collections.abc import Mapping
from typing import Any

from rockshed.components.common.component import Instance
from rockshed.components.common.roles import Role
from rockshed.components.sand_cushion.declarations import ROW
from rockshed.fmus.in_process import InProcess

from ..core.errors import InputRefused, Problem
from ..core.system.plan import Plan
from ..core.system.planning import make_plan
from ..core.system.system import SystemSpec
from ..runs.system import System

SAND, ROCK, BEAM = "SandCushion", "FallingRock", "RBSMBeam"
REMEDY = "take a case such as lab-impact, or the project of a rock shed"
_READ = {
    "transmitted": (SAND, Role.TRANSMITTED),
    "on_rock": (SAND, Role.ON_BODY),
    "penetration": (SAND, Role.PENETRATION),
}
"""Curves and numbers of the page: component that has them, role."""
_DEFLECTION = "midspan.deflection"
_MOVED = {
    "mass": ((ROCK, "mass"), (SAND, "rock.mass")),
    "radius": ((ROCK, "radius"), (SAND, "rock.radius")),
    "height": ((ROCK, "position0.y"),),
    "speed": ((ROCK, "velocity0.y"),),
    "modulus": ((SAND, "modulus"),),
}
"""Start values that the sliders of the page change, each in some components."""


def refuse_unfit(system: System) -> None:
    """Refuse a system that is no impact of a falling rock on sand.

    Parameters
    ----------
    system : System
        Its components run in this process.

    Raises
    ------
    InputRefused
        Every reason.
    """
    kinds = kinds_of(system)
    problems = [
        Problem(name, f"{kind} is a component that a page does not compute", REMEDY)
        for name, kind in kinds.items()
        if kind not in (SAND, ROCK, BEAM)
    ]
    for kind in (ROCK, SAND, BEAM):
        number = list(kinds.values()).count(kind)
        if number > 1 or (number == 0 and kind != BEAM):
            text = f"has {number or 'no'} {kind}, and a page shows one"
            problems.append(Problem(system.name, text, REMEDY))
    driven = [name for name, kind in kinds.items() if kind == ROCK and _is_driven(system, name)]
    problems += [Problem(name, "is driven and does not fall", REMEDY) for name in driven]
    if system.spec.scenario:
        problems.append(Problem("scenario", "has no place in a page", "leave it out"))
    problems += [
        Problem(key, "exchanges are made in turn in a page, all of one length", "choose another")
        for key, asked in _other_exchanges(system.spec).items()
        if asked
    ]
    if any(c.factor is not None or c.offset is not None for c in system.spec.connections):
        text = "a connection with a factor or an offset has no place in a page"
        problems.append(Problem(system.name, text, "leave it out"))
    if problems:
        raise InputRefused(problems)


def _other_exchanges(spec: SystemSpec) -> dict[str, bool]:
    """Return the keys that have exchanges made as a page cannot, and whether a system has them."""
    return {
        "master": spec.master == "implicit",
        "adaptive": spec.adaptive is not None,
        "extrapolation": bool(spec.extrapolation)
        or any(component.extrapolation for component in spec.components.values()),
    }


def _is_driven(system: System, name: str) -> bool:
    return system.spec.components[name].parameters.get("motion") == "driven"


def kinds_of(system: System) -> dict[str, str]:
    """Return the components of the catalogue by the names that they have in a system.

    Parameters
    ----------
    system : System
        The system.

    Returns
    -------
    dict of str to str
        An FMU file stands as its path.
    """
    sources = system.job.sources
    return {
        name: source.component.name
        if isinstance(source := sources.get(name), InProcess)
        else spec.fmu
        for name, spec in system.spec.components.items()
    }


def computed(system: System) -> dict[str, Any]:
    """Return exchanges and connections of a system, which all offers share.

    Parameters
    ----------
    system : System
        Of :func:`refuse_unfit`.

    Returns
    -------
    dict
        For the script of the page.
    """
    plan = make_plan(system.spec, system.job.sources)
    kinds = kinds_of(system)
    return {
        "kinds": kinds,
        "links": _links(plan),
        "turns": _turns(plan),
        "exchange": plan.timing.exchange,
        "start": plan.timing.start,
        "rate": plan.timing.rate,
        "operations": [
            [[op.action.name, op.component, op.begin, op.length] for op in exchange]
            for exchange in plan.schedule.operations
        ],
        "read": _places(system, kinds),
        "body": _body(system, kinds),
        "limits": {name: _limits(instance_of(system, name)) for name in kinds},
    }


def _links(plan: Plan) -> dict[str, list[list[Any]]]:
    """Return place of the input, component and place of the output, by component."""
    found: dict[str, list[list[Any]]] = {name: [] for name in plan.order}
    for _, target, source in plan.fed:
        place = [target.port.reference, source.component, source.port.reference]
        found[target.component].append(place)
    return found


def _turns(plan: Plan) -> list[str]:
    """Return the components in the order in which they are initialised: least needed first."""
    needs = {name: len(links) for name, links in _links(plan).items()}
    return sorted(plan.order, key=lambda name: needs[name])


def _places(system: System, kinds: Mapping[str, str]) -> dict[str, list[Any]]:
    """Return component and place of every output that is shown."""
    found = {}
    for title, (kind, role) in _READ.items():
        name, instance = _instance(system, kinds, kind)
        variable = next(v for v in instance.component.layout.variables if v.role is role)
        found[title] = [name, instance.references[variable.name]]
    if BEAM in kinds.values():
        name, instance = _instance(system, kinds, BEAM)
        found["deflection"] = [name, instance.references[_DEFLECTION]]
    return found


def _body(system: System, kinds: Mapping[str, str]) -> dict[str, Any]:
    """Return where the sand has its bodies, and what of them is shown."""
    name, instance = _instance(system, kinds, SAND)
    return {
        "sand": name,
        "entry": int(instance.component.layout.array.body),
        "row": ROW,
        "beam": instance.sizes["elements"] if BEAM in kinds.values() else 0,
        "left": instance["box.left"],
        "right": instance["box.left"] + instance["box.width"],
    }


def _limits(instance: Instance) -> dict[str, Any]:
    """Return what a component refuses in words, and the places of its step and its longest one."""
    found = {}
    for status, text in instance.component.faults.items():
        names = re.findall(r"\{([^}]+)\}", text)
        found[status] = {"text": text, "places": {n: instance.references[n] for n in names}}
    steps = [instance.references[name] for name in ("internal_step", "stable_step")]
    return {"faults": found, "steps": steps}


def _instance(system: System, kinds: Mapping[str, str], kind: str) -> tuple[str, Instance]:
    name = next(name for name, found in kinds.items() if found == kind)
    return name, instance_of(system, name)


def instance_of(system: System, name: str) -> Instance:
    """Return an instance with the start values of a component of a system, not yet initialised.

    Parameters
    ----------
    system : System
        The system.
    name : str
        Name of the component.

    Returns
    -------
    Instance
        Values of the system in it.
    """
    source = system.job.sources[name]
    assert isinstance(source, InProcess)
    instance = source.component.instance(**source.sizes)
    for key, value in system.spec.components[name].parameters.items():
        instance[key.removesuffix("[*]")] = value
    for key, value in _shared(system.spec, name):
        instance[key.removesuffix("[*]")] = value
    return instance


def _shared(spec: SystemSpec, name: str) -> list[tuple[str, Any]]:
    return [
        (target.partition(".")[2], shared.value)
        for shared in spec.shared.values()
        for target in shared.targets
        if target.partition(".")[0] == name
    ]


def start_of(system: System) -> dict[str, Any]:
    """Return what differs from offer to offer.

    Parameters
    ----------
    system : System
        Of an offer.

    Returns
    -------
    dict
        For the script of the page: buffers at the start, and where the sliders act on them.
    """
    kinds = kinds_of(system)
    plan = make_plan(system.spec, system.job.sources)
    instances = {name: instance_of(system, name) for name in kinds}
    for name, instance in instances.items():
        if problems := instance.value_problems():
            raise InputRefused([Problem(name, text) for text in problems])
    timing = plan.timing
    return {
        "exchanges": timing.exchanges,
        "row_every": timing.output_every,
        "frame_every": timing.state_every or timing.output_every,
        "components": {name: _buffers(instance) for name, instance in instances.items()},
        "moved": _moved(kinds, instances),
        "discs": instances[_named(kinds, SAND)].sizes["discs"],
    }


def _named(kinds: Mapping[str, str], kind: str) -> str:
    return next(name for name, found in kinds.items() if found == kind)


def _buffers(instance: Instance) -> dict[str, Any]:
    """Return the buffers of an instance that is not yet initialised; outputs are zero."""
    return {
        "w": instance.w.tolist(),
        "x": instance.x.size,
        "k": instance.k.size,
        "table": instance.k[: len(instance.component.layout.array) * 2].tolist(),
    }


def _moved(kinds: Mapping[str, str], instances: Mapping[str, Instance]) -> dict[str, Any]:
    """Return the places of the start values that sliders change, and their present value."""
    found = {}
    for title, targets in _MOVED.items():
        owners = [(_named(kinds, kind), variable) for kind, variable in targets]
        first, variable = owners[0]
        found[title] = {
            "places": [[name, instances[name].references[key]] for name, key in owners],
            "value": float(instances[first][variable]),
        }
    return found
