/* a b + c, rounded once to the nearest number, in whole numbers. That of zig's library has rounded otherwise where the sum is near a
   power of two or subnormal. */
#include <stdint.h>

typedef unsigned __int128 Wide;
typedef struct { Wide digits; int exponent, negative; } Scaled; /* digits times two to the power of the exponent */
enum { TOP = 125 }; /* place of the first digit: two numbers have a sum, and what is lost below is less than any digit that counts */

static int first_place(Wide w) { /* of a number that is not zero */
  uint64_t high = (uint64_t)(w >> 64), low = (uint64_t)w;
  return high ? 127 - __builtin_clzll(high) : 63 - __builtin_clzll(low);
}

static Scaled scaled(Wide digits, int exponent, int negative) {
  int up = TOP - first_place(digits);
  return (Scaled){ digits << up, exponent - up, negative };
}

static Wide lowered(Wide w, int places) { /* digits that are lost leave a one in the last place */
  if (places == 0) return w;
  if (places > TOP) return 1;
  return w >> places | ((w << (128 - places)) != 0);
}

static uint64_t digits_of(double number, int *exponent) { /* of a finite one */
  uint64_t bits;
  __builtin_memcpy(&bits, &number, 8);
  uint64_t fraction = bits & ((1ull << 52) - 1);
  int field = (int)(bits >> 52 & 2047);
  *exponent = (field ? field : 1) - 1075;
  return field ? fraction | 1ull << 52 : fraction;
}

static double power(int exponent) { /* of two, of a normal number */
  uint64_t bits = (uint64_t)(exponent + 1023) << 52;
  double number;
  __builtin_memcpy(&number, &bits, 8);
  return number;
}

static double rounded(Scaled s) {
  int place = first_place(s.digits), lost = place - 52;
  if (lost < -1074 - s.exponent) lost = -1074 - s.exponent; /* the last place of subnormal numbers */
  if (lost > place + 1) return s.negative ? -0.0 : 0.0;
  Wide kept = lost > 0 ? s.digits >> lost : s.digits << -lost, half = lost > 0 ? (Wide)1 << (lost - 1) : 0;
  Wide rest = lost > 0 ? s.digits - (kept << lost) : 0;
  if (half && (rest > half || (rest == half && (kept & 1)))) kept++;
  int exponent = s.exponent + lost;
  double number = (double)(uint64_t)kept;
  for (; exponent < -1022; exponent += 1022) number *= power(-1022);
  for (; exponent > 1023; exponent -= 1023) number *= power(1023);
  number *= power(exponent);
  return s.negative ? -number : number;
}

double exact_fma(double a, double b, double c) {
  double none = a * 0.0 + b * 0.0; /* no number, where a factor is none or infinite */
  if (none != 0.0 || a == 0.0 || b == 0.0) return a * b + c;
  if (c * 0.0 != 0.0) return c;
  int of_a, of_b, of_c, negative = __builtin_signbit(a) != __builtin_signbit(b);
  Wide product = (Wide)digits_of(a, &of_a) * digits_of(b, &of_b), summand = digits_of(c, &of_c);
  Scaled one = scaled(product, of_a + of_b, negative);
  if (!summand) return rounded(one);
  Scaled other = scaled(summand, of_c, __builtin_signbit(c) != 0);
  if (one.exponent < other.exponent || (one.exponent == other.exponent && one.digits < other.digits)) {
    Scaled smaller = one;
    one = other;
    other = smaller;
  }
  Wide digits = lowered(other.digits, one.exponent - other.exponent);
  one.digits = one.negative == other.negative ? one.digits + digits : one.digits - digits;
  return one.digits ? rounded(one) : 0.0;
}
