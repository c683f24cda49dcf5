"""Scenarios: inputs over time, values that change, faults of connections; values by hand."""

import numpy as np
import pytest

import rockshed
from rockshed.core.continuing import find_stopped
from rockshed.core.continuing import resume as go_on
from rockshed.core.errors import InputRefused
from rockshed.core.fmu.description import Port
from rockshed.core.loop.scenario import Course, noises
from rockshed.core.results.bits import first_difference
from rockshed.core.results.checkpoints import known_checkpoints
from rockshed.core.run import simulate
from rockshed.core.system.plan import End, PlannedFault
from rockshed.metrics.energy import system_residual
from tests.cosim.mocks import Mock, inp, out, par, wired

STEPS = 10


def ramp():
    """Counts its steps: 0, 1, 2, ..."""

    def step(v, t, h):
        v["x"] += 1.0

    return Mock([out("x", "m")], step)


def echo():
    """Shows what it was given in its step."""

    def step(v, t, h):
        v["got"], v["free_got"], v["level_got"] = v["x"], v["force"], v["level"]
        v["gain_got"] = v["gain"]

    ports = [
        inp("x", "m", 7.0),
        inp("force", "N", 3.0, extra="max='100'"),
        inp("level", kind="Integer"),
        par("gain", 1.0, extra=""),
        out("got", "m"),
        out("free_got", "N"),
        out("level_got"),
        out("gain_got"),
    ]
    return Mock(ports, step)


def tunable():
    made = echo()
    plain = made.model_description

    class Tunable(Mock):
        def model_description(self):
            return plain().replace(b"variability='fixed'", b"variability='tunable'")

    return Tunable(made.ports, made.step)


def run(folder, scenario, links=("ramp.x -> echo.x",), checkpoint_every=None, **settings):
    system, sources = wired(
        {"ramp": ramp(), "echo": tunable()}, list(links), scenario=scenario, **settings
    )
    return simulate(system, folder, sources=sources, checkpoint_every=checkpoint_every)


def refusals(folder, scenario, **settings):
    with pytest.raises(InputRefused) as refusal:
        run(folder / "run", scenario, **settings)
    assert not (folder / "run").exists()
    return {problem.where: problem.what for problem in refusal.value.problems}


JACOBI = {"master": "jacobi"}


def test_inputs_follow_their_columns_continuous_ones_linearly_and_others_in_stairs(tmp_path):
    table = {"time": [0.0, 0.4, 0.4, 0.6], "echo.force": [0, 4, 10, 12], "echo.level": [1, 2, 3, 4]}
    done = run(tmp_path / "run", {"inputs": table})
    force = [0, 1, 2, 3, 10, 11, 12, 12, 12, 12]
    np.testing.assert_allclose(done.series["echo.free_got"][1:], force, atol=1e-12)
    np.testing.assert_array_equal(done.series["echo.level_got"][1:], [1, 1, 1, 1, 3, 3, 4, 4, 4, 4])


def test_a_value_holds_from_its_time_on_and_before_it_is_the_start_value(tmp_path):
    values = [
        {"port": "echo.force", "value": 8.0, "at": 0.3},
        {"port": "echo.force", "value": -1.0, "at": 0.7},
        {"port": "echo.gain", "value": 5.0, "at": 0.5},
    ]
    done = run(tmp_path / "run", {"set": values})
    assert done.series["echo.free_got"][1:].tolist() == [3, 3, 3, 8, 8, 8, 8, -1, -1, -1]
    assert done.series["echo.gain_got"][1:].tolist() == [1] * 5 + [5] * 5


def test_a_value_on_a_condition_is_set_once_and_the_run_tells_when(tmp_path):
    values = [
        {"port": "echo.force", "value": 8.0, "when": "ramp.x >= 4"},
        {"port": "echo.gain", "value": 2.0, "when": "ramp.x > 99"},
    ]
    done = run(tmp_path / "run", {"set": values})
    assert done.series["echo.free_got"][1:].tolist() == [3] * 4 + [8] * 6
    (event,) = done.provenance["scenario_events"]
    assert (event["port"], event["at"]) == ("echo.force", pytest.approx(0.4))
    (warning,) = done.warnings
    assert "ramp.x > 99 was never true" in warning


def test_a_frozen_connection_delivers_the_value_at_its_begin_and_a_cut_one_the_start_value(
    tmp_path,
):
    faults = [
        {"port": "echo.x", "kind": "frozen", "from": 0.2, "to": 0.5},
        {"port": "echo.x", "kind": "cut", "from": 0.5, "to": 0.7},
    ]
    done = run(tmp_path / "run", {"fault": faults}, **JACOBI)
    assert done.series["echo.got"][1:].tolist() == [0, 1, 2, 2, 2, 7, 7, 7.0, 8, 9]


