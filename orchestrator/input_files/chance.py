"""Quantities that may be given as a number or as a distribution."""

from typing import TYPE_CHECKING, Annotated, Any, Generic, Literal, TypeAlias, TypeVar

from pydantic import Discriminator, Field, Tag

from ..core.form_faults import AS_DISTRIBUTION, AS_NUMBER
from .form import Data

Q = TypeVar("Q")


class RandomQuantity(Data, Generic[Q]):
    """A distribution: normal and lognormal with mean and deviation, uniform, or triangular.

    ``from`` and ``to`` are the ends of a uniform or triangular one, whose ``mode`` is the likeliest
    value; a normal or lognormal one is cut off there, by default three deviations from the mean.
    """

    distribution: Literal["normal", "lognormal", "uniform", "triangular"]
    mean: Q | None = None
    deviation: Q | None = None
    low: Annotated[Q | None, Field(alias="from")] = None
    high: Annotated[Q | None, Field(alias="to")] = None
    mode: Q | None = None


def _alternative(value: Any) -> str:
    return AS_DISTRIBUTION if isinstance(value, dict | RandomQuantity) else AS_NUMBER


if TYPE_CHECKING:
    Chance: TypeAlias = Q | RandomQuantity[Q]
else:  # a form of a kind is made by subscription, which an alias of types would leave out

    class Chance:
        """A number of a kind, or its distribution."""

        def __class_getitem__(cls, kind: Any) -> Any:
            """Return the annotation of a quantity of this kind."""
            number = Annotated[kind, Tag(AS_NUMBER)]
            spread = Annotated[RandomQuantity[kind], Tag(AS_DISTRIBUTION)]
            return Annotated[number | spread, Discriminator(_alternative)]
