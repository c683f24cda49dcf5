"""The short table at the end of a run: what was computed beside what the paper and the experiment found."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

from rockshed.components.common.units import cm, kgf, kN, mm, ms

from ..cases.sand_models import model_of
from ..core.results.metric import Beside, Metric
from ..core.results.reading import Run
from ..references import References
from ..tables import Table
from . import headlines as h


@dataclass(frozen=True)
class Scale:
    """A unit on the screen: its size in SI and the digits after the point."""

    unit: str
    size: float
    digits: int
    sign: str = ""


_FORCE = (Scale("kN", kN, 2), Scale("kgf", kgf, 0))
_ENERGY = (Scale("J", 1.0, 2), Scale("kgf cm", kgf * cm, 1))
_TIME = (Scale("ms", ms, 2),)
_SHARE = (Scale("%", 0.01, 3),)
_ROWS: Mapping[str, tuple[str, tuple[Scale, ...]]] = {
    h.STATIC_LOAD: ("load at 4 cm", _FORCE),
    h.STATIC_STIFFNESS: (
        "secant spring constant k",
        (Scale("kN/m", kN, 1), Scale("kgf/cm", kgf / cm, 1)),
    ),
    h.STATIC_DEPARTURE: ("departure from the secant line", (Scale("%", 0.01, 1),)),
    h.MACHINE_WORK: ("work of the machine", _ENERGY),
    h.RESIDUAL_WORK_SHARE: ("energy residual / work of the machine", (Scale("%", 0.01, 3, "+"),)),
    h.PEAK_TRANSMITTED: ("peak transmitted force", _FORCE),
    h.PEAK_TRANSMITTED_AT: ("  at", _TIME),
    h.PEAK_LOAD_CELL: ("  through the load cell", _FORCE),
    h.LOAD_CELL_CUT_OFF: ("  load cell: below", (Scale("Hz", 1.0, 0),)),
    h.PEAK_ROCK: ("peak force on the rock", _FORCE),
    h.PEAK_ROCK_AT: ("  at", _TIME),
    h.RATIO: ("ratio of the two peaks", (Scale("", 1.0, 2),)),
    h.SETTLED_TRANSMITTED: ("settled transmitted force", _FORCE),
    h.SETTLED_ROCK: ("settled force on the rock", _FORCE),
    h.SETTLED_RATIO: ("ratio of the settled maxima", (Scale("", 1.0, 2),)),
    h.SETTLED_CUT_OFF: ("  settled: below", (Scale("Hz", 1.0, 0),)),
    h.IMPULSE_TRANSMITTED: ("transmitted impulse", (Scale("N s", 1.0, 1),)),
    h.IMPULSE_ROCK: ("impulse on the rock", (Scale("N s", 1.0, 1),)),
    h.DURATION: ("duration on the rock", (Scale("ms", ms, 1),)),
    h.PENETRATION: ("penetration", (Scale("cm", cm, 2),)),
    h.DEFLECTION: ("peak midspan deflection", (Scale("mm", mm, 3),)),
    h.IMPACT_ENERGY: ("impact energy E0", _ENERGY),
    h.BEAM_ENERGY: ("peak beam energy (5), (6)", _ENERGY),
    h.BEAM_ENERGY_FROM_STRAIN: ("peak beam energy (7)", _ENERGY),
    h.BEAM_SHARE: ("peak beam energy (5), (6) / E0", (Scale("%", 0.01, 2),)),
    h.BEAM_SHARE_FROM_STRAIN: ("peak beam energy (7) / E0", (Scale("%", 0.01, 2),)),
    h.RESIDUAL_SHARE: ("energy residual / E0", (Scale("%", 0.01, 3, "+"),)),
}
_HUGE = 1e7
"""Numbers from here on, of runs that went astray, are written with an exponent."""
_TOO_SHORT = "the run ends before the rock has come to a stop: nothing is compared"
_TOO_SHALLOW = (
    "the rock is not driven 4 cm deep: there is no secant spring constant; raise --stop-time"
)
_STILL = "the force on the rock has not ended: impulse and duration would be larger with a later stop time"


@dataclass(frozen=True)
class Row:
    """A figure as it is shown: text per column, deviations (computed / reference - 1) as numbers."""

    label: str
    unit: str
    computed: str
    paper: str = ""
    paper_deviation: float | None = None
    experiment: str = ""
    experiment_deviation: float | None = None
    handbook: str = ""
    handbook_deviation: float | None = None


def known_of(run: Run) -> Mapping[str, h.Known]:
    """What a run is compared with: nothing if it ended before the rock had come to a stop, or is not the one others know of."""
    return {} if h.still_sinking(run) else _references(run).known


def _references(run: Run) -> References:
    """What others found for the case of a run, as its preparation has written it down."""
    return References.from_data(run.provenance.get("references", {}))


def figures(run: Run, known: Mapping[str, h.Known]) -> list[Metric]:
    """Every headline figure of a run, with what others found for it."""
    return [
        replace(
            figure,
            references={
                who: Beside(found.value, float(figure.value) / found.value - 1.0, found.note)
                for who, found in known.get(figure.name, h.Known()).by().items()
            },
        )
        for figure in h.headlines(run)
    ]


def rows(run: Run, known: Mapping[str, h.Known]) -> list[Row]:
    """The rows of the table, in the order in which a designer asks for them; of a system without an impact, its summary."""
    if h.still_sinking(run):
        known = {}
    computed = {figure.name: figure for figure in figures(run, known)}
    found = [
        row
        for name, (label, scales) in _ROWS.items()
        if name in computed
        for row in _rows(label, scales, computed[name])
    ]
    if not found:
        return [
            Row(
                figure.name,
                "" if figure.unit == "1" else figure.unit,
                figure.value if isinstance(figure.value, str) else f"{figure.value:.6g}",
            )
            for figure in run.metrics.values()
        ]
    return found + list(_piles(run)) + list(_couplings(run))


_OF_PILES: Mapping[str, tuple[Scale, ...]] = {
    h.HEAD_FORCE: (Scale("kN", kN, 2),),
    h.TOE_FORCE: (Scale("kN", kN, 2),),
    h.COMPRESSION: (Scale("MPa", 1e6, 2),),
    h.TENSION: (Scale("MPa", 1e6, 2),),
    h.TRANSFERRED: (Scale("J", 1.0, 2),),
    h.SETTLEMENT: (Scale("mm", mm, 3),),
    h.SET: (Scale("mm", mm, 3),),
}


def _piles(run: Run) -> Iterator[Row]:
    """Rods and grounds, each under its name."""
    for figure in h.headlines(run):
        what = figure.name.partition(": ")[2]
        if what in _OF_PILES:
            yield from _rows(figure.name, _OF_PILES[what], figure)


def _rows(label: str, scales: tuple[Scale, ...], figure: Metric) -> Iterator[Row]:
    """One row for each unit; the deviations stand in the first."""
    for number, scale in enumerate(scales):
        first = number == 0
        beside: dict[str, Any] = {}
        for who, found in figure.references.items():
            beside[who] = ("≈ " if found.note else "") + _written(found.value, scale)
            beside[f"{who}_deviation"] = found.deviation if first else None
        yield Row(
            label if first else "", scale.unit, _written(float(figure.value), scale), **beside
        )


def _written(value: float, scale: Scale) -> str:
    shown = value / scale.size
    return (
        f"{shown:{scale.sign}z.{scale.digits}f}"
        if abs(shown) < _HUGE
        else f"{shown:{scale.sign}.3g}"
    )


def _couplings(run: Run) -> Iterator[Row]:
    """Energy that each coupling has made, as a share of the impact energy."""
    impact = h.impact_energy(run)
    for column, values in run.series.items():
        if column.startswith("coupling.") and column.endswith(".energy"):
            bond = column.removeprefix("coupling.").removesuffix(".energy").replace("_", "-")
            if impact:
                yield Row(f"coupling {bond} / E0", "%", _written(values[-1] / impact, _SHARE[0]))
            else:
                yield Row(f"coupling {bond}", "J", f"{values[-1]:.4g}")


def notes(run: Run, known: Mapping[str, h.Known]) -> list[str]:
    """What a reader has to know of the figures: where references that are only about right (≈) come from, what is cut off."""
    remarks = list(_references(run).remarks)
    if h.still_sinking(run):
        return [*remarks, _TOO_SHALLOW if h.driven(run) else _TOO_SHORT]
    found = [
        f"≈ {who}: {reference.note}"
        for entry in known.values()
        for who, reference in entry.by().items()
        if reference.note
    ]
    return remarks + list(dict.fromkeys(found)) + ([_STILL] if h.still_in_contact(run) else [])


def warnings(run: Run) -> list[str]:
    """What a reader of the figures has to know: what the run warned of, whether the figures can be trusted, and whether the rock
    came through to the base."""
    return [*run.provenance.get("warnings", []), *_doubts(run), *_bottomed_out(run)]


_RESIDUAL_LIMIT = 0.01
"""Part of the impact energy that may be missing in the balance."""
_UNREST_LIMIT = 1e-3
_WEIGHT_LIMIT = 0.1
"""Random packs differ from their mean weight, and walls carry some of it."""


def _doubts(run: Run) -> Iterator[str]:
    """An energy balance that does not close, sand that was moving before the impact."""
    name, whole = (
        (h.RESIDUAL_WORK_SHARE, "work of the machine")
        if h.driven(run)
        else (h.RESIDUAL_SHARE, "impact energy")
    )
    share = _computed(run, name)
    if share is not None and not abs(share) <= _RESIDUAL_LIMIT:
        yield (
            f"the balance of energy does not close: {100.0 * share:+.3g} % of the {whole}; do not trust the figures, reduce "
            "the steps"
        )
    yield from _other_weight(run)
    sand = h.roles(run).sand
    if sand is None or f"{sand}.unrest" not in run.series:
        return
    unrest, gravity = (
        run.series[f"{sand}.unrest"][0],
        run.provenance["components"][sand]["parameters"]["gravity"]["value"],
    )
    if gravity and not unrest <= _UNREST_LIMIT:  # it is counted in gravity
        yield f"the sand was not at rest at the start (unrest {unrest:.2g}, at most {_UNREST_LIMIT:g}): raise settling.time"


def _other_weight(run: Run) -> Iterator[str]:
    """A beam that was bent by another weight than that of the sand on it."""
    sand, beam = h.roles(run).sand, h.roles(run).beam
    if sand is None or beam is None or f"{sand}.transmitted_force" not in run.series:
        return
    assumed = float(
        run.provenance["components"][beam]["parameters"].get("cushion.weight", {}).get("value", 0.0)
    )
    pressing = float(run.series[f"{sand}.transmitted_force"][0])
    if assumed and not abs(pressing / assumed - 1.0) <= _WEIGHT_LIMIT:
        yield (
            f"the beam does not start at rest: it was bent by {assumed / kN:.4g} kN and the sand presses with "
            f"{pressing / kN:.4g} kN; set {beam}.cushion.weight={pressing:.6g}"
        )


def _computed(run: Run, name: str) -> float | None:
    return next((float(f.value) for f in h.headlines(run) if f.name == name), None)


def _bottomed_out(run: Run) -> Iterator[str]:
    clearance, sand = _computed(run, h.CLEARANCE), h.roles(run).sand
    if clearance is not None and sand is not None:
        disc = 2.0 * float(run.provenance["components"][sand]["parameters"]["disc.radius"]["value"])
        if clearance < disc:
            where = (
                f"comes within {clearance / mm:.1f} mm of"
                if clearance > 0.0
                else f"presses {-clearance / mm:.1f} mm into"
            )
            yield (
                f"the rock bottoms out: it {where} the base, and a sand disc is {disc / mm:g} mm thick; the cushion is "
                "too thin for this impact"
            )


def caption(run: Run) -> list[str]:
    """What was run, in short lines: case; how it was changed, if it was; model of the sand; exchange and steps."""
    facts = run.provenance
    differences = facts.get("differences", {})
    changed = ", ".join(f"{name} = {value}" for name, value in differences.items())
    return [
        f"{facts['name']}: {facts['system']['description']}".removesuffix(": "),
        *filter(None, [changed and f"changed: {changed}", model(run)]),
        scheme(run),
    ]


def model(run: Run) -> str:
    """Which model of the sand was used."""
    name = h.roles(run).sand
    if name is None:
        return ""
    values = {
        key: entry["value"]
        for key, entry in run.provenance["components"][name]["parameters"].items()
    }
    kind = model_of(values) or "modified"
    modulus = float(values["modulus"]) / kgf * cm**2
    parts = [
        f"rotation {values['rotation']}",
        f"stiffness factor {float(values['stiffness_factor']):g}",
        *(
            f"{words} {float(values[key]) / unit:g}{name}"
            for key, words, idle, unit, name in _OPTIONAL
            if float(values[key]) != idle
        ),
        f"{values['packing']} packing"
        + (f" of {values['solid_fraction']}" if values["packing"] == "prepared" else ""),
        f"fictitious modulus E_bar {modulus:.1f} kgf/cm²",
    ]
    return f"{kind} sand: {', '.join(parts)}"


_OPTIONAL = (
    ("rolling_resistance", "rolling resistance", 0.0, 1.0, ""),
    ("unloading_ratio", "unloading ratio", 1.0, 1.0, ""),
    ("cohesion", "cohesion", 0.0, kgf / cm**2, " kgf/cm²"),
)
"""Parameters that the caption names where they are not idle: in words, idle value, unit."""


def scheme(run: Run) -> str:
    """How values were exchanged, and with which steps."""
    facts, system = run.provenance, run.provenance["system"]
    given = {
        name: spec["step"] or system["exchange_step"]
        for name, spec in system.get("components", {}).items()
    }
    used = {
        name: _step(entry, given.get(name, system["exchange_step"]))
        for name, entry in facts["components"].items()
    }
    steps = ", ".join(f"{name} {step:g}" for name, step in used.items() if step)
    coupling = (
        f"coupling {facts['coupling']}" if "coupling" in facts else f"{system['master']} master"
    )
    return f"{coupling}: steps in ms: exchange {system['exchange_step'] / ms:g}" + (
        f", {steps}" if steps else ""
    )


def _step(component: Mapping[str, Any], communication_step: float) -> float:
    """Longest internal step (ms) that a component makes: never longer than its communication step (s); 0 if it names none."""
    return (
        min(
            float(component["parameters"].get("internal_step", {}).get("value", 0.0)),
            communication_step,
        )
        / ms
    )


# ------------------------------------------------------------------ as a table, as data


def table(run: Run, known: Mapping[str, h.Known]) -> Table:
    """Return the rows as a table, without the columns that nothing stands in.

    Parameters
    ----------
    run : Run
        The run.
    known : mapping of str to Known
        What it is compared with, from :func:`known_of`.

    Returns
    -------
    Table
        Quantity, unit, computed value, references and deviations.
    """
    listed = rows(run, known)
    columns = [
        ("paper", "paper", [row.paper for row in listed]),
        ("", "paper", [_percent(row.paper_deviation) for row in listed]),
        ("experiment", "experiment", [row.experiment for row in listed]),
        ("", "experiment", [_percent(row.experiment_deviation) for row in listed]),
        ("handbook", "handbook", [row.handbook for row in listed]),
        ("", "handbook", [_percent(row.handbook_deviation) for row in listed]),
    ]
    present = {whose for _, whose, texts in columns if any(texts)}
    shown = [(title, texts) for title, whose, texts in columns if whose in present]
    titles = ["computed", *(title for title, _ in shown)]
    made = Table(("quantity", "unit", *titles), right=titles)
    for number, row in enumerate(listed):
        made.add(row.label, row.unit, row.computed, *(texts[number] for _, texts in shown))
    return made


def _percent(deviation: float | None) -> str:
    return "" if deviation is None else f"{100.0 * deviation:+.0f} %"
