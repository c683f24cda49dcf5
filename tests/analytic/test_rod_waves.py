"""The exact scheme: travelling pulses, interfaces, ends, and a struck rod against St. Venant's closed form."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rockshed.components.common.component import ComponentError

from ..rods import closed_form, march, reflecting, rod

pulses = st.lists(st.floats(-1e5, 1e5, allow_subnormal=False), min_size=1, max_size=30)


@settings(max_examples=30)
@given(pulses)
def test_an_arbitrary_pulse_travels_without_change_and_a_matched_toe_takes_it_all(pulse):
    made = rod(40, toe__condition="matched")
    force, velocity = march(
        made,
        40 + len(pulse),
        "force",
        "velocity",
        force=lambda n: pulse[n] if n < len(pulse) else 0.0,
    )
    size = max(map(abs, pulse)) or 1.0
    for segment in (0, 17, 39):
        sent = np.zeros(40 + len(pulse))
        sent[segment : segment + len(pulse)] = pulse[: len(sent) - segment]
        np.testing.assert_allclose(force[:, segment], sent, atol=1e-12 * size, rtol=0)
        np.testing.assert_allclose(
            velocity[:, segment] * made["head.impedance"], sent, atol=1e-12 * size, rtol=0
        )
    assert np.abs(force[-1]).max() <= 1e-10 * size
    assert made["energy.radiated"] == pytest.approx(made["energy.work.head"], rel=1e-12)


@pytest.mark.parametrize(("condition", "returned"), [("free", -1.0), ("fixed", 1.0)])
def test_a_pulse_comes_back_from_a_free_and_a_fixed_toe(condition, returned):
    """In force: with the other sign from the free one."""
    made = rod(20, toe__condition=condition)
    (force,) = march(made, 30, "force", force=lambda n: 1e4 * (n == 0))
    assert force[19, 19] == pytest.approx(1e4, rel=1e-12)
    assert force[29, 10] == pytest.approx(returned * 1e4, rel=1e-12)


@pytest.mark.parametrize("ratio", [0.2, 3.0])
def test_an_interface_divides_a_pulse_by_its_impedances(ratio):
    """Force: transmitted 2 Z2/(Z1 + Z2), reflected (Z2 - Z1)/(Z1 + Z2). Half of the rod, with this ratio of areas."""
    made = rod(
        20,
        sections=2,
        section__area=[1e-3, ratio * 1e-3],
        section__length=[5.0, 5.0],
        toe__condition="matched",
    )
    (force,) = march(made, 15, "force", force=lambda n: 1e4 * (n == 0))
    assert force[14, 14] == pytest.approx(1e4 * 2.0 * ratio / (1.0 + ratio), rel=1e-12)
    assert force[14, 5] == pytest.approx(1e4 * (ratio - 1.0) / (1.0 + ratio), rel=1e-12)


def test_sections_of_other_materials_keep_travel_time_and_mass():
    lengths, moduli, densities, areas = (
        [3.0, 2.0, 5.0],
        [2e11, 3e10, 1e10],
        [7850.0, 2400.0, 700.0],
        [1e-3, 4e-2, 2e-2],
    )
    made = rod(
        37,
        sections=3,
        section__length=lengths,
        section__modulus=moduli,
        section__density=densities,
        section__area=areas,
    )
    times = [length * (rho / e) ** 0.5 for length, e, rho in zip(lengths, moduli, densities)]
    assert made["travel_time"] == pytest.approx(sum(times), rel=1e-14)
    mass = float(np.sum(made.state("impedance"))) * made["time_step"]
    assert mass == pytest.approx(
        sum(rho * a * length for rho, a, length in zip(densities, areas, lengths)), rel=1e-12
    )


@pytest.mark.parametrize("alpha", [-1.0, -0.5, 0.5, 1.0])
def test_the_struck_rod_follows_the_closed_form_with_second_order(alpha):
    errors = []
    for segments in (250, 500, 1000):
        made = rod(segments, **reflecting(alpha))
        exact = closed_form(made)
        steps = int(exact.separation() / made["time_step"] + 1e-9)
        (force,) = march(made, steps, "head.contact_force")
        middle = (np.arange(steps) + 0.5) * made["time_step"]
        errors.append(np.abs(force - exact.force(middle)).max() / exact.first_force)
    assert errors[2] < 1e-4
    assert [errors[0] / errors[1], errors[1] / errors[2]] == pytest.approx([4.0, 4.0], rel=0.02)


@pytest.mark.parametrize("alpha", [-1.0, -0.5, 0.5, 1.0])
def test_separation_and_rebound_of_the_ram(alpha):
    made = rod(1000, **reflecting(alpha))
    exact = closed_form(made)
    march(made, int(exact.separation() / made["time_step"]) + 5, "force")
    assert made["ram.separation"] == pytest.approx(exact.separation(), rel=1e-4)
    assert made["ram.speed"] == pytest.approx(exact.rebound(), abs=1e-4 * exact.speed)


@pytest.mark.parametrize("alpha", [-1.0, -0.5])
@pytest.mark.parametrize("segments", [100, 250, 333, 500, 667, 1001])
def test_the_time_of_separation_is_of_second_order_at_every_number_of_segments(alpha, segments):
    """The wave falls to the force of the ram within a step, at another part of it for each number.

    A step is 0.3 to 0.5 of the time divided by the number of segments: taken at a step's end or
    start, the error would be up to half of that.
    """
    made = rod(segments, **reflecting(alpha))
    exact = closed_form(made).separation()
    march(made, int(exact / made["time_step"]) + 3, "head.position")
    assert made["ram.separation"] == pytest.approx(exact, rel=0.15 / segments**2)


@pytest.mark.parametrize("segments", [50, 333])
def test_a_wave_with_a_sharp_front_separates_ram_and_rod_at_the_front(segments):
    """The toe is free: its tension wave takes the whole force away at once, at 2 L/c."""
    made = rod(segments, **reflecting(1.0))
    march(made, 2 * segments + 3, "head.position")
    assert made["ram.separation"] == pytest.approx(2.0 * made["travel_time"], rel=1e-12)


def test_the_ram_comes_back_to_the_head_and_never_goes_into_it():
    """The toe's rebound throws the ram back upwards, after a first separation in which it still went down."""
    made = rod(100, ram__mass=63.5, toe__resistance=60e3)
    touching, speed, position, head = march(
        made, 1000, "ram.touching", "ram.speed", "ram.position", "head.position"
    )
    parts = np.flatnonzero(np.diff(touching) < 0)
    assert len(parts) == 2
    assert speed[parts[0] + 1] > 0.5
    assert speed[-1] < -1.0
    assert np.all(head - position >= -1e-12)
    assert abs(made["energy.residual"]) < 1e-11 * made["energy.start"]
    assert abs(made["energy.contact"]) < 1e-6 * made["energy.start"]


