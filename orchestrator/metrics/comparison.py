"""The table at the end of a run: metrics with the values of the paper and of the experiment."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

from rockshed.components.common.units import SCREEN_UNITS

from ..core.results.facts import table_of
from ..core.results.metric import Beside, Metric
from ..core.results.reading import StoredRun
from ..references import EXPERIMENT, PAPER, Known, References
from ..tables import Table
from . import names
from .caption import caption as caption
from .cushion import still_in_contact, still_sinking
from .doubts import warnings as warnings
from .energy import driven, impact_energy, weightless
from .headlines import headlines
from .meanings import (
    COUPLING_MEANING,
    COUPLING_ROW,
    MEANINGS,
    UTILISATION_MEANING,
    UTILISATION_ROW,
)
from .mesh import mesh_in_words
from .reported import ReportedMetric, reported
from .screen_units import is_shown_in, screen_unit
from .slope import slope_notes
from .structure_notes import on_structures


@dataclass(frozen=True)
class Scale:
    """A unit on the screen.

    Attributes
    ----------
    unit : str
        Key of :data:`rockshed.components.common.units.SCREEN_UNITS`.
    decimals : int
        Digits after the point.
    sign : str
        ``+`` where the sign of positive values is written.
    """

    unit: str
    decimals: int
    sign: str = ""


_SETTLED = (
    (names.SETTLED_TRANSMITTED, names.PEAK_TRANSMITTED),
    (names.SETTLED_ROCK, names.PEAK_ROCK),
)
"""Metrics of filtered forces, and of the same forces as they are."""
_ABOVE = 1.01
"""Ratio of both from which on the filter's overshoot is explained."""
_DIGITS = 4
"""Digits of a number, at most; those before the point are all written."""
_FORCE = (Scale("kN", 2), Scale("kgf", 0))
_ENERGY = (Scale("J", 2), Scale("kgf cm", 1))
_TIME = (Scale("ms", 2),)
_PLACE = (Scale("m", 3),)
_ROWS: Mapping[str, tuple[str, tuple[Scale, ...]]] = {
    names.STATIC_LOAD: ("load at 4 cm", _FORCE),
    names.STATIC_STIFFNESS: (
        "secant spring constant k",
        (Scale("kN/m", 1), Scale("kgf/cm", 1)),
    ),
    names.STATIC_DEPARTURE: ("departure from the secant line", (Scale("%", 1),)),
    names.MACHINE_WORK: ("work of the machine", _ENERGY),
    names.RESIDUAL_WORK_SHARE: ("energy residual / work of the machine", (Scale("%", 3, "+"),)),
    names.PEAK_TRANSMITTED: ("peak transmitted force", _FORCE),
    names.PEAK_TRANSMITTED_AT: ("  at", _TIME),
    names.PEAK_LOAD_CELL: ("  through the load cell", _FORCE),
    names.LOAD_CELL_CUT_OFF: ("  load cell: below", (Scale("Hz", 0),)),
    names.PEAK_ROCK: ("peak force on the rock", _FORCE),
    names.PEAK_ROCK_AT: ("  at", _TIME),
    names.RATIO: ("ratio of the two peaks", (Scale("1", 2),)),
    names.SETTLED_TRANSMITTED: ("settled transmitted force", _FORCE),
    names.SETTLED_ROCK: ("settled force on the rock", _FORCE),
    names.SETTLED_RATIO: ("ratio of the settled maxima", (Scale("1", 2),)),
    names.SETTLED_CUT_OFF: ("  settled: below", (Scale("Hz", 0),)),
    names.IMPULSE_TRANSMITTED: ("transmitted impulse", (Scale("N s", 1),)),
    names.IMPULSE_ROCK: ("impulse on the rock", (Scale("N s", 1),)),
    names.DURATION: ("duration on the rock", (Scale("ms", 1),)),
    names.RISE_ROCK: ("rise time on the rock, 10 to 90 %", (Scale("ms", 1),)),
    names.RISE_TRANSMITTED: ("rise time of the transmitted force", (Scale("ms", 1),)),
    names.SHAPE: ("pulse shape (half sine 0.64, triangle 0.50)", (Scale("1", 2),)),
    names.PENETRATION: ("penetration", (Scale("cm", 2),)),
    names.PENETRATION_SHARE: ("  / thickness of the cushion", (Scale("%", 0),)),
    names.PEAK_PRESSURE: ("peak pressure on the roof", (Scale("kPa", 0),)),
    names.PEAK_PRESSURE_AT: ("  at", (Scale("ms", 2),)),
    names.PEAK_PRESSURE_PLACE: ("  at the place x", (Scale("m", 2),)),
    names.LOAD_HALF: ("half of the load within", (Scale("m", 2),)),
    names.LOAD_MOST: ("90 % of the load within", (Scale("m", 2),)),
    names.SPREAD_ANGLE: ("  spread angle (45 is practice)", (Scale("deg", 0),)),
    names.DEFLECTION: ("peak midspan deflection", (Scale("mm", 3),)),
    names.RESIDUAL_DEFLECTION: ("residual midspan deflection", (Scale("mm", 3),)),
    names.PEAK_MOMENT: ("peak bending moment (+ sagging, - hogging)", (Scale("kN m", 3),)),
    names.PEAK_MOMENT_AT: ("  at", _TIME),
    names.PEAK_MOMENT_PLACE: ("  at x =", _PLACE),
    names.PEAK_SAGGING: ("peak sagging moment", (Scale("kN m", 3),)),
    names.PEAK_HOGGING: ("peak hogging moment", (Scale("kN m", 3),)),
    names.PEAK_SHEAR: ("peak shear force (+ left part pushes up)", (Scale("kN", 2),)),
    names.PEAK_SHEAR_AT: ("  at", _TIME),
    names.PEAK_SHEAR_PLACE: ("  at x =", _PLACE),
    names.PEAK_STRESS: ("peak bending stress, elastic: M/W", (Scale("MPa", 1),)),
    names.PEAK_REACTION: ("peak reaction of a support, upwards", (Scale("kN", 2),)),
    names.PEAK_REACTION_AT: ("  at", _TIME),
    names.CURVATURE_RATIO: ("largest curvature / where capacity ends", (Scale("1", 2),)),
    names.PLASTIC_WORK: ("work of yielding and cracking", _ENERGY),
    names.IMPACT_ENERGY: ("impact energy E0", _ENERGY),
    names.BEAM_ENERGY: ("peak beam energy (5), (6)", _ENERGY),
    names.BEAM_ENERGY_FROM_STRAIN: ("peak beam energy (7)", _ENERGY),
    names.BEAM_SHARE: ("peak beam energy (5), (6) / E0", (Scale("%", 2),)),
    names.BEAM_SHARE_FROM_STRAIN: ("peak beam energy (7) / E0", (Scale("%", 2),)),
    names.GRAVITY_SHARE: ("given by gravity until the end / E0", (Scale("%", 1),)),
    names.DISSIPATED_SHARE: ("dissipated at the end / E0", (Scale("%", 1),)),
    names.REBOUND_SHARE: ("kinetic energy of the rock at the end / E0", (Scale("%", 1),)),
    names.RESIDUAL_SHARE: ("energy residual / E0", (Scale("%", 3, "+"),)),
}
"""Label and units of each row, by the name of the metric, in the order in which a designer asks for
them."""
_HUGE = 1e7
"""Numbers from here on, of runs that went astray, are written with an exponent."""
_TOO_SHORT = "the run ends before the rock has come to a stop: nothing is compared"
_TOO_SHALLOW = (
    "the rock is not driven 4 cm deep: there is no secant spring constant; let the run end later"
)
_FAILED = "the run has failed: nothing is compared, and nothing is said about the design"
_STILL = (
    "the force on the rock has not ended: impulse and duration would be larger with a later stop "
    "time"
)


