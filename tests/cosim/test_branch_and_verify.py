"""Variants of a run from one of its states, and runs that are run again to see whether they differ."""

import json
from dataclasses import replace

import pyarrow as pa
import pyarrow.parquet
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from typer.testing import CliRunner

import rockshed
from rockshed.commands.app import app
from rockshed.core import continuing
from rockshed.core.continuing import find_stopped
from rockshed.core.errors import InputRefused, RunFailed
from rockshed.core.results.bits import first_difference
from rockshed.core.results.changes import ValueChange, changes_of
from rockshed.core.results.checkpoints import known_checkpoints
from rockshed.core.results.reading import read_run
from rockshed.core.run import simulate
from tests.cosim.mocks import Mock, mass, out, par, spring, wired

LINKS = ["spring.end1.force -> a.force", "a.position -> spring.end1.position"]


def system(breaks_at=None, **changes):
    """A mass on a spring; another one that falls under a weight which nobody feeds."""
    mocks = {"spring": spring(3.0), "a": mass(1.0, position=1.0), "free": mass(2.0)}
    step = mocks["free"].step

    def advance(v, t, h):
        return (3, "broken") if breaks_at is not None and t >= breaks_at else step(v, t, h)

    mocks["free"].step = advance
    options = {
        "exchange_step": 0.05,
        "stop_time": 2.0,
        "state_interval": 0.2,
        "components": {"free": {"record_states": True, "step": 0.1}},
        "watch": ["*.position"],
    }
    return wired(mocks, LINKS, **{**options, **changes})


@pytest.fixture(scope="module")
def parent(tmp_path_factory):
    """A run with checkpoints at 0, 1.2 and 1.6 s."""
    one, sources = system()
    folder = tmp_path_factory.mktemp("parent") / "run"
    return simulate(one, folder, sources=sources, checkpoint_every=0.4)


@settings(max_examples=5)
@given(exchange=st.integers(1, 39), force=st.floats(-5.0, 5.0))
def test_a_variant_is_the_run_in_one_go_whose_values_change_on_the_way(
    parent, tmp_path_factory, exchange, force
):
    place = tmp_path_factory.mktemp("variants")
    change = ValueChange(0.05 * exchange, {"free.force": force})
    branched = continuing.branch(parent, change, place / "branch", system()[1])
    one, sources = system()
    whole = simulate(one, place / "whole", sources=sources, changes=[change])
    assert first_difference(whole, branched) is None
    before = branched.time <= change.at
    assert (branched.series["free.position"][before] == 0.0).all()
    assert branched.provenance["branch"]["values"] == {"free.force": force}


def test_a_variant_that_is_ended_goes_on_with_its_values(parent, tmp_path):
    change = ValueChange(0.9, {"free.force": 3.0})
    one, sources = system()
    whole = simulate(one, tmp_path / "whole", sources=sources, changes=[change])
    for breaks_at in (0.7, 0.9, 1.6):
        place = tmp_path / f"broken-{breaks_at}"
        with pytest.raises(RunFailed, match="broken"):
            continuing.branch(parent, change, place, system(breaks_at)[1], checkpoint_every=0.15)
        done = continuing.resume(find_stopped(place), system()[1])
        assert first_difference(whole, done) is None
        assert 0 in known_checkpoints(place)


def test_values_that_nobody_may_set_on_the_way_are_refused_all_at_once(parent, tmp_path):
    values = {
        "a.mass": 3.0,
        "a.force": 1.0,
        "a.position": 1.0,
        "a.weight": 1.0,
        "b.mass": 1.0,
        "free.force": "strong",
    }
    with pytest.raises(InputRefused) as refused:
        continuing.branch(parent, ValueChange(0.37, values), tmp_path / "run", system()[1])
    told = {problem.where: str(problem) for problem in refused.value.problems}
    assert [*told] == ["at", *values]
    assert "0.37 s is no time of an exchange, which are 0.05 s apart" in told["at"]
    assert "fixed parameter: FMI sets it before the start alone" in told["a.mass"]
    assert "branch at the start of the run, which takes every parameter" in told["a.mass"]
    assert "is an input that a connection feeds" in told["a.force"]
    assert "is no parameter and no input, but output" in told["a.position"]
    assert "does not exist" in told["a.weight"]
    assert "names no component of the run; there are" in told["b.mass"]
    assert "must be a number" in told["free.force"]
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("at", [-0.05, 2.0, 3.0, float("nan")])
def test_a_variant_begins_within_the_run(parent, tmp_path, at):
    change = ValueChange(at, {"free.force": 1.0})
    with pytest.raises(InputRefused, match=r"at: "):
        continuing.branch(parent, change, tmp_path / "run", system()[1])


