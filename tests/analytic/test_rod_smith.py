"""Smith's scheme, its modification and its repair: what Uto et al. (about 1974) found of them, in numbers."""

import numpy as np
import pytest

from ..rods import closed_form, march, reflecting, rod


def kappa_of(alpha):
    return (1.0 - alpha) / (1.0 + alpha)


def alpha_of(kappa):
    return (1.0 - kappa) / (1.0 + kappa)


def struck(segments, length, fraction=1, **parameters):
    return rod(
        segments,
        section__length=length,
        fraction=fraction,
        **{"scheme": "smith", "ram__mass": 63.5, **parameters},
    )


def test_inside_the_rod_the_critical_step_is_exact_and_a_fifth_of_it_overshoots_by_26_percent():
    """5 m as in fig. 8, 1,000 segments. The front of the wave, before it reaches the toe."""
    at_critical, at_fifth = struck(1000, 5.0), struck(1000, 5.0, fraction=5)
    front = at_critical["head.impedance"] * at_critical["ram.velocity"]
    (critical,) = march(at_critical, 900, "stress.compression")
    (fifth,) = march(at_fifth, 4500, "stress.compression")
    np.testing.assert_allclose(critical[-1][:900] * 5.8e-4, front, rtol=1e-11)
    assert fifth.max() * 5.8e-4 / front == pytest.approx(1.26, abs=0.01)


def test_ten_segments_and_a_fifth_of_the_step_move_before_the_arrival_and_separate_too_early():
    """Fig. 6: 50 m."""
    made = struck(10, 50.0, fraction=5, toe__condition="free")
    force, toe = march(made, 100, "head.contact_force", "toe.velocity")
    assert np.abs(toe[:49]).max() > 0.3 * made["ram.velocity"]
    first = (np.flatnonzero(force <= 0.0)[0] + 1) * made["time_step"] / made["travel_time"]
    assert first == pytest.approx(1.26, abs=0.03)
    (fine,) = march(struck(1000, 50.0, toe__condition="free"), 2010, "head.contact_force")
    assert np.flatnonzero(fine <= 0.0)[0] == pytest.approx(2000, abs=2)


def test_a_spring_as_stiff_as_the_rod_is_one_more_segment_on_a_fixed_end():
    one = struck(100, 5.0, toe__condition="reflection", toe__reflection=0.0)
    longer = struck(101, 5.05, toe__condition="fixed")
    forces, on_toe = march(one, 400, "force", "toe.contact_force")
    (expected,) = march(longer, 400, "force")
    np.testing.assert_allclose(forces, expected[:, :100], atol=1e-9 * expected.max(), rtol=0)
    np.testing.assert_allclose(on_toe, expected[:, 100], atol=1e-9 * expected.max(), rtol=0)


@pytest.mark.parametrize("kappa", [0.5, 1.0, 2.0, 5.0])
def test_the_first_force_of_the_toe_is_kappa_times_what_arrives(kappa):
    """Five times needs alpha = -2/3."""
    made = struck(10, 50.0, toe__condition="reflection", toe__reflection=alpha_of(kappa))
    (on_toe,) = march(made, 12, "toe.contact_force")
    first = on_toe[np.flatnonzero(np.abs(on_toe) > 1e-6)[0]]
    assert first / closed_form(made).first_force == pytest.approx(kappa, rel=1e-9)


@pytest.mark.parametrize(
    ("kappa", "stable"), [(0.3, True), (1.9, True), (2.0, True), (2.1, False), (5.0, False)]
)
def test_it_diverges_where_kappa_exceeds_two(kappa, stable):
    made = struck(100, 50.0, toe__condition="reflection", toe__reflection=alpha_of(kappa))
    assert (made["stable_step"] >= made["time_step"]) == stable
    (on_toe,) = march(made, 300, "toe.contact_force")
    assert (np.abs(on_toe).max() < 3.0 * closed_form(made).first_force) == stable
    if not stable:
        growth = on_toe[-2] / on_toe[-3]
        assert growth == pytest.approx(1.0 - kappa, rel=1e-3)


def test_alpha_of_minus_a_third_is_the_limit():
    assert kappa_of(-1.0 / 3.0) == pytest.approx(2.0)


