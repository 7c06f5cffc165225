#include "surface/surface.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "surface/texels.h"

namespace intaglio::surface {

Surface::Surface(Texels texels, const Placement& placement, double max_depth, Edge edge)
    : placement_(placement),
      grid_{texels.width, texels.height, edge},
      max_depth_(max_depth),
      has_depth_(!texels.depth.empty()) {
  assert(texels.width > 0 && texels.height > 0 && max_depth >= 0);
  assert(texels.normal.size() == grid_.size());
  assert(!has_depth_ || texels.depth.size() == grid_.size());
  texels_per_metre_ = 1 / std::sqrt(texel_u() * texel_v());
  std::vector<PackedNormal> normal;
  normal.reserve(texels.normal.size());
  for (const Vec3& n : texels.normal) normal.push_back(PackedNormal::pack(n));
  // Freed before the levels are built: they take six times the packed normals' memory.
  std::vector<Vec3>().swap(texels.normal);
  contents_ = std::make_shared<const Contents>(
      Contents{TexelTiles(grid_, texels.depth, normal), Pyramid(texels.depth, grid_),
               Mips(grid_, texels.depth, normal), std::move(texels.colour)});
}

Surface Surface::placed(const Placement& placement, double max_depth) const {
  Surface out = *this;
  out.placement_ = placement;
  out.max_depth_ = max_depth;
  out.texels_per_metre_ = 1 / std::sqrt(out.texel_u() * out.texel_v());
  return out;
}

std::size_t Surface::memory_bytes() const {
  return sizeof *this + tiles().memory_bytes() + pyramid().memory_bytes() + mips().memory_bytes() +
         colour().data.size();
}

BilinearTaps Surface::taps(const Vec2& uv) const {
  return {tiles(), uv.x() * width() - 0.5, uv.y() * height() - 0.5};
}

double Surface::depth_at(const BilinearTaps& at) const {
  if (!has_depth()) return 0;
  const auto depth = [&](std::size_t k) { return max_depth_ * double(tiles().depth(at.index[k])); };
  const double low = depth(0) * (1 - at.x) + depth(1) * at.x, high = depth(2) * (1 - at.x) + depth(3) * at.x;
  return low * (1 - at.y) + high * at.y;
}

Vec3 Surface::normal_at(const BilinearTaps& at) const {
  const auto unit = [&](std::size_t k) { return tiles().normal(at.index[k]).unit(); };
  const Vec3 low = unit(0) * (1 - at.x) + unit(1) * at.x, high = unit(2) * (1 - at.x) + unit(3) * at.x;
  return (low * (1 - at.y) + high * at.y).normalized();
}

Vec2 Surface::gradient_at(const BilinearTaps& at) const {
  if (!has_depth()) return Vec2::Zero();
  const Interpolated depth = at([&](std::size_t k) { return double(tiles().depth(k)); });
  return {-max_depth_ * depth.d_x * grid_.width / placement_.size_u(),
          -max_depth_ * depth.d_y * grid_.height / placement_.size_v()};
}

double Surface::depth(const Vec2& uv) const {
  return depth_at(taps(uv));
}

Vec3 Surface::normal(const Vec2& uv) const {
  return normal_at(taps(uv));
}

Vec3 Surface::texel_normal(const Vec2& uv) const {
  return normal_of_texel(TexelCoordinate(uv.x() * width()).index, TexelCoordinate(uv.y() * height()).index);
}

Vec2 Surface::gradient(const Vec2& uv) const {
  return gradient_at(taps(uv));
}

Sample Surface::sample(const Vec2& uv, double footprint) const {
  const Mips::LevelBlend blend = mips().levels_for(footprint * texels_per_metre_);
  if (blend.level == 0 && blend.weight_of_next == 0) {
    const BilinearTaps at = taps(uv);
    return {depth_at(at), normal_at(at), gradient_at(at), 0};
  }
  Moments s = moments_at(blend.level, uv);
  if (blend.weight_of_next > 0) {
    const Moments coarse = moments_at(blend.level + 1, uv);
    const double a = 1 - blend.weight_of_next, b = blend.weight_of_next;
    s.depth = a * s.depth + b * coarse.depth;
    s.gradient = a * s.gradient + b * coarse.gradient;
    s.slope = a * s.slope + b * coarse.slope;
    s.variance = a * s.variance + b * coarse.variance;
  }
  return {s.depth, Vec3(-s.slope.x(), -s.slope.y(), 1).normalized(), s.gradient, std::sqrt(s.variance)};
}

Surface::Moments Surface::moments_at(int level, const Vec2& uv) const {
  if (level == 0) {
    const BilinearTaps at = taps(uv);
    return {depth_at(at), gradient_at(at), slope_of(normal_at(at)), 0};
  }
  const Mips::Moments m = mips().bilinear(level, uv);
  const Grid& grid = mips().grid(level);
  const Vec2 per_metre(-max_depth_ * grid.width / placement_.size_u(),
                       -max_depth_ * grid.height / placement_.size_v());
  return {max_depth_ * m.depth, m.depth_slope.cwiseProduct(per_metre), m.slope, m.variance};
}

SmoothHeight Surface::smooth(const Vec2& uv, double footprint) const {
  if (!has_depth()) return {0, Vec2::Zero()};
  const Mips::LevelBlend blend = mips().levels_for(footprint * texels_per_metre_);
  SmoothHeight s = smooth_at_level(blend.level, uv);
  if (blend.weight_of_next > 0) {
    const SmoothHeight coarse = smooth_at_level(blend.level + 1, uv);
    s.height += blend.weight_of_next * (coarse.height - s.height);
    s.gradient += blend.weight_of_next * (coarse.gradient - s.gradient);
  }
  return s;
}

SmoothHeight Surface::smooth_at_level(int level, const Vec2& uv) const {
  const Grid& grid = level == 0 ? grid_ : mips().grid(level);
  const double x = uv.x() * grid.width - 0.5, y = uv.y() * grid.height - 0.5;
  const Interpolated depth =
      level == 0 ? bicubic(tiles(), x, y, [&](std::size_t k) { return double(tiles().depth(k)); })
                 : bicubic(grid, x, y, [&](std::size_t k) { return mips().depth(level, k); });
  return {-max_depth_ * depth.value,
          {-max_depth_ * depth.d_x * grid.width / placement_.size_u(),
           -max_depth_ * depth.d_y * grid.height / placement_.size_v()}};
}

Cell Surface::cell(int i, int j) const {
  const double du = texel_u();
  const double dv = texel_v();
  return {(i + 0.5) * du,
          (j + 0.5) * dv,
          (i + 1.5) * du,
          (j + 1.5) * dv,
          {texel_z(i, j), texel_z(i + 1, j), texel_z(i, j + 1), texel_z(i + 1, j + 1)}};
}

std::pair<int, int> Surface::cell_at(double x, double y) const {
  return {TexelCoordinate(x / texel_u() - 0.5).index, TexelCoordinate(y / texel_v() - 0.5).index};
}

std::vector<float> Surface::depth_texture() const {
  std::vector<float> out;
  if (!has_depth_) return out;
  out.reserve(grid_.size());
  for (int j = 0; j < height(); ++j) {
    for (int i = 0; i < width(); ++i) out.push_back(tiles().depth(tiles().index(i, j)));
  }
  return out;
}

std::vector<float> Surface::normal_texture() const {
  std::vector<float> out;
  out.reserve(grid_.size() * 3);
  for (int j = 0; j < height(); ++j) {
    for (int i = 0; i < width(); ++i) {
      const Vec3 n = normal_of_texel(i, j);
      for (int k = 0; k < 3; ++k) out.push_back(float(n[k]));
    }
  }
  return out;
}

namespace {

// Depth fractions found so far.
struct DepthRange {
  double shallow = std::numeric_limits<double>::infinity();
  double deep = -std::numeric_limits<double>::infinity();