@settings(max_examples=20)
@given(
    st.floats(0.0, 2e5),
    st.floats(1e-4, 1e-2),
    st.floats(0.0, 1.0),
    st.floats(0.0, 5e3),
    st.floats(0.0, 10.0),
)
def test_energy_is_kept_and_nothing_creates_it(resistance, quake, damping, shaft, gravity):
    made = rod(
        20,
        ram__mass=63.5,
        toe__condition="soil",
        toe__resistance=resistance,
        toe__quake=quake,
        toe__damping=damping,
        shaft__resistance=shaft,
        gravity=gravity,
    )
    losses = march(
        made, 200, "energy.plastic", "energy.damping", "energy.contact", "energy.residual"
    )
    scale = made["energy.start"] + abs(made["energy.work.gravity"])
    assert np.abs(losses.pop()).max() < 1e-11 * scale
    for loss in losses[:2]:
        assert np.diff(loss).min() >= -1e-12 * scale
    assert abs(losses[2][-1]) < 2e-3 * scale


def test_a_load_within_the_quake_settles_where_the_soil_carries_it():
    made = rod(
        10,
        toe__resistance=30e3,
        toe__quake=2.5e-3,
        toe__damping=2.0,
        shaft__resistance=1e3,
        shaft__damping=2.0,
    )
    march(made, 20000, "force", force=lambda n: 12e3)
    rod_spring, soil_spring = (
        made["head.impedance"] / made["time_step"],
        np.array([0.0] + [1e3 / 2.5e-3] * 9 + [31e3 / 2.5e-3]),
    )
    matrix = np.diag(soil_spring + rod_spring * np.array([1.0] + [2.0] * 9 + [1.0]))
    matrix -= rod_spring * (np.eye(11, k=1) + np.eye(11, k=-1))
    place = np.linalg.solve(matrix, np.array([12e3] + [0.0] * 10))
    assert [made["head.position"], made["toe.position"]] == pytest.approx(
        [place[0], place[-1]], rel=1e-3
    )
    assert made["toe.set"] == pytest.approx(0.0, abs=1e-12)
    assert made["toe.contact_force"] + made["shaft.force"].sum() == pytest.approx(12e3, rel=1e-3)