@pytest.mark.parametrize(("segments", "excess"), [(10, 0.218), (100, 0.018), (1000, 0.0018)])
def test_the_total_energy_as_printed_exceeds_the_start_by_an_artefact(segments, excess):
    """50 m; fixed toe, until the wave arrives there."""
    made = struck(segments, 50.0, toe__condition="fixed")
    naive, residual = march(made, segments, "energy.naive", "energy.residual")
    assert naive.max() / made["energy.start"] - 1.0 == pytest.approx(excess, rel=0.02)
    assert np.abs(residual).max() < 1e-10 * made["energy.start"]


@pytest.mark.parametrize("scheme", ["smith", "modified_smith", "repaired"])
@pytest.mark.parametrize("fraction", [1, 5])
def test_the_half_step_energy_is_conserved_through_everything(scheme, fraction):
    made = rod(
        20,
        sections=2,
        section__area=[2e-3, 1e-3],
        section__length=[5.0, 5.0],
        fraction=fraction,
        scheme=scheme,
        ram__mass=63.5,
        toe__condition="soil",
        toe__resistance=60e3,
        shaft__resistance=1e3,
        gravity=9.81,
    )
    residual, loss, plastic = march(
        made, 600, "energy.residual", "energy.contact", "energy.plastic"
    )
    assert np.abs(residual).max() < 1e-10 * made["energy.start"]
    assert plastic[-1] > 0.1 * made["energy.start"]
    assert abs(loss[-1]) < 0.03 * made["energy.start"]


@pytest.mark.parametrize("kappa", [1.0 / 3.0, 1.0, 3.0])
def test_the_repaired_interface_is_stable_and_free_of_ripples(kappa):
    """Against the exact scheme: the velocity of the toe is the same to the order of the step, and as smooth."""
    parameters = reflecting(alpha_of(kappa), section__length=50.0)
    (exact,) = march(rod(1000, **parameters), 1900, "toe.velocity")
    made = rod(1000, ground_segments=900, scheme="repaired", **parameters)
    assert made["stable_step"] >= made["time_step"]
    (toe,) = march(made, 1900, "toe.velocity")
    speed = made["ram.velocity"]
    np.testing.assert_allclose(toe[1002:], exact[1002:], atol=3e-3 * speed, rtol=0)
    assert np.abs(np.diff(toe[1002:], 2)).max() < 2.0 * np.abs(np.diff(exact[1002:], 2)).max()


def test_the_modified_scheme_ripples_with_a_soft_ground_and_diverges_with_a_stiff_one():
    """Fig. 13 has alpha = 0.5. A ripple changes its sign every step and decays by kappa."""
    soft = rod(
        1000, ground_segments=900, scheme="modified_smith", **reflecting(0.5, section__length=50.0)
    )
    (toe,) = march(soft, 1900, "toe.velocity")
    second = np.diff(toe[1000:], 2) / soft["ram.velocity"]
    assert np.abs(second[3:6]).max() > 0.01
    assert np.all(np.sign(second[1:6]) == -np.sign(second[2:7]))
    assert second[4] / second[3] == pytest.approx(-kappa_of(0.5), rel=0.02)
    stiff = rod(100, ground_segments=100, scheme="modified_smith", **reflecting(-0.1))
    assert stiff["stable_step"] < stiff["time_step"]
    (toe,) = march(stiff, 180, "toe.velocity")
    assert np.abs(toe).max() > 10.0 * stiff["ram.velocity"]
    assert np.diff(toe[-10:])[-1] / np.diff(toe[-10:])[-2] == pytest.approx(
        -kappa_of(-0.1), rel=1e-2
    )


def test_energy_in_the_ground_is_half_kinetic_and_half_elastic():
    made = rod(
        1000, ground_segments=900, scheme="modified_smith", **reflecting(0.5, section__length=50.0)
    )
    ground, elastic = march(made, 1900, "energy.ground", "energy.ground.elastic")
    assert ground[-1] > 0.7 * made["energy.start"]
    assert elastic[-1] / ground[-1] == pytest.approx(0.5, abs=0.005)


def test_the_ground_as_a_rod_is_semi_infinite():
    """Its last node lets every wave out, so that one segment of it does what many do."""
    parameters = reflecting(0.5, scheme="repaired")
    (few,) = march(rod(100, ground_segments=1, **parameters), 400, "force")
    (many,) = march(rod(100, ground_segments=400, **parameters), 400, "force")
    np.testing.assert_allclose(few, many, atol=1e-9 * np.abs(many).max(), rtol=0)
