#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "core/portable_math.h"
#include "surface/fuse.h"
#include "surface/import.h"
#include "surface/maps.h"
#include "surface/recipes/builtin.h"

using namespace intaglio;
using namespace intaglio::surface;

namespace {

constexpr int known_size = 512;

// A known surface: height in texels, 0 at its lowest, and its slopes.
struct Known {
  Field height{known_size, known_size};
  Slopes slopes{Field(known_size, known_size), Field(known_size, known_size)};
  double range = 0;  // texels
};

// A sum of waves of up to `cycles` a side, seamless, of a range of `relief` sides.
Known waves(int cycles, double relief, std::uint64_t seed) {
  Random random(seed);
  struct Wave {
    double kx, ky, level, phase;
  };
  std::vector<Wave> all;
  while (all.size() < 24) {
    const double kx = std::round(random.uniform(-cycles, cycles));
    const double ky = std::round(random.uniform(-cycles, cycles));
    if (std::hypot(kx, ky) >= 1 && std::hypot(kx, ky) <= cycles)
      all.push_back({kx, ky, random.uniform(0.3, 1), random.uniform(0, 6.28)});
  }
  Known out;
  const double tau = 2 * std::numbers::pi / known_size;
  for (int y = 0; y < known_size; ++y) {
    for (int x = 0; x < known_size; ++x) {
      double h = 0, sx = 0, sy = 0;
      for (const Wave& w : all) {
        const double at = tau * (w.kx * x + w.ky * y) + w.phase;
        h += w.level * std::sin(at);
        sx += w.level * tau * w.kx * std::cos(at);
        sy += w.level * tau * w.ky * std::cos(at);
      }
      out.height.at(x, y) = float(h);
      out.slopes.x.at(x, y) = float(sx);
      out.slopes.y.at(x, y) = float(sy);
    }
  }
  const auto [low, high] = std::minmax_element(out.height.value.begin(), out.height.value.end());
  const double factor = relief * known_size / double(*high - *low);
  const float lowest = *low;
  for (float& h : out.height.value) h -= lowest;
  scale(out.height, factor);
  scale(out.slopes, factor);
  out.range = relief * known_size;
  return out;
}

Known brick(double relief) {
  BrickRecipe recipe;
  recipe.size = known_size;
  const TextureImages images = make_brick(recipe);
  Known out;
  out.range = relief * known_size;
  for (int y = 0; y < known_size; ++y) {
    for (int x = 0; x < known_size; ++x)
      out.height.at(x, known_size - 1 - y) = float((1 - images.relief.at(x, y, 3) / 65535.0) * out.range);
  }
  Field unit = out.height;
  scale(unit, 1 / out.range);
  out.slopes = central_slopes(unit, relief);
  return out;
}

double rms(const std::vector<float>& a, const std::vector<float>& b, bool without_mean) {
  double sum = 0, mean = 0;
  for (std::size_t k = 0; k < a.size(); ++k) mean += double(a[k] - b[k]);
  mean = without_mean ? mean / double(a.size()) : 0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += std::pow(double(a[k] - b[k]) - mean, 2);
  return std::sqrt(sum / double(a.size()));
}

double slope_rms(const Slopes& a, const Slopes& b) {
  return std::hypot(rms(a.x.value, b.x.value, false), rms(a.y.value, b.y.value, false));
}

struct Gains {
  double height, slope;      // over the depth alone
  double height_n, slope_n;  // over the normals alone
};

// The result of fusion when both maps of the surface have 8 bits.
Gains gains(const std::string& name, const Known& known) {
  Field h8 = known.height;
  for (float& h : h8.value) h = float(std::round(double(h) / known.range * 255) / 255 * known.range);
  Slopes s8{Field(known_size, known_size), Field(known_size, known_size)};
  for (std::size_t k = 0; k < s8.x.value.size(); ++k) {
    Vec3 normal = Vec3(-double(known.slopes.x.value[k]), -double(known.slopes.y.value[k]), 1).normalized();
    for (int c = 0; c < 3; ++c) normal[c] = std::round((0.5 * normal[c] + 0.5) * 255) / 127.5 - 1;
    s8.x.value[k] = float(-normal.x() / normal.z());
    s8.y.value[k] = float(-normal.y() / normal.z());
  }
  const Fused fused = fuse({h8, s8, known.range / 255, 2.0 / 255, FuseEdge::periodic});
  const Fused normals_only = fuse({{}, s8, 0, 2.0 / 255, FuseEdge::periodic});
  Field unit = h8;
  scale(unit, 1 / known.range);
  const Slopes depth_slopes = central_slopes(unit, known.range / known_size);
  const double height = rms(fused.height.value, known.height.value, false);
  const double slope = slope_rms(fused.slopes, known.slopes);
  const Gains out{rms(h8.value, known.height.value, false) / height,
                  slope_rms(depth_slopes, known.slopes) / slope,
                  rms(normals_only.height.value, known.height.value, true) /
                      rms(fused.height.value, known.height.value, true),
                  slope_rms(s8, known.slopes) / slope};
  MESSAGE(name << ": gain over depth alone: height " << out.height << ", slope " << out.slope
               << "; over normals alone: height " << out.height_n << ", slope " << out.slope_n << "; lambda "
               << fused.lambda);
  return out;
}

}  // namespace

