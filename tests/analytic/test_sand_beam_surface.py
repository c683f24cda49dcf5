"""The beam's top as a surface: what a contact with it stores is what the beam gives and gets."""

import numpy as np
import pytest

from tests.sand_discs import RADIUS, discs_at, rows, run

ELEMENTS, SPACING = 6, 0.05
HALF = 0.5 * SPACING
SMOOTH = {"friction_angle": 0.0, "damping": 0.0, "wall.friction_angle": 0.0}
QUANTITIES = ("position.x", "position.y", "angle")


def bent(seed):
    """Places and angles of beam discs that are moved by some millimetres and turned by hundredths."""
    random = np.random.default_rng(seed)
    x = (np.arange(ELEMENTS) + 0.5) * SPACING
    return {
        "position.x": x + random.normal(0.0, 1e-3, ELEMENTS),
        "position.y": random.normal(-HALF, 2e-3, ELEMENTS),
        "angle": random.normal(0.0, 0.03, ELEMENTS),
    }


def on_beam(beam, centres, **parameters):
    """Discs of sand at given centres (m) on a beam, without gravity, friction and damping."""
    given = {f"beam.{name}": values for name, values in beam.items()}
    return discs_at(
        centres,
        parameters={
            **SMOOTH,
            "base": "beam_surface",
            "box.left": 0.004,
            "box.width": ELEMENTS * SPACING - 0.008,
            "beam.radius": HALF,
            **given,
            **parameters,
        },
        elements=ELEMENTS,
    )


def tops(beam):
    """Tops of the discs (m), shape (elements, 2)."""
    return np.stack((beam["position.x"] - HALF * beam["angle"], beam["position.y"] + HALF), axis=1)


def pressed_at(beam, number, share, overlap):
    """Centre of a disc of sand over the line behind top ``number``, at a share of its length."""
    left, right = tops(beam)[number], tops(beam)[number + 1]
    along = (right - left) / np.hypot(*(right - left))
    return left + share * (right - left) + (RADIUS - overlap) * np.array((-along[1], along[0]))


PLACES = [(1, 0.3), (3, 0.55), (4, 0.8), (0, -0.3), (4, 1.25)]
"""Line and share; the last two lie beyond the outermost tops."""


@pytest.mark.parametrize(("number", "share"), PLACES)
@pytest.mark.parametrize("seed", [1, 2])
def test_forces_and_torques_on_the_beam_are_the_gradient_of_what_the_contact_stores(
    number, share, seed
):
    """Central differences of the energy by every place and angle of every beam disc."""
    beam = bent(seed)
    centre = pressed_at(beam, number, share, 2e-4)
    sand = on_beam(beam, [centre])
    size = abs(sand["beam.force.y"]).sum()
    assert size > 1.0
    for name, force, step in zip(QUANTITIES, ("force.x", "force.y", "torque"), (1e-8, 1e-8, 1e-7)):
        for i in range(ELEMENTS):
            energies = []
            for sign in (1.0, -1.0):
                moved = {key: values.copy() for key, values in beam.items()}
                moved[name][i] += sign * step
                energies.append(on_beam(moved, [centre])["energy.elastic"])
            gradient = (energies[0] - energies[1]) / (2.0 * step)
            assert sand[f"beam.{force}"][i] == pytest.approx(-gradient, abs=1e-5 * size)


@pytest.mark.parametrize(("number", "share"), PLACES)
def test_the_normal_tilts_with_the_line_and_the_lever_shares_the_force(number, share):
    """A disc at the distance r - d from the line is pushed by k d along its normal."""
    beam, overlap = bent(3), 2e-4
    sand = on_beam(beam, [pressed_at(beam, number, share, overlap)])
    line = np.diff(tops(beam), axis=0)[number]
    normal = np.array((-line[1], line[0])) / np.hypot(*line)
    force = np.stack((sand["beam.force.x"], sand["beam.force.y"]), axis=1)
    stiffness = sand["stiffness_factor"] * sand["modulus"] * sand["thickness"]
    assert force.sum(axis=0) == pytest.approx(-stiffness * overlap * normal, rel=1e-9)
    assert force[number + 1] == pytest.approx(share * force.sum(axis=0), rel=1e-6)
    assert force[number] == pytest.approx((1.0 - share) * force.sum(axis=0), rel=1e-6)
    assert sand["beam.torque"] == pytest.approx(-HALF * sand["beam.force.x"], rel=1e-12)


