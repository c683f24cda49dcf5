"""Headline figures and the table, from made-up results whose figures are known."""

import json
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from rockshed.cases import sonoda1993
from rockshed.cases.registry import case, cases, differences, references
from rockshed.components.catalogue import component
from rockshed.core.errors import InputRefused
from rockshed.core.fmu.fmu_slave import read_description
from rockshed.core.results.metric import Metric, Metrics
from rockshed.core.results.provenance import declarations
from rockshed.core.results.reading import StoredRun
from rockshed.fmus.description.fmi2 import model_description
from rockshed.metrics import comparison, names
from rockshed.metrics.caption import models
from rockshed.metrics.energy import system_residual
from rockshed.metrics.filtering import load_cell
from rockshed.metrics.headlines import headlines
from rockshed.references import Known, Reference, References
from rockshed.runs.building import own_sizes
from rockshed.runs.job import Request, prepare

KGF = 9.80665


@cache
def declared(model):
    """Contents, pictures and roles of a component, as its model description tells them."""
    chosen = component(model)
    xml = model_description(chosen, chosen.with_sizes(), "guid")
    return declarations(read_description(xml))


def made_up(length=0.02, summary=(), **columns):
    """A run of rock, sand and beam: a half sine of 1 kN on the rock over 10 ms, twice that transmitted 2 ms later."""
    time = np.linspace(0.0, length, 401)
    rock = np.where(time < 0.01, 1e3 * np.sin(np.pi * time / 0.01), 0.0)
    late = np.clip(time - 0.002, 0.0, 0.01)
    zero = np.zeros_like(time)
    series = {
        "time": time,
        "sand.rock.force.y": rock,
        "sand.transmitted_force": 50.0 + 2e3 * np.sin(np.pi * late / 0.01),
        "sand.penetration": 0.06 * np.sin(np.pi * time / 0.02),
        "sand.surface_height": zero + 0.1,
        "rock.energy.kinetic": 100.0 - 4e3 * time,
        "rock.energy.residual": 2e2 * time,
        "rock.energy.work.contact": -4e3 * time,
        "sand.energy.residual": -5.0 * time,
        "sand.energy.work.rock": 3.9e3 * time,
        "sand.energy.work.beam": zero - 1.0,
        "beam.energy.residual": zero,
        "beam.energy.work.contact": zero,
        "beam.position.y[1]": zero - 0.025,
        "coupling.sand_rock.energy": -1e2 * time,
        **columns,
    }
    sand = {
        "base": "beam_surface",
        "base.y": 0.0,
        "beam.radius": 0.025,
        "disc.radius": 0.005,
        "rotation": "locked",
        "stiffness_factor": 0.342,
        "density": 1800.0,
        "density_of": "disc",
        "base.shape": "flat",
        "cohesion": 0.0,
        "unloading_ratio": 1.0,
        "disc.spread": 0.0,
        "solid_fraction": 0.785,
        "modulus": 30.0 * KGF / 1e-4,
        "internal_step": 1e-5,
        "rolling_resistance": 0.0,
        "packing": "square",
        "gravity": 9.81,
    }
    provenance = {
        "status": "complete",
        "name": "made-up",
        "system": {"description": "", "master": "sequential", "exchange_step": 1e-5},
        "components": {
            name: {
                "model": model,
                **declared(model),
                "parameters": {key: {"value": value} for key, value in parameters.items()},
            }
            for name, model, parameters in (
                ("rock", "FallingRock", {}),
                ("sand", "SandCushion", sand),
                ("beam", "RBSMBeam", {"internal_step": 1e-6}),
            )
        },
    }
    return StoredRun(None, provenance, Metrics(summary), [], series)


def figure(run, name):
    return next(f.value for f in headlines(run) if f.name == name)


def test_peaks_impulse_and_duration_of_a_half_sine():
    run = made_up()
    assert figure(run, names.PEAK_ROCK) == pytest.approx(1e3, rel=1e-3)
    assert figure(run, names.PEAK_ROCK_AT) == pytest.approx(0.005, abs=1e-4)
    assert figure(run, names.PEAK_TRANSMITTED) == pytest.approx(2050.0, rel=1e-3)
    assert figure(run, names.PEAK_TRANSMITTED_AT) == pytest.approx(0.007, abs=1e-4)
    assert figure(run, names.IMPULSE_ROCK) == pytest.approx(1e3 * 0.01 * 2 / np.pi, rel=1e-3)
    assert figure(run, names.IMPULSE_TRANSMITTED) == pytest.approx(2e3 * 0.01 * 2 / np.pi, rel=1e-3)
    assert figure(run, names.DURATION) == pytest.approx(0.01, rel=0.02)


