"""``rockshed calibrate``: what is asked for, and the table, the data and the files that tell what was found."""

import csv
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

from rockshed.components.common.units import cm, kgf

from ...cases.sonoda1993 import tests
from ...core.errors import InputRefused, Problem
from ...core.system.system import Value
from ...files import write_json
from ...runs.batch import Counted
from ...runs.building import Note
from ...tables import Table
from .measurement import Measurement, of_stiffness, read_curve, stiffness_from
from .run import ROTATIONS, Calibration, Fit, Unreachable, by_misfit, calibrate

PAPER = "sonoda1993"
"""Names the six tests of table 4 instead of a file."""
BEST = "fit"
"""Both rotation models are tried."""
DATA, TABLE, CURVE, FIGURE = "calibration.json", "calibration.csv", "curve.csv", "calibration.png"
_E_BAR = kgf / cm**2
_HEADINGS = (
    "measurement",
    "rotation",
    "k (kgf/cm)",
    "E_bar (kgf/cm²)",
    "±",
    "exponent",
    "error of the curve",
    "printed",
    "to printed",
)


@dataclass(frozen=True)
class Asked:
    """What is to be calibrated. printed: the paper's E_bar (Pa) by name of the measurement."""

    measurements: Sequence[Measurement]
    rotation: str
    values: Mapping[str, Value]
    printed: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Found:
    """Calibrations, the best first, and why there is none with another rotation model."""

    asked: Asked
    calibrations: Sequence[Calibration]
    lost: Mapping[str, Unreachable] = field(default_factory=dict)

    def fits(self) -> "list[tuple[Calibration, Fit]]":
        """Each measurement with each model."""
        return [(calibration, fit) for calibration in self.calibrations for fit in calibration.fits]


def asked_for(
    target: str | None, stiffness: str | None, rotation: str, values: Mapping[str, Value]
) -> Asked:
    """The measurements that a command names: a curve, a spring constant, or the paper's tests.

    Raises:
        InputRefused: none or several of them, or what is wrong with them.
    """
    problems = []
    if (target is None) == (stiffness is None):
        problems.append(
            Problem(
                "calibrate",
                "takes either a file or --stiffness" + (", not both" if target else ""),
                f"rockshed calibrate CURVE.csv, --stiffness '39.1 kgf/cm', or {PAPER} for table 4",
            )
        )
    if rotation not in (*ROTATIONS, BEST):
        problems.append(
            Problem(
                "--rotation",
                f"{rotation!r} is unknown",
                f"choose one of {', '.join((*ROTATIONS, BEST))}",
            )
        )
    if rotation == BEST and (stiffness is not None or target == PAPER):
        problems.append(
            Problem(
                "--rotation fit",
                "needs a curve: any model has a given spring constant with some E_bar",
                "give a load-penetration curve, or choose free or locked",
            )
        )
    if rotation == BEST and "sand.rotation" in values:
        problems.append(
            Problem(
                "--set sand.rotation", "is what --rotation fit chooses", "leave one of them out"
            )
        )
    if problems:
        raise InputRefused(problems)
    if stiffness is not None:
        return Asked(
            [of_stiffness(stiffness_from(stiffness), f"k = {stiffness}")], rotation, values
        )
    if target == PAPER:
        of_table = {
            f"test {test.number}": test for test in tests().values() if test.modulus_in_table_4
        }
        return Asked(
            [of_stiffness(test.static_stiffness, name) for name, test in of_table.items()],
            rotation,
            values,
            {name: test.modulus for name, test in of_table.items()},
        )
    return Asked([read_curve(Path(str(target)))], rotation, values)


def find(asked: Asked, seeds: int, workers: int | None, note: Note, done: Counted) -> Found:
    """Calibrate with the model that is asked for, or with each.

    Raises:
        As :func:`rockshed.analyses.calibration.run.calibrate`.
    """
    models = list(ROTATIONS) if asked.rotation == BEST else [asked.rotation]
    made, lost = by_misfit(
        {
            model: partial(
                calibrate, asked.measurements, model, asked.values, seeds, workers, note, done
            )
            for model in models
        }
    )
    return Found(asked, made, lost)


# ------------------------------------------------------------------ what is told


def cells(found: Found) -> list[list[str]]:
    """The rows of the table, in the units of the paper."""
    return [
        _cells(calibration, fit, found.asked.printed.get(fit.measured.name))
        for calibration, fit in found.fits()
    ]


