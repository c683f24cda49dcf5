"""Convergence of a system in its exchange step: a mass on a spring whose force is held."""

import json
import math

import pytest

from rockshed.analyses.exchange_steps.run import converge_exchange
from rockshed.core.errors import InputRefused, RunFailed
from rockshed.runs.job import Job
from rockshed.runs.system import System
from tests.cosim.mocks import Mock, inp, mass, out, par, spring, wired

LINKS = ["spring.end1.force -> mass.force", "mass.position -> spring.end1.position"]
WATCHED = ["mass.position"]


def system(**settings):
    """A mass of 1 kg on a spring of 4 N/m, let go at 1 m: cos(2 t)."""
    mocks = {"spring": spring(4.0), "mass": mass(1.0, position=1.0)}
    made = {"exchange_step": 0.01, "stop_time": 1.0, "output_interval": 0.1, **settings}
    spec, sources = wired(mocks, LINKS, **made)
    return System(Job("test", spec, sources, {}))


@pytest.fixture(scope="module")
def found():
    return converge_exchange(system(), watch=WATCHED)


def test_a_force_that_is_held_makes_an_error_of_first_order(found):
    assert [figure.found.order for figure in found.figures_followed] == pytest.approx(
        [1.0, 1.0], abs=0.1
    )


def test_the_limit_and_the_errors_are_those_of_the_closed_form(found):
    last = found.figures_followed[1]
    assert last.limit == pytest.approx(math.cos(2.0), abs=1e-4)
    true = [value - math.cos(2.0) for value in last.values]
    assert list(last.found.errors) == pytest.approx(true, rel=0.05)


def test_the_recommended_step_has_the_accuracy_and_twice_that_step_has_not(found):
    def error(step):  # as a part of the largest amount, which is 1 m
        run = converge_exchange(system(exchange_step=step, output_interval=1.0), watch=WATCHED)
        return abs(run.figures_followed[1].values[0] - math.cos(2.0))

    step = found.step_for(found.figures_followed[1])
    assert error(step) <= 0.01
    assert error(2.0 * step) > 0.01


def test_files_and_picture_lie_in_the_folder_and_those_of_the_user_stay(tmp_path):
    (tmp_path / "mine.txt").write_text("mine")
    made = converge_exchange(system(), watch=WATCHED, folder=tmp_path, pictures=True)
    names = {"exchange-steps.json", "exchange-steps.csv", "exchange-steps.png", "mine.txt"}
    assert {file.name for file in tmp_path.iterdir()} == names
    data = json.loads((tmp_path / "exchange-steps.json").read_text())
    assert data["recommended_step"] == made.recommended_step
    assert [level["exchange_step"] for level in data["levels"]] == [0.01, 0.005, 0.0025, 0.00125]
    made.save(tmp_path, pictures=False)  # results of the same study are replaced
    assert all("mass.position, largest difference (mm)" in repr(t) for t in made.tables()[1:])


def test_all_that_is_wrong_with_the_arguments_is_refused_at_once():
    with pytest.raises(InputRefused) as refusal:
        converge_exchange(system(), levels=2, accuracy=0.0, watch=["mass.positon"])
    places = [problem.where for problem in refusal.value.problems]
    assert places == ["levels", "accuracy", "watch mass.positon"]
    assert "mass.position" in refusal.value.problems[2].remedy


def noise():
    """Something chaotic: what it shows follows from the number of its steps in no order."""

    def step(v, t, h):
        v["value"] = (3.9 * v["value"] * (1.0 - v["value"])) if v["value"] else 0.3

    return Mock([inp("unused"), out("value")], step)


def test_chaos_has_no_order_and_no_step_is_recommended():
    spec, sources = wired({"noise": noise()}, [], stop_time=1.0, exchange_step=0.1)
    made = converge_exchange(System(Job("test", spec, sources, {})), watch=["noise.value"])
    assert made.recommended_step is None
    assert "no exchange step can be recommended" in made.notes[0]
    assert any("no order" in note for note in made.notes)


def test_a_run_that_breaks_down_is_told_with_its_step():
    def step(v, t, h):
        return (3, "too short for me") if h < 0.04 else None

    spec, sources = wired({"a": Mock([par("x", 1.0), out("y")], step)}, [])
    with pytest.raises(RunFailed, match=r"exchange step of 0\.025 s"):
        converge_exchange(System(Job("test", spec, sources, {})), watch=["a.y"])