def test_tunable_parameters_may_be_set_on_the_way(tmp_path):
    mock = Mock([par("gain", 1.0), out("y")], lambda v, t, h: v.update(y=v["gain"] * t))
    description = Mock.model_description

    class Tunable(Mock):
        def model_description(self):
            return description(self).replace(b"variability='fixed'", b"variability='tunable'")

    one, sources = wired({"a": Tunable(mock.ports, mock.step)}, [])
    whole = simulate(one, tmp_path / "run", sources=sources, checkpoint_every=0.2)
    change = ValueChange(0.5, {"a.gain": 10.0})
    variant = continuing.branch(whole, change, tmp_path / "variant", sources)
    assert variant.series["a.y"][5] == whole.series["a.y"][5]
    assert variant.series["a.y"][6] == 10.0 * whole.series["a.y"][6]


def test_a_variant_of_a_variant_has_the_values_of_both(parent, tmp_path):
    """Also where it begins at a checkpoint from before the change of the first one."""
    changes = [ValueChange(0.5, {"free.force": 3.0}), ValueChange(1.0, {"free.force": -1.0})]
    first = continuing.branch(
        parent, changes[0], tmp_path / "first", system()[1], checkpoint_every=0.4
    )
    assert known_checkpoints(first.folder)[1] * 0.05 > 1.0
    second = continuing.branch(first, changes[1], tmp_path / "second", system()[1])
    one, sources = system()
    whole = simulate(one, tmp_path / "whole", sources=sources, changes=changes)
    assert first_difference(whole, second) is None
    assert first_difference(first, second) is not None
    assert changes_of(second.provenance) == changes


def refusing():
    """Mocks of which one takes no force of more than 5 N between two steps."""
    _, sources = system()
    made = type(sources["free"]).instantiate

    class Wilful(Mock):
        def instantiate(self, name):
            slave = made(self, name)
            take = slave.set

            def put(references, values, kind="Real"):
                if slave.running and max(values) > 5.0:
                    return slave._said((3, "too strong"))
                return take(references, values, kind)

            slave.set = put
            return slave

    free = sources["free"]
    return {**sources, "free": Wilful(free.ports, free.step, free.start)}


@pytest.mark.parametrize("at", [1.2, 1.3])
def test_a_value_that_is_refused_on_the_way_ends_a_variant_as_failed(parent, tmp_path, at):
    """At a checkpoint too, where the value is set before the first exchange."""
    change = ValueChange(at, {"free.force": 9.0})
    with pytest.raises(RunFailed, match=r"free at t = 1\.[23] s: force = 9.0 is refused"):
        continuing.branch(parent, change, tmp_path / "run", refusing())
    kept = read_run(tmp_path / "run")
    assert (kept.status, kept.time[-1]) == ("failed", pytest.approx(at))


def test_what_was_set_on_the_way_is_told_as_the_cause_of_a_state_that_runs_away(parent, tmp_path):
    _, sources = system()
    step = sources["free"].step

    def burst(v, t, h):
        step(v, t, h)
        if v["force"] > 5.0:
            v["position"] = float("nan")

    sources["free"].step = burst
    change = ValueChange(1.2, {"free.force": 9.0})
    with pytest.raises(RunFailed) as failure:
        continuing.branch(parent, change, tmp_path / "run", sources)
    told = str(failure.value)
    assert "the likely cause is what was set on the way, free.force = 9.0 N at t = 1.2 s" in told
    assert "reduce" not in told


def test_a_run_that_a_component_has_ended_has_no_variants_after_its_end(parent, tmp_path):
    short = replace(parent, series={name: x[:20] for name, x in parent.series.items()})
    with pytest.raises(InputRefused, match=r"at: 1\.2 s is after the end of the run"):
        continuing.branch(
            short, ValueChange(1.2, {"free.force": 1.0}), tmp_path / "run", system()[1]
        )


# ---------------------------------------------------------------- from Python and the command line


@pytest.fixture(scope="module")
def fall(tmp_path_factory):
    """A falling rock, with checkpoints."""
    made = rockshed.System.new("fall", exchange_step=1e-3, stop_time=0.1, watch=["rock.position.y"])
    made = made.add("rock", "FallingRock", {"velocity0.y": -1.0})
    folder = tmp_path_factory.mktemp("fall") / "run"
    return rockshed.simulate(made, folder, checkpoint_every=0.02)


def test_a_variant_from_the_start_takes_every_parameter(fall):
    slower = rockshed.branch(fall, {"rock.velocity0.y": -0.5})
    assert slower["rock.velocity.y"][0] == -0.5
    assert slower.provenance["differences"]["rock.velocity0.y"] == -0.5
    assert slower.provenance["branch"]["of"] == str(fall.folder)
    assert slower.time.size == fall.time.size
    with pytest.raises(InputRefused, match=r"rock.velocity0.y: is a fixed parameter"):
        rockshed.branch(fall, {"rock.velocity0.y": -0.5}, at=0.05)


def test_a_force_acts_on_a_rock_from_a_time_on(fall):
    pushed = rockshed.branch(fall.folder, {"rock.force.x": 50.0}, at=0.05)
    mass_ = fall.provenance["components"]["rock"]["parameters"]["mass"]["value"]
    velocity = pushed["rock.velocity.x"]
    assert velocity[50] == 0.0
    assert velocity[-1] == pytest.approx(0.05 * 50.0 / mass_)


