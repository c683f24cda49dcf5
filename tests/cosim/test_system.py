"""The form of a system: TOML, unknown keys, values that are shared or overridden."""

from fractions import Fraction
from pathlib import Path

import pytest

from rockshed.core.errors import InputRefused
from rockshed.core.system.other_values import with_values
from rockshed.core.system.parts import Connection
from rockshed.core.system.reading import load_system, system_from

TEXT = """
name = "pair"
exchange_step = 1e-5
stop_time = 0.02
order = ["sand", "rock"]
connections = [
    "sand.rock.force.x -> rock.force.x",
    { source = "rock.position.x", target = "sand.rock.position.x" },
]

[components.rock]
fmu = "dist/Rock.fmu"
parameters = { mass = 4.0, shape = "sphere" }

[components.sand]
fmu = "dist/Sand.fmu"
step = 2e-5
record_states = true

[shared.rock_radius]
value = 0.05
targets = ["rock.radius", "sand.rock.radius"]

[bonds.rock]
giver = "sand"
force = ["rock.force.x"]
taker = "rock"
position = ["position.x"]
"""


def minimal(**more):
    return {
        "name": "x",
        "components": {"a": {"fmu": "a.fmu"}},
        "exchange_step": 1.0,
        "stop_time": 1.0,
        **more,
    }


def refused(data):
    with pytest.raises(InputRefused) as refusal:
        system_from(data)
    return {
        problem.where.removeprefix("system: "): problem.what for problem in refusal.value.problems
    }


def test_a_toml_file_becomes_a_system(tmp_path):
    (tmp_path / "pair.toml").write_text(TEXT)
    system = load_system(tmp_path / "pair.toml")
    assert system.components["rock"].fmu == str(tmp_path / "dist/Rock.fmu")
    assert system.components["rock"].parameters == {"mass": 4.0, "shape": "sphere"}
    assert (system.step("rock"), system.step("sand")) == (1e-5, 2e-5)
    assert system.connections == [
        Connection(source="sand.rock.force.x", target="rock.force.x"),
        Connection(source="rock.position.x", target="sand.rock.position.x"),
    ]
    assert system.master == "sequential"
    assert system.bonds["rock"].taker == "rock"


def test_all_problems_of_form_are_told_at_once_with_the_path_of_the_key():
    found = refused(
        {
            "name": "x",
            "stop_time": float("nan"),
            "exchange_step": 1.0,
            "outputinterval": 1.0,
            "master": "gauss",
            "components": {
                "a": {"fmu": "a.fmu", "step": -1.0, "stp": 2.0},
                "time": {"fmu": "t.fmu"},
                "b": {},
            },
            "connections": ["a.x > b.y"],
        }
    )
    assert set(found) == {
        "stop_time",
        "outputinterval",
        "master",
        "components.a.step",
        "components.a.stp",
        "components.b.fmu",
        "components.time.[key]",
        "connections.0",
    }
    assert "did you mean output_interval" in found["outputinterval"]
    assert "did you mean step" in found["components.a.stp"]
    assert "greater than 0 (given: -1.0)" in found["components.a.step"]
    assert found["components.b.fmu"] == "is missing"
    assert "columns of the results" in found["components.time.[key]"]
    assert "'a.x > b.y' is no connection" in found["connections.0"]


@pytest.mark.parametrize(
    ("text", "message"), [("name = ", "is not valid TOML"), (None, "cannot be read")]
)
def test_a_file_that_is_no_toml(tmp_path, text, message):
    path = tmp_path / "s.toml"
    if text is not None:
        path.write_text(text)
    with pytest.raises(InputRefused, match=message) as refusal:
        load_system(path)
    assert str(path) in str(refusal.value)


def test_values_are_overridden_and_shared_ones_change_for_all(tmp_path):
    (tmp_path / "pair.toml").write_text(TEXT)
    system = load_system(tmp_path / "pair.toml")
    changed = with_values(system, {"rock.mass": 5.0, "sand.rock.radius": 0.1})
    assert changed.components["rock"].parameters == {"mass": 5.0, "shape": "sphere"}
    assert changed.shared["rock_radius"].value == 0.1
    assert changed.shared["rock_radius"].targets == ["rock.radius", "sand.rock.radius"]
    assert with_values(system, {"rock_radius": 0.2}).shared["rock_radius"].value == 0.2
    assert system.components["rock"].parameters["mass"] == 4.0
    assert system.shared["rock_radius"].value == 0.05


def test_an_element_of_a_shared_array_changes_the_shared_value():
    system = system_from(minimal(shared={"width": {"value": 1.0, "targets": ["a.width[*]"]}}))
    assert with_values(system, {"a.width[3]": 2.0}).shared["width"].value == 2.0


def test_overrides_that_cannot_be_meant():
    system = system_from(minimal(shared={"r": {"value": 1.0, "targets": ["a.r", "a.s"]}}))
    with pytest.raises(InputRefused) as refusal:
        with_values(system, {"b.mass": 1.0, "mass": 1.0, "a.r": 2.0, "a.s": 3.0})
    text = str(refusal.value)
    assert len(refusal.value.problems) == 3
    assert "b.mass: is neither component.parameter nor a shared value; there are a, r" in text
    assert "r: is one value for all its targets, and is given several: a.r = 2.0, a.s = 3.0" in text


def test_paths_stay_absolute(tmp_path):
    (tmp_path / "s.toml").write_text(
        'name="x"\nexchange_step=1.0\nstop_time=1.0\ncomponents.a.fmu="/opt/a.fmu"'
    )
    assert Path(load_system(tmp_path / "s.toml").components["a"].fmu) == Path("/opt/a.fmu")


def test_the_example_in_the_documentation_is_a_system(tmp_path):
    import rockshed

    text = (Path(rockshed.__file__).parent / "README.md").read_text(encoding="utf-8")
    (tmp_path / "example.toml").write_text(text.split("```toml\n")[1].split("```")[0])
    assert load_system(tmp_path / "example.toml").bonds["rock"].work == "energy.work.rock"


@pytest.mark.parametrize("given", ["1/60", 1 / 60, Fraction(1, 60)])
def test_a_time_may_be_a_fraction_of_a_second(given):
    assert system_from(minimal(exchange_step=given)).exchange_step == 1 / 60


@pytest.mark.parametrize("given", ["1/0", "-1/60", "a/b"])
def test_a_fraction_that_is_no_time_is_refused(given):
    assert list(refused(minimal(exchange_step=given))) == ["exchange_step"]
