"""The command ``rockshed formula``: formulas of practice for an impact."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Annotated, Any

import typer

from rockshed.components.common.units import deg, kN

from ..core.errors import InputRefused, Problem
from ..core.system.quantities import in_si
from ..formulas import RockImpact, estimates, table_of
from ..formulas.rock_impact import FRICTION_ANGLE, LAME, MODULUS, ROCK_DENSITY, radius_of
from .options import Json
from .screen import opened

_ONE_OF = "give one of the two"


def _option(name: str, text: str) -> Any:
    return typer.Option(name, metavar="QUANTITY", help=text)


_UNITS = {
    "--mass": "kg",
    "--height": "m",
    "--speed": "m/s",
    "--diameter": "m",
    "--density": "kg/m3",
    "--thickness": "m",
    "--lame": "Pa",
    "--modulus": "Pa",
    "--friction-angle": "rad",
}
"""Units in which options without one are read."""


def command(
    mass: Annotated[str, _option("--mass", 'Mass of the rock: 2500, "2.5 t".')],
    height: Annotated[str, _option("--height", "Height of its free fall.")] = "",
    speed: Annotated[str, _option("--speed", "Or its speed.")] = "",
    diameter: Annotated[str, _option("--diameter", "Diameter of the rock.")] = "",
    density: Annotated[
        str, _option("--density", f"Or its density; default {ROCK_DENSITY:g} kg/m3.")
    ] = "",
    thickness: Annotated[
        str,
        _option("--thickness", "Of the cushion; without it, formulas that need it are left out."),
    ] = "",
    lame: Annotated[
        str, _option("--lame", f"Lame constant of the sand; default {LAME / kN:g} kN/m2.")
    ] = "",
    modulus: Annotated[
        str, _option("--modulus", f"M_E of the cushion; default {MODULUS / kN:g} kN/m2, assumed.")
    ] = "",
    friction_angle: Annotated[
        str,
        _option(
            "--friction-angle", f"Of the cushion; default {FRICTION_ANGLE / deg:g} deg, assumed."
        ),
    ] = "",
    as_json: Json = False,
) -> None:
    """Impact force by formulas of practice: Japanese handbook, ASTRA, Labiouse, Hertz.

    A quantity may have a unit, "2.5 t", 25m, "1000 kN/m2"; without one it is in SI units.
    """
    texts = (mass, height, speed, diameter, density, thickness, lame, modulus, friction_angle)
    with opened(quiet=False, as_json=as_json) as screen:
        impact = _impact({name: text for name, text in zip(_UNITS, texts, strict=True) if text})
        listed = estimates(impact)
        if as_json:
            shown = {**vars(impact), "drop_height": impact.drop_height, "energy": impact.energy}
            screen.dump({"impact": shown, "estimates": [entry.as_data() for entry in listed]})
            return
        table = table_of(listed, title=_title(impact))
        screen.table(table)
        screen.show("", *table.notes)


def _title(impact: RockImpact) -> str:
    cushion = f" on {impact.thickness:g} m" if impact.thickness else ""
    rock = f"{impact.mass / 1e3:.3g} t, {2.0 * impact.radius:.2f} m in diameter"
    motion = f"{impact.speed:.3g} m/s, {impact.energy / 1e3:,.0f} kJ"
    return f"{rock}, from {impact.drop_height:.3g} m ({motion}){cushion}"


def _impact(texts: Mapping[str, str]) -> RockImpact:
    """Return the impact of the options that were given."""
    problems: list[Problem] = []
    given: dict[str, float] = {}
    for name, text in texts.items():
        with _collected(name, problems):
            given[name] = _possible(name, in_si(text, _UNITS[name]))
    for one, other in (("--height", "--speed"), ("--diameter", "--density")):
        if one in texts and other in texts:
            problems.append(Problem(f"{one} and {other}", "exclude each other", _ONE_OF))
    if not {"--height", "--speed"} & texts.keys():
        problems.append(Problem("--height or --speed", "is missing", _ONE_OF))
    if problems:
        raise InputRefused(problems)
    return _made(given)


def _made(given: Mapping[str, float]) -> RockImpact:
    density = given.get("--density", ROCK_DENSITY)
    radius = (
        given["--diameter"] / 2.0 if "--diameter" in given else radius_of(given["--mass"], density)
    )
    make: Callable[..., RockImpact] = RockImpact.fallen if "--height" in given else RockImpact
    return make(
        given["--mass"],
        radius,
        given.get("--height", given.get("--speed")),
        thickness=given.get("--thickness"),
        lame=given.get("--lame", LAME),
        modulus=given.get("--modulus", MODULUS),
        friction_angle=given.get("--friction-angle", FRICTION_ANGLE),
    )


def _possible(name: str, value: float) -> float:
    if value <= 0.0:
        raise ValueError("must be positive")
    if name == "--friction-angle" and value >= 90.0 * deg:
        raise ValueError("must be less than 90 deg")
    return value


@contextmanager
def _collected(name: str, problems: list[Problem]) -> Iterator[None]:
    try:
        yield
    except ValueError as error:
        problems.append(Problem(name, str(error)))
