"""Rocks, starts and profiles as they are: distributions, measured boulders, zones, faces and overhangs."""

import numpy as np
import pytest

import rockshed
from rockshed.analyses.saved import saved_result
from rockshed.components.slope_rockfall.records import OUTCOME, ROCK
from rockshed.core.errors import InputRefused
from rockshed.input_files.chance import RandomQuantity
from rockshed.input_files.spreads import bounds, values_of
from rockshed.sites.rockfall.preparation import prepare

POINTS = [[0, 40, "rock"], [10, 30, "soil"], [30, 12], [80, 10]]


def site(**parts):
    content = {
        "rock": {"radius": 0.4, "density": 2600.0},
        "start": {"x": 1.0},
        "limit_speed": {"mean": 12.0, "deviation": 2.0},
        "profile": {"points": POINTS},
        "ground": [{"material": "soil", "from": 10.0}],
    }
    return {**content, **parts}


def refusal(**parts):
    with pytest.raises(InputRefused) as refused:
        prepare(site(**parts), trials=500)
    return "\n".join(f"{p.where}: {p.what}; {p.remedy}" for p in refused.value.problems)


DISTRIBUTIONS = {
    "normal": ({"mean": 0.5, "deviation": 0.1}, 0.5, 0.0987),
    "lognormal": ({"mean": 0.5, "deviation": 0.1}, 0.5, 0.097),
    "uniform": ({"from": 0.2, "to": 0.8}, 0.5, 0.6 / 12**0.5),
    "triangular": ({"from": 0.2, "mode": 0.3, "to": 0.8}, 1.3 / 3, 0.1312),
}


@pytest.mark.parametrize("kind", DISTRIBUTIONS)
def test_the_rocks_of_many_trials_have_mean_and_deviation_of_the_distribution(kind):
    values, mean, deviation = DISTRIBUTIONS[kind]
    rocks = prepare(site(rock={"radius": {"distribution": kind, **values}, "mass": 500.0})).rocks
    radius = rocks.sample(0, 40_000)[:, ROCK.radius]
    assert radius.mean() == pytest.approx(mean, rel=0.01)
    assert radius.std() == pytest.approx(deviation, rel=0.02)
    low, high = bounds(RandomQuantity(distribution=kind, **values))
    assert low <= radius.min() <= radius.max() <= high


def test_ends_cut_a_normal_distribution_off():
    spread = RandomQuantity(
        distribution="normal", mean=0.0, deviation=1.0, **{"from": 0.5, "to": 1.0}
    )
    values = values_of(spread, np.linspace(0.0, 1.0, 11))
    assert values[0] == pytest.approx(0.5)
    assert values[-1] == pytest.approx(1.0)
    assert np.all(np.diff(values) > 0.0)


def test_a_rock_of_mass_and_density_has_the_radius_of_the_sphere():
    rock = {
        "mass": {"distribution": "uniform", "from": 100.0, "to": "0.9 t"},
        "density": "2.5 t/m3",
    }
    rocks = prepare(site(rock=rock)).rocks.sample(0, 100)
    volume = 4.0 / 3.0 * np.pi * rocks[:, ROCK.radius] ** 3
    np.testing.assert_allclose(rocks[:, ROCK.mass], 2500.0 * volume, rtol=1e-12)


def test_a_trial_has_its_rock_whatever_trials_are_computed_with_it():
    rocks = prepare(
        site(
            start={
                "along": [1.0, 8.0],
                "velocity": [{"distribution": "uniform", "from": 0, "to": 2}, 0.0],
            }
        )
    ).rocks
    np.testing.assert_array_equal(rocks.sample(0, 50)[30:], rocks.sample(30, 20))


def test_a_hypercube_gives_each_rock_a_stratum_of_its_own():
    spread = {"distribution": "uniform", "from": 1.0, "to": 2.0}
    rocks = prepare(site(rock={"radius": spread, "density": 2600.0}, hypercube=20)).rocks
    strata = np.floor(20 * (rocks.sample(20, 20)[:, ROCK.radius] - 1.0))
    assert sorted(strata) == list(range(20))


def test_rocks_start_along_the_slope_as_long_as_it_is():
    """Half of 10 m at 45 degrees and half of the same length on a face of 14 m."""
    points = [[0, 40, "rock"], [10, 30, "rock"], [10, 30 - 200**0.5, "soil"], [80, 10]]
    rocks = prepare(site(profile={"points": points}, start={"along": [0.0, 11.0]})).rocks
    x = rocks.sample(0, 4000)[:, ROCK.x]
    assert np.mean(x < 9.999) == pytest.approx(np.mean((x > 9.999) & (x < 10.1)), abs=0.05)


