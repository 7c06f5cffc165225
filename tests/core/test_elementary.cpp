// Our elementary functions: how true they are, against the C library's in 80 bits; what holds exactly; and
// that their bits are what they were when this was written, whatever processor, compiler and library this is.
#include <doctest/doctest.h>

#include <bit>
#include <cmath>
#include <complex>
#include <functional>
#include <limits>
#include <numbers>
#include <vector>

#include "core/fourier.h"
#include "core/hash.h"
#include "core/portable_math.h"
#include "intaglio/vec.h"

using namespace intaglio;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double none = std::numeric_limits<double>::quiet_NaN();
constexpr int count = 100'000;

// In units in the last place of what it should be.
double ulps(double got, long double wanted) {
  int exponent = 0;
  static_cast<void>(std::frexp(static_cast<double>(wanted), &exponent));
  return static_cast<double>(std::abs(static_cast<long double>(got) - wanted) /
                             std::ldexp(1.0L, std::max(exponent - 53, -1074)));
}

double worst(const std::function<double(Random&)>& draw, const std::function<double(double)>& ours,
             const std::function<long double(long double)>& theirs) {
  Random random(1);
  double most = 0;
  for (int k = 0; k < count; ++k) {
    const double x = draw(random), off = ulps(ours(x), theirs(x));
    // Also when it is not a number.
    if (!(off <= most)) most = off;
  }
  return most;
}

std::function<double(Random&)> even(double low, double high) {
  return [=](Random& random) { return random.uniform(low, high); };
}
std::function<double(Random&)> of_any_size(double low, double high) {
  return [=](Random& random) { return std::ldexp(random.uniform(1, 2), int(random.uniform(low, high))); };
}

std::uint64_t bits(double x) {
  return std::bit_cast<std::uint64_t>(x);
}

}  // namespace

TEST_CASE("elementary functions are true within an ulp or two") {
  // Elsewhere long double may be what double is, and says nothing.
  if (std::numeric_limits<long double>::digits < 64) return;
  const auto sin = [](long double x) { return std::sin(x); };
  const auto cos = [](long double x) { return std::cos(x); };
  for (const double range : {1e-5, 0.8, 7.0, 100.0, 1.5e6}) {
    CHECK(worst(even(-range, range), elementary::sin, sin) < 1.2);
    CHECK(worst(even(-range, range), elementary::cos, cos) < 1.2);
  }
  const auto beside_a_zero = [](Random& random) {
    return std::floor(random.uniform(0, 1e6)) * (std::numbers::pi / 2);
  };
  CHECK(worst(beside_a_zero, elementary::sin, sin) < 1.2);
  CHECK(worst(beside_a_zero, elementary::cos, cos) < 1.2);
  const auto exp = [](long double x) { return std::exp(x); };
  CHECK(worst(even(-1, 1), elementary::exp, exp) < 1);
  CHECK(worst(even(-740, 709), elementary::exp, exp) < 1.1);
  const auto log = [](long double x) { return std::log(x); };
  CHECK(worst(even(0.5, 2), elementary::log, log) < 1);
  CHECK(worst(of_any_size(-1070, 1023), elementary::log, log) < 1);
  for (const double y : {0.2, 1.1, 2.2, -1.5}) {
    const auto ours = [y](double x) { return elementary::pow(x, y); };
    const auto theirs = [y](long double x) { return std::pow(x, static_cast<long double>(y)); };
    CHECK(worst(even(0, 3), ours, theirs) < 1.2);
    CHECK(worst(of_any_size(-18, 18), ours, theirs) < 1.2);
  }
  CHECK(worst(of_any_size(-1070, 1023), elementary::cbrt, [](long double x) { return std::cbrt(x); }) < 1);
  CHECK(worst(even(-1, 1), elementary::acos, [](long double x) { return std::acos(x); }) < 2);
  for (const double y : {1.0, -3.7, 1e-3}) {
    const auto ours = [y](double x) { return elementary::atan2(y, x); };
    const auto theirs = [y](long double x) { return std::atan2(static_cast<long double>(y), x); };
    CHECK(worst(even(-10, 10), ours, theirs) < 2);
  }
  Random random(2);
  for (int k = 0; k < count; ++k) {
    const double x = random.uniform(-20, 20);
    CHECK_MESSAGE(std::abs(elementary::tanh(x) - std::tanh(static_cast<long double>(x))) < 3e-16, x);
  }
}

