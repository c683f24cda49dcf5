"""``rockshed.System``: made from a case, a file or nothing, and changed without changing the first."""

import json

import numpy as np
import pytest

import rockshed


def lab(**options):
    return rockshed.case("lab-impact", in_process=True, **options)


def value(system, component, name):
    return system.spec.components[component].parameters[name]


def test_a_change_gives_another_system():
    first = lab()
    second = first.with_values({"sand.damping": 0.3}).with_options(stop_time=0.01)
    assert value(second, "sand", "damping") == 0.3
    assert second.spec.stop_time == 0.01
    assert "damping" not in first.spec.components["sand"].parameters
    assert first.spec.stop_time == 0.04
    assert second.job.facts["differences"] == {"sand.damping": 0.3, "stop_time": 0.01}


def test_a_value_that_is_shared_reaches_all_its_targets():
    assert lab().with_values({"rock.mass": 8.0}).spec.shared["rock_mass"].value == 8.0


def test_values_that_follow_from_others_are_adapted():
    girders = rockshed.case("girders-8", in_process=True)
    heavier = girders.with_values({"sand.thickness": 3.4})
    assert value(heavier, "beam", "cushion.weight") == pytest.approx(
        2.0 * value(girders, "beam", "cushion.weight")
    )


@pytest.mark.parametrize(
    "name", ["lab-impact", "lab-impact-13", "static-test", "rigid-base-pit", "girders-10"]
)
def test_a_rock_starts_as_far_above_sand_of_finer_discs_as_above_the_sand_of_the_case(name):
    case = rockshed.case(name, model="calibrated", in_process=True)
    radius = value(case, "sand", "disc.radius") if "disc.radius" in of_sand(case) else 0.005
    discs = case.job.facts["sizes"]["sand"]["discs"]
    finer = case.with_sizes({"sand.discs": 4 * discs})
    finer = finer.with_values({"sand.disc.radius": radius / 2})
    start = value(case, "rock", "position0.y")
    assert value(finer, "rock", "position0.y") == pytest.approx(start, rel=1e-12)
    mine = finer.with_values({"rock.position0.y": 3.0})
    assert value(mine, "rock", "position0.y") == 3.0
    taller = case.with_sizes({"sand.discs": 2 * discs})
    height = value(taller, "rock", "position0.y") - start
    wider = taller.with_values({"sand.box.width": 2.0 * width_of(case)})
    assert value(wider, "rock", "position0.y") == pytest.approx(start, abs=2 * radius)
    assert height > 8 * 2 * radius


def of_sand(system):
    return system.spec.components["sand"].parameters


def width_of(system):
    shared = system.spec.shared.get("box_width")
    return shared.value if shared else of_sand(system)["box.width"]


def test_a_case_is_made_again_in_other_sizes():
    taller = lab().with_sizes({"sand.discs": 740})
    assert value(taller, "rock", "position0.y") > value(lab(), "rock", "position0.y")
    assert taller.job.facts["sizes"]["sand"]["discs"] == 740
    with pytest.raises(rockshed.InputRefused, match=r"sand\.disks.*did you mean sand\.discs"):
        lab().with_sizes({"sand.disks": 9})
    with pytest.raises(rockshed.InputRefused, match="no whole number"):
        lab().with_sizes({"sand.discs": 9.5})


def test_a_system_that_is_no_case_refuses_other_sizes_with_a_reason(tmp_path):
    for system in (lab().connect("rock.position.x -> sand.rock.position.x"), saved(tmp_path)):
        with pytest.raises(rockshed.InputRefused, match="only cases are made again"):
            system.with_sizes({"sand.discs": 740})


def saved(folder):
    fall = rockshed.System.new("fall", exchange_step=1e-3, stop_time=0.01)
    file = fall.add("rock", "FallingRock", {"velocity0.y": -1.0}).save(folder / "fall")
    return rockshed.System.load(file)