@dataclass(frozen=True)
class ComparedRow:
    """A metric as it is shown.

    Attributes
    ----------
    label, unit, computed : str
        Texts of the first columns.
    beside : mapping of str to tuple of str and float or None
        By who found it: the reference as text, and the deviation, computed / reference - 1; None
        where it stands in another row.
    """

    label: str
    unit: str
    computed: str
    beside: Mapping[str, tuple[str, float | None]] = field(default_factory=dict)


def known_of(run: StoredRun) -> Mapping[str, Known]:
    """Return the references of a run, as its preparation has written them down.

    Parameters
    ----------
    run : StoredRun
        The run.

    Returns
    -------
    mapping of str to Known
        By the name of the metric; empty if the run ended before the rock had come to a stop.
    """
    return {} if run.has_failed or still_sinking(run) else _references(run).known


def _references(run: StoredRun) -> References:
    return References.from_data(run.provenance.get("references", {}))


def figures(run: StoredRun, known: Mapping[str, Known]) -> list[Metric]:
    """Return every headline metric of a run with its references.

    Parameters
    ----------
    run : StoredRun
        The run.
    known : mapping of str to Known
        References by the name of the metric, from :func:`known_of`.
    """
    return [_compared(metric, known.get(metric.name, Known())) for metric in headlines(run)]