TEST_CASE("elementary functions at their ends") {
  CHECK(bits(elementary::sin(0.0)) == bits(0.0));
  CHECK(bits(elementary::sin(-0.0)) == bits(-0.0));
  CHECK(elementary::cos(0) == 1);
  CHECK(elementary::exp(0) == 1);
  CHECK(elementary::exp(-infinity) == 0);
  CHECK(elementary::exp(-746) == 0);
  CHECK(elementary::exp(710) == infinity);
  CHECK(elementary::exp(-745) == std::numeric_limits<double>::denorm_min());
  CHECK(bits(elementary::log(1)) == bits(0.0));
  CHECK(elementary::log(0) == -infinity);
  CHECK(elementary::log(infinity) == infinity);
  CHECK(elementary::pow(0, 0.2) == 0);
  CHECK(elementary::pow(0, 0) == 1);
  CHECK(elementary::pow(0, -1) == infinity);
  CHECK(elementary::pow(1, none) == 1);
  CHECK(elementary::pow(10, 400) == infinity);
  CHECK(elementary::pow(10, -400) == 0);
  CHECK(elementary::pow(infinity, -2) == 0);
  CHECK(elementary::cbrt(0) == 0);
  CHECK(elementary::cbrt(-27) == -3);
  CHECK(elementary::acos(1) == 0);
  CHECK(elementary::acos(-1) == std::numbers::pi);
  CHECK(elementary::tanh(infinity) == 1);
  for (const double y : {0.0, -0.0, 1.0, -1.0, infinity, -infinity})
    for (const double x : {0.0, -0.0, 1.0, -1.0, infinity, -infinity})
      CHECK(bits(elementary::atan2(y, x)) == bits(std::atan2(y, x)));
  // One not-a-number, whatever came in: hashes see its bits.
  for (const double x : {none, -none, infinity, -infinity}) {
    CHECK(bits(elementary::sin(x)) == bits(none));
    CHECK(bits(elementary::cos(x)) == bits(none));
    CHECK(bits(elementary::acos(x)) == bits(none));
  }
  for (const double x : {none, -none}) {
    CHECK(bits(elementary::exp(x)) == bits(none));
    CHECK(bits(elementary::log(x)) == bits(none));
    CHECK(bits(elementary::pow(x, 2)) == bits(none));
    CHECK(bits(elementary::cbrt(x)) == bits(none));
    CHECK(bits(elementary::atan2(x, 1)) == bits(none));
    CHECK(bits(elementary::tanh(x)) == bits(none));
  }
  CHECK(bits(elementary::log(-1)) == bits(none));
  CHECK(bits(elementary::pow(-1, 2)) == bits(none));
}

TEST_CASE("elementary functions have their symmetries to the bit") {
  Random random(3);
  for (int k = 0; k < count; ++k) {
    const double x = random.uniform(-1, 1) * (k % 2 == 0 ? 3 : 2e6), y = random.uniform(-3, 3);
    CHECK(bits(elementary::sin(-x)) == bits(-elementary::sin(x)));
    CHECK(bits(elementary::cos(-x)) == bits(elementary::cos(x)));
    CHECK(bits(elementary::cbrt(-x)) == bits(-elementary::cbrt(x)));
    CHECK(bits(elementary::tanh(-x)) == bits(-elementary::tanh(x)));
    CHECK(bits(elementary::atan2(-y, x)) == bits(-elementary::atan2(y, x)));
    const auto [s, c] = elementary::sin_cos(x);
    CHECK(bits(s) == bits(elementary::sin(x)));
    CHECK(bits(c) == bits(elementary::cos(x)));
    CHECK(bits(elementary::cbrt(8 * x)) == bits(2 * elementary::cbrt(x)));
  }
}

TEST_CASE("a Fourier transform is the sum that it stands for, and its inverse takes it back") {
  Random random(4);
  for (const int n : {1, 2, 3, 4, 5, 7, 8, 12, 30, 49, 64, 97, 120}) {
    std::vector<std::complex<double>> in, out(std::size_t(n), 0), back(std::size_t(n), 0);
    for (int k = 0; k < n; ++k) in.emplace_back(random.uniform(-1, 1), random.uniform(-1, 1));
    Fourier<double>(n, false)(out.data(), in.data());
    Fourier<double>(n, true)(back.data(), out.data());
    for (int k = 0; k < n; ++k) {
      std::complex<double> sum = 0;
      for (int j = 0; j < n; ++j)
        sum += in[std::size_t(j)] * std::polar(1.0, -2 * std::numbers::pi * ((j * k) % n) / n);
      CHECK(std::abs(out[std::size_t(k)] - sum) < 1e-13 * n);
      CHECK(std::abs(back[std::size_t(k)] - in[std::size_t(k)]) < 1e-15 * n);
    }
  }
}

TEST_CASE("rotations by an angle are Eigen's") {
  Random random(5);
  for (int k = 0; k < 1000; ++k) {
    const Vec3 axis = Vec3(random.normal(), random.normal(), random.normal()).normalized();
    const double angle = random.uniform(0, std::numbers::pi);
    const Quat turn = rotation(angle, axis), theirs(Eigen::AngleAxisd(angle, axis));
    CHECK((turn.coeffs() - theirs.coeffs()).norm() < 1e-15);
    CHECK((rotation(Vec3(angle * axis)).coeffs() - theirs.coeffs()).norm() < 1e-15);
    const Quat from = Quat(random.normal(), random.normal(), random.normal(), random.normal()).normalized();
    CHECK(std::abs(angle_between(from, from * turn) - angle) < 1e-14);
    const double share = random.uniform();
    const Quat part = between(from, from * turn, share);
    CHECK((part.coeffs() - from.slerp(share, from * turn).coeffs()).norm() < 1e-14);
    // The shorter way, whichever of its two signs a quaternion has.
    Quat other = from * turn;
    other.coeffs() *= -1;
    CHECK(angle_between(part, between(from, other, share)) < 1e-7);
  }
  CHECK(rotation(Vec3::Zero()).isApprox(Quat::Identity()));
  CHECK(between(Quat::Identity(), Quat::Identity(), 0.3).isApprox(Quat::Identity()));
}

TEST_CASE("elementary functions have the bits that they had when this was written") {
  Hash hash;
  Random random(6);
  for (int k = 0; k < 2 * count; ++k) {
    const double x = random.uniform(-20, 20), size = std::ldexp(random.uniform(1, 2), k % 200 - 100);
    for (const double value :
         {elementary::sin(x), elementary::cos(x * size), elementary::exp(x), elementary::log(size),
          elementary::pow(size, 0.1 * x), elementary::cbrt(size), elementary::atan2(x, size),
          elementary::acos(0.05 * x), elementary::tanh(x), elementary::hypot(x, size), random.normal()})
      hash.add(value);
  }
  MESSAGE("hash of elementary functions: " << hash.value());
  CHECK(hash.value() == 0xb040061be1d5daaa);
}
