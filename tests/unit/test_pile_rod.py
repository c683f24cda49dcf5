"""Rod and hammer as components: refusals, limits of the ports, state."""

import math

import numpy as np
import pytest

from rockshed.components.common.component import ComponentError

from ..rods import HAMMER, ROD, march, named, rod

BAD = [
    ({"section__area": 0.0}, r"section\.area\[1\] = 0 m2: allowed is 1e-12 m2 or more"),
    ({"section__area": -5e-4}, r"section\.area\[1\] = -0\.0005 m2"),
    ({"section__modulus": 0.0}, r"section\.modulus\[1\] = 0 Pa"),
    ({"section__density": -1.0}, r"section\.density\[1\] = -1 kg/m3"),
    ({"section__length": 0.0}, r"section\.length\[1\] = 0 m"),
    ({"section__modulus": math.nan}, r"section\.modulus\[1\] = nan: must be a finite number"),
    ({"toe__quake": 0.0}, r"toe\.quake = 0 m: allowed is 1e-09 m or more"),
    ({"shaft__quake": 0.0}, r"shaft\.quake\[1\] = 0 m.*shaft\.quake\[2\] = 0 m"),
    ({"toe__resistance": -1.0}, r"toe\.resistance = -1 N: allowed is 0 N or more"),
    ({"shaft__resistance": -1.0}, r"shaft\.resistance\[1\] = -1 N"),
    ({"toe__damping": -0.1}, r"toe\.damping = -0\.1 s/m"),
    ({"toe__reflection": 1.5}, r"toe\.reflection = 1\.5: allowed is -1 to 1"),
    ({"head__force": math.inf}, r"head\.force = inf"),
    ({"ram__mass": -1.0}, r"ram\.mass = -1 kg"),
    ({"gauge__depth": 10.1}, r"gauge\.depth = 10\.1 m is below the toe"),
    (
        {"head__port": "waves", "scheme": "smith"},
        "a port of waves needs the scheme characteristics",
    ),
    (
        {"toe__condition": "port", "toe__port": "waves", "scheme": "repaired"},
        "a port of waves needs the scheme characteristics",
    ),
    ({"head__port": "waves", "ram__mass": 5.0}, r"ram\.mass = 5 kg takes the place"),
]


@pytest.mark.parametrize(("parameters", "message"), BAD)
def test_bad_input_is_refused(parameters, message):
    made = named(ROD.instance(segments=2), parameters)
    with pytest.raises(ComponentError, match=message):
        made.initialise()


def test_all_that_is_wrong_is_said_at_once():
    made = named(
        ROD.instance(segments=1),
        {"toe__quake": 0.0, "toe__resistance": -1.0, "section__area": -1.0},
    )
    with pytest.raises(ComponentError) as refusal:
        made.initialise()
    assert len(refusal.value.problems) == 3


def test_fewer_than_one_segment_is_refused():
    with pytest.raises(ComponentError, match="segments = 0: allowed is 1 to"):
        ROD.instance(segments=0)


@pytest.mark.parametrize(
    ("partner", "limit"),
    [({"head__partner__stiffness": 1e8}, "Z/k"), ({"head__partner__mass": 1.0}, "M/Z")],
)
def test_a_plain_port_refuses_steps_above_its_limit(partner, limit):
    made = rod(10, **partner)
    impedance = 5.8e-4 * 7850 * 5120
    expected = {"Z/k": impedance / 1e8, "M/Z": 1.0 / impedance}[limit]
    assert made["step_limit"] == made["head.step_limit"] == pytest.approx(expected, rel=1e-12)
    made.step(0.0, expected)
    with pytest.raises(
        ComponentError, match=f"exceeds the limit of the ports, step_limit = {expected:.6g} s"
    ):
        made.step(expected, 1.001 * expected)


def test_a_plain_port_below_the_toe_has_its_own_limit():
    made = rod(10, toe__condition="port", toe__partner__stiffness=1e9)
    assert (
        made["toe.step_limit"] == made["step_limit"] == pytest.approx(made["toe.impedance"] / 1e9)
    )


