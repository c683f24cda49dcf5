"""Fused multiply-add for processors that have none, as instructions in the place of the call.

WebAssembly has no instruction that is a fused multiply-add on every processor. :func:`fast_sum`
writes one from sums and products alone. With the error e of a product and u of a sum, both exact
(Dekker 1971, Knuth),

    a b + c = p + e + c = s + u + e,     p = fl(a b),  s = fl(p + c),

the result is r = fl(s + fl(u + e)). It is rounded twice, and yet right unless fl(u + e) is where
the rounding of s + u + e turns: halfway between two numbers, which is a multiple of a quarter of
the distance of numbers at s, and no more than six of them. Of such a number the last 50 bits are
zero. What may be wrong is therefore seen in the numbers themselves:

- u + e has a word of zeros at its end, and e is not zero (else u + e is exact), or it is no number
  after an overflow;
- s is so small that e may have been below the smallest number.

Both are words of few values, so that the least word of several numbers is looked at once. It goes
to a second look, and from there to the function ``exact_fma`` of ``fma.h``, exact and slow. A
product with factors 1, -1 and 0 is exact, and needs none of this (:func:`define_sum`).
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import reduce

from llvmlite import ir

REAL, INTEGER, WORD = ir.DoubleType(), ir.IntType(64), ir.IntType(32)

_LOW_BITS = 27
"""Bits of a significand that the upper half of a factor leaves out: 26 and 26 remain."""
_LEAST_PRODUCT = 2.0**-959
"""From here on the error of a product is no subnormal number."""
_LEAST_SUM = 2.0**-899
"""From here on a product that is less than the least one changes no rounding of the sum."""
_EXPONENT_OF_LEAST = (1023 - 900) << 20
"""Upper word of half the least sum."""
RELAXED = "relaxed_madd"
"""Stands for the multiply-add of relaxed vectors."""
_GROUP = 2
"""Registers whose numbers are looked at together; arguments of a call are in six."""


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
        whole = _whole(kind.count)
        builder = self.builder
        bits = builder.bitcast(self.value, whole)
        rounded = builder.add(bits, _all(whole, 1 << (_LOW_BITS - 1)))
        return self.made(builder.bitcast(builder.and_(rounded, _all(whole, -1 << _LOW_BITS)), kind))


@dataclass(frozen=True)
class FastSum:
    """A multiply-add that may be wrong, and what tells where.

    Parameters
    ----------
    result : WideNumber
        The sum.
    product, lost : WideNumber
        Product of the factors, and minus its error.
    total, rest : WideNumber
        Sum of product and summand, and minus what is missing in it.
    """

    result: WideNumber
    product: WideNumber
    lost: WideNumber
    total: WideNumber
    rest: WideNumber

    def words(self) -> ir.Value:
        """Return pairs of 32-bit words, one of which is small where the sum may be wrong."""
        builder = self.result.builder
        count = self.result.value.type.count
        words = ir.VectorType(WORD, 2 * count)
        nothing = self.rest - self.rest  # or no number
        is_exact = builder.sext(
            builder.fcmp_ordered("==", self.lost.value, nothing.value), _whole(count)
        )
        low = builder.or_(builder.bitcast(self.rest.value, _whole(count)), is_exact)
        places = [WORD(at) for number in range(0, 2 * count, 2) for at in (number, number + 1)]
        places[1::2] = [WORD(2 * count + number) for number in range(1, 2 * count, 2)]
        mixed = ir.Constant(words, places)
        high = builder.bitcast(self.total.magnitude().value, words)
        return builder.shuffle_vector(builder.bitcast(low, words), high, mixed)

    def doubt(self, a: WideNumber, b: WideNumber, c: WideNumber) -> ir.Value:
        """Return where it may be wrong, for factors ``a``, ``b`` and a summand ``c``."""
        builder = a.builder
        zero = a.filled(0.0)
        whole = _whole(a.value.type.count)
        low = builder.and_(builder.bitcast(self.rest.value, whole), _all(whole, (1 << 32) - 1))
        is_inexact = self.lost.differs(self.rest - self.rest)  # or after an overflow
        turns = a.made(builder.icmp_signed("==", low, _all(whole, 0))) & is_inexact
        tiny = (self.total.magnitude() < a.filled(_LEAST_SUM)) & (
            self.product.magnitude() < a.filled(_LEAST_PRODUCT)
        )
        tiny = tiny & a.differs(zero) & b.differs(zero)
        # where product or summand is no number, the result is none, and right
        are_numbers = a.made(builder.fcmp_ordered("ord", self.product.value, c.value))
        return ((turns | tiny) & are_numbers).value


def fast_sum(a: WideNumber, b: WideNumber, c: WideNumber) -> FastSum:
    """Write ``a b + c``, rounded once but where :class:`FastSum` tells.

    Parameters
    ----------
    a, b, c : WideNumber
        Factors and summand.

    Returns
    -------
    FastSum
        The sums.
    """
    a_high, b_high = a.upper_half(), b.upper_half()
    a_low, b_low = a - a_high, b - b_high
    product = a * b
    middle = a_low * b_high + a_high * b_low
    # minus the error of the product, every step of it exact
    lost = product - a_high * b_high - middle - a_low * b_low
    total = product + c
    part = total - product
    # minus the error of the sum; +0 where there is none, so that a zero keeps its sign
    rest = (part - c) + ((total - part) - product) + lost
    return FastSum(total - rest, product, lost, total, rest)


def define_fused(module: ir.Module, name: str, lanes: int, exact: str, together: int) -> None:
    """Add a function ``name(a, b, c)`` on vectors to a module: ``a b + c`` rounded once.

    The instructions stand once in the module, for as many numbers as two registers of the host
    hold: set into every place they would make it larger by more than a half, and not faster.

    Parameters
    ----------
    module : llvmlite.ir.Module
        The module.
    name : str
        Name of the function.
    lanes : int
        Numbers in a vector.
    exact : str
        Name of a function of the same on three single numbers, for what is not certain.
    together : int
        Numbers in a register of the host; ``lanes`` is a multiple of it.
    """
    group = min(lanes, together * (_GROUP if together > 1 else 1))
    called = module.globals.get(f"fused_group_{group}") or _group(module, group, exact, together)
    function, builder = _begun(module, name, ir.VectorType(REAL, lanes))
    function.attributes.add("alwaysinline")
    results = [builder.call(called, values) for values in _cut(builder, function.args, group)]
    builder.ret(_joined(builder, results))


def define_sum(module: ir.Module, name: str, lanes: int) -> None:
    """Add a function as that of :func:`define_fused`, for products that are exact.

    Parameters
    ----------
    module, name, lanes
        As for :func:`define_fused`.
    """
    function, builder = _begun(module, name, ir.VectorType(REAL, lanes))
    function.attributes.add("alwaysinline")
    a, b, c = (WideNumber(builder, value) for value in function.args)
    builder.ret((a * b + c).value)


def _group(module: ir.Module, lanes: int, exact: str, together: int) -> ir.Function:
    """Add the function that all others call: some registers, looked at together."""
    function, builder = _begun(module, f"fused_group_{lanes}", ir.VectorType(REAL, lanes))
    function.attributes.add("noinline")
    numbers = [
        [WideNumber(builder, value) for value in values]
        for values in _cut(builder, function.args, together)
    ]
    sums = [fast_sum(*values) for values in numbers]
    result = _joined(builder, [one.result.value for one in sums])
    with builder.if_then(_is_small(builder, [one.words() for one in sums])):
        doubt = [one.doubt(*values) for one, values in zip(sums, numbers, strict=True)]
        wide = [builder.sext(one, _whole(together)) for one in doubt]
        with builder.if_then(_any(builder, reduce(builder.or_, wide)), likely=False):
            builder.ret(_slow(builder, function.args, exact))
    builder.ret(result)
    return function


def _is_small(builder: ir.IRBuilder, words: Sequence[ir.Value]) -> ir.Value:
    """Return whether any first word of a pair is 0, or any second one that of a small number."""
    kind = words[0].type
    name = f"llvm.umin.v{kind.count}i32"
    least = _declared(builder.module, name, kind, [kind, kind])
    smallest = reduce(lambda one, other: builder.call(least, [one, other]), words)
    bounds = [WORD(bound) for _ in range(kind.count // 2) for bound in (1, _EXPONENT_OF_LEAST)]
    is_small = builder.icmp_unsigned("<", smallest, ir.Constant(kind, bounds))
    return _any(builder, builder.bitcast(builder.sext(is_small, kind), _whole(kind.count // 2)))


def define_relaxed(module: ir.Module, name: str, lanes: int, exact: str, together: int) -> None:
    """Add the function of :func:`define_fused`, written with the multiply-add of relaxed vectors.

    It rounds once where the processor has such an instruction. WebAssembly leaves it to the host,
    which makes one choice for all its modules; who runs the code has to look at it first. It
    stands as a call of :data:`RELAXED`, for which the instruction is put into the assembly: LLVM
    does not know then that there are relaxed vectors. It would use them for the larger and smaller
    of two numbers too, and hosts do not agree on that of 0 and -0.

    Parameters
    ----------
    module, name, lanes, exact, together
        As for :func:`define_fused`; ``together`` is 2, and ``exact`` is not called.
    """
    part = ir.VectorType(REAL, together)
    instruction = _declared(module, RELAXED, part, [part] * 3)
    instruction.attributes.add("nounwind")
    instruction.attributes.add("readnone")
    function, builder = _begun(module, name, ir.VectorType(REAL, lanes))
    function.attributes.add("alwaysinline")
    cut = _cut(builder, function.args, together)
    builder.ret(_joined(builder, [builder.call(instruction, values) for values in cut]))


def _whole(count: int) -> ir.VectorType:
    return ir.VectorType(INTEGER, count)


def _all(kind: ir.VectorType, number: int) -> ir.Constant:
    """Return the same whole number in all lanes."""
    return ir.Constant(kind, [ir.Constant(INTEGER, number)] * kind.count)


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
