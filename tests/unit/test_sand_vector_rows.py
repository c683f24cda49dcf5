"""Rows and columns of the block of pairs: the vector form against its plain twin, bit for bit."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rockshed.components.common.kernels import kernel
from rockshed.components.sand_cushion.contact_search import pair_of
from rockshed.components.sand_cushion.declarations import BLOCK
from rockshed.components.sand_cushion.vector import rows as vector_rows

BODIES = 40


@kernel
def to_columns(body, pair, block):
    vector_rows.pairs_to_columns(body, pair, 0, block)


@kernel
def to_rows(load, pair, block):
    vector_rows.columns_to_pairs(load, pair, 0, block)


@kernel
def to_rows_that_do_not_turn(load, pair, block):
    vector_rows.forces_to_pairs(load, pair, 0, block)


def pairs(seed):
    """A block of pairs of which many share a disc, also next to each other."""
    random = np.random.default_rng(seed)
    first = np.sort(random.integers(0, BODIES - 1, BLOCK))
    second = random.integers(first + 1, BODIES)
    return (
        random,
        first,
        second,
        np.array([pair_of.py_func(int(i), int(j)) for i, j in zip(first, second)]),
    )


@given(seed=st.integers(0, 10**6))
def test_columns_are_those_of_the_plain_loop(seed):
    random, first, second, pair = pairs(seed)
    body = random.normal(0.0, 1.0, 8 * BODIES)
    vector, plain = np.zeros(7 * BLOCK), np.zeros(7 * BLOCK)
    to_columns(body, pair, vector)
    vector_rows.plain_pairs_to_columns(body, pair, 0, plain)
    np.testing.assert_array_equal(vector, plain)
    rows = body.reshape(-1, 8)
    assert plain[:BLOCK] == pytest.approx(rows[second, 0] - rows[first, 0])
    assert plain[5 * BLOCK : 6 * BLOCK] == pytest.approx(rows[second, 5] + rows[first, 5])
    assert plain[6 * BLOCK :] == pytest.approx(rows[second, 7] + rows[first, 7])


@given(seed=st.integers(0, 10**6))
def test_loads_add_up_in_the_order_of_the_plain_loop(seed):
    random, _, _, pair = pairs(seed)
    block, start = random.normal(0.0, 1.0, 4 * BLOCK), random.normal(0.0, 1.0, 4 * BODIES)
    vector, plain = start.copy(), start.copy()
    to_rows(vector, pair, block)
    vector_rows.plain_columns_to_pairs(plain, pair, 0, block)
    np.testing.assert_array_equal(vector, plain)
    locked = start.copy()
    to_rows_that_do_not_turn(locked, pair, block)
    np.testing.assert_array_equal(locked.reshape(-1, 4)[:, :2], plain.reshape(-1, 4)[:, :2])
    np.testing.assert_array_equal(locked.reshape(-1, 4)[:, 2:], start.reshape(-1, 4)[:, 2:])
    gained = (plain - start).reshape(-1, 4).sum(axis=0)
    assert gained[:2] == pytest.approx(0.0, abs=1e-12)  # action and reaction
    assert gained[2] == pytest.approx(2.0 * block[2 * BLOCK : 3 * BLOCK].sum())
