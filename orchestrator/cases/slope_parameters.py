"""Parameters of a slope, as the FMU takes them."""

from rockshed.components.common.component import Instance
from rockshed.components.common.ports import Causality, Kind, Variable

from ..core.system.fields import Value


def site_parameters(instance: Instance) -> dict[str, Value]:
    """Return every parameter of a slope that differs from its start value, as the FMU takes it.

    Parameters
    ----------
    instance : Instance
        A slope with all values set.

    Returns
    -------
    dict of str to Value
        By the name of the parameter.
    """
    found: dict[str, Value] = {}
    names = iter(instance.references.items())
    for variable in instance.component.layout.ordered:
        for number in range(1 if variable.size is None else instance.sizes[variable.size]):
            name, index = next(names)
            value = float(instance.w[index])
            if variable.causality is Causality.PARAMETER and value != variable.start_at(
                number, instance.sizes
            ):
                found[name] = _value(variable, value)
    return found


def _value(variable: Variable, value: float) -> Value:
    """Return a value in the kind of its variable."""
    if variable.kind is Kind.ENUMERATION:
        return variable.choices[int(value) - 1]
    if variable.kind is Kind.BOOLEAN:
        return bool(value)
    return int(value) if variable.kind is Kind.INTEGER else value