def _compared(metric: Metric, known: Known) -> Metric:
    references = {
        who: Beside(found.value, float(metric.value) / found.value - 1.0, found.note)
        for who, found in known.by().items()
    }
    return replace(metric, references=references)


def rows(run: StoredRun, known: Mapping[str, Known]) -> list[ComparedRow]:
    """Return the rows of the table.

    Parameters
    ----------
    run : StoredRun
        The run.
    known : mapping of str to Known
        References by the name of the metric, from :func:`known_of`.

    Returns
    -------
    list of ComparedRow
        In the order in which a designer asks for them; of a system without any of them, its
        summary.
    """
    computed = figures(run, {} if still_sinking(run) else known)
    shown = [
        row
        for name in _ROWS
        for metric in computed
        if names.without_component(metric.name) == name
        for row in _headline_rows(run, metric, name)
    ]
    shown += [row for metric in computed for row in _utilisation_rows(metric)]
    shown += [
        row
        for entry in reported(run)
        for row in _rows(entry.metric.name, _scales(run, [_declared(entry)]), entry.metric)
    ]
    if not shown:
        return [_plain(metric) for metric in run.metrics.values()]
    return shown + list(_couplings(run))


@dataclass(frozen=True)
class ShownMetric:
    """A metric in the first of its units on the screen.

    Attributes
    ----------
    name : str
        Of the metric.
    label, unit : str
        Texts of the first columns.
    scale : Scale
        Unit and decimals.
    """

    name: str
    label: str
    unit: str
    scale: Scale

    def written(self, value: float) -> str:
        """Return a value (SI) of the metric as it is shown."""
        return _written(value, self.scale)


def shown_metrics(run: StoredRun) -> list[ShownMetric]:
    """Return the metrics of the table of a run, in its order, each once.

    Parameters
    ----------
    run : StoredRun
        The run.

    Returns
    -------
    list of ShownMetric
        Times and places under a peak have its name in their label.
    """
    computed = headlines(run)
    found = [
        _shown(metric.name, f"{metric.name.removesuffix(name)}{_full_label(name)}", scales[0])
        for name, (_, scales) in _ROWS.items()
        for metric in computed
        if names.without_component(metric.name) == name
    ]
    found += [
        _shown(metric.name, f"utilisation: {criterion}", Scale("1", 2))
        for metric in computed
        if (criterion := names.criterion_of(names.without_component(metric.name)))
    ]
    found += [
        _shown(entry.metric.name, entry.metric.name, Scale(entry.unit, entry.decimals))
        for entry in reported(run)
    ]
    return found


def _full_label(name: str) -> str:
    """Return the label of a row by itself: one that is indented belongs to the row above."""
    label = _ROWS[name][0]
    return label if not label.startswith(" ") else name