def test_rocks_start_on_a_line_in_the_air():
    slope = prepare(site(start={"line": [[2.0, 45.0], [6.0, 43.0]]}))
    rocks = slope.rocks.sample(0, 500)
    np.testing.assert_allclose(rocks[:, ROCK.y], 46.0 - 0.5 * rocks[:, ROCK.x])
    assert np.ptp(rocks[:, ROCK.x]) > 3.9
    assert not slope.instance["on_slope"]


CSV = "mass (t),length1 (cm),length2 (cm),length3 (cm)\n0.5,100,80,50\n1.2,90,120,100\n"


def test_measured_boulders_come_from_a_file_with_units(tmp_path):
    (tmp_path / "boulders.csv").write_text(CSV)
    file = str(tmp_path / "boulders.csv")
    ellipse = prepare(site(rock={"file": file, "shape": "ellipse"})).rocks.sample(0, 200)
    assert set(ellipse[:, ROCK.mass]) == {500.0, 1200.0}
    light = ellipse[ellipse[:, ROCK.mass] == 500.0][0]
    assert light[ROCK.radius] == pytest.approx(0.5 * 0.8**0.5)
    assert light[ROCK.elongation] == pytest.approx(1.25)
    sphere = prepare(site(rock={"file": file})).rocks.sample(0, 200)
    assert sphere[:, ROCK.elongation].max() == 1.0
    assert sphere[:, ROCK.radius].min() == pytest.approx(0.5 * 0.4 ** (1 / 3))


def test_a_campaign_of_blocks_has_the_same_bits_on_any_threads_and_after_reading(tmp_path):
    (tmp_path / "boulders.csv").write_text(CSV)
    rocks = {"file": str(tmp_path / "boulders.csv"), "shape": "ellipse"}
    blocks = site(rock=rocks, start={"along": [1.0, 8.0]}, line=[{"name": "road", "x": 40.0}])
    one = rockshed.rockfall(blocks, trials=1200, workers=1, folder=tmp_path / "out", pictures=False)
    two = rockshed.rockfall(blocks, trials=1200, workers=2)
    np.testing.assert_array_equal(one.records.outcomes, two.records.outcomes)
    np.testing.assert_array_equal(one.records.passages, two.records.passages)
    stored = saved_result(tmp_path / "out")
    np.testing.assert_array_equal(stored.rocks, one.rocks)
    np.testing.assert_array_equal(stored.replay(7).x, one.replay(7).x)
    path = one.replay(1100)
    assert path.x[-1] == pytest.approx(one.records.outcomes[1100, OUTCOME.x], abs=1e-9)


