"""Shape of ``run.json``, which is looked at before anything is computed or drawn from it.

Only what readers rely on is described; other entries are passed over.
"""

from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Discriminator, Field, Strict, Tag, ValidationError

_Name = Annotated[str, Field(max_length=10_000)]
_Positive = Annotated[float, Field(gt=0.0, lt=1e30)]


class _Shape(BaseModel):
    model_config = ConfigDict(strict=True, extra="ignore", defer_build=True)


class _Parameter(_Shape):
    value: int | float | str | bool


class _Reported(_Shape):
    name: _Name
    statistic: _Name
    unit: _Name
    decimals: Annotated[int, Field(ge=0, le=20)]


class _Variable(_Shape):
    role: _Name | None = None
    label: _Name | None = None
    reported: list[_Reported] = []


class _Curve(_Shape):
    variable: _Name
    label: _Name
    factor: float
    from_start: bool
    dashed: bool


class _Curves(_Shape):
    label: _Name
    unit: _Name
    second_unit: _Name
    downwards: bool
    common: bool = False
    references: _Name
    curves: Annotated[list[_Curve], Field(min_length=1)]


class _Envelope(_Shape):
    label: _Name
    unit: _Name
    variable: _Name
    along: _Name
    ends: _Name
    at_edges: bool = False


def _kind_of_panel(panel: Any) -> str:
    """Return the kind of a panel as pictures tell it: an envelope has places along it."""
    return "envelope" if isinstance(panel, Mapping) and "along" in panel else "curves"


_Panel = Annotated[
    Annotated[_Curves, Tag("curves")] | Annotated[_Envelope, Tag("envelope")],
    Discriminator(_kind_of_panel),
]


class _Picture(_Shape):
    name: _Name
    panels: list[_Panel]


class _Component(_Shape):
    contents: _Name | None = None
    parameters: dict[str, _Parameter] = {}
    variables: dict[str, _Variable] = {}
    pictures: list[_Picture] = []


class _Steps(_Shape):
    step: _Positive | None = None


class _System(_Shape):
    description: _Name = ""
    master: _Name
    exchange_step: _Positive
    components: dict[str, _Steps] = {}


class _Reference(_Shape):
    value: float
    note: _Name = ""


class _References(_Shape):
    known: dict[str, dict[_Name, _Reference]] = {}
    remarks: list[_Name] = []


class _Width(_Shape):
    width: _Positive
    metrics: dict[_Name, float] = {}


_Text = Annotated[tuple[float, str], Strict(False)]
"""A time (s) and the text from then on."""


class _Checkpoints(_Shape):
    every: _Positive
    run: _Name
    warnings: list[_Name]


class _Change(_Shape):
    at: float
    values: dict[str, int | float | str | bool]


class _Branch(_Change):
    inherited: list[_Change] = []


class _Run(_Shape):
    status: _Name
    name: _Name = ""
    error: _Name | None = None
    warnings: list[_Name] = []
    components: dict[str, _Component] = {}
    system: _System | None = None
    differences: dict[str, Any] = {}
    references: _References = _References()
    load_cell: _Positive | None = None
    band: dict[_Name, _Width] = {}
    texts: dict[_Name, list[_Text]] = {}
    versions: dict[str, Any] = {}
    checkpoints: _Checkpoints | None = None
    branch: _Branch | None = None
    resumed: list[Any] = []


def check(provenance: Mapping[str, Any]) -> None:
    """Refuse facts of a run that have not the shape that readers rely on.

    Parameters
    ----------
    provenance : mapping
        Content of ``run.json``.

    Raises
    ------
    ValueError
        The first entry that is wrong, and why.
    """
    try:
        _Run.model_validate(provenance)
    except ValidationError as error:
        first = error.errors(include_url=False, include_input=False)[0]
        place = ".".join(map(str, first["loc"]))
        raise ValueError(f"{place}: {first['msg'].lower()}") from error