def test_extremes_over_all_exchanges_go_before_those_of_the_rows():
    run = made_up(
        summary=[
            Metric("sand.rock.force.y maximum", 1234.0, "N"),
            Metric("sand.rock.force.y maximum at", 0.0049, "s"),
        ]
    )
    assert figure(run, names.PEAK_ROCK) == 1234.0
    assert figure(run, names.PEAK_ROCK_AT) == 0.0049


def test_the_systems_residual_takes_what_the_works_leave():
    """Residuals 195 W, works -100 W: 95 W over 20 ms; the constant work at the start does not count."""
    run = made_up()
    np.testing.assert_allclose(system_residual(run), 95.0 * run.series["time"], atol=1e-9)
    assert figure(run, names.RESIDUAL_SHARE) == pytest.approx(95.0 * 0.02 / 100.0)


def test_without_a_balance_of_every_component_there_is_none():
    run = made_up()
    del run.series["beam.energy.residual"]
    assert system_residual(run) is None
    assert names.RESIDUAL not in [f.name for f in headlines(run)]


def test_a_rock_near_the_base_is_warned_of():
    """A layer of 10 cm; the beam has given way, so that the depth alone does not tell."""

    def sunk(depth, sag):
        way = np.sin(np.pi * made_up().series["time"] / 0.02)
        return made_up(
            **{"sand.penetration": depth * way, "sand.clearance": 0.1 - (depth - sag) * way}
        )

    assert not any("bottoms out" in text for text in comparison.warnings(made_up()))
    near = comparison.warnings(sunk(0.098, 0.002))
    assert "within 4.0 mm of the base" in near[-1]
    through = comparison.warnings(sunk(0.105, 0.002))
    assert "presses 3.0 mm into the base" in through[-1]


def test_a_balance_that_does_not_close_is_warned_of():
    assert system_residual(made_up())[-1] / 100.0 == pytest.approx(0.019)  # beyond 1 %
    lost = made_up(**{"rock.energy.residual": -19.9 * np.linspace(0.0, 1.0, 401)})
    assert "does not close: -22 % of the impact energy" in comparison.warnings(lost)[0]
    row = next(row for row in comparison.rows(lost, {}) if row.label == "energy residual / E0")
    assert row.computed == "-22.00"
    closed = made_up(**{"rock.energy.residual": 2.1 * np.linspace(0.0, 1.0, 401)})
    assert comparison.warnings(closed) == []


def test_sand_that_was_not_at_rest_is_warned_of():
    level = np.ones(401)
    quiet = {"rock.energy.residual": 2.0 * np.linspace(0.0, 1.0, 401)}
    assert (
        comparison.warnings(made_up(**quiet, **{"sand.unbalanced_force_ratio": 1e-6 * level})) == []
    )
    restless = made_up(**quiet, **{"sand.unbalanced_force_ratio": 2e-3 * level})
    assert "raise settling.time" in comparison.warnings(restless)[0]
    restless.provenance["components"]["sand"]["parameters"]["gravity"]["value"] = 0.0
    (only,) = comparison.warnings(restless)
    assert "the sand has no gravity" in only


def test_a_load_cell_shows_a_step_as_an_oscillator_of_damping_ratio_0_7_does():
    """Overshoot exp(-pi) at the time sqrt(2) pi / omega; nothing before the step; the level of the start is kept."""
    time = np.linspace(0.0, 0.02, 4001)
    force = np.where(time < 0.005, 300.0, 1300.0)
    shown = load_cell(time, force, 1000.0)
    assert shown[time < 0.005] == pytest.approx(300.0, rel=1e-9)
    assert shown.max() == pytest.approx(1300.0 + 1000.0 * np.exp(-np.pi), rel=1e-3)
    assert time[shown.argmax()] - 0.005 == pytest.approx(
        np.sqrt(2.0) * np.pi / (2.0 * np.pi * 1000.0), rel=0.02
    )
    assert shown[-1] == pytest.approx(1300.0, rel=1e-6)


