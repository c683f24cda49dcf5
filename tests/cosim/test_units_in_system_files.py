"""Quantities with units inside system files and scenarios: in the units of the FMUs' variables."""

import json
import re
import tomllib
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st
from typer.testing import CliRunner

import rockshed
from rockshed.commands.app import app
from rockshed.core.errors import InputRefused
from rockshed.core.fmu.description import UnitDefinition
from rockshed.core.run import simulate
from rockshed.core.system.in_si import numbers_in
from rockshed.core.system.quantities import in_si, in_unit
from rockshed.core.system.reading import load_system, system_from
from tests.cosim.mocks import Mock, inp, out, par

DECIMAL = {
    ("mm", "m"): "0.001",
    ("cm", "m"): "0.01",
    ("km", "m"): "1000",
    ("cm4", "m4"): "0.00000001",
    ("ms", "s"): "0.001",
    ("us", "s"): "0.000001",
    ("min", "s"): "60",
    ("g", "kg"): "0.001",
    ("t", "kg"): "1000",
    ("t/m3", "kg/m3"): "1000",
    ("kN", "N"): "1000",
    ("kgf", "N"): "9.80665",
    ("lbf", "N"): "4.4482216152605",
    ("in", "m"): "0.0254",
    ("kgf/cm^2", "Pa"): "98066.5",
    ("GPa", "Pa"): "1000000000",
    ("kN/cm", "N/m"): "100000",
    ("kJ", "J"): "1000",
    ("m", "m"): "1",
}
"""Factors between units that are decimal numbers."""
NUMBERS = st.decimals(-(10**9), 10**9, allow_nan=False, places=None).map(
    lambda d: format(d, "f")[:30]
)


@given(NUMBERS, st.sampled_from(sorted(DECIMAL)))
def test_a_quantity_whose_factor_is_a_decimal_number_is_the_si_value_to_the_bit(number, units):
    unit, si = units
    assert in_si(f"{number} {unit}", si) == float(Fraction(number) * Fraction(DECIMAL[units]))


MILLIMETRE = UnitDefinition("mm", {"m": 1}, 1e-3)
CELSIUS = UnitDefinition("degC", {"K": 1}, offset=273.15)


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("12 mm", MILLIMETRE, 12.0),
        ("1.2 cm", MILLIMETRE, 12.0),
        ("0.012 m", MILLIMETRE, 12.0),
        ("0.012", MILLIMETRE, 0.012),
        ("293.15 K", CELSIUS, 20.0),
        ("20 degC", CELSIUS, 20.0),
        ("20 °C", CELSIUS, 20.0),
        ("5 stone", UnitDefinition("stone"), 5.0),
        ("5 kN", UnitDefinition("N"), 5000.0),
        ("90 deg", UnitDefinition("rad", {"rad": 1}), 1.5707963267949),
    ],
)
def test_a_quantity_is_taken_in_the_unit_of_the_variable_whatever_that_is(text, unit, value):
    assert in_unit(text, unit) == value


def test_a_difference_passes_over_the_offset_of_a_unit():
    assert in_unit("2 K", CELSIUS, is_difference=True) == 2.0


@pytest.mark.parametrize(
    ("text", "unit", "reason"),
    [
        ("5 kN", None, "must be a number alone: it has no unit"),
        ("5 kg", UnitDefinition("stone"), "what its unit stone is, is told nowhere"),
        ("5 kg", MILLIMETRE, "must be a length, in mm (given: '5 kg', which is a mass)"),
        ("5 kg", UnitDefinition("x", {"A": 1}), "must be in x (1 A)"),
    ],
)
def test_a_quantity_that_a_variable_cannot_have_is_refused_with_its_unit(text, unit, reason):
    with pytest.raises(ValueError, match=re.escape(reason)):
        in_unit(text, unit)


# ---------------------------------------------------------------- all places of a system

