#include "intaglio/surface/brick.h"

#include <algorithm>
#include <cmath>

#include "intaglio/core/vec.h"
#include "intaglio/surface/noise.h"

namespace intaglio::surface {

namespace {

double smoothstep(double low, double high, double x) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

// One point of the tile, described: which brick it belongs to and how it lies in it.
struct Spot {
  int column, row;
  double inside;  // signed distance to the outline of the brick's foot, fraction of the side, > 0 on the brick
  double across, along;  // -1..1 over the brick
};

Spot locate(const BrickRecipe& r, double u, double v) {
  // A slow warp makes the outlines hand-laid; the fine one chips them.
  const double warp_u = 0.0022 * periodic_fractal(u, v, 9, 3, 0.5, r.seed + 100) + 0.0012 * periodic_fractal(u, v, 40, 2, 0.6, r.seed + 300);
  const double warp_v = 0.0022 * periodic_fractal(u, v, 9, 3, 0.5, r.seed + 200) + 0.0012 * periodic_fractal(u, v, 40, 2, 0.6, r.seed + 400);
  const double y = (v + warp_v) * r.rows;
  const int row = static_cast<int>(std::floor(y));
  const double x = (u + warp_u) * r.columns + ((row & 1) != 0 ? 0.5 : 0.0);
  const int column = static_cast<int>(std::floor(x));
  const double half_u = 0.5 / r.columns;
  const double half_v = 0.5 / r.rows;
  const double from_middle_u = (x - column - 0.5) / r.columns;
  const double from_middle_v = (y - row - 0.5) / r.rows;
  // Signed distance to a rounded rectangle.
  const double qu = std::abs(from_middle_u) - (half_u - 0.5 * r.joint - r.corner_radius);
  const double qv = std::abs(from_middle_v) - (half_v - 0.5 * r.joint - r.corner_radius);
  const double outside = std::hypot(std::max(qu, 0.0), std::max(qv, 0.0)) + std::min(std::max(qu, qv), 0.0) - r.corner_radius;
  const auto wrap = [](int i, int n) { return ((i % n) + n) % n; };
  return {wrap(column, r.columns), wrap(row, r.rows), -outside, from_middle_u / half_u, from_middle_v / half_v};
}

// Depth in 0..1, 0 = top.
double brick_depth(const BrickRecipe& r, double u, double v) {
  const Spot spot = locate(r, u, v);
  const double lift = lattice_hash(spot.column, spot.row, r.seed);
  const double tilt_u = lattice_hash(spot.column, spot.row, r.seed + 1) - 0.5;
  const double tilt_v = lattice_hash(spot.column, spot.row, r.seed + 2) - 0.5;
  const double face = 0.05 + 0.07 * lift + 0.04 * (tilt_u * spot.across + tilt_v * spot.along) +
                      0.045 * periodic_fractal(u, v, 24, 4, 0.55, r.seed + 500) -
                      0.05 * std::min(0.0, periodic_fractal(u, v, 32, 2, 0.5, r.seed + 700) + 0.25);
  // A brick's edge is worn: the face falls off gently before the bevel.
  const double wear = 0.10 * std::exp(-std::max(0.0, spot.inside - r.bevel) / (0.6 * r.bevel));
  const double mortar = 0.93 + 0.05 * periodic_fractal(u, v, 48, 3, 0.6, r.seed + 600);
  const double on_brick = smoothstep(0.0, r.bevel, spot.inside);
  return std::clamp(mortar + on_brick * (face + wear - mortar), 0.0, 1.0);
}

Vec3 brick_colour(const BrickRecipe& r, double u, double v) {
  const Spot spot = locate(r, u, v);
  const double shade = lattice_hash(spot.column, spot.row, r.seed + 3);
  const double hue = lattice_hash(spot.column, spot.row, r.seed + 4);
  const double mottle = periodic_fractal(u, v, 12, 5, 0.6, r.seed + 800);
  const double speckle = periodic_fractal(u, v, 96, 2, 0.7, r.seed + 900);
  Vec3 brick = Vec3(0.56, 0.235, 0.155) + hue * Vec3(0.05, 0.075, 0.05);
  brick *= (0.72 + 0.42 * shade) * (1 + 0.28 * mottle + 0.12 * speckle);
  const Vec3 mortar = Vec3(0.60, 0.57, 0.52) * (1 + 0.16 * speckle + 0.10 * mottle);
  const double on_brick = smoothstep(0.1 * r.bevel, 0.7 * r.bevel, spot.inside);
  return (mortar + on_brick * (brick - mortar)).cwiseMax(0.0).cwiseMin(1.0);
}

}  // namespace

TextureImages make_brick(const BrickRecipe& recipe) {
  const int n = recipe.size;
  TextureImages out{Image16(n, n, 4), Image8(n, n, 3)};
  std::vector<double> depth(std::size_t(n) * std::size_t(n));
  const auto texel = [&](int x, int y) -> double& {
    return depth[std::size_t((y + n) % n) * std::size_t(n) + std::size_t((x + n) % n)];
  };
  const auto u = [n](int x) { return (x + 0.5) / n; };
  const auto v = [n](int y) { return 1 - (y + 0.5) / n; };  // row 0 = top
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x) texel(x, y) = brick_depth(recipe, u(x), v(y));
  }
  const double slope = recipe.depth_fraction * n / 2;  // of a central difference over two texels
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x) {
      const double dz_du = -(texel(x + 1, y) - texel(x - 1, y)) * slope;
      const double dz_dv = -(texel(x, y - 1) - texel(x, y + 1)) * slope;
      const Vec3 normal = Vec3(-dz_du, -dz_dv, 1).normalized();
      for (int c = 0; c < 3; ++c) out.relief.at(x, y, c) = static_cast<std::uint16_t>(std::lround((0.5 * normal[c] + 0.5) * 65535));
      out.relief.at(x, y, 3) = static_cast<std::uint16_t>(std::lround(texel(x, y) * 65535));
      const Vec3 colour = brick_colour(recipe, u(x), v(y));
      for (int c = 0; c < 3; ++c) out.colour.at(x, y, c) = static_cast<std::uint8_t>(std::lround(colour[c] * 255));
    }
  }
  return out;
}

}  // namespace intaglio::surface