@pytest.mark.parametrize(
    ("parts", "words"),
    [
        (
            {
                "rock": {
                    "radius": {"distribution": "normal", "mean": 0.3, "deviation": 0.2},
                    "density": 2600.0,
                }
            },
            "the distribution reaches -0.3, and no rock has such a radius; cut it off with from, or take a lognormal one",
        ),
        (
            {"rock": {"radius": {"distribution": "uniform", "from": 0.3}, "density": 2600.0}},
            "a uniform distribution has no to; give from, to",
        ),
        (
            {
                "rock": {
                    "radius": {"distribution": "uniform", "from": 0.3, "to": 0.2},
                    "density": 2600.0,
                }
            },
            "from = 0.3 is not below to = 0.2",
        ),
        (
            {
                "rock": {
                    "radius": {"distribution": "uniform", "from": 0.3, "to": 0.4, "mean": 0.3},
                    "density": 2600.0,
                }
            },
            "a uniform distribution has no mean; leave it out",
        ),
        (
            {
                "rock": {
                    "radius": {"distribution": "lognormal", "mean": 0.3, "deviation": 0.0},
                    "density": 2600.0,
                }
            },
            "rock.radius.deviation: must be greater than 0",
        ),
        (
            {
                "rock": {
                    "radius": {
                        "distribution": "normal",
                        "mean": 0.3,
                        "deviation": 0.01,
                        "from": 0.5,
                        "to": 0.6,
                    },
                    "density": 2600.0,
                }
            },
            "from and to leave nothing of the distribution",
        ),
        (
            {"rock": {"radius": {"distribution": "beta", "mean": 0.3}, "density": 2600.0}},
            "rock.radius.distribution: must be one of",
        ),
        ({"rock": {"radius": "30 kg", "density": 2600.0}}, "rock.radius: must be a length"),
        (
            {
                "rock": {
                    "radius": {"distribution": "uniform", "from": "30 kg", "to": 1.0},
                    "density": 2600.0,
                }
            },
            "rock.radius.from: must be a length",
        ),
        (
            {"rock": {"density": 2600.0}},
            "rock.radius: is missing; give two of radius, mass and density, or a file of boulders",
        ),
        (
            {"rock": {"radius": 0.4, "density": 2600.0, "elongation": 2.0}},
            "an elongation has no meaning for a sphere",
        ),
        (
            {"rock": {"radius": 0.4, "density": 2600.0, "shape": "ellipse", "elongation": 0.5}},
            "elongation = 0.5: allowed is 1 to 10",
        ),
        ({"rock": {"radius": 0.4, "file": "none.csv"}}, "there is no file none.csv"),
        (
            {"start": {"x": 1.0, "along": [1.0, 2.0]}},
            "x and along exclude each other; give x (and y), or line, or along",
        ),
        ({"start": {}}, "start.x: is missing"),
        (
            {"start": {"x": {"distribution": "uniform", "from": 50.0, "to": 90.0}}},
            "x = 90 m is beside the profile; give an x from 0 to 80 m",
        ),
        (
            {"start": {"x": 1.0, "y": {"distribution": "uniform", "from": 38.0, "to": 48.0}}},
            "rocks would start inside the slope",
        ),
        (
            {"material": {"soil": {"like": "soil", "strength": 1e6, "normal_restitution": 0.3}}},
            "strength belong to DRSP, normal_restitution to another law of impact; give the values of one law",
        ),
        (
            {"material": {"soil": {"like": "soil", "normal_restitution": 0.3}}},
            "material soil has no tangential_restitution",
        ),
        (
            {"material": {"soil": {"like": "talus", "normal_restitution": 1.3}}},
            "normal_restitution = 1.3",
        ),
    ],
)
def test_what_no_rock_or_start_can_be_is_refused(parts, words):
    assert words in refusal(**parts)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("mass,length1\n1,1\n", "has no column length2, length3"),
        ("mass (kg),radius (m)\n-3,0.4\n", "boulders.csv, line 2: boulder 1 has no mass above 0"),
        ("mass,radius,elongation\n3,1,2\n3,1,11\n", "line 3: boulder 2 has the elongation 11; 1"),
        ("mass (kg),radius (m)\n3,\n", "boulder 1 has no radius above 0"),
        ("mass (kg),radius (m)\n3,big\n", "line 2, column 3: 'big' is no finite number"),
        ("mass (m),radius (m)\n3,1\n", "'mass (m)': must be a mass"),
        ("", "is empty"),
    ],
)
def test_a_file_of_boulders_is_refused_with_its_line(tmp_path, text, words):
    (tmp_path / "boulders.csv").write_text(text)
    assert words in refusal(rock={"file": str(tmp_path / "boulders.csv")})


# --- faces and overhangs ---


def nodes(points):
    return prepare(site(profile={"points": points}, ground=[{"material": "soil"}]))


def test_a_vertical_face_becomes_as_steep_as_can_be_computed():
    made = nodes([[0, 40], [10, 30], [10, 20], [80, 10]])
    assert made.nodes[2].x == pytest.approx(10.0, abs=0.02)
    assert made.nodes[2].y == 20.0
    assert made.notes == ()


def test_an_overhang_is_a_vertical_face_at_its_lip():
    made = nodes([[0, 40], [10, 30], [9, 20], [20, 9], [80, 8]])
    assert [(node.x, node.y) for node in made.nodes[1:3]] == [
        (10, 30),
        pytest.approx((10.0, 19.0), abs=0.02),
    ]
    (note,) = made.notes
    assert "overhang of 1 m at x = 10 m" in note


def test_an_overhang_that_rises_hides_the_ground_below_it():
    made = nodes([[0, 20], [10, 10], [20, 10], [19, 16], [40, 17]])
    assert [(node.x, node.y) for node in made.nodes[2:4]] == [
        pytest.approx((19.0, 10.0)),
        pytest.approx((19.0, 16.0), abs=0.02),
    ]


def test_a_profile_ends_beyond_its_overhang():
    with pytest.raises(InputRefused, match="ends below the overhang"):
        nodes([[0, 40], [10, 30], [9, 20]])
