"""Power bonds that nothing drives: a rock that no force stops, a sand without its rock."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from ..core.fmu.description import Description, Port
from ..core.system.plan import Plan
from ..core.system.values import written


@dataclass(frozen=True)
class _Bond:
    """A power bond of a component: its inputs, its outputs, and what it declares."""

    component: str
    told: Mapping[str, Any]
    inputs: frozenset[str]
    outputs: frozenset[str]


def undriven(plan: Plan) -> list[str]:
    """Warn of power bonds whose inputs are neither connected nor given a value.

    Of a bond that says what is so without a partner, and of one that hands out what it computes and
    gets nothing back.

    Parameters
    ----------
    plan : Plan
        A system ready to run.

    Returns
    -------
    list of str
        A sentence with a remedy for each bond.
    """
    driven = {f"{end.component}.{_array(end.port)}" for end in plan.inputs}
    driven |= {f"{name}.{_array(port)}" for name in plan.starts for port, _ in plan.starts[name]}
    used = {f"{source.component}.{_array(source.port)}" for _, _, source in plan.fed}
    return [
        _warning(bond)
        for name, description in plan.descriptions.items()
        for bond in _bonds(name, description)
        if bond.inputs
        and not bond.inputs & driven
        and (bond.outputs & used or (bond.told["idle"] and not _plays_no_part(plan, bond)))
    ]


def _array(port: Port) -> str:
    """Return the name of a port without the number of an element."""
    return port.name.partition("[")[0]


def _bonds(component: str, description: Description) -> list[_Bond]:
    """Return the bonds that a component declares, with ``component.port`` of their members."""
    made = []
    for told in description.bonds:
        members = set(told["members"].values())
        sides = (
            frozenset(
                f"{component}.{_array(port)}"
                for port in description.named(causality)
                if _array(port) in members
            )
            for causality in ("input", "output")
        )
        made.append(_Bond(component, told, *sides))
    return made


def _plays_no_part(plan: Plan, bond: _Bond) -> bool:
    """Return whether a parameter of the component takes the bond out of play."""
    if not bond.told["unless"]:
        return False
    name, word = bond.told["unless"]
    port = plan.descriptions[bond.component].ports[name]
    values = {entry.name: value for entry, value in plan.starts[bond.component]}
    value = values.get(name, float(port.start or "nan"))
    return (value if isinstance(value, str) else written(port, value)) == word


def _warning(bond: _Bond) -> str:
    told = bond.told
    inputs = ", ".join(name.removeprefix(f"{bond.component}.") for name in sorted(bond.inputs))
    what = told["idle"] or "what it hands out drives others, and nothing comes back"
    return (
        f"{bond.component}: nothing drives {inputs} ({told['description']}): {what}; connect them, "
        "or give one of them a value if that is meant"
    )