WITH_UNITS = """
name = "all"
start_time = "1 ms"
stop_time = "2 s"
exchange_step = "1000 us"
output_interval = "10ms"
state_interval = "1/10"
time_limit = "2 min"
connections = [
    {source = "a.force", target = "b.shift", factor = "3 mm/N", offset = "1 cm"},
    {source = "a.force", target = "b.heat", factor = 1.0, offset = "2 K"},
]
[components.a]
fmu = "a"
step = "0.5 ms"
time_limit = "1 min"
parameters = {stiffness = "3 kN/cm", label = "5 kN", width = "2 cm", "row[1]" = "1 mm", plain = 2}
[components.b]
fmu = "b"
[shared.size]
value = "12 cm"
targets = ["b.size"]
[energy_alarm]
reference = "2 kJ"
[iteration]
window = "2 ms"
[[iteration.connections]]
source = "a.*"
absolute = "2 N"
[adaptive]
tolerance = 1e-3
largest_step = "4 ms"
[scenario]
inputs = {time = [0, "500 ms", "1 min"], "b.push" = [0, "2 kN", 3.0]}
[[scenario.set]]
port = "b.warm"
value = "293.15 K"
at = "100 ms"
[[scenario.set]]
port = "b.push2"
value = "1 kgf"
when = "a.force >= 2 kN"
[[scenario.fault]]
port = "b.shift"
kind = "noise"
from = "10 ms"
to = "0.1 s"
deviation = "1 cm"
"""
IN_SI = {
    "start_time": 0.001,
    "stop_time": 2.0,
    "exchange_step": 0.001,
    "output_interval": 0.01,
    "state_interval": 0.1,
    "time_limit": 120.0,
}


def sources():
    a = [
        par("stiffness", 1.0, "N/m"),
        par("width", 1.0, "m", formerly="breadth"),
        par("row[1]", 1.0, "m"),
        par("plain", 1.0),
        par("label", 1.0, kind="String"),
        out("force", "kN"),
    ]
    b = [
        inp("shift", "mm"),
        inp("heat", "degC"),
        par("size", 1.0, "mm"),
        inp("push", "kN"),
        inp("push2", "N"),
        inp("warm", "degC"),
    ]
    return {"a": Mock(a), "b": Mock(b)}


def from_text(text, made=None):
    made = made or sources()
    return system_from(tomllib.loads(text), "file", lambda name, entry: made[name])


def test_every_place_of_a_system_takes_a_quantity_and_keeps_a_number():
    system = from_text(WITH_UNITS)
    told = system.model_dump()
    assert {key: told[key] for key in IN_SI} == IN_SI
    a = system.components["a"]
    assert (a.step, a.time_limit) == (0.0005, 60.0)
    known = {"stiffness": 3e5, "label": "5 kN", "width": 0.02, "row[1]": 0.001, "plain": 2}
    assert a.parameters == known
    first, second = system.connections
    assert (first.factor, first.offset) == (3000.0, 10.0)  # mm for each kN, mm
    assert (second.factor, second.offset) == (1.0, 2.0)  # a difference of 2 K is one of 2 degC
    assert system.shared["size"].value == 120.0  # mm
    assert system.energy_alarm.reference == 2000.0
    assert system.iteration.window == 0.002
    assert system.iteration.connections[0].absolute == 0.002  # kN
    assert system.adaptive.largest_step == 0.004
    assert system.scenario.inputs == {"time": [0.0, 0.5, 60.0], "b.push": [0.0, 2.0, 3.0]}
    warm, push = system.scenario.set
    assert (warm.value, warm.at) == (20.0, 0.1)
    assert (push.value, push.when) == (9.80665, "a.force >= 2.0")
    (fault,) = system.scenario.fault
    assert (fault.begin, fault.end, fault.deviation) == (0.01, 0.1, 10.0)


def test_numbers_stay_as_they_are_and_no_fmu_is_asked():
    def nobody(name, entry):
        raise AssertionError(name)

    plain = {"components": {"a": {"fmu": "a", "parameters": {"x": 1.0, "word": "soft"}}}}
    assert numbers_in(plain, nobody) == (plain, {})


@given(
    st.recursive(
        st.none() | st.text(max_size=8) | st.just("3 kN") | st.integers(),
        lambda inner: (
            st.lists(inner, max_size=3)
            | st.dictionaries(
                st.sampled_from(
                    [
                        "components",
                        "connections",
                        "shared",
                        "scenario",
                        "set",
                        "fault",
                        "inputs",
                        "iteration",
                        "energy_alarm",
                        "value",
                        "port",
                        "when",
                        "a",
                        "fmu",
                        "parameters",
                        "source",
                        "factor",
                        "targets",
                        "reference",
                        "absolute",
                        "deviation",
                    ]
                ),
                inner,
                max_size=4,
            )
        ),
        max_leaves=20,
    )
)
def test_data_of_whatever_form_are_gone_through(data):
    numbers_in(data if isinstance(data, dict) else {"scenario": data}, lambda n, e: sources()["a"])


