"""A site as data: rock, start, profile, ground, search lines and barriers. Form only: preparation.py checks the meaning."""

import re
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from ..core.errors import InputRefused, Problem
from ..core.names import nearest
from .places import Places, line_and_column, places

Number = Annotated[float, Field(allow_inf_nan=False)]
Positive = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]
NotNegative = Annotated[float, Field(ge=0.0, allow_inf_nan=False)]
Distribution = Literal["truncated_normal", "uniform", "lognormal", "triangular"]

MOST_TRIALS = 2**31 - 1


class _Data(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class Rock(_Data):
    """Mass, or density of a sphere; shape says what the moment of inertia follows from."""

    radius: Positive
    density: Positive | None = None
    mass: Positive | None = None
    shape: Literal["sphere", "disc", "given"] = "sphere"
    moment_of_inertia: Positive | None = None


class Start(_Data):
    """Of the rock's centre (m, m/s, rad/s); without y it starts in contact with the slope."""

    x: Number
    y: Number | None = None
    velocity: tuple[Number, Number] = (0.0, 0.0)
    angular_velocity: Number = 0.0


class Profile(_Data):
    """Nodes ``[x, y]`` or ``[x, y, material]`` from left to right, or a file with them (CSV, DXF).

    layers: those of a DXF file that are read; all by default. end: x (m) at which a trial ends, by default that of the last node.
    """

    points: list[Any] | None = None
    file: str | None = None
    layers: list[str] | None = None
    end: Number | None = None


class Ground(_Data):
    """The material between two x (m); without them, of the whole profile."""

    material: str
    left: Annotated[Number | None, Field(alias="from")] = None
    right: Annotated[Number | None, Field(alias="to")] = None


class Scatter(_Data):
    """Mean and standard deviation."""

    mean: Number
    deviation: NotNegative = 0.0


class Material(_Data):
    """What a cell is made of; with ``like``, only what differs from that material. Names and units: those of SlopeRockfall."""

    like: str | None = None
    description: str = ""
    strength: Number | None = None
    stiffness: Number | None = None
    hardening: Number | None = None
    friction: Number | None = None
    resistance: Number | None = None
    tilt: Scatter | None = None
    roughness: Scatter | None = None
    source: dict[str, str] = {}


class LimitSpeed(Scatter):
    """V_lim (m/s)."""

    distribution: Distribution = "truncated_normal"


class Distributions(_Data):
    """Of R_o and K_s."""

    roughness: Distribution = "truncated_normal"
    tilt: Distribution = "truncated_normal"


class Line(_Data):
    """A search line between two points, or upwards from the surface at x."""

    name: Annotated[str, Field(min_length=1)]
    points: tuple[tuple[Number, Number], tuple[Number, Number]] | None = None
    x: Number | None = None


class Barrier(_Data):
    """Upright on the surface. It holds a rock of at most ``capacity`` (J) whose centre passes below height - free_border (m)."""

    name: Annotated[str, Field(min_length=1)]
    x: Number
    height: Positive
    capacity: NotNegative
    free_border: NotNegative | None = None


class Site(_Data):
    """All that a campaign is made of. hypercube: trials of a Latin hypercube, 0: independent trials. model: other parameters of
    SlopeRockfall by name. stations: places along the profile at which envelopes are kept.
    """

    name: str = ""
    description: str = ""
    trials: Annotated[int, Field(ge=1, le=MOST_TRIALS)] = 10_000
    seed: Annotated[int, Field(ge=0, le=MOST_TRIALS)] = 1
    hypercube: Annotated[int, Field(ge=0, le=MOST_TRIALS)] = 0
    rock: Rock
    start: Start
    profile: Profile
    ground: list[Ground] = []
    material: dict[str, Material] = {}
    limit_speed: LimitSpeed
    distribution: Distributions = Distributions()
    model: dict[str, bool | float | str] = {}
    line: list[Line] = []
    barrier: list[Barrier] = []
    stations: Annotated[int, Field(ge=2, le=100_000)] = 201


def read_toml(path: Path) -> tuple[dict[str, Any], Places]:
    """Content of a TOML file, and where each value stands.

    Raises:
        InputRefused: it cannot be read, or is not TOML.
    """
    try:
        text = path.read_text(encoding="utf-8")
        return tomllib.loads(text), places(str(path), text)
    except tomllib.TOMLDecodeError as error:
        raise InputRefused([Problem(str(path), f"is not valid TOML: {error}")]) from error
    except UnicodeDecodeError as error:
        raise InputRefused([Problem(f"{path}, {_undecodable(path, error)}", "is not UTF-8 text", "save it as UTF-8")]) from error
    except OSError as error:
        raise InputRefused([Problem(str(path), f"cannot be read: {error.strerror or error}", "correct the path")]) from error


def _undecodable(path: Path, error: UnicodeDecodeError) -> str:
    before = path.read_bytes()[:error.start].decode("utf-8")
    return line_and_column(before, len(before))


def site_from(data: Mapping[str, Any], where: Places, problems: list[Problem]) -> Site | None:
    """A site from plain data; None, and the reasons in ``problems``, if its form is wrong."""
    try:
        return Site.model_validate(data)
    except ValidationError as error:
        found: dict[tuple[Any, ...], list[str]] = {}
        for entry in error.errors():
            found.setdefault(_key(entry["loc"]), []).append(_sentence(entry))
        problems += [Problem(where.of(key), f"{_name(key)}: {' or '.join(dict.fromkeys(texts))}", _remedy(key, texts))
                     for key, texts in found.items()]
        return None


def _key(location: tuple[Any, ...]) -> tuple[Any, ...]:
    return tuple(part for part in location if part not in ("bool", "float", "str"))


def _name(key: tuple[Any, ...]) -> str:
    """``barrier[1].height``: elements are counted from 1 for people."""
    text = ""
    for part in key:
        text += f"[{part + 1}]" if isinstance(part, int) else f".{part}" if text else str(part)
    return text


def _sentence(error: Any) -> str:
    if error["type"] == "extra_forbidden":
        return "there is no such key"
    if error["type"] == "missing":
        return "is missing"
    given = "" if isinstance(error["input"], dict | list) else f" (given: {error['input']!r})"
    message = re.sub(r"a valid dictionary.*", "a table", str(error["msg"]))
    return message[0].lower() + message[1:] + given


def _remedy(key: tuple[Any, ...], texts: list[str]) -> str:
    if "there is no such key" not in texts:
        return ""
    return nearest(str(key[-1]), known_keys(key[0] if len(key) > 1 else ""))


def known_keys(section: str) -> list[str]:
    """Keys of a section, or of the whole file."""
    owners: dict[str, type[BaseModel]] = {
        "rock": Rock, "start": Start, "profile": Profile, "ground": Ground, "material": Material, "limit_speed": LimitSpeed,
        "distribution": Distributions, "line": Line, "barrier": Barrier}
    return [entry.alias or name for name, entry in owners.get(section, Site).model_fields.items()]
