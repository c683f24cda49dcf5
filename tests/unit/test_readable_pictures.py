"""Every picture of a run can be read, whatever was computed: no text covers another or is cut."""

from dataclasses import replace

import numpy as np
import pytest

from rockshed.pictures import draw_all, sand
from rockshed.pictures.sheet import LEGEND_SIZE, Sheet, legend_columns, width_of
from tests.drawn_text import faults

LONG = "a component with a name of which nobody can say that it is short " * 2


def test_a_legend_has_no_more_columns_than_its_panel_has_room_for():
    """Matplotlib shares four names in three columns out as 2, 1, 1."""
    names = ["m" * 40] * 4
    three = 3 * (width_of(names[0], LEGEND_SIZE) + 0.7)
    assert legend_columns(names, three) == 3
    assert legend_columns(names, 0.8 * three) == 2


@pytest.fixture(scope="module")
def plain(short_impact):
    return short_impact


def with_facts(run, **facts):
    return replace(run, provenance={**run.provenance, **facts})


def much_changed(run):
    values = {f"slope.profile.point[{i}].height": 0.6122930790163246 * i for i in range(180)}
    system = {**run.provenance["system"], "description": "a very long description " * 40}
    return with_facts(run, differences=values, name="a name " * 40, system=system)


def renamed(run):
    """The beam and the rock have names that fill a line, with signs that mean something elsewhere."""
    names = {"beam": f"{LONG}$x_1$", "rock": f"_{LONG}"}

    def new(name):
        head, dot, rest = name.partition(".")
        return names.get(head, head) + dot + rest

    facts = run.provenance
    system = {**facts["system"], "components": _keys(facts["system"]["components"], new)}
    return replace(
        with_facts(run, components=_keys(facts["components"], new), system=system),
        columns=[replace(column, name=new(column.name)) for column in run.columns],
        series=_keys(run.series, new),
    )


def _keys(mapping, new):
    return {new(key): value for key, value in mapping.items()}


def scaled(run, factor):
    series = {
        name: values if name == "time" or ".position." in name else factor * values
        for name, values in run.series.items()
    }
    return replace(run, series=series, metrics=type(run.metrics)())


def one_row(run):
    series = {name: values[:1] for name, values in run.series.items()}
    return replace(run, series=series, metrics=type(run.metrics)())


EXTREMES = {
    "plain": lambda run: run,
    "hundreds of changed values": much_changed,
    "long names": renamed,
    "huge numbers": lambda run: scaled(run, 1e12),
    "very huge numbers": lambda run: scaled(run, 1e30),
    "tiny numbers": lambda run: scaled(run, 1e-9),
    "nothing but zeros": lambda run: scaled(run, 0.0),
    "a single row": one_row,
    "all at once": lambda run: renamed(much_changed(scaled(run, -1e9))),
    "a run that failed": lambda run: with_facts(run, status="failed", error="diverged " * 50),
}
QUICK = ("all at once",)


@pytest.fixture
def seen(monkeypatch):
    """What is wrong with the figures that are written, by their caption or number."""
    wrong = {}
    write = Sheet.savefig

    def looked_at(figure, file, **options):
        if found := faults(figure):
            wrong[file.name] = found
        write(figure, file, **options)

    monkeypatch.setattr(Sheet, "savefig", looked_at)
    return wrong


def drawn(run, folder):
    """Draw all pictures; every one is drawn, and without a warning."""
    told = []
    files = draw_all(run, folder, told.append, told.append)
    assert not told
    return files


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(
    "extreme",
    [name if name in QUICK else pytest.param(name, marks=pytest.mark.slow) for name in EXTREMES],
)
def test_pictures_of_a_run_can_be_read(plain, extreme, seen, tmp_path):
    files = drawn(EXTREMES[extreme](plain), tmp_path)
    assert {file.stem for file in files} >= {"overview", "sand", "forces", "penetration", "energy"}
    assert not seen


def sunk(state, way):
    """A state whose beam has gone down by so much in its middle."""
    beam = state.beam
    middle = 0.5 * (beam.x[0] + beam.x[-1])
    shape = np.clip(1.0 - np.abs(beam.x - middle) / (beam.x[-1] - middle), 0.0, 1.0)
    return replace(state, beam=replace(beam, y=beam.y - way * shape))


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("way", [0.5, pytest.param(20.0, marks=pytest.mark.slow)])
def test_a_deep_deflection_stays_in_pictures_that_can_be_read(
    plain, way, seen, tmp_path, monkeypatch
):
    decoded = sand.decoded
    monkeypatch.setattr(sand, "decoded", lambda *args: sunk(decoded(*args), way))
    sand.snapshots(plain, "sand", tmp_path / "sand.png")
    sand.overview(plain, "sand", {}, tmp_path / "overview.png")
    assert not seen


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("side_by_side", [False, True])
def test_variables_of_several_runs_can_be_read(plain, side_by_side):
    other = much_changed(scaled(plain, 1e7))
    names = ("sand.transmitted_force", "rock.velocity.*", "beam.moment[*]")
    figure = plain.plot(*names, beside=[other], side_by_side=side_by_side)
    assert not faults(figure)
