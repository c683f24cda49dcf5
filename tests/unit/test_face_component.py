"""``rockshed.component`` and ``rockshed.build_fmu``: a component without FMI, and its FMU."""

import pytest

import rockshed
from rockshed.components.catalogue import component as catalogued


def test_a_component_is_stepped_by_names():
    beam = rockshed.component("RBSMBeam", elements=6)
    beam["force.y[3]"] = -100.0
    beam.initialise()
    for _ in range(5):
        beam.step(1e-5)
    assert beam.time == pytest.approx(5e-5)
    assert beam["midspan.deflection"] > 0.0
    assert len(beam["force.y"]) == 6
    assert "midspan.deflection" in beam
    assert "force.y[3]" in list(beam)
    with pytest.raises(KeyError, match=r"did you mean midspan\.deflection"):
        beam["midspan.deflecton"]
    with pytest.raises(KeyError, match="RBSMBeam has no variable"):
        beam["forcey"] = 1.0
    assert repr(beam).startswith("<RBSMBeam, elements 6")
    assert "<table>" in beam._repr_html_()


def test_choices_are_words():
    rock = rockshed.component("FallingRock")
    rock["motion"] = "driven"
    assert ("motion", "driven") in [(r["variable"], r["value"]) for r in rock.variables()]


def test_a_component_of_ones_own_is_taken_as_it_is():
    rock = rockshed.component(catalogued("FallingRock"))
    rock.initialise()
    assert rock["velocity.y"] == -8.0


def test_unknown_components_and_sizes_are_refused(tmp_path):
    with pytest.raises(KeyError, match="did you mean SandCushion"):
        rockshed.component("SandCushon")
    with pytest.raises(rockshed.ComponentError, match="has no size"):
        rockshed.component("FallingRock", discs=3)
    with pytest.raises(rockshed.InputRefused, match="has no size"):
        rockshed.build_fmu("FallingRock", {"discs": 3}, tmp_path)
    with pytest.raises(rockshed.InputRefused, match='add runtime="native"'):
        rockshed.build_fmu("FallingRock", folder=tmp_path, runtime="python", fmi=3)
    with pytest.raises(rockshed.InputRefused, match="one at a time"):
        rockshed.build_fmu("FallingRock", folder=tmp_path, runtime="both")
    assert list(tmp_path.iterdir()) == []


def test_an_fmu_is_built_in_a_size_and_taken_into_a_system(tmp_path):
    file = rockshed.build_fmu("RBSMBeam", {"elements": 4}, tmp_path)
    assert file.parent == tmp_path / "python"
    still = rockshed.System.new("still", exchange_step=1e-5, stop_time=1e-4)
    run = rockshed.simulate(still.add("beam", file, {"span": 1.0}))
    assert run.provenance["components"]["beam"]["model"] == "RBSMBeam"
    assert "beam.force.y[4]" not in run
    assert "beam.position.y[4]" in run


def test_a_component_is_stepped_only_when_it_can_be():
    rock = rockshed.component("FallingRock")
    with pytest.raises(rockshed.ComponentError, match=r"call initialise\(\) first"):
        rock.step(1e-3)
    rock.initialise()
    for step in (0.0, -1e-3, float("nan"), float("inf")):
        with pytest.raises(rockshed.ComponentError, match="must be a positive number"):
            rock.step(step)
    rock.step(1e-3)
    assert rock.time == 1e-3


def test_a_component_that_failed_steps_no_more():
    rock = rockshed.component("FallingRock")
    rock.initialise()
    rock.instance.step = lambda time, step: 1 / 0
    with pytest.raises(ZeroDivisionError):
        rock.step(1e-3)
    with pytest.raises(rockshed.ComponentError, match="an earlier step has failed"):
        rock.step(1e-3)


def test_values_that_a_component_does_not_take_are_refused():
    rock = rockshed.component("FallingRock")
    with pytest.raises(rockshed.ComponentError, match=r"mass = 'heavy': must be a number"):
        rock["mass"] = "heavy"
    with pytest.raises(rockshed.ComponentError, match="takes one number"):
        rock["mass"] = [1.0, 2.0]
    with pytest.raises(rockshed.ComponentError, match="is an output"):
        rock["velocity.y"] = 1.0
    rock.initialise()
    with pytest.raises(rockshed.ComponentError, match="is fixed after initialise"):
        rock["mass"] = 5.0
    with pytest.raises(rockshed.ComponentError, match="must be a finite number"):
        rock["force.y"] = float("nan")
    rock["force.y"] = 3.0


def test_fmus_of_two_runtimes_in_one_folder_stay_apart(tmp_path, monkeypatch):
    """What is written is looked at without building: the place alone is the question."""
    from rockshed.runs import building

    places = []

    def noted(components, sizes, folders, export):
        places.extend(folders.values())
        return [next(iter(folders.values())) / "FallingRock.fmu"]

    monkeypatch.setattr(building, "_build", noted)
    for choice in ({}, {"runtime": "native"}, {"fmi": 3}):
        rockshed.build_fmu("FallingRock", folder=tmp_path, **choice)
    assert [place.relative_to(tmp_path).as_posix() for place in places] == [
        "python",
        "native",
        "native-fmi3",
    ]
