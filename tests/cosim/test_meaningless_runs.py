"""A run that means nothing says so: it is refused where that is certain before it begins, and else
the first warning tells it."""

import json
import re
from dataclasses import replace

import pytest
from typer.testing import CliRunner

import rockshed
from rockshed.commands.app import app
from rockshed.core.errors import InputRefused, RunFailed
from rockshed.core.results.reading import read_run
from rockshed.core.system.reading import system_from


def lab_impact(stop_time=0.002, sizes=None, **values):
    """The laboratory case with other values; a double underscore stands for a point."""
    named = {"sand.settling.time": 0.0}  # it takes long, and changes nothing here
    named |= {name.replace("__", "."): value for name, value in values.items()}
    options = {"stop_time": stop_time, "output_interval": 1e-4}
    case = rockshed.case("lab-impact", in_process=True, values=named, sizes=sizes or {})
    return case.with_options(**options)


def warnings(**changes):
    return rockshed.simulate(lab_impact(**changes)).warnings


def refusal(**values):
    with pytest.raises(InputRefused) as refused:
        rockshed.simulate(lab_impact(stop_time=1e-4, **values))
    return str(refused.value)


# ------------------------------------------------------------------ only the result shows it


def test_a_rock_that_flies_upwards_has_never_touched_the_sand():
    first = warnings(rock__velocity0__y=8.0)[0]
    assert "the rock has never touched the sand: there is no impact in this run" in first
    # 0.5 mm above the discs at the start, then 16 mm in 2 ms, less g t^2 / 2 = 0.02 mm
    height = float(re.search(r"ends ([\d.]+) mm above", first).group(1))
    assert height == pytest.approx(0.5 + 16.0 - 0.02, abs=0.02)
    assert "moves away from it" in first


def test_a_rock_above_a_beam_that_is_too_low_is_told_how_long_it_still_needs():
    first = warnings(beam__axis__y=-0.5)[0]
    assert "the rock has never touched the sand" in first
    found = re.search(r"ends ([\d.]+) mm above the surface and needs some ([\d.]+) ms", first)
    distance, time = map(float, found.groups())
    assert distance == pytest.approx(500 - 25 + 1 - 16, rel=0.05)  # the top was 25 mm over y = 0
    assert time == pytest.approx(distance / 8.02, rel=0.01)


def test_sand_on_a_rigid_floor_loads_no_beam():
    first = warnings(sand__base="floor")[0]
    assert "the sand rests on a rigid floor (base = floor)" in first
    assert "nothing of the impact reaches the beam" in first


def with_two_gravities():
    """The laboratory case as a system of one's own may be: rock and sand share no gravity."""
    case = lab_impact(stop_time=2e-4)
    data = case.spec.model_dump()
    del data["shared"]["gravity"]
    return rockshed.System(replace(case.job, system=system_from(data)))


@pytest.mark.parametrize(
    ("values", "said"),
    [
        ({"rock__gravity": 0.0}, "sand.gravity = 9.80665, rock.gravity = 0 m/s2"),
        ({"sand__gravity": 0.0}, "sand.gravity = 0, rock.gravity = 9.80665 m/s2"),
        ({"rock__gravity": 1.62}, "sand.gravity = 9.80665, rock.gravity = 1.62 m/s2"),
    ],
)
def test_rock_and_sand_that_do_not_fall_alike_are_told_first(values, said):
    named = {name.replace("__", "."): value for name, value in values.items()}
    first = rockshed.simulate(with_two_gravities().with_values(named)).warnings[0]
    assert f"rock and cushion do not fall alike: {said}" in first


def test_sand_without_gravity_is_held_by_nothing():
    found = warnings(stop_time=2e-4, sand__gravity=0.0, rock__gravity=0.0)
    assert "the sand has no gravity" in found[0]
    assert not any("fall alike" in text for text in found)


@pytest.mark.parametrize("discs", [1, 37, 74])
def test_a_layer_of_one_or_two_discs_is_no_cushion(discs):
    found = warnings(stop_time=1e-3, sizes={"sand.discs": discs})
    assert "the sand is no cushion: it is" in found[0]


def test_a_rock_that_goes_through_the_base_is_told_before_anything_else():
    first = warnings(rock__velocity0__y=-400.0)[0]
    assert "the rock has gone through the sand and what carries it" in first


def test_a_run_that_means_something_has_none_of_these_warnings():
    (told,) = warnings(stop_time=0.004, sand__settling__time=2.0)
    assert told.startswith("the run ends at 4 ms, before the rock has come to a stop")


# ------------------------------------------------------------------ certain before the run


def test_a_rock_that_jumps_over_contacts_fails_at_once():
    with pytest.raises(RunFailed, match=r"-3000 m/s upwards, moves on by more than the radius"):
        rockshed.simulate(lab_impact(rock__velocity0__y=-3000.0))


def test_a_rock_that_starts_under_the_beam_is_refused():
    said = refusal(rock__position0__y=-0.3)
    assert "the rock starts in or under what carries the sand" in said
    assert "its centre lies at y = -0.3 m and its radius is 0.0495 m" in said


@pytest.mark.parametrize("x", [-2.0, 0.8])
def test_a_rock_that_starts_beside_the_box_is_refused(x):
    assert "the rock starts in or behind a side wall" in refusal(rock__position0__x=x)


# ------------------------------------------------------------------ everywhere the same


def test_a_run_from_python_has_the_metrics_and_warnings_of_the_command(tmp_path):
    made = rockshed.simulate(lab_impact(rock__velocity0__y=8.0), tmp_path / "python")
    words = ["--in-process", "--stop-time", "0.002", "--output-interval", "1e-4"]
    words += ["--set", "rock.velocity0.y=8", "--set", "sand.settling.time=0"]
    words += ["--output-dir", str(tmp_path / "command")]
    shown = CliRunner().invoke(app, ["run", "lab-impact", "--json", "--no-figures", *words])
    assert shown.exit_code == 0, shown.stderr
    command = read_run(tmp_path / "command")
    timed = {"wall_time_of_the_exchanges"}
    values = {key: metric.value for key, metric in made.metrics.items() if key not in timed}
    assert {key: m.value for key, m in command.metrics.items() if key not in timed} == values
    assert "peak_transmitted_force" in values
    assert made.warnings
    assert json.loads(shown.stdout)["warnings"] == made.warnings
    for folder in ("python", "command"):
        kept = json.loads((tmp_path / folder / "run.json").read_text())
        assert kept["warnings"] == made.warnings
    assert rockshed.read_run(tmp_path / "python").warnings == made.warnings


def test_large_results_are_told_before_the_run(tmp_path):
    case = lab_impact(stop_time=3e-4).with_options(state_interval=1e-5, output_interval=1e-5)
    told = []
    done = rockshed.simulate(case, tmp_path / "small", note=told.append)
    assert told == []
    state = (done.folder / "states.h5").stat().st_size / 31
    large = case.with_options(stop_time=0.1)

    def stop(reached, _stop):
        assert told, "nothing was told before the first exchange"
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        rockshed.simulate(large, tmp_path / "large", note=told.append, progress=stop)
    (said,) = told
    assert re.search(r"10,001 rows of (\d+) columns and 10,001 states of", said)
    size = float(re.search(r"will take ([\d.]+) MB or more", said).group(1)) * 1e6
    assert 0.5 < size / (10_001 * (state + 25 * len(done.columns))) < 1.5
