"""The multiply-add of WebAssembly against exact rational arithmetic."""

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from rockshed.temporary import TemporaryFolder
from tests.wasm import Hosted, bits

pytest.importorskip("wasmtime")
pytest.importorskip("ziglang")

CODE = """
declare <2 x double> @llvm.fma.v2f64(<2 x double>, <2 x double>, <2 x double>)
define void @fused(ptr %at) {
  %second = getelementptr i8, ptr %at, i64 16
  %third = getelementptr i8, ptr %at, i64 32
  %a = load <2 x double>, ptr %at, align 8
  %b = load <2 x double>, ptr %second, align 8
  %c = load <2 x double>, ptr %third, align 8
  %sum = call <2 x double> @llvm.fma.v2f64(<2 x double> %a, <2 x double> %b, <2 x double> %c)
  store <2 x double> %sum, ptr %at, align 8
  ret void
}
define i64 @rockshed_initialise(ptr %w, ptr %x, ptr %k, i64 %l, i64 %m, i64 %n) { ret i64 0 }
define i64 @rockshed_evaluate(ptr %w, ptr %x, ptr %k, i64 %l, i64 %m, i64 %n) { ret i64 0 }
define i64 @rockshed_step(double %t, double %h, ptr %w, ptr %x, ptr %k, i64 %l, i64 %m, i64 %n) {
  ret i64 0
}
"""


@pytest.fixture(scope="module", params=["plain", "simd", "relaxed"])
def fused(request):
    """A function of three numbers, each pair of which is in both lanes of a vector."""
    import llvmlite.binding as llvm

    from rockshed.fmus.wasm.kernels import VARIANTS, emitted
    from rockshed.fmus.wasm.module import linked

    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    with TemporaryFolder() as work:
        code = emitted(CODE, VARIANTS[request.param], {"fused": None})
        (work / f"{request.param}.o").write_bytes(code)
        host = Hosted(linked("test", request.param, ("fused",), work))
    place = host.room(48)

    def sums(a, b, c, beside=(1.0, 1.0, 1.0)):
        host.write(place, np.array([a, beside[0], b, beside[1], c, beside[2]]))
        host.call("fused", place)
        return host.read(place, np.zeros(2))

    def is_single(a, b, c):
        return sums(a, b, c)[0]

    if request.param == "relaxed" and is_single(1 + 2**-30, 1 - 2**-30, -1.0) == 0.0:
        pytest.skip("this processor has no fused multiply-add")
    return sums


def exact(a, b, c):
    """Return a b + c, rounded once."""
    if math.isfinite(a) and math.isfinite(b) and not math.isfinite(c):
        return c
    if not all(map(math.isfinite, (a, b, c))):
        return a * b + c
    total = Fraction(a) * Fraction(b) + Fraction(c)
    if total == 0:
        return a * b + c if a == 0.0 or b == 0.0 else 0.0
    try:
        rounded = total.numerator / total.denominator
    except OverflowError:
        rounded = math.inf
    return math.copysign(rounded, 1 if total > 0 else -1)


ANY = st.floats(allow_nan=True, allow_infinity=True, allow_subnormal=True)


def scaled(low, high):
    """Numbers with exponents in a range and significands of few or many bits."""
    return st.builds(
        lambda whole, sign, shift: sign * math.ldexp(whole, shift),
        st.one_of(st.integers(1, 2**53 - 1), st.integers(1, 2**8)),
        st.sampled_from((1.0, -1.0)),
        st.integers(low, high),
    )


@given(ANY, ANY, ANY)
@settings(max_examples=200)
def test_any_three_numbers_give_the_sum_rounded_once(fused, a, b, c):
    assert bits(fused(a, b, c)[0]) == bits(exact(a, b, c))


@given(scaled(-60, 0), scaled(-60, 0), scaled(-120, 60))
@settings(max_examples=750)
def test_numbers_of_like_size_give_the_sum_rounded_once(fused, a, b, c):
    for summand in (c, -a * b, math.nextafter(-a * b, math.inf)):
        assert bits(fused(a, b, summand)[0]) == bits(exact(a, b, summand))


@given(scaled(-700, -400), scaled(-700, -400), st.one_of(scaled(-1074, -1000), st.just(0.0)))
@example(2.0**-537, 2.0**-538, 5e-324)
@example(2.0**-537, -(2.0**-538), 5e-324)
@example(2.0**-600, -(2.0**-600), 0.0)
@settings(max_examples=400)
def test_products_that_are_subnormal_give_the_sum_rounded_once(fused, a, b, c):
    assert bits(fused(a, b, c)[0]) == bits(exact(a, b, c))


@given(scaled(440, 480), scaled(440, 480), scaled(900, 970))
@settings(max_examples=200)
def test_sums_near_the_largest_number_are_rounded_once(fused, a, b, c):
    for summand in (c, -c):
        assert bits(fused(a, b, summand)[0]) == bits(exact(a, b, summand))


@given(scaled(-52, -52), scaled(-52, -52), scaled(-52, 10))
@settings(max_examples=200)
def test_ties_are_rounded_to_even(fused, a, b, c):
    one = math.copysign(1.0, a)
    for summand in (c, one * math.ulp(c) / 2, -one * math.ulp(c) / 2):
        assert bits(fused(one, c, summand)[0]) == bits(exact(one, c, summand))
    assert bits(fused(a, b, c)[0]) == bits(exact(a, b, c))


@given(scaled(-1074, 900), scaled(-60, 60), st.sampled_from((0.0, -0.0)))
@settings(max_examples=100)
def test_zeros_keep_their_sign(fused, a, b, zero):
    for numbers in ((zero, b, zero), (zero, -b, -zero), (zero, b, a), (b, -zero, -0.0)):
        assert bits(fused(*numbers)[0]) == bits(exact(*numbers))
    assert bits(fused(a, zero, -0.0)[0]) == bits(exact(a, zero, -0.0))


def test_one_doubtful_lane_leaves_the_other_right(fused):
    beside = (1.0 + 2.0**-30, 1.0 - 2.0**-30, -1.0)
    assert list(fused(2.0**-600, 2.0**-600, 1.0, beside)) == [1.0, -(2.0**-60)]