def test_a_saved_system_runs_with_the_same_result(tmp_path):
    fall = rockshed.System.new("fall", exchange_step=1e-3, stop_time=0.01)
    fall = fall.add("rock", "FallingRock", {"velocity0.y": -1.0})
    one, other = rockshed.simulate(fall), rockshed.simulate(saved(tmp_path))
    assert (one["rock.position.y"].values == other["rock.position.y"].values).all()
    quicker = saved(tmp_path / "again").with_values({"rock.velocity0.y": -2.0})
    assert rockshed.simulate(quicker)["rock.velocity.y"][0] == -2.0


def test_a_system_from_nothing_is_the_case(tmp_path):
    """Rock and sand of the static test, put together by hand: the same bits, and its energy."""
    static = rockshed.case("static-test", in_process=True, stop_time=0.02)
    made = rockshed.System.new(
        "by-hand", exchange_step=1e-3, stop_time=0.02, output_interval=5e-3, order=["sand", "rock"]
    )
    for name, model in (("sand", "SandCushion"), ("rock", "FallingRock")):
        sizes = {"discs": 370, "elements": 1} if name == "sand" else None
        made = made.add(name, model, static.spec.components[name].parameters, sizes=sizes)
    made = made.with_values(
        {name: shared.value for shared in static.spec.shared.values() for name in shared.targets}
    )
    made = made.connect(*(f"{c.source} -> {c.target}" for c in static.spec.connections))
    axes = ("x", "y")
    made = made.bond(
        "sand_rock",
        [*(f"sand.rock.force.{axis}" for axis in axes), "sand.rock.torque"],
        [*(f"rock.position.{axis}" for axis in axes), "rock.angle"],
        work="sand.energy.work.rock",
    )
    assert made.validate() == []
    one, other = rockshed.simulate(static), rockshed.simulate(made)
    for name in ("sand.rock.force.y", "coupling.sand_rock.energy"):
        assert (one[name].values == other[name].values).all()


def test_numbers_of_numpy_are_taken_and_lists_are_refused(recwarn):
    system = lab(values={"sand.modulus": np.int64(300000)}, sizes={"sand.discs": np.int64(740)})
    system = system.with_values({"sand.damping": np.float64(0.3)}).with_options(
        stop_time=np.float64(0.001)
    )
    assert json.dumps(dict(system.job.facts["request"]))
    assert value(system, "sand", "modulus") == 300000
    with pytest.raises(
        rockshed.InputRefused, match=r"sand\.damping: \[0\.1, 0\.2\]: takes one number"
    ):
        system.with_values({"sand.damping": [0.1, 0.2]})
    with pytest.raises(rockshed.InputRefused, match="'abc': must be a number"):
        rockshed.simulate(lab(values={"sand.damping": "abc"}))
    assert not [warning for warning in recwarn if "Pydantic" in str(warning.message)]


def test_a_value_is_shared():
    fall = rockshed.System.new("fall", exchange_step=1e-3, stop_time=0.01)
    with pytest.raises(rockshed.InputRefused, match="takes one number"):
        fall.add("rock", "FallingRock", {"mass": [1.0, 2.0]})
    fall = fall.add("rock", "FallingRock").add("other", rockshed.component("FallingRock"))
    shared = fall.share("mass", 8.0, ["rock.mass", "other.mass"])
    assert shared.validate() == []
    assert shared.with_values({"rock.mass": 9.0}).spec.shared["mass"].value == 9.0
    with pytest.raises(rockshed.InputRefused, match="is shared already"):
        shared.share("mass", 8.0, "rock.mass")


def test_a_saved_folder_is_read_under_the_name_in_its_file(tmp_path):
    saved(tmp_path)
    again = rockshed.System.load(tmp_path / "fall")
    assert again.name == "fall"
    assert sorted(file.name for file in (tmp_path / "fall").iterdir()) == [
        "FallingRock.fmu",
        "system.toml",
    ]


def test_a_bond_takes_forces_before_positions():
    static = rockshed.case("static-test", in_process=True)
    problems = static.bond("b", "rock.position.x", "sand.rock.force.x").validate()
    assert any("is in m, and no force or torque" in str(problem) for problem in problems)