def test_an_older_name_and_a_whole_array_have_the_unit_of_the_variable():
    text = 'name="x"\nstop_time=1\nexchange_step=1\n[components.a]\nfmu="a"\n'
    more = '[components.a.parameters]\nbreadth = "3 cm"\n"row[*]" = "1 cm"\n'
    found = from_text(text + more).components["a"].parameters
    assert found == {"breadth": 0.03, "row[*]": 0.01}


WRONG = {
    'stiffness = "3 kN/cm"': ('stiffness = "3 kN"', "components.a.parameters.stiffness", "N/m"),
    'factor = "3 mm/N"': ('factor = "3 mm"', "connections.0.factor", "in mm per kN"),
    'offset = "1 cm"': ('offset = "1 kg"', "connections.0.offset", "must be a length, in mm"),
    'value = "12 cm"': ('value = "12 kg"', "shared.size.value", "must be a length, in mm"),
    'reference = "2 kJ"': ('reference = "2 kg"', "energy_alarm.reference", "in J"),
    'absolute = "2 N"': ('absolute = "2 m"', "iteration.connections.0.absolute", "in kN"),
    '"2 kN", 3.0': ('"2 kg", 3.0', "scenario.inputs.b.push.1", "must be a force, in kN"),
    '"500 ms", "1 min"': ('"5 kg", "1 min"', "scenario.inputs.time.1", "must be a time, in s"),
    '"293.15 K"': ('"293.15 kg"', "scenario.set.0.value", "must be in degC"),
    "a.force >= 2 kN": ("a.force >= 2 m", "scenario.set.1.when", "must be a force, in kN"),
    'deviation = "1 cm"': ('deviation = "1 N"', "scenario.fault.0.deviation", "in mm"),
    'from = "10 ms"': ('from = "10 kg"', "scenario.fault.0.from", "must be a time, in s"),
    'step = "0.5 ms"': ('step = "0.5 m"', "components.a.step", "must be a time, in s"),
    'window = "2 ms"': ('window = "2 m"', "iteration.window", "must be a time, in s"),
}


@pytest.mark.parametrize("right", WRONG)
def test_a_quantity_of_another_kind_is_refused_with_its_key(right):
    wrong, key, reason = WRONG[right]
    assert WITH_UNITS.count(right) == 1
    with pytest.raises(InputRefused) as refused:
        from_text(WITH_UNITS.replace(right, wrong))
    (problem,) = refused.value.problems
    assert problem.where == f"file: {key}"
    assert reason in problem.what


def test_all_wrong_quantities_are_told_at_once():
    text = WITH_UNITS
    for right, (wrong, _, _) in WRONG.items():
        text = text.replace(right, wrong)
    with pytest.raises(InputRefused) as refused:
        from_text(text)
    places = {problem.where for problem in refused.value.problems}
    assert places == {f"file: {key}" for _, key, _ in WRONG.values()}


def test_a_run_with_units_has_the_bits_of_the_run_in_si(tmp_path):
    def run(name, push, factor, at):
        def show(v, t, h):
            v["force"] = v["push"]

        def move(v, t, h):
            v["got"] = v["shift"]

        made = {
            "a": Mock([inp("push", "kN"), out("force", "kN")], show),
            "b": Mock([inp("shift", "mm"), out("got", "mm")], move),
        }
        text = f"""
        name = "x"
        stop_time = "1 s"
        exchange_step = "100 ms"
        connections = [{{source = "a.force", target = "b.shift", factor = {factor}}}]
        components = {{a = {{fmu = "a"}}, b = {{fmu = "b"}}}}
        scenario = {{set = [{{port = "a.push", value = {push}, at = {at}}}]}}
        """
        return simulate(from_text(text, made), tmp_path / name, sources=made)

    one, two = run("one", '"700 N"', '"3 mm/N"', '"300 ms"'), run("two", 0.7, 3000.0, 0.3)
    assert one.provenance["system"] == two.provenance["system"]
    assert one.series["b.got"].tolist() == two.series["b.got"].tolist()
    assert one.series["b.got"][-1] == 2100.0


# ---------------------------------------------------------------- files and commands