def _cells(calibration: Calibration, fit: Fit, printed: float | None) -> list[str]:
    stiffness = float(fit.measured.load[-1] / fit.measured.depth[-1]) / kgf * cm
    return [
        fit.measured.name,
        calibration.rotation,
        f"{stiffness:.1f}",
        f"{fit.modulus / _E_BAR:.1f}",
        f"{fit.uncertainty / _E_BAR:.1f}",
        f"{fit.exponent:.2f}",
        f"{100 * fit.misfit:.1f} %" if fit.measured.is_curve else "",
        f"{printed / _E_BAR:.1f}" if printed else "",
        f"{100 * (fit.modulus / printed - 1):+.0f} %" if printed else "",
    ]


def table(found: Found) -> Table:
    """For the screen; columns in which nothing stands are left out."""
    rows = cells(found)
    shown = [i for i in range(len(_HEADINGS)) if any(row[i] for row in rows)]
    made = Table([_HEADINGS[i] for i in shown], right=_HEADINGS[2:])
    for row in rows:
        made.add(*(row[i] for i in shown))
    return made


def notes(found: Found) -> list[str]:
    """What a reader has to know of the figures."""
    best = found.calibrations[0]
    said = [
        f"rotation {best.rotation}: {', '.join(_settings(best))}; {len(best.pushes)} static tests, "
        f"{len({push.seed for push in best.pushes})} samples",
        "±: standard deviation of the E_bar that single samples ask for"
        + (", and error of the curve, together" if best.fits[0].measured.is_curve else ""),
    ]
    if found.asked.rotation == BEST:
        said.append(f"rotation {best.rotation} fits best, by the error of the curve")
    return said + [
        f"rotation {name} not possible: {problem.what}"
        for name, reason in found.lost.items()
        for problem in reason.problems
    ]


def _settings(calibration: Calibration) -> list[str]:
    return [f"{name}={value}" for name, value in calibration.values.items()]


def as_data(found: Found) -> dict[str, Any]:
    """For programs, in SI."""
    return {
        "calibrations": [
            {
                "rotation": calibration.rotation,
                "settings": _settings(calibration),
                "tests": [
                    {"e_bar": push.modulus, "seed": push.seed} for push in calibration.pushes
                ],
                "results": [
                    {
                        "measurement": fit.measured.name,
                        "e_bar": fit.modulus,
                        "uncertainty": fit.uncertainty,
                        "spread_of_samples": fit.spread,
                        "error_of_the_curve": fit.misfit if fit.measured.is_curve else None,
                        "exponent": fit.exponent,
                        "printed": found.asked.printed.get(fit.measured.name),
                        "penetration": fit.measured.depth.tolist(),
                        "measured_load": fit.measured.load.tolist(),
                        "computed_load": fit.load.tolist(),
                        "computed_load_spread": fit.load_spread.tolist(),
                    }
                    for fit in calibration.fits
                ],
            }
            for calibration in found.calibrations
        ],
        "unit_of_e_bar": "Pa",
        "remarks": notes(found),
    }


def write(found: Found, folder: Path) -> list[Path]:
    """JSON, CSV and the figure; return the files.

    Raises:
        OSError: the folder cannot be written.
    """
    from .pictures import draw

    folder.mkdir(parents=True, exist_ok=True)
    write_json(folder / DATA, as_data(found))
    _write_csv(folder / TABLE, _HEADINGS, cells(found))
    best = found.calibrations[0].fits[0]
    files = [folder / DATA, folder / TABLE, folder / FIGURE]
    if best.measured.is_curve:
        columns = (
            best.measured.depth / cm,
            best.measured.load / kgf,
            best.load / kgf,
            best.load_spread / kgf,
        )
        _write_csv(
            folder / CURVE,
            ("penetration (cm)", "load (kgf)", "computed load (kgf)", "spread (kgf)"),
            [[f"{value:.5g}" for value in row] for row in zip(*columns, strict=True)],
        )
        files.append(folder / CURVE)
    draw(found.calibrations, found.asked.printed, notes(found), folder / FIGURE)
    return files


def _write_csv(file: Path, head: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    with file.open("w", newline="", encoding="utf-8") as text:
        csv.writer(text).writerows([head, *rows])
