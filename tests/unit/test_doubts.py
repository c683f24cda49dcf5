"""Doubts about a run, from made-up results that are known to be doubtful."""

import numpy as np
import pytest

import rockshed
from rockshed.metrics import comparison
from rockshed.metrics.doubts import meaningless, warnings
from tests.unit.test_headlines import made_up


def boxed(**columns):
    """A run whose box of sand reaches from x = 0 to 0.4 m; the rock touches the sand from the start on."""
    run = made_up(**columns)
    sand = run.provenance["components"]["sand"]["parameters"]
    sand.update({"box.left": {"value": 0.0}, "box.width": {"value": 0.4}})
    return run


WAY = np.linspace(0.0, 1.0, 401)


def test_a_rock_that_leaves_the_box_sideways_after_it_has_struck_is_told_with_the_time():
    (said,) = meaningless(boxed(**{"rock.position.x": 0.2 + 0.4 * WAY}))
    assert "the rock leaves the sand sideways: at 10.05 ms" in said
    assert "from x = 0 m to 0.4 m" in said


def test_a_rock_that_comes_from_beside_the_box_is_not_doubted():
    late = np.where(WAY > 0.6, 1e3, 0.0)  # it strikes when it is above the box
    columns = {"sand.rock.force.y": late, "rock.position.x": -0.3 + 0.6 * WAY}
    assert meaningless(boxed(**columns)) == []


def against_walls(**columns):
    pressed = {"sand.penetration": 0.02 * WAY, "sand.rock.force.y": 1e3 + 0.0 * WAY}
    run = boxed(**{**pressed, **columns})
    run.provenance["components"]["rock"]["parameters"]["radius"] = {"value": 0.05}
    return [text for text in warnings(run) if "meets a side wall" in text]


def test_a_rock_that_meets_a_wall_in_the_sand_is_told_with_its_depth():
    moves = 0.2 + 0.18 * WAY  # its edge is at the wall, x = 0.4 m, after 15 / 18 of the run
    (said,) = against_walls(**{"rock.position.x": moves})
    assert "meets a side wall of the sand at 16.7 ms, 16.7 mm deep" in said


def test_a_rock_above_the_sand_or_away_from_its_walls_meets_none():
    assert against_walls(**{"rock.position.x": 0.2 + 0.14 * WAY}) == []
    flies = {"rock.position.x": 0.2 + 0.18 * WAY, "sand.penetration": 0.0 * WAY}
    assert against_walls(**flies) == []


def test_a_beam_that_an_impact_leaves_as_it_was_is_told():
    (said,) = meaningless(made_up(**{"beam.midspan.deflection": np.full(401, 2e-3)}))
    assert "the beam is never loaded: its deflection stays 2 mm from the start to the end" in said
    assert meaningless(made_up(**{"beam.midspan.deflection": 2e-3 + 1e-6 * WAY})) == []


def ends(**columns):
    return [text for text in warnings(made_up(**columns)) if text.startswith("the run ends")]


def test_a_largest_value_in_the_last_row_is_told():
    (said,) = ends(**{"sand.transmitted_force": 1e3 + 1e5 * WAY})
    assert "with the largest value of peak transmitted force so far: raise the stop time" in said
    assert ends() == []


def test_a_rock_that_still_sinks_at_the_end_is_told():
    (said,) = ends(**{"sand.penetration": 0.1 * WAY})
    assert "before the rock has come to a stop" in said


# ------------------------------------------------------------------ strict


def idle_beam():
    system = rockshed.System.new("idle", exchange_step=1e-4, stop_time=1e-3)
    return system.add("beam", "RBSMBeam")


def test_a_run_with_warnings_is_an_error_if_it_has_to_be_strict(tmp_path):
    with pytest.raises(
        rockshed.RunDoubted, match=r"1 warning.*strict.*\n.*nothing drives"
    ) as doubted:
        rockshed.simulate(idle_beam(), tmp_path / "run", strict=True)
    assert doubted.value.run.status == "complete"
    assert rockshed.read_run(tmp_path / "run").warnings == doubted.value.run.warnings


def test_a_run_without_warnings_is_none(tmp_path):
    system = idle_beam().with_values({"beam.force.y[12]": -1000.0})
    assert rockshed.simulate(system, strict=True).warnings == []


# ------------------------------------------------------------------ the table


def test_a_settled_force_above_the_peak_is_explained():
    late = np.where(np.linspace(0.0, 0.02, 401) > 0.01, 1e3, 0.0)  # a step: the filter overshoots
    stepped = made_up(**{"sand.rock.force.y": late})
    said = [text for text in comparison.notes(stepped, {}) if "above the peak" in text]
    assert said[-1].startswith("settled maximum of the force on the rock: is above the peak")
    assert "faster than 212 Hz, overshoots" in said[-1]


def test_a_balance_that_values_set_on_the_way_have_opened_is_not_blamed_on_the_steps():
    run = boxed(**{"rock.energy.residual": 100.0 * WAY})
    (blamed,) = [text for text in warnings(run) if "does not close" in text]
    assert "reduce the steps" in blamed
    run.provenance["branch"] = {"of": "parent", "at": 0.005, "values": {"beam.load": 1.0}}
    (told,) = [text for text in warnings(run) if "does not close" in text]
    assert "it has not the work of what was set at 5 ms" in told
    assert "reduce" not in told