def test_an_empty_system_is_refused_and_a_case_is_run_by_name(tmp_path):
    empty = rockshed.System.new("fall", exchange_step=1e-3, stop_time=0.01)
    for use in (rockshed.simulate, rockshed.System.describe, lambda it: it.save(tmp_path / "a")):
        with pytest.raises(rockshed.InputRefused, match="has no component"):
            use(empty)
    assert list(tmp_path.iterdir()) == []
    with pytest.raises(rockshed.InputRefused, match="did you mean lab-impact"):
        rockshed.simulate("lab-impakt")
    with pytest.raises(rockshed.InputRefused, match="or the name of a case"):
        rockshed.simulate(3)


def test_connections_are_texts_or_two_names():
    fall = rockshed.System.new("fall", exchange_step=1e-3, stop_time=0.01)
    fall = fall.add("rock", "FallingRock").add("other", "FallingRock")
    assert (
        fall.connect("rock.position.x", "other.force.x").spec
        == fall.connect("rock.position.x -> other.force.x").spec
    )
    with pytest.raises(rockshed.InputRefused, match="is no connection"):
        fall.connect("rock.position.x")
    problems = fall.connect("rock.position.z -> other.force.x").validate()
    assert any("rock.position.z" in str(problem) for problem in problems)


def test_what_is_no_component_or_bond_is_refused():
    empty = rockshed.System.new("fall", exchange_step=1e-3, stop_time=0.01)
    assert "has no component" in str(empty.validate()[0])
    with pytest.raises(KeyError, match="did you mean FallingRock"):
        empty.add("rock", "FalingRock")
    one = empty.add("rock", "FallingRock")
    with pytest.raises(rockshed.InputRefused, match="is there already"):
        one.add("rock", "FallingRock")
    with pytest.raises(rockshed.InputRefused, match="leave them out"):
        one.add("beam", "RBSMBeam.fmu", sizes={"elements": 3})
    with pytest.raises(rockshed.InputRefused, match="not outputs of one component"):
        one.bond("b", ["rock.force.y", "sand.force.y"], "rock.position.y")
    with pytest.raises(rockshed.InputRefused, match="there is no such key"):
        one.with_options(stop_tim=1.0)
    with pytest.raises(rockshed.InputRefused, match=r"System\.load"):
        rockshed.case("fall.toml")


def test_a_system_that_is_put_together_anew_is_not_compared():
    changed = lab(stop_time=0.001).connect("rock.angle -> sand.rock.angle")
    assert changed.job.facts["references"]["remarks"]


def test_a_system_shows_itself_in_a_line_and_is_described_in_tables():
    system = lab(stop_time=0.01)
    assert repr(system) == ("<System lab-impact: sand, rock, beam; 0.01 s in exchanges of 1e-05 s>")
    assert "<table>" in system._repr_html_()
    described = str(system.describe())
    assert "order sand, rock, beam; exchange every 1e-05 s" in described
    assert "rock_mass" in described
    assert "<table>" in system.describe()._repr_html_()


def test_girders_begin_with_the_model_of_the_sand_that_fits_them():
    sand = of_sand(rockshed.case("girders-10", in_process=True))
    assert (sand["packing"], sand["unloading_ratio"]) == ("prepared", 3.0)
    asked = of_sand(rockshed.case("girders-10", model="calibrated", in_process=True))
    assert "packing" not in asked
    assert rockshed.case("lab-impact", in_process=True).job.facts.get("model") is None


def test_a_case_with_a_scenario_is_not_compared_with_what_others_found_in_the_undisturbed_one():
    fault = {"port": "rock.force.y", "kind": "cut", "from": 0.01}
    disturbed = lab().scenario({"time": [0.0], "rock.torque": [0.0]}, faults=[fault])
    assert disturbed.job.facts["differences"] == {"scenario": "1 input column, 1 fault"}
    assert "scenario" in disturbed.job.facts["references"]["remarks"][0]
    assert disturbed.spec.scenario.fault[0].begin == 0.01