def _shown(name: str, label: str, scale: Scale) -> ShownMetric:
    return ShownMetric(name, label, "" if scale.unit == "1" else scale.unit, scale)


def _plain(metric: Metric) -> ComparedRow:
    value = metric.value if isinstance(metric.value, str) else f"{metric.value:.6g}"
    return ComparedRow(metric.name, "" if metric.unit == "1" else metric.unit, value)


def _headline_rows(run: StoredRun, metric: Metric, name: str) -> Iterator[ComparedRow]:
    """Yield the rows of a headline metric; of one among several, with the name of its component."""
    label, scales = _ROWS[name]
    owner = metric.name.removesuffix(name)
    return _rows(f"{owner}{label}", _scales(run, scales), metric)


def _declared(entry: ReportedMetric) -> Scale:
    return Scale(entry.unit, entry.decimals)


def _scales(run: StoredRun, scales: Sequence[Scale]) -> list[Scale]:
    """Return the units in which a run is shown: kgf for cases of papers, kJ of large energies."""
    return [
        replace(scale, unit=screen_unit(scale.unit, run))
        for scale in scales
        if is_shown_in(scale.unit, run)
    ]


def _utilisation_rows(metric: Metric) -> Iterator[ComparedRow]:
    """Yield the row of a metric that compares the run with a criterion; none of another metric."""
    criterion = names.criterion_of(names.without_component(metric.name))
    if criterion:
        yield from _rows(f"utilisation: {criterion}", (Scale("1", 2),), metric)


def _rows(label: str, scales: Sequence[Scale], metric: Metric) -> Iterator[ComparedRow]:
    """Yield one row for each unit; the deviations stand in the first."""
    for number, scale in enumerate(scales):
        first = number == 0
        beside = {
            who: (
                ("≈ " if found.note else "") + _written(found.value, scale),
                found.deviation if first else None,
            )
            for who, found in metric.references.items()
        }
        unit = "" if scale.unit == "1" else scale.unit
        computed = _written(float(metric.value), scale)
        yield ComparedRow(label if first else "", unit, computed, beside)


def _written(value: float, scale: Scale) -> str:
    shown = value / SCREEN_UNITS[scale.unit]
    if abs(shown) < _HUGE:
        before_point = len(f"{abs(shown):.0f}")
        decimals = min(scale.decimals, max(_DIGITS - before_point, 0))
        return f"{shown:{scale.sign}z.{decimals}f}"
    return f"{shown:{scale.sign}.3g}"


def _couplings(run: StoredRun) -> Iterator[ComparedRow]:
    """Yield the energy that each coupling has made, as a share of the impact energy."""
    impact = impact_energy(run)
    for column, values in run.series.items():
        if column.startswith("coupling.") and column.endswith(".energy"):
            bond = column.removeprefix("coupling.").removesuffix(".energy").replace("_", "-")
            if impact:
                yield ComparedRow(
                    f"coupling {bond} / E0", "%", _written(values[-1] / impact, Scale("%", 3))
                )
            else:
                yield ComparedRow(f"coupling {bond}", "J", f"{values[-1]:.4g}")


def notes(run: StoredRun, known: Mapping[str, Known]) -> list[str]:
    """Return what a reader of the table has to know.

    Parameters
    ----------
    run : StoredRun
        The run.
    known : mapping of str to Known
        References by the name of the metric, from :func:`known_of`.

    Returns
    -------
    list of str
        Why something is not compared, what the numbers of a structure are, weights left out, where
        references that are only about right (≈) come from, what the end of the run has cut off,
        why a settled force is above the peak, and how far the results hang on the mesh.
    """
    remarks = [*_references(run).remarks, *slope_notes(run), *_of_design(run)]
    remarks += [
        f"{name}: its gravity is 0, so moment and reactions are those beyond its own weight"
        for name in weightless(run)
    ]
    if run.has_failed:
        return [*remarks, _FAILED]
    remarks += on_structures(run)
    if still_sinking(run):
        return [*remarks, _TOO_SHALLOW if driven(run) else _TOO_SHORT]
    origins = [
        f"≈ {who}: {reference.note}"
        for entry in known.values()
        for who, reference in entry.by().items()
        if reference.note
    ]
    still = [_STILL] if still_in_contact(run) else []
    still += _narrow(run)
    mesh = [text] if (text := mesh_in_words(run)) else []
    return [*remarks, *dict.fromkeys(origins), *still, *_overshooting(run), *mesh]


