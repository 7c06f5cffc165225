#include "core/portable_math.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace intaglio::elementary {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// A number as the sum of two doubles: `low` holds the rounding error of `high`.
struct Pair {
  double high, low;
};

// a + b, exact for any magnitudes (Knuth).
inline Pair sum(double a, double b) {
  const double s = a + b, b_virtual = s - a;
  return {s, (a - (s - b_virtual)) + (b - b_virtual)};
}

// a b, exact while nothing overflows: split into halves of 26 bits (Dekker, Veltkamp).
inline Pair product(double a, double b) {
  constexpr double splitter = 0x1p27 + 1;
  const double a_cut = splitter * a, b_cut = splitter * b;
  const double a_high = a_cut - (a_cut - a), b_high = b_cut - (b_cut - b);
  const double a_low = a - a_high, b_low = b - b_high, p = a * b;
  return {p, ((a_high * b_high - p) + a_high * b_low + a_low * b_high) + a_low * b_low};
}

// The nearest integer, |x| < 2^51.
inline double nearest(double x) {
  constexpr double big = 0x1.8p52;
  return (x + big) - big;
}

// Sum of c[k] x^k by pairs, pairs of pairs and so on: a short chain of operations, always in the same order.
template <std::size_t count>
inline double polynomial(const std::array<double, count>& c, double x) {
  if constexpr (count == 1) {
    return c[0];
  } else {
    std::array<double, (count + 1) / 2> pairs;
    for (std::size_t k = 0; k < count / 2; ++k) pairs[k] = c[2 * k] + x * c[2 * k + 1];
    if constexpr (count % 2 == 1) pairs[count / 2] = c[count - 1];
    return polynomial(pairs, x * x);
  }
}

constexpr double factorial(int n) {
  return n == 0 ? 1 : n * factorial(n - 1);
}
template <std::size_t count, class Make>
constexpr std::array<double, count> series(Make make) {
  std::array<double, count> out{};
  for (std::size_t k = 0; k < count; ++k) out[k] = make(int(k));
  return out;
}
constexpr double alternating(int k) {
  return k % 2 == 0 ? 1 : -1;
}

// Taylor series, truncated below a thousandth of an ulp.
// (sin x - x) / x^3 and (cos x - 1 + x^2/2) / x^4 in x^2, |x| < pi/4
constexpr auto sine = series<8>([](int k) { return -alternating(k) / factorial(2 * k + 3); });
constexpr auto cosine = series<8>([](int k) { return alternating(k) / factorial(2 * k + 4); });
// (e^x - 1 - x) / x^2, |x| < ln 2 / 2
constexpr auto exponential = series<13>([](int k) { return 1 / factorial(k + 2); });
// (2 artanh(s) - 2 s) / s^3 in s^2, |s| < 0.172
constexpr auto artanh = series<11>([](int k) { return 2.0 / (2 * k + 3); });
// (atan t - t) / t^3 in t^2, |t| < 1/16
constexpr auto arctangent = series<7>([](int k) { return -alternating(k) / (2 * k + 3); });

// pi/2 in three parts and ln 2 in two; the first ones have so few bits that their integer multiples are
// exact.
constexpr double half_pi[3] = {0x1.921fb544p+0, 0x1.0b4611a6p-34, 0x1.3198a2e037073p-69};
constexpr Pair ln_2 = {0x1.62e42fefa38p-1, 0x1.ef35793c7673p-45};
constexpr double reduction_limit = 1.6e6;  // radians: fewer than 2^20 quarter turns

// An angle as a multiple of a quarter turn, modulo 4, and the remainder.
struct Reduced {
  int quarter;
  Pair remainder;
};

Reduced reduce(double x) {
  if (std::abs(x) <= 0.785) return {0, {x, 0}};
  constexpr double two_over_pi = 0x1.45f306dc9c883p-1, two_pi = 0x1.921fb54442d18p+2;
  if (!(std::abs(x) < reduction_limit)) x = std::isfinite(x) ? std::fmod(x, two_pi) : nan;
  if (std::isnan(x)) return {0, {nan, nan}};
  const double n = nearest(x * two_over_pi);
  const Pair difference = sum(x - n * half_pi[0], -n * half_pi[1]);
  return {int(std::int64_t(n) & 3), sum(difference.high, difference.low - n * half_pi[2])};
}