def test_a_blow_leaves_a_set_and_unloads_elastically():
    made = rod(50, ram__mass=63.5, toe__resistance=40e3, toe__damping=0.0)
    place, under, on_toe = march(made, 4000, "toe.position", "toe.set", "toe.contact_force")
    assert under[-1] > 5e-3
    assert np.all(np.diff(under) >= -1e-12)
    assert on_toe.max() == pytest.approx(40e3, rel=1e-12)
    loaded = (place - under > 0.0) & (place - under < 2.5e-3 * (1 - 1e-9))
    middle = 0.5 * (place - under)[1:] + 0.5 * (place - under)[:-1]
    both = loaded[1:] & loaded[:-1]
    np.testing.assert_allclose(on_toe[1:][both], 40e3 / 2.5e-3 * middle[both], atol=1e-3 * 40e3)


def test_the_weight_alone_accelerates_a_free_rod():
    made = rod(30, toe__condition="free", gravity=9.81)
    (velocity,) = march(made, 90, "velocity")
    np.testing.assert_allclose(velocity[-1], 9.81 * 90 * made["time_step"], rtol=1e-9)
    assert made["energy.residual"] == pytest.approx(0.0, abs=1e-12)


def test_the_envelopes_are_the_largest_stresses_of_the_segments():
    made = rod(40, **reflecting(0.7))
    (force,) = march(made, 300, "force")
    np.testing.assert_allclose(
        made["stress.compression"], force.max(axis=0).clip(0) / 5.8e-4, rtol=1e-12
    )
    np.testing.assert_allclose(
        made["stress.tension"], (-force).max(axis=0).clip(0) / 5.8e-4, rtol=1e-12
    )


def test_the_gauge_sees_the_incident_wave_with_force_equal_to_zv():
    made = rod(100, gauge__depth=2.5, **reflecting(-1.0))
    force, zv, stress = march(made, 170, "gauge.force", "gauge.zv", "gauge.stress")
    np.testing.assert_array_equal(force[:25], 0.0)
    assert force[25] > 0.9 * closed_form(made).first_force
    np.testing.assert_allclose(zv, force, rtol=1e-12)
    np.testing.assert_allclose(stress, force / 5.8e-4, rtol=1e-12)
    assert made["energy.transferred"] == pytest.approx(made["energy.head"])