def test_a_run_is_verified_by_running_it_again(fall):
    found = rockshed.verify(fall)
    assert found
    assert str(found).startswith("verified: the same to the bit (101 rows, ")
    assert rockshed.verify(rockshed.branch(fall, {"rock.velocity0.y": -0.5}))


def altered(run, folder, column, row):
    """A copy of a run in which one number is the next one that there is."""
    run.save(folder)
    table = pyarrow.parquet.read_table(folder / "timeseries.parquet")
    place = table.column_names.index(column)
    values = table.column(place).to_numpy().copy()
    values.view("u8")[row] += 1
    table = table.set_column(place, table.schema.field(place), pa.array(values))
    pyarrow.parquet.write_table(table, folder / "timeseries.parquet")
    return values[row]


def test_the_first_difference_is_told_with_column_time_and_both_values(fall, tmp_path):
    value = altered(fall, tmp_path / "run", "rock.velocity.y", 40)
    found = rockshed.verify(tmp_path / "run")
    assert not found
    assert (found.difference.what, found.difference.time) == ("rock.velocity.y", 0.04)
    assert float(found.difference.value) == value
    assert float(found.difference.again) == fall["rock.velocity.y"][40] != value
    told = CliRunner().invoke(app, ["verify", str(tmp_path / "run")])
    assert told.exit_code == 3
    assert "rock.velocity.y at t = 0.04 s is" in " ".join(told.output.split())


def test_a_metric_that_was_altered_is_told(fall, tmp_path):
    fall.save(tmp_path / "run")
    path = tmp_path / "run" / "summary.json"
    metrics = json.loads(path.read_text())
    changed = next(entry for entry in metrics if entry["name"] == "rock.position.y minimum")
    changed["value"] = -1.0
    path.write_text(json.dumps(metrics))
    assert rockshed.verify(tmp_path / "run").difference.what == "rock.position.y minimum"


def test_a_run_of_other_versions_is_not_verified(fall, tmp_path):
    fall.save(tmp_path / "run")
    path = tmp_path / "run" / "run.json"
    told = json.loads(path.read_text())
    told["versions"]["rockshed"] = "0.0.1"
    told["components"]["rock"]["sources"] = "other"
    path.write_text(json.dumps(told))
    with pytest.raises(InputRefused) as refused:
        rockshed.verify(tmp_path / "run")
    assert [problem.where for problem in refused.value.problems] == [
        "rockshed",
        "rock: FallingRock",
    ]


def test_folders_of_many_runs_say_how_they_go_on(tmp_path):
    (tmp_path / "ended" / ".finished-runs").mkdir(parents=True)
    with pytest.raises(InputRefused, match="start the same command again: it goes on from these"):
        rockshed.resume(tmp_path / "ended")
    (tmp_path / "whole").mkdir()
    (tmp_path / "whole" / "run.json").write_text('{"kind": "study", "status": "complete"}')
    with pytest.raises(InputRefused, match="results of study, which has ended; nothing is left"):
        rockshed.resume(tmp_path / "whole")


def test_the_commands_show_variant_and_verification(fall, tmp_path):
    runner = CliRunner()
    words = ["--set", "rock.force.x=50", "--at", "50ms", "--output-dir", str(tmp_path / "v")]
    told = runner.invoke(app, ["branch", str(fall.folder), *words, "--no-figures"])
    assert told.exit_code == 0, told.output
    assert read_run(tmp_path / "v").provenance["branch"]["at"] == 0.05
    told = runner.invoke(app, ["verify", str(tmp_path / "v"), "--json"])
    assert json.loads(told.stdout)["same"] is True
    told = runner.invoke(app, ["branch", str(fall.folder)])
    assert told.exit_code == 2
    assert "--set" in told.output
    told = runner.invoke(app, ["resume", str(tmp_path / "v"), "--no-figures"])
    assert told.exit_code == 0
    assert "nothing is left to do" in told.output


@pytest.mark.slow
def test_a_variant_of_a_strangers_fmu_is_its_run_in_one_go(foreign, tmp_path):
    """Plain pythonfmu, whose state has the registered variables and nothing else."""
    from rockshed.core.fmu.fmu_slave import FmuFile

    def strangers():
        return {"a": FmuFile(foreign), "b": FmuFile(foreign)}

    links = ["a.force -> b.speed", "a.next_level -> b.level"]
    one, _ = wired(strangers(), links, output_interval=0.1, stop_time=2.0)
    whole = simulate(one, tmp_path / "run", sources=strangers(), checkpoint_every=0.3)
    change = ValueChange(1.3, {"a.speed": 2.0})
    variant = continuing.branch(whole, change, tmp_path / "variant", strangers())
    expected = simulate(one, tmp_path / "expected", sources=strangers(), changes=[change])
    assert first_difference(expected, variant) is None
    assert first_difference(whole, variant) is not None