  void add(double depth) {
    shallow = std::min(shallow, depth);
    deep = std::max(deep, depth);
  }
};

// An interval of one axis in texels (texel centres at integers).
struct Interval {
  double low, high;
};

// Adds the depths over `x` x `y`, which is within one period of cells.
class RangeSearch {
 public:
  RangeSearch(const Surface& surface, const Interval& x, const Interval& y, DepthRange& range)
      : surface_(surface), pyramid_(surface.pyramid()), x_(x), y_(y), range_(range) {}

  void run() { descend(pyramid_.levels() - 1, 0, 0); }

 private:
  void descend(int level, int x, int y) {
    const Pyramid::Bounds4 quad = pyramid_.quad(level, x, y);
    for (int k = 0; k < 4; ++k) {
      const int side = Pyramid::block_cells(level), cx = 2 * x + (k & 1), cy = 2 * y + (k >> 1);
      const double shallow = quad.shallow[std::size_t(k)], deep = quad.deep[std::size_t(k)];
      if (shallow > deep) continue;  // missing
      if (shallow >= range_.shallow && deep <= range_.deep) continue;
      const double x0 = pyramid_.first_cell() + cx * side,
                   x1 = std::min(x0 + side, double(pyramid_.first_cell() + pyramid_.columns()));
      const double y0 = pyramid_.first_cell() + cy * side,
                   y1 = std::min(y0 + side, double(pyramid_.first_cell() + pyramid_.rows()));
      if (x_.high < x0 || x_.low > x1 || y_.high < y0 || y_.low > y1) continue;
      const bool inside = x_.low <= x0 && x_.high >= x1 && y_.low <= y0 && y_.high >= y1;
      if (inside && level > 0) {
        range_.add(shallow);
        range_.add(deep);
      } else if (level > 0) {
        descend(level - 1, cx, cy);
      } else {
        cells({std::max(x_.low, x0), std::min(x_.high, x1)}, {std::max(y_.low, y0), std::min(y_.high, y1)});
      }
    }
  }

