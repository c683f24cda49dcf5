"""Methods of the implicit master: guesses of values until what comes back is the guess."""

import numpy as np
import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st
from threadpoolctl import threadpool_limits

from rockshed.core.masters.acceleration import acceleration_of

NUMBERS = st.integers(-30, 30).map(lambda i: i / 10.0)


@st.composite
def loops(draw):
    """A linear loop G(z) = A z + b with a solution that is well determined."""
    size = draw(st.integers(1, 6))
    row = st.lists(NUMBERS, min_size=size, max_size=size)
    matrix = np.array(draw(st.lists(row, min_size=size, max_size=size)))
    assume(np.linalg.cond(np.eye(size) - matrix) < 30.0)
    return matrix, np.array(draw(row))


def solved(method, matrix, constant, start, most, scale=None):
    """The last guess, and the number of iterations until it came back."""
    guess = start
    scale = np.ones(start.size) if scale is None else scale
    method.begin()
    for iteration in range(1, most + 1):
        result = matrix @ guess + constant
        if np.all(np.abs(result - guess) <= 1e-8 * (1.0 + np.abs(result)) * scale):
            return guess, iteration
        guess = method.next(guess, result, scale)
    return guess, most + 1


@pytest.mark.parametrize("name", ["anderson", "quasi_newton"])
@given(loops())
@example((np.array([[-1.7, 0.5], [-1.1, 1.0]]), np.array([0.0, 1.0])))
@example((np.array([[0.0, -1.0, 0.0], [0.0, 0.0, -1.0], [-2.0, 0.0, 1.0]]), -2.0 * np.eye(3)[2]))
@example((np.roll(np.eye(6), 1, axis=0) * -1.5, np.eye(6)[0]))
def test_a_linear_loop_of_n_values_is_solved_in_n_plus_1_iterations(name, drawn):
    """Whether it contracts or not; the next iteration shows that it is solved.

    In the examples some differences, of the last one all but one, make the residual no smaller.
    """
    matrix, constant = drawn
    size = constant.size
    found, iterations = solved(
        acceleration_of(name, size), matrix, constant, np.zeros(size), 4 * size + 8
    )
    expected = np.linalg.solve(np.eye(size) - matrix, constant)
    assert found == pytest.approx(expected, rel=1e-6, abs=1e-6)
    assert iterations <= size + 2


@given(st.integers(1, 4000), st.floats(-10.0, 10.0))
def test_a_scalar_loop_of_any_stiffness_is_solved_by_each_method_in_three(stiffness, constant):
    assume(abs(constant) > 1e-3)
    for name in ("fixed_point", "anderson", "quasi_newton"):
        matrix, given_ = np.array([[-float(stiffness)]]), np.array([constant])
        found, iterations = solved(acceleration_of(name, 1), matrix, given_, np.zeros(1), 6)
        assert found == pytest.approx([constant / (1.0 + stiffness)], rel=1e-6)
        assert iterations <= 4


def test_what_earlier_windows_have_taught_saves_iterations():
    generator = np.random.default_rng(1)
    matrix = generator.normal(size=(5, 5))
    counts = {}
    for name in ("anderson", "quasi_newton"):
        method = acceleration_of(name, 5)
        counts[name] = [
            solved(method, matrix, generator.normal(size=5), np.zeros(5), 30)[1] for _ in range(4)
        ]
    assert max(counts["quasi_newton"][1:]) <= 3 < min(counts["anderson"])


def test_values_of_different_units_do_not_matter_to_each_other():
    """A force of 1e6 N beside a displacement of 1e-6 m."""
    units = np.array([1e6, 1e-6])
    matrix = np.array([[0.2, -1.5], [2.0, 0.1]]) * units[:, None] / units
    constant = units
    expected = np.linalg.solve(np.eye(2) - matrix, constant)
    for name in ("anderson", "quasi_newton"):
        method = acceleration_of(name, 2)
        found, _ = solved(method, matrix, constant, np.zeros(2), 10, units)
        assert found == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize("name", ["fixed_point", "anderson", "quasi_newton"])
def test_what_is_remembered_makes_the_same_guesses(name):
    matrix = np.array([[0.3, -0.8], [0.5, 0.2]])
    one, other = acceleration_of(name, 2), acceleration_of(name, 2)
    solved(one, matrix, np.ones(2), np.zeros(2), 5)
    other.recall({key: array.copy() for key, array in one.memory().items()})
    guesses = []
    for method in (one, other):
        method.begin()
        guesses.append(method.next(np.zeros(2), np.array([1.0, 2.0]), np.ones(2)))
    assert np.array_equal(*guesses)


@pytest.mark.parametrize("name", ["anderson", "quasi_newton"])
def test_guesses_do_not_hang_on_the_threads_of_linear_algebra(name):
    """On one core the libraries have one thread, and this shows nothing."""
    random = np.random.default_rng(5)
    size = 100_000
    factors, start, constant = random.uniform(-1.2, 1.2, size), np.zeros(size), np.ones(size)

    def guesses(threads):
        method, guess = acceleration_of(name, size), start
        method.begin()
        with threadpool_limits(threads, user_api="blas"):
            for _ in range(16):
                guess = method.next(guess, factors * guess + constant, np.ones(size))
        return guess

    assert guesses(1).tobytes() == guesses(2).tobytes()
