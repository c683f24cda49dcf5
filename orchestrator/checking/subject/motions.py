"""Motions that many probes make: some steps, and what the outputs were after each."""

from collections.abc import Sequence

from .calls import Called, CallRefused
from .subject import Subject
from .variables import Declared, Numbers, exactly

OutputCourse = list[dict[str, tuple[str, ...]]]
"""Values of variables, exact to the bit, after each step."""


def course(
    subject: Subject,
    instance: Called,
    steps: int | None = None,
    variables: Sequence[Declared] | None = None,
) -> OutputCourse:
    """Make steps and return the outputs before the first and after each.

    Parameters
    ----------
    subject : Subject
        The FMU.
    instance : Called
        Which is initialised.
    steps : int, optional
        Number of steps, by default those of an ordinary simulation.
    variables : sequence of Declared, optional
        Instead of the outputs.

    Returns
    -------
    list
        Fewer entries where the FMU wants to end earlier.
    """
    read = subject.outputs if variables is None else variables
    rows = [exactly(instance.get(read))]
    for _ in range(subject.steps if steps is None else steps):
        done = instance.step(subject.step)
        rows.append(exactly(instance.get(read)))
        if done.terminated:
            break
    return rows


def first_difference(one: OutputCourse, other: OutputCourse) -> str:
    """Return where two courses differ first, in words; empty where they are equal."""
    for number, (row, its) in enumerate(zip(one, other, strict=False)):
        for name, values in row.items():
            if its[name] != values:
                where = "at the start" if number == 0 else f"after step {number}"
                return f"{name} differs {where}: {_told(its[name])} instead of {_told(values)}"
    return "" if len(one) == len(other) else "one of them ends earlier"


def _told(values: tuple[str, ...]) -> str:
    texts = [f"{float.fromhex(text):.9g}" if "0x" in text else text for text in values[:2]]
    return ", ".join(texts) + (", ..." if len(values) > 2 else "")


def perturbed(subject: Subject, instance: Called) -> dict[str, Numbers]:
    """Set the inputs to other values; those that the FMU refuses are left.

    Parameters
    ----------
    subject : Subject
        The FMU.
    instance : Called
        An instance of it.

    Returns
    -------
    dict of str to tuple
        Values that were set, by variable.
    """
    taken = {}
    for variable in subject.inputs():
        values = variable.other_start()
        if values is None or variable.kind == "Binary":
            continue
        try:
            instance.set(variable, values)
        except CallRefused:
            continue
        taken[variable.name] = values
    return taken