def on_a_spring(steps, port, stiffness=3e7, exchange="sequential"):
    """Displacement of the toe over four travel times, on a spring outside. steps: of the rod from exchange to exchange."""
    made = rod(
        256,
        ram__mass=63.5,
        toe__condition="port",
        toe__port=port,
        toe__partner__stiffness=stiffness,
        exchange=exchange,
    )
    step, known, places = steps * made["time_step"], 0.0, []
    for n in range(1024 // steps):
        if port == "waves":
            # F = c - Z v and F = k (u + v H/2), both means over the step
            wave, impedance = made["toe.wave"], made["toe.impedance"]
            force = (known + 0.5 * step * wave / impedance) / (
                1.0 / stiffness + 0.5 * step / impedance
            )
            known += step * (wave - force) / impedance
            if exchange == "sequential":
                made["toe.force"] = force
            made.step(n * step, step)
            made["toe.force"] = force
        else:
            made["toe.force"] = stiffness * made["toe.position"]
            made.step(n * step, step)
        places.append(made["toe.position"])
    return made, np.array(places)


def test_a_spring_below_a_wave_port_is_the_soil_inside_at_every_step():
    made, outside = on_a_spring(1, "waves")
    inside = rod(256, ram__mass=63.5, toe__quake=1.0, toe__resistance=3e7, toe__damping=0.0)
    (place,) = march(inside, len(outside), "toe.position")
    pressed = place > 0.0
    until = np.flatnonzero(~pressed & (np.arange(len(place)) > 260))
    until = until[0] if until.size else len(place)
    np.testing.assert_allclose(outside[:until], place[:until], rtol=1e-9, atol=1e-15)
    assert made["energy.residual"] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("exchange", ["sequential", "parallel"])
def test_a_wave_port_below_the_toe_converges_with_second_order(exchange):
    _, exact = on_a_spring(1, "waves")
    errors = []
    for steps in (4, 8, 16):
        made, places = on_a_spring(steps, "waves", exchange=exchange)
        late = round(made["delay"] / made["time_step"])
        at = np.arange(1, len(places) + 1) * steps - 1 - late
        errors.append(np.abs(places[at >= 0] - exact[at[at >= 0]]).max() / exact.max())
    assert errors[2] < 0.02
    assert errors[1] / errors[0] > 3.0
    assert errors[2] / errors[1] > 3.0


def test_a_plain_port_below_the_toe_is_of_first_order_and_has_its_limit():
    """Z/k = 0.78 ms is 101 steps of the rod. At a third of it the plain port makes energy; the port of waves never does."""
    _, exact = on_a_spring(1, "waves")
    errors = []
    for steps in (4, 8, 16):
        _, places = on_a_spring(steps, "kinematics")
        errors.append(
            np.abs(places - exact[np.arange(1, len(places) + 1) * steps - 1]).max() / exact.max()
        )
    assert 1.5 < errors[1] / errors[0] < 2.5
    assert 1.5 < errors[2] / errors[1] < 2.5
    assert on_a_spring(32, "kinematics")[0]["energy.work.toe"] > 10.0
    assert on_a_spring(32, "waves")[0]["energy.work.toe"] < 0.0
    with pytest.raises(ComponentError, match="exceeds the limit of the ports"):
        on_a_spring(128, "kinematics")


def test_waves_bear_a_toe_a_thousand_times_stiffer_than_the_plain_port_can():
    """At an exchange of 16 steps (0.12 ms): no energy is made."""
    limit = rod(256)["toe.impedance"] / (16 * 10.0 / 5120.0 / 256)
    made, places = on_a_spring(16, "waves", stiffness=1000.0 * limit)
    fixed = rod(256, ram__mass=63.5, toe__condition="fixed")
    (force,) = march(fixed, 256 * 3, "force")
    assert made["energy.work.toe"] <= 1e-9
    assert np.abs(places).max() < 4.0 * force.max() / (1000.0 * limit)
    assert made["energy.kinetic"] + made["energy.elastic"] + made["energy.ram"] <= made[
        "energy.start"
    ] * (1.0 + 1e-12)