def _narrow(run: StoredRun) -> list[str]:
    """Say it where the load on the roof is narrower than the rock."""
    values = {names.without_component(metric.name): metric.value for metric in headlines(run)}
    if float(values.get(names.SPREAD_ANGLE, 0.0)) >= 0.0:
        return []
    return [
        f"spread angle below 0: 90 % of the load lie within {float(values[names.LOAD_MOST]):.2g} m "
        "of its centre, nearer than the edge of the rock: the cushion does not spread it"
    ]


def _of_design(run: StoredRun) -> list[str]:
    """Return what the project of a run says of itself."""
    told = table_of(run.provenance, "design").get("notes", ())
    return [str(text) for text in told] if isinstance(told, list | tuple) else []


def _overshooting(run: StoredRun) -> list[str]:
    """Say why a settled maximum lies above the peak, where one does."""
    values = {metric.name: metric.value for metric in headlines(run)}
    return [
        f"{settled}: is above the peak because the filter, which leaves out what is faster than "
        f"{float(values[names.SETTLED_CUT_OFF]):.3g} Hz, overshoots where a force rises quickly; "
        "the peak is the larger force that acts"
        for settled, peak in _SETTLED
        if settled in values and float(values[settled]) > _ABOVE * float(values[peak])
    ]


def table(run: StoredRun, known: Mapping[str, Known]) -> Table:
    """Return the rows as a table, without the columns that nothing stands in.

    Parameters
    ----------
    run : StoredRun
        The run.
    known : mapping of str to Known
        References by the name of the metric, from :func:`known_of`.

    Returns
    -------
    Table
        Quantity, unit, computed value, references and deviations.
    """
    listed = rows(run, known)
    named = dict.fromkeys(who for row in listed for who in row.beside)
    sources = [*(who for who in (PAPER, EXPERIMENT) if who in named), *named]
    sources = list(dict.fromkeys(sources))
    titles = ["computed", *(title for who in sources for title in (who, ""))]
    made = Table(("quantity", "unit", *titles), right=titles)
    for row in listed:
        cells = [row.beside.get(who, ("", None)) for who in sources]
        shown = (text for value, deviation in cells for text in (value, _percent(deviation)))
        made.add(row.label, row.unit, row.computed, *shown)
    return made


def meanings(run: StoredRun) -> Table:
    """Return the meanings of the rows that the table of a run has.

    Parameters
    ----------
    run : StoredRun
        The run.

    Returns
    -------
    Table
        A row for each row of the table that is not clear by itself.
    """
    computed = {names.without_component(metric.name) for metric in headlines(run)}
    shown = {_ROWS[name][0].strip(): words for name, words in MEANINGS.items() if name in computed}
    if any(names.criterion_of(name) for name in computed):
        shown[UTILISATION_ROW] = UTILISATION_MEANING
    if next(_couplings(run), None):
        shown[COUPLING_ROW] = COUPLING_MEANING
    made = Table(("row", "meaning"))
    for label, words in shown.items():
        made.add(label, words)
    return made


def every_meaning() -> dict[str, str]:
    """Return the meanings of all rows that a table may have, by their labels."""
    return {
        **{_ROWS[name][0].strip(): words for name, words in MEANINGS.items()},
        UTILISATION_ROW: UTILISATION_MEANING,
        COUPLING_ROW: COUPLING_MEANING,
    }


def _percent(deviation: float | None) -> str:
    return "" if deviation is None else f"{100.0 * deviation:+.0f} %"
