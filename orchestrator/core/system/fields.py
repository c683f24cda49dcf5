"""Types of the entries of a system: values, times, names."""

from typing import Annotated, Any, Literal

import numpy as np
from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field

from .clock import from_text

Value = bool | int | float | str
"""Value of a parameter or input; of an enumeration, the name or the number of an item."""


def plain_value(value: Any) -> Any:
    """Return a number of numpy as one of Python; refuse a list.

    Parameters
    ----------
    value : Any
        Value for a parameter or input.

    Returns
    -------
    Any
        The value; its type is not checked.

    Raises
    ------
    ValueError
        It is a list, an array or a mapping.
    """
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, list | tuple | dict | np.ndarray):
        raise ValueError(ONE_VALUE)
    return value


ONE_VALUE = (
    "takes one number, true or false, or a word; give array elements one by one as name[1], "
    "name[2], ..., or all the same value as name[*]"
)
"""Why a list is refused as a value."""

PlainValue = Annotated[Value, BeforeValidator(plain_value)]


Time = Annotated[float, BeforeValidator(from_text), Field(allow_inf_nan=False)]
Seconds = Annotated[float, BeforeValidator(from_text), Field(gt=0.0, allow_inf_nan=False)]
Finite = Annotated[float, Field(allow_inf_nan=False)]
Tolerance = Annotated[float, Field(gt=0.0, lt=1.0, allow_inf_nan=False)]
Extrapolation = Literal[0, 1, 2]
Name = Annotated[str, Field(pattern=r"^[A-Za-z_][A-Za-z0-9_]*$")]
_DottedName = Annotated[str, Field(pattern=r"^[A-Za-z_][A-Za-z0-9_]*(\.[A-Za-z_][A-Za-z0-9_]*)*$")]
"""Name of a component, ``rock``, also of one inside a system of an SSP, ``shed.rock``."""

RESERVED = ("time", "coupling")
"""Names that a component cannot have: columns of the results begin with them."""


def _not_reserved(name: str) -> str:
    if name.partition(".")[0] in RESERVED:
        raise ValueError(
            f"a component cannot be called {name}: columns of the results are; choose another name"
        )
    return name


ComponentName = Annotated[_DottedName, AfterValidator(_not_reserved)]


class SystemData(BaseModel):
    """A part of a system: no other keys, never changed."""

    model_config = ConfigDict(extra="forbid", frozen=True, defer_build=True)