inline double sine_of(const Pair& x) {
  if (x.high == 0) return x.high;  // keeps the sign of zero
  const double square = x.high * x.high;
  return x.high + (x.high * square * polynomial(sine, square) + x.low * (1 - 0.5 * square));
}

inline double cosine_of(const Pair& x) {
  const double square = x.high * x.high, half = 0.5 * square, estimate = 1 - half;
  return estimate +
         (((1 - estimate) - half) + (square * square * polynomial(cosine, square) - x.high * x.low));
}

// x 2^n.
inline double ldexp_fast(double x, int n) {
  if (n < -1022 || n > 1023) return std::ldexp(x, n);
  return x * std::bit_cast<double>(std::uint64_t(n + 1023) << 52);
}

double exp_of(const Pair& x) {
  if (std::isnan(x.high)) return nan;
  if (x.high > 709.8) return infinity;
  if (x.high < -745.2) return 0;
  constexpr double inv_ln2 = 0x1.71547652b82fep+0;  // 1 / ln 2
  const double n = nearest(x.high * inv_ln2);
  const Pair remainder = sum(x.high - n * ln_2.high, x.low - n * ln_2.low);
  const double r = remainder.high;
  return ldexp_fast(1 + (r + (remainder.low + r * r * polynomial(exponential, r))), int(n));
}

// x = m 2^n with m from sqrt(1/2) to sqrt(2); x is positive and finite, normal or not.
struct Normalised {
  double m, n;
};

Normalised normalised(double x) {
  double n = 0;
  if (x < std::numeric_limits<double>::min()) {
    x *= 0x1p54;
    n = -54;
  }
  // Subtracting the bits of sqrt(1/2) leaves n in the exponent field.
  constexpr std::uint64_t start = 0x3fe6a09e667f3bcd;
  const auto bits = std::bit_cast<std::uint64_t>(x) - start;
  const auto exponent = std::int64_t(bits) >> 52;
  return {std::bit_cast<double>((bits & 0xfffffffffffffull) + start), n + double(exponent)};
}

// log x to about 58 bits; x is positive and finite.
Pair log_of(double x) {
  const auto [m, n] = normalised(x);
  const double f = m - 1;
  const Pair below = sum(2, f);
  const double s = f / below.high, square = s * s;
  const Pair back = product(s, below.high);
  const double s_low = (((f - back.high) - back.low) - s * below.low) / below.high;
  const Pair large = sum(n * ln_2.high, 2 * s);
  return sum(large.high, large.low + (2 * s_low + n * ln_2.low + s * square * polynomial(artanh, square)));
}

// atan(k/8), with its rounding error.
constexpr Pair atan_eighths[9] = {{0, 0},
                                  {0x1.fd5ba9aac2f6ep-4, -0x1.cd37686760c17p-59},
                                  {0x1.f5b75f92c80ddp-3, 0x1.8ab6e3cf7afbdp-57},
                                  {0x1.6f61941e4def1p-2, -0x1.c63aae6f6e918p-56},
                                  {0x1.dac670561bb4fp-2, 0x1.a2b7f222f65e2p-56},
                                  {0x1.1e00babdefeb4p-1, -0x1.928df287a668fp-58},
                                  {0x1.4978fa3269ee1p-1, 0x1.2419a87f2a458p-56},
                                  {0x1.700a7c5784634p-1, -0x1.8c34d25aadef6p-56},
                                  {0x1.921fb54442d18p-1, 0x1.1a62633145c07p-55}};

// a - b
inline Pair subtract(const Pair& a, const Pair& b) {
  const Pair d = sum(a.high, -b.high);
  return {d.high, d.low + (a.low - b.low)};
}

}  // namespace

SinCos sin_cos(double x) {
  const auto [quarter, remainder] = reduce(x);
  const double s = sine_of(remainder), c = cosine_of(remainder);
  switch (quarter) {
    case 0:
      return {s, c};
    case 1:
      return {c, -s};
    case 2:
      return {-s, -c};
    default:
      return {-c, s};
  }
}

