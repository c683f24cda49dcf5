"""The report of a run, finished or not."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from rockshed.components.common.units import ms, tonne

from ..core.errors import InputRefused
from ..core.results.facts import number_of, table_of, tables_of, texts_of
from ..core.results.reading import StoredRun
from ..core.system.reading import system_from
from ..files import write_file
from ..metrics import comparison, contents
from ..metrics.caption import models
from ..metrics.contents import ForeignStateError
from ..metrics.divergence import note_of, until_divergence
from ..metrics.practice import formula_table
from ..metrics.roles import parameters as values_of
from ..metrics.slope import AS_SPHERE, slope_notes, slope_of, slope_table
from ..metrics.structure_notes import on_structures
from ..metrics.width_band import width_band_table
from ..pictures import RunPicture, pictures_of
from ..pictures.diagram import system_diagram
from ..runs.run import Run
from ..tables import Table, digits
from . import inputs, origin
from .charts import charts_of
from .film import film_of
from .form import Chapter, Chart, Document, Film, Illustration
from .step_halving import StepHalving, in_words

_FRAME = (
    "Frame: x to the right, y upwards, angles counter-clockwise. Forces are named by what they act "
    "on. Times count from the start of the run."
)

_SHARP = ".svg"


def report_of_run(
    run: Run, halving: StepHalving | None, without: str = "", repeat: str = ""
) -> Document:
    """Return the report of a run.

    Parameters
    ----------
    run : Run
        Finished or not.
    halving : StepHalving or None
        The check by halved steps.
    without : str
        Why there is no such check.
    repeat : str
        Command that repeats the run; by default lines of Python.

    Returns
    -------
    Document
        With what there is: of a run that failed, until then.
    """
    chapters = [
        *_warnings(run),
        *_results(run),
        *_formulas(run),
        *_effective_width(run),
        *_illustrations(run),
        *_slope(run),
        *_system(run),
        *_inputs(run),
        _assumptions(run),
        *_meanings(run),
        _check(halving, without),
        _origin(run),
        *_repetition(run, repeat),
    ]
    return Document(title_of(run), run.caption if run.time.size else [], status_of(run), chapters)


def title_of(run: StoredRun) -> str:
    """Return the title of a run, of the values that were computed with.

    Parameters
    ----------
    run : StoredRun
        The run.
    """
    name = str(run.provenance.get("name", "run"))
    rock, cushion, roof = (
        table_of(run.provenance, "design", p) for p in ("rock", "cushion", "roof")
    )
    mass, height = number_of(rock, "mass"), number_of(rock, "drop_height")
    slope = slope_of(run)
    thickness = number_of(cushion, "thickness")
    words = [
        _mass(mass) if mass else "",
        f"from {digits(height, 3)} m" if height and not slope else "",
        f"from the slope {slope['name']}" if slope else "",
        f"on {digits(thickness, 3)} m of {_material(cushion)}" if thickness else "",
        f"over {roof['section']}" if roof.get("section") else "",
    ]
    told = " ".join(filter(None, words))
    return f"{name}: {told}" if told else name


def _material(cushion: Mapping[str, Any]) -> str:
    """Return the name of the material of a cushion; of a cushion without one, sand."""
    return str(next(iter(table_of(cushion, "materials")), "sand"))


def _mass(mass: float) -> str:
    """Return a mass (kg) in the unit in which one says it."""
    return f"{digits(mass / tonne, 3)} t" if mass >= tonne else f"{digits(mass, 3)} kg"


def status_of(run: StoredRun) -> str:
    """Return why a run is not complete; empty if it is.

    Parameters
    ----------
    run : StoredRun
        The run.
    """
    if run.status == "complete":
        return ""
    reached = f"until t = {1e3 * run.time[-1]:g} ms" if run.time.size else "before its first row"
    told = {
        "failed": f"This run failed. It is reported on what was computed {reached}. {run.error}",
        "interrupted": f"This run was interrupted {reached}, and is reported on until then.",
    }
    killed = (
        f"This run has not ended: it goes on, or was killed. Reported is what there is {reached}."
    )
    return told.get(run.status, killed)


def _warnings(run: Run) -> Iterator[Chapter]:
    texts = run.warnings
    if texts:
        yield Chapter("Warnings", texts, alarm=True)


def _results(run: Run) -> Iterator[Chapter]:
    if not run.time.size:
        return
    made = run.table()
    if len(made):
        deviation = "Deviations from what others found are computed / reference - 1."
        told = [deviation] if len(made.columns) > len(("quantity", "unit", "computed")) else []
        yield Chapter("Results", [*told, *run.notes], [made])


def _meanings(run: Run) -> Iterator[Chapter]:
    """Yield the meanings of the rows, on the page only when they are asked for."""
    if run.time.size and len(made := comparison.meanings(run)):
        yield Chapter("What the rows mean", tables=[made], folded=True)


def _formulas(run: StoredRun) -> Iterator[Chapter]:
    """Yield the formulas of practice beside the run, where it has them."""
    estimates = tables_of(run.provenance, "formulas")
    if not estimates:
        return
    made = Table(("formula", "quantity", "value", "unit", "source", "remark"), right=("value",))
    for told in estimates:
        doubts = [
            "" if told.get("verified", True) else "source not verified",
            "outside of its range" if told.get("within_range") is False else "",
            *(str(told.get(key) or "") for key in ("validity", "remark")),
        ]
        made.add(
            *(str(told.get("name", "")), str(told.get("quantity", ""))),
            *_in_screen_unit(number_of(told, "value") or 0.0, str(told.get("unit", "1"))),
            *(str(told.get("source", "")), "; ".join(filter(None, doubts))),
        )
    beside = formula_table(run)
    deviations = [Table(beside.columns, beside.rows, beside.right, "deviation of this run")]
    yield Chapter("Formulas of practice", tables=[*(deviations if len(beside) else []), made])


def _effective_width(run: StoredRun) -> Iterator[Chapter]:
    """Yield the band of the effective width, where it was computed."""
    band = width_band_table(run)
    if len(band):
        text = "The same project with the smallest and the largest effective width of all rules."
        yield Chapter("Effective width", [text], [band])


def _slope(run: StoredRun) -> Iterator[Chapter]:
    """Yield campaign and choice of the slope that the rock comes from, where there is one."""
    told = slope_of(run)
    if told:
        yield Chapter("Slope", slope_notes(run), [slope_table(run)])


def _in_screen_unit(value: float, unit: str) -> tuple[str, str]:
    """Return a value in SI as a table shows it, and its unit."""
    if unit == "N":
        return digits(value / 1e3, 3), "kN"
    return digits(value, 3), "" if unit == "1" else unit.replace(".", " ")


def _illustrations(run: StoredRun) -> Iterator[Chapter]:
    """Yield the pictures that the results allow; of the others, why there are none."""
    if not run.time.size:
        return
    run = until_divergence(run)
    charts = charts_of(run)
    films: dict[str, Film | None] = {}
    made: list[Illustration] = []
    remarks: list[str] = [f"{text[0].upper()}{text[1:]}." for text in note_of(run)]
    for picture in pictures_of(run):
        if missing := picture.missing(run):
            remarks.append(f"No picture {picture.name}: the run has no {', '.join(missing)}.")
            continue
        try:
            made.append(_illustration(run, picture, charts, films))
        except ForeignStateError as error:
            remarks.append(f"No picture {picture.name}: another version made its states ({error}).")
    if made or remarks:
        yield Chapter("Figures", remarks, illustrations=made)


def _illustration(
    run: StoredRun,
    picture: RunPicture,
    charts: Mapping[str, Sequence[Chart]],
    films: dict[str, Film | None],
) -> Illustration:
    """Return a picture with its charts; the first picture of a cushion's states has their film."""
    title = picture.name.replace("_", " ").capitalize()
    shown = charts.get(picture.name, ())
    if picture.states_of is None or shown:
        return Illustration(title, shown, draw=picture.draw, printed=_SHARP)
    if picture.states_of in films:
        return Illustration(title, draw=picture.draw, on_page=False, printed=_SHARP)
    film = films[picture.states_of] = film_of(run, picture.states_of)
    return Illustration(title, film=film, draw=picture.draw, printed=_SHARP)


