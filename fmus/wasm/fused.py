"""Fused multiply-add for processors that have none, as instructions in the place of the call.

WebAssembly has no instruction that is a fused multiply-add on every processor. :func:`fast_sum`
writes one from sums and products alone. With the error e of a sum and u of a product, both exact
(Dekker 1971, Knuth),

    a b + c = p + u + c = s + e + u,     p = fl(a b),  s = fl(p + c).

e + u is far smaller than s, and where fl(s + (e + u)(1 - 2**-50)) and fl(s + (e + u)(1 + 2**-50))
are one number, it is a b + c rounded once, because rounding is monotone. Everything else (a tie or
nearly one, numbers near overflow, products whose error would be subnormal) is seen in the numbers
themselves and goes to the function ``fma`` of a C library, which is exact and slow. To round e + u
to odd (Boldo and Melquiond 2008) would need no second way for ties, and a fifth more instructions.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from llvmlite import ir

REAL, INTEGER, WORD = ir.DoubleType(), ir.IntType(64), ir.IntType(32)

_LOW_BITS = 27
"""Bits of a significand that the upper half of a factor leaves out: 26 and 26 remain."""
_LEAST_PRODUCT = 2.0**-960
"""From here on the error of a product is no subnormal number."""
_PART = "fused_part"
_DOUBT = 2.0**-50
"""Share of e + u by which the test goes beyond it; its rounding errors are less."""


@dataclass(frozen=True)
class WideNumber:
    """One vector of float64 or of masks, with the arithmetic of a number, while LLVM is written."""

    builder: ir.IRBuilder
    value: ir.Value

    def made(self, value: ir.Value) -> "WideNumber":
        """Return another vector at the same place of the program."""
        return WideNumber(self.builder, value)

    def __add__(self, other: "WideNumber") -> "WideNumber":
        return self.made(self.builder.fadd(self.value, other.value))

    def __sub__(self, other: "WideNumber") -> "WideNumber":
        return self.made(self.builder.fsub(self.value, other.value))

    def __mul__(self, other: "WideNumber") -> "WideNumber":
        return self.made(self.builder.fmul(self.value, other.value))

    def __and__(self, other: "WideNumber") -> "WideNumber":
        return self.made(self.builder.and_(self.value, other.value))

    def __or__(self, other: "WideNumber") -> "WideNumber":
        return self.made(self.builder.or_(self.value, other.value))

    def __lt__(self, other: "WideNumber") -> "WideNumber":
        return self.made(self.builder.fcmp_ordered("<", self.value, other.value))

    def differs(self, other: "WideNumber") -> "WideNumber":
        """Return where numbers differ, or one of them is no number."""
        return self.made(self.builder.fcmp_unordered("!=", self.value, other.value))

    def filled(self, number: float) -> "WideNumber":
        """Return the same number in all lanes."""
        kind = self.value.type
        return self.made(ir.Constant(kind, [ir.Constant(REAL, number)] * kind.count))

    def magnitude(self) -> "WideNumber":
        """Return the absolute value of each number."""
        kind = self.value.type
        name = f"llvm.fabs.v{kind.count}f64"
        function = _declared(self.builder.module, name, kind, [kind])
        return self.made(self.builder.call(function, [self.value]))

    def upper_half(self) -> "WideNumber":
        """Return numbers rounded to their upper 26 bits."""
        kind = self.value.type
        whole = ir.VectorType(INTEGER, kind.count)
        builder = self.builder

        def all_lanes(number: int) -> ir.Constant:
            return ir.Constant(whole, [ir.Constant(INTEGER, number)] * kind.count)

        bits = builder.bitcast(self.value, whole)
        rounded = builder.add(bits, all_lanes(1 << (_LOW_BITS - 1)))
        return self.made(builder.bitcast(builder.and_(rounded, all_lanes(-1 << _LOW_BITS)), kind))


def fast_sum(a: WideNumber, b: WideNumber, c: WideNumber) -> tuple[WideNumber, WideNumber]:
    """Write ``a b + c`` rounded once, and where that is not certain.

    Parameters
    ----------
    a, b, c : WideNumber
        Factors and summand.

    Returns
    -------
    result : WideNumber
        The sums.
    doubtful : WideNumber
        Mask of the lanes in which they may be wrong.
    """
    a_high, b_high = a.upper_half(), b.upper_half()
    a_low, b_low = a - a_high, b - b_high
    product = a * b
    # minus the error of the product, every step of it exact
    lost = product - a_high * b_high - a_low * b_high - a_high * b_low - a_low * b_low
    total = product + c
    part = total - product
    # minus the error of the sum; +0 where there is none, so that a zero keeps its sign
    rest = (part - c) + ((total - part) - product) + lost
    least = total - rest * rest.filled(1.0 - _DOUBT)
    most = total - rest * rest.filled(1.0 + _DOUBT)
    zero = a.filled(0.0)
    small = (product.magnitude() < a.filled(_LEAST_PRODUCT)) & a.differs(zero) & b.differs(zero)
    # the difference is not zero either where both are infinite
    return least, (most - least).differs(zero) | small


def define_fused(module: ir.Module, name: str, lanes: int, exact: str, together: int) -> None:
    """Add a function ``name(a, b, c)`` on vectors to a module: ``a b + c`` rounded once.

    The instructions stand once in the module, for as many numbers as one register of the host
    holds: set into every place they would make it more than twice as large, and not faster.

    Parameters
    ----------
    module : llvmlite.ir.Module
        The module.
    name : str
        Name of the function.
    lanes : int
        WideNumber in a vector.
    exact : str
        Name of a function of the same on three single numbers, for what is not certain.
    together : int
        WideNumber that are computed together; ``lanes`` is a multiple of it.
    """
    part = ir.VectorType(REAL, together)
    called = module.globals.get(_PART) or _part(module, part, exact)
    function, builder = _begun(module, name, ir.VectorType(REAL, lanes))
    function.attributes.add("alwaysinline")
    results = [builder.call(called, values) for values in _cut(builder, function.args, together)]
    builder.ret(_joined(builder, results))


def _part(module: ir.Module, kind: ir.VectorType, exact: str) -> ir.Function:
    """Add the function that all others call, on as many numbers as a register holds."""
    function, builder = _begun(module, _PART, kind)
    function.attributes.add("noinline")
    result, doubtful = fast_sum(*(WideNumber(builder, value) for value in function.args))
    wide = ir.VectorType(INTEGER, kind.count)
    with builder.if_then(_any(builder, builder.sext(doubtful.value, wide)), likely=False):
        builder.ret(_slow(builder, function.args, exact))
    builder.ret(result.value)
    return function


def define_relaxed(module: ir.Module, name: str, lanes: int, exact: str, together: int) -> None:
    """Add the function of :func:`define_fused`, written with the multiply-add of relaxed vectors.

    It rounds once where the processor has such an instruction. WebAssembly leaves it to the host,
    which makes one choice for all its modules; who runs the code has to look at it first.

    Parameters
    ----------
    module, name, lanes, exact, together
        As for :func:`define_fused`; ``together`` is 2, and ``exact`` is not called.
    """
    part = ir.VectorType(REAL, together)
    instruction = _declared(module, "llvm.wasm.relaxed.madd.v2f64", part, [part] * 3)
    function, builder = _begun(module, name, ir.VectorType(REAL, lanes))
    function.attributes.add("alwaysinline")
    cut = _cut(builder, function.args, together)
    builder.ret(_joined(builder, [builder.call(instruction, values) for values in cut]))


def _begun(module: ir.Module, name: str, kind: ir.VectorType) -> tuple[ir.Function, ir.IRBuilder]:
    function = ir.Function(module, ir.FunctionType(kind, [kind] * 3), name)
    return function, ir.IRBuilder(function.append_basic_block())


def _declared(module: ir.Module, name: str, result: ir.Type, kinds: list[ir.Type]) -> ir.Function:
    return module.globals.get(name) or ir.Function(module, ir.FunctionType(result, kinds), name)


def _cut(
    builder: ir.IRBuilder, vectors: Sequence[ir.Value], together: int
) -> Iterator[list[ir.Value]]:
    """Yield the first numbers of each vector, then the next ones."""
    for first in range(0, vectors[0].type.count, together):
        numbers = [WORD(first + place) for place in range(together)]
        places = ir.Constant(ir.VectorType(WORD, together), numbers)
        yield [builder.shuffle_vector(vector, vector, places) for vector in vectors]


def _joined(builder: ir.IRBuilder, parts: Sequence[ir.Value]) -> ir.Value:
    """Return vectors behind each other as one vector; their number is a power of two."""
    vectors = list(parts)
    while len(vectors) > 1:
        count = 2 * vectors[0].type.count
        places = ir.Constant(ir.VectorType(WORD, count), [WORD(place) for place in range(count)])
        vectors = [
            builder.shuffle_vector(one, other, places)
            for one, other in zip(vectors[::2], vectors[1::2], strict=True)
        ]
    return vectors[0]


def _any(builder: ir.IRBuilder, mask: ir.Value) -> ir.Value:
    """Return whether any bit of a mask is set."""
    name = f"llvm.vector.reduce.or.v{mask.type.count}i64"
    function = _declared(builder.module, name, INTEGER, [mask.type])
    return builder.icmp_signed("!=", builder.call(function, [mask]), INTEGER(0))


def _slow(builder: ir.IRBuilder, vectors: Sequence[ir.Value], exact: str) -> ir.Value:
    """Call the function on single numbers, lane by lane."""
    single = _declared(builder.module, exact, REAL, [REAL] * 3)
    kind = vectors[0].type
    result: ir.Value = ir.Constant(kind, ir.Undefined)
    for number in range(kind.count):
        lane = [builder.extract_element(vector, WORD(number)) for vector in vectors]
        result = builder.insert_element(result, builder.call(single, lane), WORD(number))
    return result