def test_of_a_linear_connection_what_arrives_is_frozen_and_cut(tmp_path):
    link = {"source": "ramp.x", "target": "echo.x", "factor": 2.0, "offset": 1.0}
    faults = [
        {"port": "echo.x", "kind": "frozen", "from": 0.2, "to": 0.4},
        {"port": "echo.x", "kind": "cut", "from": 0.8},
    ]
    done = run(tmp_path / "run", {"fault": faults}, links=[link], **JACOBI)
    assert done.series["echo.got"][1:].tolist() == [1, 3, 5, 5, 9, 11, 13, 15, 7, 7]


def numbers(seed, name="x", count=4000):
    end = End("echo", Port(name, 0, "Real", "input", "Real"))
    fault = PlannedFault(end, "noise", 0, count, 0.0, 1.0, seed)
    return noises(fault, 0, count)


def test_noise_is_normal_and_no_number_tells_another_one():
    one = numbers(1)
    within = [np.mean(np.abs(one) < bound) for bound in (1.0, 2.0)]
    assert within == pytest.approx([0.6827, 0.9545], abs=0.03)
    assert abs(one.mean()) < 4.0 / np.sqrt(one.size)
    for other in (np.roll(one, 1), numbers(2), numbers(1, "y")):
        assert abs(np.corrcoef(one, other)[0, 1]) < 4.0 / np.sqrt(one.size)


def test_noise_is_added_to_what_arrives_from_its_begin_on_and_a_seed_gives_it_again(tmp_path):
    def noisy(folder, deviation):
        fault = {"port": "echo.x", "kind": "noise", "from": 0.3, "deviation": deviation, "seed": 1}
        done = run(tmp_path / folder, {"fault": [fault]}, **JACOBI)
        return done.series["echo.got"][1:] - np.arange(10.0)

    first = noisy("a", 0.5)
    assert not first[:3].any()
    assert first[3:].all()
    np.testing.assert_array_equal(noisy("b", 0.5), first)
    np.testing.assert_allclose(noisy("c", 1.0), 2.0 * first, atol=1e-12)


SCENARIO = {
    "inputs": {"time": [0.0, 1.0], "echo.force": [0.0, 50.0]},
    "set": [
        {"port": "echo.level", "value": 4, "when": "ramp.x > 2"},
        {"port": "echo.gain", "value": 3.0, "at": 0.2},
    ],
    "fault": [
        {"port": "echo.x", "kind": "frozen", "from": 0.2, "to": 0.8},
        {"port": "echo.x", "kind": "noise", "from": 0.8, "deviation": 1.0, "seed": 3},
    ],
}


@pytest.mark.parametrize("breaks_at", [0.55, 0.85])
def test_a_run_that_goes_on_has_the_bits_of_one_in_one_go(tmp_path, breaks_at):
    system, sources = wired(
        {"ramp": ramp(), "echo": tunable()}, ["ramp.x -> echo.x"], scenario=SCENARIO
    )
    whole = simulate(system, tmp_path / "whole", sources=sources)
    healthy = sources["ramp"].step

    def advance(v, t, h):
        return (3, "broken") if t >= breaks_at - 1e-9 else healthy(v, t, h)

    sources["ramp"].step = advance
    with pytest.raises(Exception, match="broken"):
        simulate(system, tmp_path / "run", sources=sources, checkpoint_every=0.2)
    assert known_checkpoints(tmp_path / "run")
    sources["ramp"].step = healthy
    done = go_on(find_stopped(tmp_path / "run"), sources)
    assert first_difference(whole, done) is None
    assert done.provenance["scenario_events"] == whole.provenance["scenario_events"]


def test_everything_that_does_not_fit_is_refused_at_once(tmp_path):
    found = refusals(
        tmp_path,
        {
            "inputs": {"time": [0, 1], "echo.x": [0, 1], "echo.force": [0, 101], "echo.no": [0, 1]},
            "set": [
                {"port": "echo.got", "value": 1.0, "at": 0.1},
                {"port": "echo.gain", "value": 1.0, "at": 0.15},
                {"port": "echo.gain", "value": 1.0, "at": 1.0},
                {"port": "echo.gain", "value": 1.0, "when": "ramp.x is large"},
                {"port": "echo.level", "value": 1.5, "at": 0.1},
            ],
            "fault": [
                {"port": "echo.force", "kind": "cut", "from": 0.0},
                {"port": "echo.x", "kind": "cut", "from": 0.0, "to": 0.5},
                {"port": "echo.x", "kind": "frozen", "from": 0.4},
            ],
        },
    )
    assert {key: True for key in found} == dict.fromkeys(
        [
            "scenario.inputs",
            "scenario.inputs: echo.force",
            "scenario.set.0.port",
            "scenario.set.1.at",
            "scenario.set.2.at",
            "scenario.set.3.when",
            "scenario.set.4.value",
            "scenario.fault.0.port",
            "scenario.fault",
        ],
        True,
    )
    assert "0.15 s is no time of an exchange" in found["scenario.set.1.at"]