TEST_CASE("the transform of an impulse is flat, Parseval holds, and the inverse undoes it") {
  for (const auto& [w, h] : {std::pair{16, 16}, {30, 14}, {37, 53}}) {
    Random random(5);
    std::vector<std::complex<float>> data(std::size_t(w) * std::size_t(h));
    for (auto& v : data) v = {float(random.normal()), float(random.normal())};
    auto copy = data;
    fft2(copy, w, h, Transform::forward);
    double before = 0, after = 0;
    for (const auto& v : data) before += std::norm(v);
    for (const auto& v : copy) after += std::norm(v);
    CHECK(after / (w * h) == doctest::Approx(before).epsilon(1e-4));
    fft2(copy, w, h, Transform::inverse);
    for (std::size_t k = 0; k < data.size(); ++k) CHECK(std::abs(copy[k] - data[k]) < 1e-4);
    std::vector<std::complex<float>> impulse(data.size());
    impulse[0] = 1;
    fft2(impulse, w, h, Transform::forward);
    for (const auto& v : impulse) CHECK(std::abs(v - std::complex<float>(1, 0)) < 1e-4);
  }
}

TEST_CASE("fusion of 8-bit maps is never worse than either map alone") {
  const Gains smooth = gains("16 cycles, relief 4 %", waves(16, 0.04, 1));
  const Gains fine = gains("60 cycles, relief 1.4 %", waves(60, 0.014, 2));
  const Gains wall = gains("brick, relief 2.2 %", brick(0.022));
  for (const Gains& g : {smooth, fine, wall}) {
    CHECK(g.height >= 1);
    CHECK(g.slope >= 1);
    CHECK(g.height_n >= 1);
    CHECK(g.slope_n >= 1);
  }
  CHECK(smooth.height >= 5);
  CHECK(smooth.slope >= 8);
}

TEST_CASE("normals alone, at 8 bits, are integrated within 1 % of the range") {
  for (const Known& known : {waves(16, 0.04, 3), waves(60, 0.014, 4), brick(0.022)}) {
    Slopes s8 = known.slopes;
    for (std::size_t k = 0; k < s8.x.value.size(); ++k) {
      Vec3 normal = Vec3(-double(s8.x.value[k]), -double(s8.y.value[k]), 1).normalized();
      for (int c = 0; c < 3; ++c) normal[c] = std::round((0.5 * normal[c] + 0.5) * 255) / 127.5 - 1;
      s8.x.value[k] = float(-normal.x() / normal.z());
      s8.y.value[k] = float(-normal.y() / normal.z());
    }
    const Fused fused = fuse({{}, s8, 0, 2.0 / 255, FuseEdge::periodic});
    const double error = rms(fused.height.value, known.height.value, true) / known.range;
    MESSAGE("normals alone: error " << 100 * error << " % of the range, curl " << fused.curl);
    CHECK(error < 0.01);
  }
}

TEST_CASE("a mirrored tile keeps its mean slope, which a periodic one cannot have") {
  Slopes ramp{Field(64, 64), Field(64, 64)};
  std::fill(ramp.x.value.begin(), ramp.x.value.end(), 0.3f);
  const Fused mirrored = fuse({{}, ramp, 0, 0, FuseEdge::mirrored});
  CHECK(mirrored.height.at(60, 10) - mirrored.height.at(4, 10) == doctest::Approx(0.3 * 56).epsilon(0.02));
  const Fused periodic = fuse({{}, ramp, 0, 0, FuseEdge::periodic});
  CHECK(std::abs(periodic.height.at(60, 10) - periodic.height.at(4, 10)) < 1e-3);
  CHECK(periodic.mean_slope_x == doctest::Approx(0.3));
}

TEST_CASE("rotational slopes are reported as curl, and slopes of a height have none") {
  Slopes swirl{Field(64, 64), Field(64, 64)};
  const double tau = 2 * std::numbers::pi / 64;
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      swirl.x.at(x, y) = float(-std::sin(tau * y));
      swirl.y.at(x, y) = float(std::sin(tau * x));
    }
  }
  const Fused swirled = fuse({{}, swirl, 0, 0, FuseEdge::periodic});
  CHECK(swirled.curl == doctest::Approx(1).epsilon(1e-3));
  CHECK(rms(swirled.height.value, std::vector<float>(64 * 64, 0.0f), false) < 1e-3);
  CHECK(fuse({{}, waves(16, 0.04, 9).slopes, 0, 0, FuseEdge::periodic}).curl < 1e-3);
}
