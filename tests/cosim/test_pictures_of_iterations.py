"""The picture of the implicit master: iterations over time, residuals of kept exchanges."""

from dataclasses import replace

import pytest

from rockshed.core.errors import RunFailed
from rockshed.core.results.reading import read_run
from rockshed.pictures import draw_all, pictures_of
from rockshed.pictures.sheet import Sheet
from tests.cosim.test_implicit import pair, run
from tests.drawn_text import faults


@pytest.fixture
def figures(monkeypatch):
    """The figures that are written."""
    made = []
    write = Sheet.savefig

    def kept(figure, file, **options):
        made.append(figure)
        write(figure, file, **options)

    monkeypatch.setattr(Sheet, "savefig", kept)
    return made


def drawn(stored, folder, figures):
    """The panels of the picture, which can be read."""
    told = []
    files = draw_all(stored, folder, told.append, told.append)
    assert [file.name for file in files] == ["iterations.png"]
    assert not told
    (figure,) = figures
    assert not faults(figure)
    return figure.axes


def ways(axes):
    """Numbers of points of the curves of a panel, without what stands in the legend alone."""
    return [
        line.get_xdata().size
        for line in axes.get_lines()
        if len(line.get_xdata()) and line.get_label().startswith("_")
    ]


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("steps", [{}, {"a": 0.02}])
def test_it_has_each_residual_of_the_exchanges_that_are_kept(tmp_path, figures, steps):
    components = {name: {"step": step} for name, step in steps.items()}
    result = run(tmp_path / "run", pair(4e4, components=components))
    axes = drawn(read_run(tmp_path / "run"), tmp_path / "pictures", figures)
    told = result.provenance["iteration"]
    over_time, most, last = axes
    assert over_time.get_ylabel() == "iterations"
    which = "windows" if steps else "exchanges"
    assert f"the last {which}: 6, from" in last.get_title("left")
    assert last.get_yscale() == most.get_yscale() == "log"
    each = len(told["connections"])
    kept = [window["iterations"] for window in told["windows"]]
    assert ways(last) == [n for n in kept[-6:] for _ in range(each)]
    assert ways(most) == [n for n in sorted(kept)[-6:] for _ in range(each)]
    names = {line.get_label() for line in most.get_lines()}
    assert names >= {"contact.a.force", "a.velocity", "tolerance"}


@pytest.mark.filterwarnings("error")
def test_an_exchange_that_did_not_converge_is_in_it(tmp_path, figures):
    """Also the very first one, before there is a row."""
    with pytest.raises(RunFailed):
        run(tmp_path / "run", pair(4e6, 0.0, 0.02, iteration={"most": 2}))
    stored = read_run(tmp_path / "run")
    (window,) = stored.provenance["iteration"]["windows"]
    assert window["iterations"] == 2
    (every,) = drawn(stored, tmp_path / "pictures", figures)
    assert every.get_title("left") == "all exchanges: at 0 ms"
    assert min(every.get_ylim()) < 1.0


@pytest.mark.filterwarnings("error")
def test_it_can_be_read_whatever_names_and_residuals_there_are(tmp_path, figures):
    run(tmp_path / "run", pair(stop=0.1))
    stored = read_run(tmp_path / "run")
    told = stored.provenance["iteration"]
    names = [{"source": f"_{'long $x$ ' * 20}{i}", "targets": []} for i in range(30)]
    residuals = [[0.0, float("inf"), float("nan"), 1e300, 1e-300] * 6] * 50
    windows = [{**window, "iterations": 50, "residuals": residuals} for window in told["windows"]]
    facts = {**told, "connections": names, "windows": windows}
    facts = {**stored.provenance, "iteration": facts}
    axes = drawn(replace(stored, provenance=facts), tmp_path / "pictures", figures)
    assert "22 more" in {line.get_label() for line in axes[1].get_lines()}


def test_a_run_with_another_master_has_none(tmp_path):
    run(tmp_path / "run", pair(master="jacobi", stop=0.1))
    assert pictures_of(read_run(tmp_path / "run")) == []


@pytest.mark.parametrize("residuals", [None, [], [[1.0], [1.0, 2.0]], [["a"] * 6], [[-1.0] * 6]])
def test_damaged_residuals_are_told(tmp_path, residuals):
    run(tmp_path / "run", pair(stop=0.1))
    stored = read_run(tmp_path / "run")
    told = {**stored.provenance["iteration"], "windows": [{"time": 0.0, "residuals": residuals}]}
    damaged = replace(stored, provenance={**stored.provenance, "iteration": told})
    warned = []
    assert draw_all(damaged, tmp_path / "pictures", warn=warned.append) == []
    (said,) = warned
    assert "run.json" in said
    assert "the results are damaged" in said