def _system(run: StoredRun) -> Iterator[Chapter]:
    """Yield the diagram of the system."""
    try:
        system = system_from(table_of(run.provenance, "system"))
    except InputRefused:  # another version wrote it
        return
    loops = texts_of(run.provenance, "loops")
    fmus = {name: str(fmu) for name, fmu in table_of(run.provenance, "fmus").items()}
    drawn = Illustration(
        "Components, their steps, and the values that go between them",
        draw=lambda file: write_file(file, system_diagram(system, loops, fmus)),
        printed=_SHARP,
        shown=_SHARP,
    )
    yield Chapter("System", illustrations=[drawn])


def _inputs(run: StoredRun) -> Iterator[Chapter]:
    content = inputs.project_text(run)
    tables = [*inputs.project_tables(run)]
    tables += filter(None, (inputs.differences(run), inputs.shared_values(run)))
    description = str(table_of(run.provenance, "system").get("description", ""))
    told = [f"{run.provenance.get('case', 'system')}: {description}"] if description else []
    if content:
        file = table_of(run.provenance, "project").get("file") or "that was given in Python"
        told = [f"The project {file}, as it was when the run was made:"]
    yield Chapter("Inputs", told, tables, content)
    derived = inputs.derived(run)
    if derived is not None:
        yield Chapter("Derived from the project", tables=[derived], folded=True)
    yield Chapter("All parameters", tables=list(inputs.parameters(run)), folded=True)