@pytest.mark.parametrize(("exchange", "share"), [("sequential", 1.0), ("parallel", 0.5)])
def test_a_wave_port_bears_steps_up_to_the_travel_time(exchange, share):
    made = rod(10, head__port="waves", exchange=exchange)
    assert made["step_limit"] == pytest.approx(share * made["travel_time"], rel=1e-12)
    for n in range(3):
        made.step(n * made["step_limit"], made["step_limit"])
    with pytest.raises(ComponentError, match="exceeds the limit"):
        made.step(1.0, 1.01 * made["step_limit"])
    other = rod(10, head__port="waves", exchange=exchange)
    step = 0.99 * other["step_limit"]
    if exchange == "parallel":
        other.step(0.0, step)
    with pytest.raises(
        ComponentError, match=r"the waves of a next step of .* s are not known yet, step_limit"
    ):
        other.step(step, step)


def test_the_nearest_reflection_limits_a_wave_port():
    made = named(
        ROD.instance(segments=20),
        {
            "head__port": "waves",
            "exchange": "sequential",
            "toe__condition": "port",
            "toe__port": "waves",
        },
    )
    made["shaft.resistance[8]"] = 1e3
    made.initialise()
    assert made["head.step_limit"] == pytest.approx(8 * made["time_step"])
    assert made["toe.step_limit"] == pytest.approx(12 * made["time_step"])


def test_where_stiffnesses_differ_the_port_of_a_section_ends():
    made = rod(
        20,
        sections=2,
        section__area=[1e-3, 2e-3],
        section__length=[2.5, 7.5],
        head__port="waves",
        exchange="sequential",
    )
    assert made["head.step_limit"] == pytest.approx(5 * made["time_step"])


def test_the_port_may_count_upwards():
    """As the supports of a beam: a negative force presses the head down, which then goes down."""
    down = rod(10)
    up = rod(10, head__direction="up")
    march(down, 25, "force", force=lambda n: 1e3)
    march(up, 25, "force", force=lambda n: -1e3)
    np.testing.assert_array_equal(down["force"], up["force"])
    assert up["head.position"] == -down["head.position"] < 0.0
    assert up["head.velocity"] == -down["head.velocity"]


def test_a_preload_is_left_out():
    made = rod(10, head__preload=2e4)
    march(made, 30, "force", force=lambda n: 2e4)
    assert not made["force"].any()
    assert made["head.position"] == 0.0


def test_steps_of_any_length_give_the_same_motion():
    """A step that is no multiple of the rod's own waits for the rest."""
    one, other = rod(20, ram__mass=63.5), rod(20, ram__mass=63.5)
    step = one["time_step"]
    for n in range(30):
        one.step(n * step, step)
    for n in range(30 * 7 // 3):
        other.step(n * step * 3 / 7, step * 3 / 7)
    np.testing.assert_allclose(other["force"], one["force"], rtol=1e-12)
    assert other["delay"] == 0.0


def test_a_state_that_is_restored_goes_on_the_same_way():
    one = rod(20, ram__mass=63.5, shaft__resistance=500.0)
    march(one, 55, "force")
    other = ROD.instance(segments=20)
    other.from_bytes(one.to_bytes())
    for made in (one, other):
        march(made, 50, "force")
    assert other.to_bytes() == one.to_bytes()


def test_a_force_that_is_no_number_stops_the_rod():
    made = rod(5)
    made["head.force"] = math.nan
    with pytest.raises(ComponentError, match="no longer a finite number"):
        made.step(0.0, made["time_step"])


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"mass": 0.0}, r"mass = 0 kg"),
        ({"efficiency": 1.2}, r"efficiency = 1\.2: allowed is 0 to 1"),
        ({"cushion__stiffness": -1.0}, r"cushion\.stiffness = -1 N/m"),
        ({"cushion__restitution": 0.0}, r"cushion\.restitution = 0"),
        ({"drop_height": math.nan}, r"drop_height = nan"),
        ({"head__impedance": -1.0}, r"head\.impedance = -1"),
        (
            {"port": "kinematics"},
            r"a rigid ram \(cushion\.stiffness = 0\) finds its force from the wave",
        ),
    ],
)
def test_a_hammer_refuses_bad_input(parameters, message):
    made = named(HAMMER.instance(), parameters)
    with pytest.raises(ComponentError, match=message):
        made.initialise()


def test_a_hammer_needs_an_impedance():
    made = named(HAMMER.instance(), {"head__impedance": 0.0})
    made.initialise()
    with pytest.raises(ComponentError, match=r"head\.impedance = 0 N s/m"):
        made.step(0.0, 1e-5)