double sin(double x) {
  const auto [quarter, remainder] = reduce(x);
  const double value = quarter % 2 == 0 ? sine_of(remainder) : cosine_of(remainder);
  return quarter < 2 ? value : -value;
}

double cos(double x) {
  const auto [quarter, remainder] = reduce(x);
  const double value = quarter % 2 == 0 ? cosine_of(remainder) : sine_of(remainder);
  return quarter == 0 || quarter == 3 ? value : -value;
}

double exp(double x) {
  return exp_of({x, 0});
}

double log(double x) {
  if (std::isnan(x) || x < 0) return nan;
  if (x == 0) return -infinity;
  if (x == infinity) return infinity;
  // log m = 2 artanh(s) = f - s (f - R) = f - (f^2/2 - s (f^2/2 + R)), as 2 s = f - s f: only small terms are
  // rounded before the last sum.
  const auto [m, n] = normalised(x);
  const double f = m - 1, s = f / (2 + f), square = s * s, half = 0.5 * f * f;
  const double remainder = square * polynomial(artanh, square);
  return n * ln_2.high + (f - (half - (s * (half + remainder) + n * ln_2.low)));
}

double pow(double x, double y) {
  if (y == 0 || x == 1) return 1;
  if (std::isnan(x) || std::isnan(y) || x < 0) return nan;
  if (x == 0) return y > 0 ? 0 : infinity;
  if (x == infinity) return y > 0 ? infinity : 0;
  const Pair log_x = log_of(x);
  const double estimate = y * log_x.high;
  if (!(std::abs(estimate) < 800)) return estimate > 0 ? infinity : 0;
  const Pair exponent = product(y, log_x.high);
  return exp_of({exponent.high, exponent.low + y * log_x.low});
}

double cbrt(double x) {
  if (std::isnan(x)) return nan;
  if (x == 0 || !std::isfinite(x)) return x;
  auto [m, n] = normalised(std::abs(x));
  const double thirds = std::floor(n / 3);
  m = ldexp_fast(m, int(n - 3 * thirds));
  // One Newton step, with the residual in double-double.
  const double y = exp_of({log_of(m).high / 3, 0});
  const Pair square = product(y, y), cube = product(square.high, y);
  const double residual = ((cube.high - m) + cube.low) + square.low * y;
  return std::copysign(ldexp_fast(y - residual / (3 * square.high), int(thirds)), x);
}

double atan2(double y, double x) {
  if (std::isnan(x) || std::isnan(y)) return nan;
  double a = std::abs(y), b = std::abs(x);
  if (std::isinf(a) || std::isinf(b)) {
    a = std::isinf(a) ? 1 : 0;
    b = std::isinf(b) ? 1 : 0;
  }
  const bool is_steep = a > b;
  const double low = is_steep ? b : a, high = is_steep ? a : b;
  Pair angle{0, 0};
  if (high > 0) {
    // atan(q) = atan(k/8) + atan((q - k/8) / (1 + q k/8))
    const double k = nearest(8 * (low / high));
    const Pair back = product(0.125 * k, high);
    const double t = ((low - back.high) - back.low) / (high + 0.125 * k * low), square = t * t;
    const Pair& eighth = atan_eighths[std::size_t(k)];
    const double correction = t * square * polynomial(arctangent, square);
    angle = k == 0 ? Pair{t, correction} : Pair{eighth.high, t + (eighth.low + correction)};
  }
  constexpr Pair half_pi_pair = {0x1.921fb54442d18p+0, 0x1.1a62633145c07p-54};
  constexpr Pair pi = {2 * half_pi_pair.high, 2 * half_pi_pair.low};
  if (is_steep) angle = subtract(half_pi_pair, angle);
  if (std::signbit(x)) angle = subtract(pi, angle);
  return std::copysign(angle.high + angle.low, y);
}

double acos(double x) {
  if (!(std::abs(x) <= 1)) return nan;
  return atan2(std::sqrt((1 - x) * (1 + x)), x);
}

double tanh(double x) {
  if (std::isnan(x)) return nan;
  return std::copysign(1 - 2 / (exp(2 * std::abs(x)) + 1), x);
}

}  // namespace intaglio::elementary
