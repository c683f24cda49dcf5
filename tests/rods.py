"""Rods for tests."""

import numpy as np

from rockshed.components.catalogue import component
from rockshed.components.pile_rod.st_venant import StVenant

ROD = component("PileRod")
HAMMER = component("Hammer")


def named(instance, parameters):
    """Set parameters; ``__`` stands for the dot in their names."""
    for name, value in parameters.items():
        instance[name.replace("__", ".")] = value
    return instance


def rod(segments=50, sections=1, ground_segments=1, fraction=1, **parameters):
    """An initialised rod. fraction: parts of the critical step for masses and springs."""
    made = named(
        ROD.instance(segments=segments, sections=sections, ground_segments=ground_segments),
        parameters,
    )
    speeds = np.sqrt(made["section.modulus"] / made["section.density"])
    made["internal_step"] = (
        float(np.sum(made["section.length"] / speeds)) / segments / fraction * (1.0 + 1e-12)
    )
    made.initialise()
    return made


def march(instance, steps, *names, force=lambda n: 0.0):
    """Make steps of the length in use; rows of the named variables (arrays as a whole), after each step."""
    dt, rows = instance["time_step"], []
    for n in range(steps):
        instance["head.force"] = force(n)
        instance.step(n * dt, dt)
        rows.append([np.copy(instance[name]) for name in names])
    return [np.array(column) for column in zip(*rows)]


def reflecting(alpha, **parameters):
    """Parameters of a rod struck by the ram of the standard penetration test, with this reflection at the toe."""
    return {
        "ram__mass": 63.5,
        "toe__condition": "reflection",
        "toe__reflection": alpha,
        **parameters,
    }


def closed_form(instance):
    """St. Venant's solution for a rod with a ram and a reflecting toe."""
    return StVenant(
        instance["ram.mass"],
        instance["ram.velocity"],
        instance["head.impedance"],
        instance["travel_time"],
        instance["toe.reflection"],
    )