FALL = """\
name = "fall"
exchange_step = {step}
stop_time = {stop}

[components.rock]
fmu = "{fmu}"
parameters = {{mass = {mass}, radius = {radius}}}

[shared]
weight = {{value = {weight}, targets = ["rock.gravity"]}}

[[scenario.set]]
port = "rock.force.x"
value = {push}
when = "rock.position.y < {low}"
"""
QUANTITIES = {
    "step": '"1 ms"',
    "stop": '"20ms"',
    "mass": '"2 t"',
    "radius": '"50 cm"',
    "weight": '"981 cm/s2"',
    "push": '"2 kN"',
    "low": "99.9 cm",
}
NUMBERS_ = {
    "step": 1e-3,
    "stop": 0.02,
    "mass": 2000.0,
    "radius": 0.5,
    "weight": 9.81,
    "push": 2000.0,
    "low": 0.999,
}


@pytest.fixture
def files(rock_fmu, tmp_path, monkeypatch):
    """The same system with quantities and with numbers, in a folder to stand in."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "300")
    (tmp_path / "units.toml").write_text(FALL.format(fmu=rock_fmu, **QUANTITIES))
    (tmp_path / "si.toml").write_text(FALL.format(fmu=rock_fmu, **NUMBERS_))
    return tmp_path


def command(*words):
    return CliRunner().invoke(app, [*map(str, words)])


def test_a_file_with_units_and_one_in_si_are_one_system_in_all_that_is_written(files):
    for name in ("units", "si"):
        done = command("run", f"{name}.toml", "--no-figures", "--output-dir", name)
        assert done.exit_code == 0, done.output
        assert command("export", f"{name}.toml", f"{name}.out").exit_code == 0
    systems = [json.loads((files / name / "run.json").read_text()) for name in ("units", "si")]
    assert systems[0]["system"] == systems[1]["system"]
    assert (files / "units/timeseries.csv").read_bytes() == (
        files / "si/timeseries.csv"
    ).read_bytes()
    written = [(files / f"{name}.out" / "system.toml").read_text() for name in ("units", "si")]
    assert written[0] == written[1]
    assert "mass = 2000.0" in written[0]
    assert command("verify", "units").exit_code == 0
    shown = command("info", "--toml", "units.toml").output
    assert shown == command("info", "--toml", "si.toml").output


def test_a_file_that_is_loaded_has_numbers(files):
    assert load_system(files / "units.toml") == load_system(files / "si.toml")
    one, two = (rockshed.System.load(files / f"{name}.toml").spec for name in ("units", "si"))
    assert one == two


def test_a_run_of_a_file_with_units_is_branched(files):
    run = ("run", "units.toml", "--no-figures", "--output-dir", "run", "--checkpoint-every", "5ms")
    assert command(*run).exit_code == 0
    done = command("branch", "run", "--set", "rock.mass=1 t", "--output-dir", "branch")
    assert done.exit_code == 0, done.output


def test_options_and_values_beside_a_file_go_before_its_quantities(files):
    words = ("run", "units.toml", "--no-figures", "--output-dir", "run")
    done = command(*words, "--set", "rock.mass=3 t", "--stop-time", "10 ms")
    assert done.exit_code == 0, done.output
    system = json.loads((files / "run/run.json").read_text())["system"]
    assert system["components"]["rock"]["parameters"] == {"mass": 3000.0, "radius": 0.5}
    assert system["stop_time"] == 0.01


def test_a_system_made_in_python_takes_quantities_too():
    fall = rockshed.System.new("fall", exchange_step="1 ms", stop_time="20 ms")
    fall = fall.add("rock", "FallingRock", {"mass": "2 t", "radius": "50 cm"}, step="500 us")
    fall = fall.share("weight", "981 cm/s2", "rock.gravity")
    fall = fall.with_values({"rock.position0.y": "99 cm"})
    push = {"time": [0.0, "10 ms"], "rock.force.x": [0.0, "2 kN"]}
    fall = fall.scenario(push, values=[{"port": "rock.force.y", "value": "1 kN", "at": "5 ms"}])
    rock = fall.spec.components["rock"]
    known = {"mass": 2000.0, "radius": 0.5, "position0.y": 0.99}
    assert (rock.step, rock.parameters) == (0.0005, known)
    assert fall.spec.shared["weight"].value == 9.81
    assert fall.spec.scenario.inputs == {"time": [0.0, 0.01], "rock.force.x": [0.0, 2000.0]}
    assert fall.spec.scenario.set[0].value == 1000.0
    assert fall.validate() == []
    with pytest.raises(InputRefused, match="must be a mass, in kg"):
        fall.with_values({"rock.mass": "2 m"})
    with pytest.raises(InputRefused, match="must be a mass, in kg"):
        fall.add("other", "FallingRock", {"mass": "2 m"})