def test_a_load_cell_passes_slow_forces_and_halves_the_power_at_its_cut_off():
    time = np.linspace(0.0, 0.1, 20001)
    for frequency, passed in (
        (20.0, 1.0),
        (1000.0, np.sqrt(0.5)),
        (4000.0, 1 / np.sqrt(1.0 + 4.0**4)),
    ):
        shown = load_cell(time, np.sin(2.0 * np.pi * frequency * time), 1000.0)
        assert np.ptp(shown[10000:]) / 2.0 == pytest.approx(passed, rel=0.01)


def test_rows_that_are_too_far_apart_for_a_load_cell_are_refused():
    time = np.linspace(0.0, 0.02, 201)
    assert load_cell(time, time, 2000.0).size == 201
    with pytest.raises(ValueError, match=r"0\.0001 s apart carry a cut-off of 2000 Hz, not 2001"):
        load_cell(time, time, 2001.0)


def test_the_load_cell_that_a_run_was_asked_for_stands_beside_the_measurement():
    run = made_up()
    assert names.PEAK_LOAD_CELL not in [f.name for f in headlines(run)]
    run.provenance["load_cell"] = 1000.0
    assert figure(run, names.LOAD_CELL_CUT_OFF) == 1000.0
    assert figure(run, names.PEAK_LOAD_CELL) == pytest.approx(
        figure(run, names.PEAK_TRANSMITTED), rel=5e-3
    )
    known = sonoda1993.known_of(sonoda1993.tests()[4])
    row = next(row for row in comparison.rows(run, known) if "load cell" in row.label)
    assert row.beside["experiment"][0] == "5.09"


@pytest.mark.parametrize(
    ("cut_off", "options", "said"),
    [
        (
            2500.0,
            {},
            r"2500 Hz: rows every 0\.1 ms carry a cut-off above 0 and up to 2000 Hz.*output_interval=8e-05",
        ),
        (1000.0, {"output_interval": 1e-3}, r"rows every 1 ms carry .* up to 200 Hz"),
        (-5.0, {}, "-5 Hz.*above 0"),
    ],
)
def test_a_cut_off_that_the_rows_cannot_carry_is_refused_before_the_run(cut_off, options, said):
    with pytest.raises(InputRefused, match=said):
        prepare(Request("lab-impact", in_process=True, options=options, load_cell=cut_off))


def test_a_request_for_a_load_cell_goes_into_the_facts_of_the_run():
    assert (
        prepare(Request("lab-impact", in_process=True, load_cell=1000.0)).facts["load_cell"]
        == 1000.0
    )
    assert "load_cell" not in prepare(Request("lab-impact", in_process=True)).facts


def test_a_beam_bent_by_another_weight_than_the_sands_is_warned_of():
    run = made_up(**{"rock.energy.residual": 2.0 * np.linspace(0.0, 1.0, 401)})
    beam = run.provenance["components"]["beam"]["parameters"]
    for weight, warned in ((52.0, False), (0.0, False), (60.0, True)):
        beam["cushion.weight"] = {"value": weight}
        assert (
            any("set beam.cushion.weight=50" in text for text in comparison.warnings(run)) == warned
        )


def test_energy_of_the_beam_counts_from_the_start():
    run = made_up(**{"beam.energy.elastic": 3.0 + 2.0 * np.linspace(0.0, 1.0, 401)})
    assert figure(run, names.BEAM_ENERGY) == pytest.approx(2.0)
    assert figure(run, names.BEAM_SHARE) == pytest.approx(0.02)


def test_without_impact_energy_there_are_no_shares_of_it():
    still = made_up(**{"rock.energy.kinetic": np.zeros(401)})
    assert not [row.label for row in comparison.rows(still, {}) if "/ E0" in row.label]
    assert comparison.warnings(still) == []


def test_a_picture_that_fails_leaves_the_others(tmp_path, monkeypatch):
    from rockshed import pictures

    def fails(file):
        raise TypeError("no colours")

    def works(file):
        file.write_bytes(b"")

    made = [
        pictures.RunPicture(name, draw, ["time"]) for name, draw in (("one", fails), ("two", works))
    ]
    monkeypatch.setattr(pictures, "pictures_of", lambda run: made)
    said = []
    assert pictures.draw_all(made_up(), tmp_path, warn=said.append) == [tmp_path / "two.png"]
    assert said == ["no picture one: drawing it failed (TypeError: no colours)"]


