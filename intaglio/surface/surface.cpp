#include "intaglio/surface/surface.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace intaglio::surface {

namespace {

// Splits a texel coordinate into the cell's index and the place in it.
struct Split {
  int index;
  double fraction;

  explicit Split(double coordinate) {
    // Far outside (a body a million metres away) the texture is periodic anyway: stay within int.
    const double bounded = std::clamp(coordinate, -1e9, 1e9);
    const double floor = std::floor(bounded);
    index = static_cast<int>(floor);
    fraction = bounded - floor;
  }
};

}  // namespace

Surface::Surface(Texels texels, const Placement& placement, double max_depth, Edge edge)
    : placement_(placement),
      width_(texels.width),
      height_(texels.height),
      max_depth_(max_depth),
      edge_(edge),
      depth_(std::move(texels.depth)),
      colour_(std::move(texels.colour)) {
  assert(width_ > 0 && height_ > 0 && max_depth >= 0);
  assert(texels.normal.size() == std::size_t(width_) * std::size_t(height_));
  assert(depth_.empty() || depth_.size() == texels.normal.size());
  normal_.reserve(texels.normal.size());
  for (const Vec3& n : texels.normal) {
    normal_.push_back({static_cast<std::int16_t>(std::lround(std::clamp(n.x(), -1.0, 1.0) * 32767)),
                       static_cast<std::int16_t>(std::lround(std::clamp(n.y(), -1.0, 1.0) * 32767))});
  }
}

std::size_t Surface::memory_bytes() const {
  return sizeof *this + depth_.size() * sizeof(float) + normal_.size() * sizeof(Packed) + colour_.data.size();
}

Vec3 Surface::unpacked(int i, int j) const {
  const Packed p = normal_[index(i, j)];
  const double x = p.x / 32767.0;
  const double y = p.y / 32767.0;
  return {x, y, std::sqrt(std::max(0.0, 1.0 - x * x - y * y))};
}

double Surface::depth(const Vec2& uv) const {
  const Split x(uv.x() * width_ - 0.5);
  const Split y(uv.y() * height_ - 0.5);
  const double low = texel_z(x.index, y.index) * (1 - x.fraction) + texel_z(x.index + 1, y.index) * x.fraction;
  const double high = texel_z(x.index, y.index + 1) * (1 - x.fraction) + texel_z(x.index + 1, y.index + 1) * x.fraction;
  return -(low * (1 - y.fraction) + high * y.fraction);
}

Vec3 Surface::normal(const Vec2& uv) const {
  const Split x(uv.x() * width_ - 0.5);
  const Split y(uv.y() * height_ - 0.5);
  const Vec3 low = unpacked(x.index, y.index) * (1 - x.fraction) + unpacked(x.index + 1, y.index) * x.fraction;
  const Vec3 high = unpacked(x.index, y.index + 1) * (1 - x.fraction) + unpacked(x.index + 1, y.index + 1) * x.fraction;
  return (low * (1 - y.fraction) + high * y.fraction).normalized();
}

Vec3 Surface::texel_normal(const Vec2& uv) const {
  return unpacked(Split(uv.x() * width_).index, Split(uv.y() * height_).index);
}

Vec2 Surface::gradient(const Vec2& uv) const {
  const Split x(uv.x() * width_ - 0.5);
  const Split y(uv.y() * height_ - 0.5);
  const Cell c = cell(x.index, y.index);
  const double twist = c.z[3] - c.z[2] - c.z[1] + c.z[0];
  return {((c.z[1] - c.z[0]) + y.fraction * twist) / c.width(), ((c.z[2] - c.z[0]) + x.fraction * twist) / c.height()};
}

Cell Surface::cell(int i, int j) const {
  const double du = texel_u();
  const double dv = texel_v();
  return {(i + 0.5) * du, (j + 0.5) * dv, (i + 1.5) * du, (j + 1.5) * dv,
          {texel_z(i, j), texel_z(i + 1, j), texel_z(i, j + 1), texel_z(i + 1, j + 1)}};
}

std::pair<int, int> Surface::cell_at(double x, double y) const {
  return {Split(x / texel_u() - 0.5).index, Split(y / texel_v() - 0.5).index};
}

std::vector<float> Surface::normal_texture() const {
  std::vector<float> out;
  out.reserve(normal_.size() * 3);
  for (int j = 0; j < height_; ++j) {
    for (int i = 0; i < width_; ++i) {
      const Vec3 n = unpacked(i, j);
      for (int k = 0; k < 3; ++k) out.push_back(static_cast<float>(n[k]));
    }
  }
  return out;
}

}  // namespace intaglio::surface
