"""A project with a slope: its form, its faults, and the rock that its campaign gives."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import rockshed
from rockshed.campaigns.chosen_rock import Choice, chosen_place
from rockshed.campaigns.replay import replay
from rockshed.campaigns.roof import CushionOnProfile, receiver_of
from rockshed.cases.shed import prepared
from rockshed.components.common.units import standard_gravity
from rockshed.components.slope_rockfall.records import ARRIVAL
from rockshed.core.errors import InputRefused
from rockshed.metrics.percentiles import percentile
from rockshed.sites.rockfall.profile import Node
from rockshed.sites.rockfall.start_check import distance
from tests.slopes_and_sheds import PROJECT, SITE, with_slope, written


def refusals(file, changes=None):
    with pytest.raises(InputRefused) as refused:
        prepared(file, changes)
    return [str(problem) for problem in refused.value.problems]


@pytest.fixture(scope="module")
def shed(tmp_path_factory):
    """The project as it is."""
    return prepared(written(tmp_path_factory.mktemp("gully")))


# ---------------------------------------------------------------- faults


def test_a_project_has_a_rock_or_a_slope(tmp_path):
    (text,) = refusals(written(tmp_path, project={"slope": None}))
    assert "rock: is missing, or slope" in text


def test_what_the_rock_table_says_beside_a_slope_is_told_key_by_key(tmp_path):
    rock = {"mass": "2 t", "drop_height": "20 m", "place": 3.0}
    told = refusals(written(tmp_path, project={"rock": rock}))
    for key in rock:
        assert any(f"rock.{key}: the rock comes from the slope" in text for text in told)
    assert all("line" in text for text in told)


def test_all_faults_are_told_before_a_campaign_is_carried_out(tmp_path, monkeypatch):
    monkeypatch.setattr("rockshed.cases.below_slope.arrivals_of", None)
    site = {"rock": {"radius": -0.4, "density": 2600.0}}
    keys = with_slope(percentile=95.0, trial=3)
    roof = {"roof": {**PROJECT["roof"], "section": "H-1x1"}, "numerics": {"clearance": 0.2}}
    told = "\n".join(refusals(written(tmp_path, site, {**keys, **roof})))
    for text in ("rock.radius", "slope.percentile: a trial is chosen already", "H-1x1"):
        assert text in told
    assert "numerics.clearance: a rock from a slope starts where the campaign has it" in told


@pytest.mark.parametrize(
    ("keys", "text"),
    [
        ({"file": "none.toml"}, "slope.file: there is no file"),
        ({"x": 153.0}, "trials are computed from 100 to 160 m"),
        ({"y": 8.0}, "the profile stands 3.1 m out of the cushion"),
        ({"y": 60.0}, "no rock strikes the cushion: of 300 rocks 300 do not come to the roof"),
        ({"percentile": 99.9}, "do not bear 99.9 %"),
        ({"percentile": 100.0}, "must be less than 100"),
        ({"trial": 300}, "the campaign has 300 trials"),
        ({"quantity": "momentum"}, "slope.quantity"),
    ],
)
def test_faults_of_a_slope_name_their_key(tmp_path, keys, text):
    (told,) = refusals(written(tmp_path, project=with_slope(**keys)))
    assert text in told


def test_a_trial_that_does_not_strike_the_cushion_is_refused_with_some_that_do(shed, tmp_path):
    strikes = shed.slope.origin.strikes
    missing = next(n for n in range(300) if n not in strikes.number)
    (told,) = refusals(written(tmp_path, project=with_slope(trial=missing)))
    assert f"the rock of trial {missing}" in told
    assert str(strikes.number[0]) in told


def test_rocks_larger_than_the_cushion_and_another_gravity_are_refused(tmp_path):
    site = {"rock": {"radius": 1.2, "density": 2600.0}, "model": {"gravity": 9.0}}
    project = {"cushion": {"thickness": "0.9 m", "width": "2 m"}}
    told = "\n".join(refusals(written(tmp_path, site, project)))
    assert "the largest rock of the campaign, 2.4 m, does not fit" in told
    assert "model.gravity: 9 m/s2, and a shed has" in told


def test_parameters_that_follow_from_the_slope_cannot_be_set_apart(tmp_path):
    file = written(tmp_path)
    for name in ("rock.trial", "rock.seed", "rock_mass", "sand.box.wall_height"):
        with pytest.raises(InputRefused, match=r"follows from the project's"):
            rockshed.shed(file, values={name: 1.0}, in_process=True)


# ---------------------------------------------------------------- the rock


def test_a_rock_that_falls_straight_onto_the_roof_has_the_energy_of_its_fall(tmp_path):
    """From 30 m above the cushion, without a slope on its way: v^2 = 2 g h."""
    site = {
        "trials": 90,
        "start": {"x": 131.5, "y": 42.3, "velocity": [0.0, 0.0], "angular_velocity": 2.0},
    }
    shed = prepared(written(tmp_path, site))
    rock, height = shed.layout.rock, 42.3 - 12.1 - 0.4
    assert rock.speed == pytest.approx(math.sqrt(2.0 * standard_gravity * height), rel=1e-12)
    assert rock.place == pytest.approx(3.5, abs=1e-12)
    assert rock.spin == 2.0
    assert rock.mass == pytest.approx(2600.0 * 4.0 / 3.0 * math.pi * 0.4**3)
    strikes = shed.slope.origin.strikes
    inertia = 0.4 * rock.mass * 0.4**2
    energy = rock.mass * standard_gravity * height + 0.5 * inertia * 2.0**2
    assert strikes.energy == pytest.approx(np.full(90, energy), rel=1e-12)
    fall = (rock.velocity_y + shed.layout.arrival.velocity_y) / standard_gravity
    assert shed.layout.arrival.delay - shed.layout.arrival.lead == pytest.approx(fall, rel=1e-9)


def test_every_rock_is_counted_once(shed):
    strikes = shed.slope.origin.strikes
    others = (strikes.on_ends, strikes.beyond, strikes.below, strikes.elsewhere)
    assert len(strikes.number) + sum(others) == SITE["trials"]
    assert min(others) >= 0 < len(strikes.number)
    clear = shed.slope.origin.cushion
    assert (strikes.x - strikes.radius > clear.left).all()
    assert (strikes.x + strikes.radius < clear.right).all()


@pytest.mark.parametrize("quantity", ["energy", "speed"])
@pytest.mark.parametrize("percent", [50.0, 90.0])
def test_the_rock_of_a_percentile_is_one_of_the_campaign_within_its_interval(
    shed, quantity, percent
):
    strikes = shed.slope.origin.strikes
    values = np.sort(getattr(strikes, quantity))
    found = percentile(values, percent / 100.0)
    value = getattr(strikes, quantity)[chosen_place(strikes, Choice(quantity, percent))]
    assert value == found.value
    assert found.low <= value <= found.high


def test_the_rock_is_where_a_replay_of_its_trial_has_it(shed):
    origin = shed.slope.origin
    row = origin.arrived[origin.trial]
    again = replay(origin.slope, origin.campaign, origin.trial, 1e-3)
    for name, column in (("x", ARRIVAL.x), ("y", ARRIVAL.y), ("energy", ARRIVAL.kinetic)):
        curve = np.interp(row[ARRIVAL.time], again.time, getattr(again, name))
        assert curve == pytest.approx(row[column], rel=1e-4)


def test_a_barrier_keeps_rocks_from_the_roof(shed, tmp_path):
    fence = {"name": "fence", "x": 127.0, "height": 3.0, "capacity": 1e9, "free_border": 0.0}
    kept = prepared(written(tmp_path, {"barrier": [fence], "trials": 3000})).slope.origin.strikes
    share = len(shed.slope.origin.strikes.number) / SITE["trials"]
    assert 0 < len(kept.number) < 0.9 * share * 3000


def test_a_block_strikes_as_the_sphere_of_the_radius_of_its_campaign(tmp_path):
    spread = {"distribution": "uniform", "from": "1 t", "to": "2 t"}
    body = {"shape": "ellipse", "elongation": 1.5, "density": 2600.0, "mass": spread}
    shed = prepared(written(tmp_path, {"rock": body}))
    rock, origin = shed.layout.rock, shed.slope.origin
    drawn = origin.campaign.rocks.sample(origin.trial, 1)[0]
    assert (rock.mass, rock.radius) == (drawn[0], drawn[1])
    assert rock.density == pytest.approx(2600.0)
    assert 1000.0 <= rock.mass <= 2000.0


def test_trials_and_seed_of_the_project_go_before_those_of_the_slope(tmp_path):
    changes = {"slope.trials": 200, "slope.seed": 9, "slope.percentile": 50.0}
    origin = prepared(written(tmp_path), changes).slope.origin
    assert (origin.campaign.trials, origin.campaign.seed) == (200, 9)


# ---------------------------------------------------------------- the box


@settings(max_examples=60)
@given(
    steepness=st.floats(0.0, 20.0),
    berm=st.floats(0.0, 3.0),
    drop=st.floats(0.1, 12.0),
    radius=st.floats(0.1, 1.5),
)
def test_no_rock_on_the_cushion_is_in_the_ground_at_the_sides_of_the_box(
    steepness, berm, drop, radius
):
    """Whatever the ground beside the roof is like, a rock that leaves the box is out of it."""
    nodes = [
        Node(x, y, "soil", "")
        for x, y in (
            (-berm - 21.0, 0.9 + 20.0 * steepness + 1.0),
            (-berm - 1e-3, 0.9),
            (10.5 - 1e-3, 0.9),
            (10.5, 0.9 - drop),
            (40.0, 0.9 - drop),
        )
    ]
    cushion = CushionOnProfile(0.0, 10.0, 0.0, 0.9)
    box = receiver_of(cushion, nodes, radius)
    sides = np.array([box.left, box.right])
    free = distance(nodes, sides, np.full(2, 0.9 + radius))
    assert free.min() >= radius - 1e-5
    assert box.left < radius + 1.0
    assert box.right > 10.0
    assert box.bottom < 0.0 < 0.9 + radius < box.top
