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
declare <N x double> @llvm.fma.vNf64(<N x double>, <N x double>, <N x double>)
define void @fused(ptr %at) {
  %second = getelementptr <N x double>, ptr %at, i64 1
  %third = getelementptr <N x double>, ptr %at, i64 2
  %a = load <N x double>, ptr %at, align 8
  %b = load <N x double>, ptr %second, align 8
  %c = load <N x double>, ptr %third, align 8
  %sum = call <N x double> @llvm.fma.vNf64(<N x double> %a, <N x double> FACTOR, <N x double> %c)
  store <N x double> %sum, ptr %at, align 8
  ret void
}
define i64 @rockshed_initialise(ptr %w, ptr %x, ptr %k, i64 %l, i64 %m, i64 %n) { ret i64 0 }
define i64 @rockshed_evaluate(ptr %w, ptr %x, ptr %k, i64 %l, i64 %m, i64 %n) { ret i64 0 }
define i64 @rockshed_step(double %t, double %h, ptr %w, ptr %x, ptr %k, i64 %l, i64 %m, i64 %n) {
  ret i64 0
}
"""


KINDS = (("plain", 8, 2), ("simd", 2, 0), ("simd", 8, 6), ("relaxed", 8, 3))
"""Variant of the code, numbers in a vector, and the one that is looked at."""


def hosted(variant, lanes, factor="%b"):
    """A module with a multiply-add of vectors."""
    import llvmlite.binding as llvm

    from rockshed.fmus.wasm.kernels import write_code
    from rockshed.fmus.wasm.module import linked

    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    with TemporaryFolder() as work:
        code = CODE.replace("N x", f"{lanes} x").replace("vNf", f"v{lanes}f")
        write_code(code.replace("FACTOR", factor), variant, ("fused",), work)
        return Hosted(linked("test", variant, ("fused",), work))


@pytest.fixture(scope="module", params=KINDS, ids=lambda kind: "-".join(map(str, kind)))
def fused(request):
    """A function of three numbers in one lane of vectors, and of three others in the rest."""
    variant, lanes, lane = request.param
    host = hosted(variant, lanes)
    place = host.room(24 * lanes)

    def sums(a, b, c, beside=(1.0, 1.0, 1.0)):
        vectors = np.repeat(beside, lanes).reshape(3, lanes)
        vectors[:, lane] = a, b, c
        host.write(place, vectors)
        host.call("fused", place)
        found = host.read(place, np.zeros(lanes))
        others = set(map(bits, np.delete(found, lane)))
        assert len(others) == 1
        return found[lane], found[lane - 1]

    if variant == "relaxed" and sums(1 + 2**-30, 1 - 2**-30, -1.0)[0] == 0.0:
        pytest.skip("this processor has no fused multiply-add")
    return sums


@pytest.mark.parametrize("variant", ["plain", "simd", "relaxed"])
def test_a_product_with_signs_is_exact(variant):
    """What the gathering of rows does: the sum alone is rounded, also where it is subnormal."""
    signs = np.repeat([-1.0, 0.0, 1.0], [4, 1, 3])
    factor = f"<{', '.join(f'double {sign:e}' for sign in signs)}>"
    host = hosted(variant, 8, factor)
    place = host.room(192)
    numbers = np.random.default_rng(3).uniform(-1.0, 1.0, (400, 2, 8))
    numbers[:100] *= 2.0**-1060
    numbers[100:200, 1] *= 2.0**-53
    numbers[200] = [np.full(8, 5e-324), np.full(8, -0.0)]
    numbers[201] = [np.full(8, 1.7e308), np.full(8, 1.7e308)]
    for a, c in numbers:
        host.write(place, np.array([a, signs, c]))
        host.call("fused", place)
        found = host.read(place, np.zeros(8))
        assert found.tolist() == [exact(*each) for each in zip(a, signs, c)]


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


DOUBTFUL = (2.0**-537, 2.0**-538, 5e-324)
"""Beside such numbers all are computed in the exact way."""


@given(scaled(-60, 0), scaled(-60, 0), scaled(-120, 60))
@example(0.007338032126426696, 0.09375000000000004, -8796093022208.0)
@example(178657.31249999997, -56679.7945637234, 1.5474250491067253e26)
@example(-1.0859682188070947e-175, -1.63637881659204e-130, -2.0522684006491881e-289)
@example(1.0952995975104675e-123, -4.738095254265071e-176, 8.607837561916492e-283)
@example(-1.5683389623076296e192, -1.814754610596867e96, -4.388899255034951e304)
@settings(max_examples=200)
def test_the_exact_way_gives_the_sum_rounded_once(fused, a, b, c):
    for summand in (c, -a * b, math.nextafter(-a * b, math.inf)):
        found = fused(a, b, summand, beside=DOUBTFUL)
        assert bits(found[0]) == bits(exact(a, b, summand))
        assert bits(found[1]) == bits(exact(*DOUBTFUL))


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