def test_energies_that_are_all_zero_are_drawn(tmp_path):
    from rockshed.pictures.energy import energy

    run = made_up()
    energy(replace(run, series={name: np.zeros(1) for name in run.series}), tmp_path / "energy.png")
    assert (tmp_path / "energy.png").is_file()


def test_models_of_the_sand_have_their_names():
    run = made_up()
    sand = run.provenance["components"]["sand"]["parameters"]
    assert models(run)[0] == (
        "calibrated sand: rotation locked, stiffness factor 0.342, "
        "square packing, fictitious modulus E_bar 2.94 MPa (30.0 kgf/cm²)"
    )
    literal = {"rotation": "free", "stiffness_factor": 1.0, "base.shape": "round"}
    for name, value in literal.items():
        sand[name]["value"] = value
    assert models(run)[0].startswith("modified sand: rotation free")
    sand["base"]["value"] = "beam_discs"
    assert models(run)[0].startswith("literal sand: rotation free")
    sand["rolling_resistance"]["value"] = 0.3
    assert models(run)[0].startswith(
        "modified sand: rotation free, stiffness factor 1, rolling resistance 0.3, "
    )
    sand["rotation"]["value"], sand["rolling_resistance"]["value"] = "locked", 0.0
    assert models(run)[0].startswith("modified sand")


def test_deviations_stand_beside_the_references():
    known = {names.PEAK_TRANSMITTED: Known(Reference(2500.0, "a guess"), Reference(1640.0))}
    row = comparison.rows(made_up(), known)[0]
    assert row.computed == "2.05"
    assert row.beside == {
        "paper": ("≈ 2.50", pytest.approx(-0.18, abs=1e-3)),
        "experiment": ("1.64", pytest.approx(0.25, abs=1e-3)),
    }
    assert comparison.notes(made_up(), known)[-1] == "≈ paper: a guess"


def test_a_run_that_ends_too_soon_is_not_compared():
    known = {names.PEAK_TRANSMITTED: Known(experiment=Reference(1640.0))}
    short = made_up(length=0.008)
    assert comparison.rows(short, known)[0].beside == {}
    assert "nothing is compared" in comparison.notes(short, known)[-1]


def test_a_force_that_has_not_ended_is_told():
    depth = {"sand.penetration": 0.06 * np.sin(np.pi * np.linspace(0.0, 1.5, 401) / 1.6)}
    assert any(
        "has not ended" in note for note in comparison.notes(made_up(length=0.009, **depth), {})
    )
    assert not any(
        "has not ended" in note for note in comparison.notes(made_up(length=0.012, **depth), {})
    )


def test_the_papers_trend_goes_through_its_table_and_grows_with_the_modulus():
    known = {n: sonoda1993.known_of(test) for n, test in sonoda1993.tests().items()}
    for number, entry in known.items():
        assert (
            entry[names.PEAK_TRANSMITTED].experiment.value == sonoda1993.tests()[number].peak_force
        )
    by_modulus = sorted(known, key=lambda n: sonoda1993.tests()[n].modulus)
    peaks = [known[n][names.PEAK_TRANSMITTED].paper.value for n in by_modulus]
    depths = [known[n][names.PENETRATION].paper.value for n in by_modulus]
    assert peaks == sorted(peaks)
    assert depths == sorted(depths, reverse=True)
    between = known[4][names.PEAK_TRANSMITTED].paper  # E_bar = 30.4 lies between 20 and 40
    assert 351.2 < between.value / KGF < 449.5
    assert "interpolated" in between.note
    assert "extrapolated" in known[10][names.PEAK_TRANSMITTED].paper.note


def test_every_test_of_the_paper_is_a_case_and_finds_its_references_again():
    assert len(cases()) == 26
    assert next(iter(cases())) == "lab-impact"
    found = references(case("lab-impact-10"), {})
    measured = found.known[names.PEAK_TRANSMITTED].experiment
    assert measured.value == pytest.approx(673.2 * KGF)
    assert References.from_data(json.loads(json.dumps(found.as_data()))) == replace(
        found, remarks=()
    )
    assert References.from_data({}).known == {}


def of_lab_impact(changed, **sizes):
    """What a run of lab-impact with other values and sizes of the sand has other than the case."""
    chosen = case("lab-impact")
    own = own_sizes(chosen, {})
    built = {**own, "sand": {**own["sand"], **sizes}}
    base = chosen.make(chosen.models, built, "paper")
    return differences(chosen, base, changed, built, own)