@pytest.mark.parametrize(
    ("part", "entry", "words"),
    [
        ("set", {"port": "echo.force", "value": 1.0}, "either at"),
        ("set", {"port": "e.f", "value": 1.0, "at": 0.0, "when": "a.b < 1"}, "either at"),
        ("fault", {"port": "e.x", "kind": "noise", "from": 0.0}, "needs a deviation"),
        ("fault", {"port": "e.x", "kind": "cut", "from": 0.0, "seed": 4}, "are for noise"),
        ("fault", {"port": "e.x", "kind": "cut", "from": 0.5, "to": 0.5}, "ends at 0.5 s"),
        ("fault", {"port": "e.x", "kind": "broken", "from": 0.5}, "must be one of"),
    ],
)
def test_an_entry_of_a_wrong_form_is_refused_in_words(part, entry, words):
    with pytest.raises(InputRefused) as refusal:
        wired({"echo": echo()}, [], scenario={part: [entry]})
    (problem,) = refusal.value.problems
    assert words in str(problem)
    assert f"scenario.{part}.0" in problem.where


def fall(**values):
    made = rockshed.System.new("fall", exchange_step=1e-3, stop_time=0.05)
    return made.add("rock", "FallingRock", {"mass": 2.0, "velocity0.y": 0.0, **values})


def test_the_work_of_a_constant_force_is_the_force_times_the_way_and_the_balance_has_it():
    """12 N on 2 kg for 0.05 s: s = 6 m/s2 t (t + h) / 2 with h, the internal step; W = F s."""
    run = rockshed.simulate(
        fall().scenario(values=[{"port": "rock.force.x", "value": 12, "at": 0}])
    )
    time = run["time"].values
    work = run["coupling.scenario.work"]
    np.testing.assert_allclose(work.values, 12.0 * 3.0 * time * (time + 1e-5), rtol=1e-9)
    np.testing.assert_allclose(work.values, 12.0 * run["rock.position.x"].values, rtol=1e-12)
    assert work.unit == "J"
    assert not [text for text in run.warnings if "balance of energy" in text]


@pytest.mark.parametrize("push", [{"rock.force.x": [0.0, 80.0]}, {"rock.torque": [2.0, -0.5]}])
def test_with_a_table_what_is_left_of_the_balance_is_the_error_of_the_internal_step(push):
    left = []
    for step in (1e-5, 5e-6):
        run = rockshed.simulate(fall(internal_step=step).scenario({"time": [0.0, 0.05], **push}))
        work, whole = run["coupling.scenario.work"].values, system_residual(run)
        left.append(np.abs(whole).max())
    assert left[0] / left[1] == pytest.approx(2.0, rel=1e-3)
    assert left[0] < 1e-3 * work[-1]


def test_with_every_master_a_table_and_a_condition_do_the_same():
    """Nothing comes back from the rock, so no master has anything to repeat."""
    table = {"time": [0.0, 0.05], "rock.force.x": [0.0, 80.0]}
    turn = {"port": "rock.torque", "value": 4.0, "when": "rock.position.y < 0.995"}
    found = [
        rockshed.simulate(fall().with_options(master=master).scenario(table, values=[turn]))
        for master in ("sequential", "jacobi", "implicit")
    ]
    assert found[0]["rock.velocity.x"][-1] == pytest.approx(0.98)
    for run in found[1:]:
        for name in ("rock.velocity.x", "rock.angular_velocity", "coupling.scenario.work"):
            np.testing.assert_array_equal(run[name].values, found[0][name].values)


class Bonded(Mock):
    """A mock that declares a power bond at its end, as our components do."""

    def model_description(self):
        members = "".join(
            f"<Member name='{name}' variable='end.{name}'/>" for name in ("position.x", "force.x")
        )
        told = f"<Component><Bond name='end' description='' idle=''>{members}</Bond></Component>"
        annotation = (
            f"<VendorAnnotations><Tool name='org.rockshed'>{told}</Tool></VendorAnnotations>"
        )
        plain = super().model_description().decode()
        return plain.replace("<ModelVariables>", f"{annotation}<ModelVariables>").encode()


