"""The contact law: with vectors, with single numbers, and against plain formulas."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rockshed.components.common.kernels import kernel
from rockshed.components.sand_cushion import contact_law
from rockshed.components.sand_cushion.declarations import BLOCK, COLUMN, LANES, LAW, TALLY, Law
from rockshed.components.sand_cushion.vector import law as vector_law
from rockshed.components.sand_cushion.vector import rows as vector_rows

STIFFNESS, TANGENTIAL, DT = 1e5, 2.5e4, 1e-5


@kernel
def plain(block, spring, plastic, law, tally):
    vector_law.plain_law(block, spring, plastic, law, DT, 0, tally)


@kernel
def lasting(block, spring, plastic, law, tally):
    vector_law.lasting_law(block, spring, plastic, law, DT, 0, tally)


@kernel
def move(body, load, begin, end, dt, gravity, turning, motion):
    vector_rows.move_rows(body, load, begin, end, dt, gravity, turning, motion)


def constants(ratio, pull):
    law = np.zeros(len(LAW))
    law[LAW.normal], law[LAW.tangential], law[LAW.compliance] = (
        STIFFNESS,
        TANGENTIAL,
        1.0 / TANGENTIAL,
    )
    law[LAW.damping], law[LAW.tangential_damping] = (
        0.4 * math.sqrt(STIFFNESS),
        0.4 * math.sqrt(TANGENTIAL),
    )
    law[LAW.friction], law[LAW.unloading], law[LAW.yielding] = (
        0.5,
        ratio * STIFFNESS,
        1.0 - 1.0 / ratio,
    )
    law[LAW.pull], law[LAW.bridge] = pull, 0.05
    return law


@kernel
def answer(overlap, opening, slip, root, spring, law, dt):
    approach = contact_law.Approach(overlap, opening, slip, root)
    resistance = contact_law.slip_resistance(root, law, dt)
    return contact_law.respond(approach, spring, resistance, law, dt)


def contact(column, spring, plastic, law, energies):
    """One contact by plain formulas: force on the second disc, tangential and normal force, spring
    and permanent overlap.

    The law for single numbers, compiled, says the same.
    """
    distance = math.hypot(column.x, column.y)
    nx, ny = column.x / distance, column.y / distance
    overlap = column.reach - distance
    bridge, full = law[LAW.bridge] * column.reach, law[LAW.pull] * column.reach
    opening, slip = column.vx * nx + column.vy * ny, column.vy * nx - column.vx * ny - column.spin
    stays = max(plastic, law[LAW.yielding] * overlap)
    if stays > plastic:
        share = law[LAW.yielding]
        hardening = 0.5 * law[LAW.unloading] * (1.0 - share) / share
        energies["plastic"] += (stays - plastic) * (hardening * (stays + plastic) - full)
    stays = stays if overlap > -bridge else 0.0
    overlap -= stays
    closed = min(1.0, max(0.0, 1.0 + overlap / bridge))
    pull = full * closed
    energies["capillary"] -= full * (0.5 * bridge * closed * closed + max(0.0, overlap))
    numbers = answer(overlap, opening, slip, column.root, spring, Law(*law), DT)
    if overlap <= 0.0:
        energies["sliding"] += 0.5 * spring**2 / TANGENTIAL
        assert numbers == (0.0,) * 6
        return (-pull * nx, -pull * ny, 0.0, 0.0), 0.0, stays
    elastic = law[LAW.unloading] * overlap
    normal = max(0.0, elastic - law[LAW.damping] * column.root * opening)
    dashpot, limit = law[LAW.tangential_damping] * column.root, law[LAW.friction] * normal
    rate = TANGENTIAL * DT + dashpot
    force = min(limit, max(-limit, spring + rate * slip))
    taken = (force - spring) / rate
    kept = spring + TANGENTIAL * DT * taken
    assert numbers == pytest.approx((normal, force, elastic, spring, kept, taken), abs=1e-12)
    energies["elastic"] += 0.5 * elastic * overlap + 0.5 * kept**2 / TANGENTIAL
    energies["normal_dashpot"] += (elastic - normal) * opening * DT
    energies["tangential_dashpot"] += dashpot * taken**2 * DT
    energies["sliding"] += force * (slip - taken) * DT
    normal_part = normal - pull
    return (
        (normal_part * nx + force * ny, normal_part * ny - force * nx, force, normal),
        kept,
        stays,
    )


@given(
    seed=st.integers(0, 10**6),
    speed=st.sampled_from([1e-3, 1.0, 30.0]),
    model=st.sampled_from(
        [(plain, 1.0, 0.0), (lasting, 3.0, 0.0), (lasting, 1.0, 2e3), (lasting, 3.0, 2e3)]
    ),
)
def test_a_block_is_as_many_contacts(seed, speed, model):
    law_of_block, ratio, pull = model
    random = np.random.default_rng(seed)
    columns = np.zeros((len(COLUMN), BLOCK))
    angle, reach = random.uniform(0.0, 2.0 * np.pi, BLOCK), random.uniform(0.008, 0.012, BLOCK)
    distance = reach * (
        1.0 + random.choice([1e-4, 1e-2, 0.1], BLOCK) * random.normal(0.0, 1.0, BLOCK)
    )
    columns[:] = (
        distance * np.cos(angle),
        distance * np.sin(angle),
        *random.normal(0.0, speed, (3, BLOCK)),
        reach,
        random.uniform(0.3, 0.4, BLOCK),
    )
    spring = random.normal(0.0, 5.0, BLOCK) * random.integers(0, 2, BLOCK)
    plastic = np.abs(random.normal(0.0, 1e-4, BLOCK)) if ratio > 1.0 else np.zeros(BLOCK)
    law, energies = (
        constants(ratio, pull),
        dict.fromkeys(
            ("elastic", "normal_dashpot", "tangential_dashpot", "sliding", "plastic", "capillary"),
            0.0,
        ),
    )
    expected = [
        contact(type(COLUMN)(*column), force, stays, law, energies)
        for column, force, stays in zip(columns.T.tolist(), spring.tolist(), plastic.tolist())
    ]

    block, tally = columns.ravel().copy(), np.zeros(LANES * len(TALLY))
    law_of_block(block, spring, plastic, law, tally)

    forces, expected_forces = (
        block.reshape(-1, BLOCK)[:4].T,
        np.array([force for force, _, _ in expected]),
    )
    scale = max(abs(expected_forces).max(), 1.0)
    assert forces == pytest.approx(expected_forces, abs=1e-11 * scale)
    assert spring == pytest.approx([kept for _, kept, _ in expected], abs=1e-11 * scale)
    assert plastic == pytest.approx([stays for _, _, stays in expected], abs=1e-16)
    found = type(TALLY)(*tally.reshape(-1, LANES).sum(axis=1))
    assert 0.5 * (found.elastic + found.stretched / TANGENTIAL) == pytest.approx(
        energies["elastic"], rel=1e-10
    )
    assert found.normal_dashpot * DT == pytest.approx(
        energies["normal_dashpot"], rel=1e-9, abs=1e-18
    )
    assert law[LAW.tangential_damping] * found.tangential_dashpot * DT == pytest.approx(
        energies["tangential_dashpot"], rel=1e-9
    )
    assert found.sliding * DT + 0.5 * found.released / TANGENTIAL == pytest.approx(
        energies["sliding"], rel=1e-9, abs=1e-12
    )
    assert found.plastic == pytest.approx(energies["plastic"], rel=1e-10, abs=1e-15)
    assert found.capillary == pytest.approx(energies["capillary"], rel=1e-10, abs=1e-15)


@pytest.mark.parametrize("turning", [0.0, 2.0])
def test_discs_move_by_the_second_law(turning):
    """Force, torque and weight change the velocities, the new velocities the places; energies are
    those of the mean velocity."""
    random, n, dt, gravity = np.random.default_rng(1), 7, 1e-3, 9.8
    body, load, motion = (
        random.normal(0.0, 1.0, (n, 8)),
        random.normal(0.0, 1.0, (n, 4)),
        np.zeros(8),
    )
    mass, radius = random.uniform(1.0, 2.0, n), random.uniform(0.1, 0.2, n)
    body[:, 5], body[:, 6], body[:, 7], load[:, 3] = radius, 1.0 / mass, 0.5 * np.sqrt(mass), 0.0
    before, force = body.copy(), load.copy()
    move(body.ravel(), load.ravel(), 1, n, dt, gravity, turning, motion)
    moved = slice(1, n)
    gained = force[moved, :3] / mass[moved, None] * dt - [0.0, gravity * dt, 0.0]
    if turning:
        gained[:, 2] = (
            force[moved, 2]
            * radius[moved]
            / (0.5 * mass[moved] * radius[moved] ** 2)
            * radius[moved]
            * dt
        )  # torque / I
    else:
        gained[:, 2] = 0.0
    assert body[moved, 2:5] == pytest.approx(before[moved, 2:5] + gained)
    assert body[moved, :2] == pytest.approx(before[moved, :2] + body[moved, 2:4] * dt)
    np.testing.assert_array_equal(body[moved, 5:], before[moved, 5:])
    np.testing.assert_array_equal(body[0], before[0])
    assert not load[moved].any()
    np.testing.assert_array_equal(load[0], force[0])
    quarter = 0.25 * mass[moved]
    assert motion[:3] == pytest.approx(
        (quarter[:, None] * before[moved, 2:5] * body[moved, 2:5]).sum(axis=0)
    )
    assert motion[4] == pytest.approx((body[moved, 2:4] ** 2).sum(axis=1).max())
    assert motion[7] == pytest.approx((quarter * before[moved, 1]).sum())