def _assumptions(run: StoredRun) -> Chapter:
    """Return what the figures rest on: models, what is calibrated, width, frame."""
    told = [_FRAME]
    told += [f"Model: {text}." for text in models(run)]
    told += [str(text) for text in table_of(run.provenance, "design").get("notes", ())]
    told += [f"{AS_SPHERE[0].upper()}{AS_SPHERE[1:]}."] if slope_of(run) else []
    if words := run.provenance.get("coupling_words"):
        told.append(f"Coupling {run.provenance['coupling']}: {words}.")
    for component in run.provenance["components"]:
        known = contents.measures(run, component)
        assumed = getattr(known, "assumptions", None)
        told += assumed(values_of(run, component)) if assumed else []
    cushion = table_of(run.provenance, "design", "cushion")
    width = number_of(cushion, "effective_width")
    if width:
        rule = f", by the rule {cushion['rule']}" if cushion.get("rule") else ""
        told.append(f"Effective width of the plane model: {digits(width, 4)} m{rule}.")
    told += on_structures(run)
    return Chapter("Assumptions", list(dict.fromkeys(told)))


def _check(halving: StepHalving | None, without: str) -> Chapter:
    title = "Check by halved steps"
    if halving is None:
        return Chapter(title, [without or "The run was not made again with half of its steps."])
    return Chapter(title, [in_words(halving)], [halving.table])


def _origin(run: StoredRun) -> Chapter:
    told = [scheme_of(run)] if run.provenance.get("system") else []
    return Chapter("Origin", told, [origin.circumstances(run), origin.fmus(run)])


def scheme_of(run: StoredRun) -> str:
    """Return how long the run was to be, and how often values were exchanged and recorded.

    Parameters
    ----------
    run : StoredRun
        The run.
    """
    system: Mapping[str, Any] = run.provenance["system"]
    step = float(system["exchange_step"])
    interval = number_of(system, "output_interval") or step
    stop = number_of(system, "stop_time") or 0.0
    return (
        f"Simulated time {digits(stop, 6)} s, exchange every {digits(step / ms)} ms by the "
        f"{system['master']} master, rows every {digits(interval / ms)} ms."
    )


def _repetition(run: StoredRun, repeat: str) -> Iterator[Chapter]:
    told = table_of(run.provenance, "request")
    if told:
        listing = repeat or origin.in_python(told, "project" in run.provenance)
        yield Chapter("How to repeat it", ["With the versions above:"], listing=listing)