def references_of(differing):
    return references(case("lab-impact"), differing)


@pytest.mark.parametrize(
    "changed",
    [
        {
            "beam.internal_step": 5e-7,
            "sand.rotation": "free",
            "sand.stiffness_factor": 1.0,
            "sand.friction_angle": 0.6,
            "sand.packing": "random",
            "exchange_step": 2e-5,
            "stop_time": 0.02,
        },
        {
            "rock.mass": 4,
            "rock_radius": 0.0495,
            "sand.base": "beam_surface",
            "rock.position0.y": 0.15,
            "sand.damping": 0.2,
        },
    ],
)
def test_other_steps_and_models_and_the_tests_own_values_leave_the_comparison(changed):
    assert references_of(of_lab_impact(changed, discs=370)) == case("lab-impact").references({})


@pytest.mark.parametrize(
    ("changed", "sizes", "named"),
    [
        ({"rock.mass": 8}, {}, "rock.mass differs"),
        ({"rock_mass": 8}, {}, "rock_mass differs"),
        ({}, {"discs": 740}, "sand.discs differs"),
        ({"sand.base": "floor", "sand.modulus": 1e6}, {}, "sand.base differs"),
        ({"rock.radius": 0.06, "sand.box.width": 0.4}, {}, "rock.radius, sand.box.width differ"),
        ({"beam.gravity": 9.81}, {}, "beam.gravity differs"),
    ],
)
def test_another_system_is_not_compared_and_the_reason_is_named(changed, sizes, named):
    found = references_of(of_lab_impact(changed, **sizes))
    assert found.known == {}
    assert found.remarks == [f"not compared: {named} from the test"]


def test_another_sand_is_compared_with_table_5_only():
    found = references_of(of_lab_impact({"sand.modulus": 40 * KGF / 1e-4, "sand.damping": 0.3}))
    assert found.known[names.PEAK_TRANSMITTED] == Known(Reference(pytest.approx(456.5 * KGF)))
    assert found.known[names.PENETRATION].paper.value == pytest.approx(0.0634)
    assert "experiment: sand.modulus, sand.damping differ" in found.remarks[0]
    none = references_of(of_lab_impact({"sand.damping": 0.25}))
    assert none.known == {}
    assert "0.1, 0.2, 0.3, not 0.25" in none.remarks[1]


def test_changed_values_and_sizes_are_named():
    differing = of_lab_impact({"rock.mass": 8, "rock.radius": 0.0495}, discs=740)
    assert differing == {"rock.mass": 8, "sand.discs": 740}
    assert of_lab_impact({"stop_time": 0.1}) == {"stop_time": 0.1}
    run = made_up()
    run.provenance.update(differences=differing, coupling="paper")
    assert "changed: rock.mass = 8, sand.discs = 740" in comparison.caption(run)


@pytest.mark.parametrize("asked", ["rock.mass", "sand.rock.mass", "rock_mass"])
def test_a_value_that_several_take_is_named_once_as_it_was_given(asked):
    facts = prepare(Request("girders-10", {asked: 2500.0}, in_process=True)).facts
    assert facts["differences"] == {asked: 2500.0}
    both = {asked: 2500.0, "sand.rock.mass": 2500.0}
    facts = prepare(Request("girders-10", both, in_process=True)).facts
    assert facts["differences"] == {asked: 2500.0}


def test_a_size_that_several_share_is_named_once_as_it_was_given():
    facts = prepare(Request("girders-10", sizes={"beam.elements": 24}, in_process=True)).facts
    assert facts["differences"] == {"beam.elements": 24}
    assert facts["references"]["remarks"] == ["not compared: beam.elements differs from the test"]


def test_a_load_cell_under_a_box_does_not_see_what_accelerates_the_box():
    """A quarter of what varies in the force moves the box: the peak over the level at rest is less by it."""
    run = made_up()
    force = run.series["sand.transmitted_force"]
    boxed = made_up(**{"beam.box.inertia_force": 0.25 * (force - force[0])})
    peaks = []
    for seen in (run, boxed):
        seen.provenance["load_cell"] = 1000.0
        peaks.append(figure(seen, names.PEAK_LOAD_CELL))
        assert figure(seen, names.PEAK_TRANSMITTED) == pytest.approx(2050.0, rel=1e-3)
    assert peaks == pytest.approx([2050.0, 1550.0], rel=5e-3)