def test_a_disc_that_passes_kinks_keeps_its_energy():
    """Smooth and elastic on an arch with kinks of 0.2 rad: no distance jumps where two lines meet.

    The force turns there within a step, which errs in proportion to the step.
    """
    places = (np.arange(ELEMENTS) + 0.5) * SPACING
    arch = {
        "position.x": places,
        "position.y": -HALF + 2.0 * (places - 0.5 * ELEMENTS * SPACING) ** 2,
        "angle": np.zeros(ELEMENTS),
    }
    worst = []
    for step in (2e-6, 5e-7):
        sand = on_beam(arch, [pressed_at(arch, 0, 0.7, 1e-4)], gravity=9.80665, internal_step=step)
        rows(sand)[0, 2:4] = 0.5, 0.0
        sand.evaluate()
        visited, errors = set(), []
        for _ in range(200):
            run(sand, 1e-3)
            visited.add(int(rows(sand)[0, 0] / SPACING - 0.5))
            errors.append(abs(sand["energy.residual"]) / sand["energy.start"])
        assert visited >= {0, 1, 2, 3}
        worst.append(max(errors))
    assert worst[1] < 3e-4
    assert worst[0] / worst[1] == pytest.approx(4.0, rel=0.5)


@pytest.mark.parametrize("friction_angle", [0.0, 0.5])
def test_a_disc_that_bounces_on_a_moving_beam_closes_its_balance(friction_angle):
    """Every disc of the beam heaves, slides and turns on its own; the error falls with the step."""
    residuals = []
    for step in (4e-6, 1e-6):
        beam = bent(5)
        sand = on_beam(
            beam,
            [pressed_at(beam, 2, 0.4, 0.0)],
            friction_angle=friction_angle,
            internal_step=step,
        )
        rows(sand)[0, 2:4] = 0.3, -1.0
        sand.evaluate()
        random = np.random.default_rng(6)
        rates = {
            name: random.normal(0.0, s, ELEMENTS) for name, s in zip(QUANTITIES, (0.2, 0.2, 4.0))
        }
        for name, rate in rates.items():
            speed = "angular_velocity" if name == "angle" else name.replace("position", "velocity")
            sand[f"beam.{speed}"] = rate
        for s in range(round(2e-3 / step)):
            for name, rate in rates.items():
                sand[f"beam.{name}"] = beam[name] + rate * s * step
            sand.step(s * step, step)
        assert abs(sand["energy.work.beam"]) > 1e-4
        residuals.append(abs(sand["energy.residual"]) / sand["energy.kinetic"])
    assert residuals[0] < 5e-3
    assert residuals[1] < 0.5 * residuals[0]


def test_a_beam_that_only_turns_its_discs_brings_the_list_of_contacts_up_to_date():
    """The rise from one top to the next comes to lie under a disc of sand that was beside it."""
    beam = {
        "position.x": (np.arange(ELEMENTS) + 0.5) * SPACING,
        "position.y": np.full(ELEMENTS, -HALF),
        "angle": np.zeros(ELEMENTS),
    }
    beam["position.y"][3:] += 0.05
    sand = on_beam(beam, [(0.165, 0.0549)])
    assert abs(sand["beam.force.y"]).sum() == 0.0
    for s in range(51):
        sand["beam.angle"] = np.full(ELEMENTS, 0.01 * s)
        sand.step(s * 1e-5, 1e-5)
    assert abs(sand["beam.force.y"]).sum() > 1.0