  // The patches' extremes are at the corners of the rectangle's intersections with the cells.
  void cells(const Interval& x, const Interval& y) {
    for (double b = y.low;; b = std::min(std::floor(b) + 1, y.high)) {
      for (double a = x.low;; a = std::min(std::floor(a) + 1, x.high)) {
        range_.add(depth(a, b));
        if (a >= x.high) break;
      }
      if (b >= y.high) break;
    }
  }

  double depth(double a, double b) const {
    const TexelTiles& tiles = surface_.tiles();
    const BilinearTaps taps(tiles, a, b);
    const std::array<double, 4> w = taps.weights();
    double sum = 0;
    for (std::size_t k = 0; k < 4; ++k) sum += w[k] * tiles.depth(taps.index[k]);
    return sum;
  }

  const Surface& surface_;
  const Pyramid& pyramid_;
  Interval x_, y_;
  DepthRange& range_;
};

// The intervals of one period [0, n] that a..b covers: one, or two when it crosses the seam.
struct WrappedIntervals {
  std::array<Interval, 2> part;
  std::size_t count;

  WrappedIntervals(double a, double b, int n, Edge edge) : part{}, count(1) {
    if (edge == Edge::clamp) {
      // Beyond the outermost texel centres the relief is constant.
      part[0] = {std::clamp(a, 0.0, n - 1.0), std::clamp(b, 0.0, n - 1.0)};
      return;
    }
    const double period = n;
    if (b - a >= period) {
      part[0] = {0, period};
      return;
    }
    const double shift = std::floor(a / period) * period;
    const double from = std::clamp(a - shift, 0.0, period), to = from + (b - a);
    part[0] = {from, std::min(to, period)};
    if (to > period) part[count++] = {0, to - period};
  }
};

}  // namespace

HeightRange height_range(const Surface& surface, const Vec2& uv_a, const Vec2& uv_b) {
  if (!surface.has_depth()) return {};
  const double z = -surface.max_depth();
  if (!uv_a.allFinite() || !uv_b.allFinite()) {
    const Pyramid::Range total = surface.pyramid().total_range();
    return {z * total.deep, z * total.shallow};
  }
  const Vec2 low = uv_a.cwiseMin(uv_b), high = uv_a.cwiseMax(uv_b);
  const Grid& grid = surface.grid();
  const WrappedIntervals across(low.x() * grid.width - 0.5, high.x() * grid.width - 0.5, grid.width,
                                grid.edge);
  const WrappedIntervals along(low.y() * grid.height - 0.5, high.y() * grid.height - 0.5, grid.height,
                               grid.edge);
  DepthRange range;
  for (std::size_t b = 0; b < along.count; ++b) {
    for (std::size_t a = 0; a < across.count; ++a)
      RangeSearch(surface, across.part[a], along.part[b], range).run();
  }
  return {z * range.deep, z * range.shallow};
}

}  // namespace intaglio::surface