def test_an_imposed_motion_does_the_work_that_a_spring_stores(tmp_path):
    """The end of a spring of 400 N/m is moved by 0.1 m; what it holds back is counted."""

    def step(v, _t=0.0, _h=0.0):
        v["end.force.x"] = -400.0 * v["end.position.x"]

    ports = [inp("end.position.x", "m"), out("end.force.x", "N")]
    mock = Bonded(ports, step, step)
    table = {"time": [0.0, 0.8], "spring.end.position.x": [0.0, 0.1]}
    for steps in (20, 200):
        system, sources = wired(
            {"spring": mock}, [], scenario={"inputs": table}, exchange_step=1.0 / steps
        )
        done = simulate(system, tmp_path / str(steps), sources=sources)
        assert done.series["coupling.scenario.work"][-1] == pytest.approx(2.0, rel=1e-12)


def test_exchanges_with_a_table_stay_in_the_loop_until_a_condition_is_true(monkeypatch):
    """400 exchanges with a table and noise: the master looks at the start, at the condition and at the end."""
    looks = []
    look = Course.look
    monkeypatch.setattr(Course, "look", lambda self, n: (looks.append(n), look(self, n))[1])
    table = {"time": [0.0, 1.0], "rock.force.x": [0.0, 1.0]}
    hit = {"port": "rock.torque", "value": 4.0, "when": "rock.position.y < 0.95"}
    system = fall().with_options(exchange_step=1e-4, stop_time=0.2).scenario(table, values=[hit])
    run = rockshed.simulate(system)
    (event,) = run.provenance["scenario_events"]
    first = int(np.argmax(run["rock.position.y"].values < 0.95))
    assert looks == [0, first, 1000, 2000] or looks == [0, 1000, first, 2000]
    assert event["at"] == pytest.approx(first * 1e-4)


# ------------------------------------------------------------------ files


FILE = """name = "alone"
master = "jacobi"
stop_time = 0.4
exchange_step = 0.05

[components.Stranger]
fmu = "{fmu}"

[scenario]
inputs = "in.csv"
"""
TABLE = "time,Stranger.speed,Stranger.level\n0,0,1\n0.2,2,5\n0.2,4,6\n0.4,4,6\n"


def written(folder, fmu, more="", table=TABLE):
    folder.mkdir(exist_ok=True)
    (folder / "in.csv").write_text(table)
    (folder / "system.toml").write_text(FILE.format(fmu=fmu) + more)
    return folder / "system.toml"


def test_a_table_of_a_file_gives_the_bits_of_the_fmu_alone_and_stays_with_the_run(
    tmp_path, foreign
):
    file = written(tmp_path / "system", foreign)
    system = rockshed.System.load(file)
    done = rockshed.simulate(system, tmp_path / "run")
    (tmp_path / "in.csv").write_text(TABLE.replace("Stranger.", ""))
    alone = rockshed.simulate(rockshed.alone(foreign, tmp_path / "in.csv", step_size=0.05))
    assert np.any(done["Stranger.force"])
    np.testing.assert_array_equal(done["Stranger.force"], alone["Stranger.force"])
    (file.parent / "in.csv").unlink()
    assert rockshed.verify(tmp_path / "run")
    assert "Stranger.speed" in str(system.describe())


def test_a_system_with_its_scenario_is_written_and_read_again_and_is_no_ssp(tmp_path, foreign):
    more = '[[scenario.set]]\nport = "Stranger.enabled"\nvalue = false\nat = 0.1\n'
    system = rockshed.System.load(written(tmp_path / "system", foreign, more))
    with pytest.raises(InputRefused, match="no place in an SSP"):
        system.save(tmp_path / "system.ssp")
    again = rockshed.System.load(system.save(tmp_path / "again"))
    assert again.spec.scenario == system.spec.scenario
    assert again.spec.scenario.set[0].at == 0.1


def test_faults_of_a_file_are_told_at_once_by_line_and_column(tmp_path, foreign):
    more = """
[[scenario.set]]
port = "Stranger.enabled"
value = true
at = 0.12

[[scenario.fault]]
port = "Stranger.speed"
kind = "cut"
from = 0.1
"""
    with pytest.raises(InputRefused) as refusal:
        rockshed.System.load(written(tmp_path / "a", foreign, more))
    places = [problem.where for problem in refusal.value.problems]
    assert [place.partition("system.toml, ")[2] for place in places] == [
        "line 15, column 1: scenario.set.0.at",
        "line 18, column 1: scenario.fault.0.port",
    ]
    wrong = more.replace("value = true", 'valu = "on"')
    with pytest.raises(InputRefused) as refusal:
        rockshed.System.load(written(tmp_path / "b", foreign, wrong))
    places = [str(problem.where) for problem in refusal.value.problems]
    assert any("line 14, column 1: scenario.set.0.valu" in place for place in places)
    with pytest.raises(InputRefused) as refusal:
        rockshed.System.load(written(tmp_path / "c", foreign, "", TABLE.replace("2,5", "2,five")))
    assert "in.csv, line 3, column" in str(refusal.value)
