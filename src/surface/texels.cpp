#include "surface/texels.h"

#include "core/portable_math.h"

namespace intaglio::surface {

PackedNormal PackedNormal::pack(const Vec3& normal) {
  const auto packed = [](double n) { return std::int16_t(std::lround(std::clamp(n, -1.0, 1.0) * 32767)); };
  return {packed(normal.x()), packed(normal.y())};
}

TexelTiles::TexelTiles(const Grid& grid, std::span<const float> depth, std::span<const PackedNormal> normal)
    : grid_(grid) {
  const auto across = std::size_t((grid.width + side - 1) / side),
             along = std::size_t((grid.height + side - 1) / side);
  stride_ = across * tile_texels;
  depth_.resize(stride_ * along);
  normal_.resize(stride_ * along);
  std::size_t from = 0;
  for (int j = 0; j < grid.height; ++j) {
    for (int i = 0; i < grid.width; ++i, ++from) {
      const std::size_t to = index(i, j);
      if (!depth.empty()) depth_[to] = depth[from];
      normal_[to] = normal[from];
    }
  }
}

namespace {

// The averaged quantities. The second moment rather than the variance, because it is linear.
struct TexelMoments {
  float depth, slope_x, slope_y, second;
};

// The texels of the finer level that a texel of the coarser one covers along one axis, and the fraction of it
// that each fills. At most three: a coarse texel is at most two fine ones long.
struct Coverage {
  int first;
  std::array<float, 3> weight;
};

std::vector<Coverage> coverage(int fine, int coarse) {
  std::vector<Coverage> out;
  for (std::int64_t k = 0; k < coarse; ++k) {
    // In units of side / (fine * coarse) all lengths are integers: a fine texel is `coarse` long, a coarse
    // one `fine`.
    const std::int64_t low = k * fine, high = low + fine;
    Coverage cover{int(low / coarse), {}};
    for (std::int64_t n = 0; n < 3; ++n) {
      const std::int64_t from = std::max(low, (cover.first + n) * coarse),
                         to = std::min(high, (cover.first + n + 1) * coarse);
      cover.weight[std::size_t(n)] = float(std::max<std::int64_t>(0, to - from)) / float(fine);
    }
    out.push_back(cover);
  }
  return out;
}

// The coarser level; `fine(k)` returns the moments of texel k of the finer one.
template <class Fine>
std::vector<TexelMoments> downsample(const Grid& grid, const Grid& half, const Fine& fine) {
  const std::vector<Coverage> across = coverage(grid.width, half.width),
                              along = coverage(grid.height, half.height);
  std::vector<TexelMoments> out;
  out.reserve(half.size());
  for (const Coverage& y : along) {
    for (const Coverage& x : across) {
      TexelMoments sum{};
      for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c) {
          const float weight = y.weight[std::size_t(r)] * x.weight[std::size_t(c)];
          if (weight == 0) continue;
          const TexelMoments& s = fine(grid.index(x.first + c, y.first + r));
          sum.depth += weight * s.depth;
          sum.slope_x += weight * s.slope_x;
          sum.slope_y += weight * s.slope_y;
          sum.second += weight * s.second;
        }
      }
      out.push_back(sum);
    }
  }
  return out;
}

}  // namespace

Vec2 slope_of(const Vec3& normal) {
  const double across = elementary::hypot(normal.x(), normal.y());
  // n_z >= across / max_slope limits the slope's length, and 1e-9 avoids 0 / 0.
  return -normal.head<2>() / std::max(normal.z(), std::max(across / max_slope, 1e-9));
}

Mips::Mips(const Grid& grid, std::span<const float> depth, std::span<const PackedNormal> normal) {
  for (const PackedNormal& n : normal) scale_ = std::max(scale_, slope_of(n.unit()).norm());
  const auto finest = [&](std::size_t k) {
    const Vec2 slope = slope_of(normal[k].unit());
    return TexelMoments{depth.empty() ? 0.0f : depth[k], float(slope.x()), float(slope.y()),
                        float(slope.squaredNorm())};
  };
  const double inverse_scale = scale_ > 0 ? 1 / scale_ : 0;
  const auto pack = [&](const TexelMoments& s) {
    Texel t{std::uint16_t(std::lround(std::clamp(s.depth, 0.0f, 1.0f) * 65535)),
            std::int16_t(std::lround(std::clamp(s.slope_x * inverse_scale, -1.0, 1.0) * 32767)),
            std::int16_t(std::lround(std::clamp(s.slope_y * inverse_scale, -1.0, 1.0) * 32767)), 0};
    // Variance about the slope as stored, so that rounding the mean loses no second moment.
    const double variance = std::max(0.0, s.second - unpack(t).slope.squaredNorm());
    t.roughness = std::uint16_t(std::lround(std::min(1.0, std::sqrt(variance) * inverse_scale) * 65535));
    return t;
  };
  std::vector<TexelMoments> sums;
  for (Grid from = grid; from.width > 1 || from.height > 1;) {
    const Grid to{(from.width + 1) / 2, (from.height + 1) / 2, from.edge};
    sums = levels_.empty()
               ? downsample(from, to, finest)
               : downsample(from, to, [&](std::size_t k) -> const TexelMoments& { return sums[k]; });
    levels_.push_back({to, texels_.size()});
    if (texels_.empty())
      texels_.reserve(to.size() + to.size() / 3 + std::size_t(2 * (to.width + to.height)) + 64);
    for (const TexelMoments& s : sums) texels_.push_back(pack(s));
    from = to;
  }
  texels_.shrink_to_fit();
  levels_.shrink_to_fit();
}

Mips::Moments Mips::unpack(const Texel& t) const {
  const double roughness = t.roughness * (scale_ / 65535);
  return {t.depth / 65535.0, Vec2::Zero(), Vec2(t.slope_x, t.slope_y) * (scale_ / 32767),
          roughness * roughness};
}

Mips::Moments Mips::texel(int level, int i, int j) const {
  return unpack(texels_[levels_[std::size_t(level - 1)].start + grid(level).index(i, j)]);
}

Mips::Moments Mips::bilinear(int level, const Vec2& uv) const {
  const Level& l = levels_[std::size_t(level - 1)];
  const BilinearTaps taps(l.grid, uv.x() * l.grid.width - 0.5, uv.y() * l.grid.height - 0.5);
  const std::array<double, 4> weights = taps.weights();
  Moments sum{0, Vec2::Zero(), Vec2::Zero(), 0};
  for (std::size_t k = 0; k < 4; ++k) {
    const Moments m = unpack(texels_[l.start + taps.index[k]]);
    sum.slope += weights[k] * m.slope;
    sum.variance += weights[k] * m.variance;
  }
  const Interpolated depth = taps([&](std::size_t k) { return this->depth(level, k); });
  sum.depth = depth.value;
  sum.depth_slope = {depth.d_x, depth.d_y};
  return sum;
}

Mips::LevelBlend Mips::levels_for(double footprint) const {
  if (!(footprint > 1)) return {0, 0};
  int exponent = 0;
  // footprint = mantissa 2^exponent, mantissa in 0.5..1
  const double mantissa = std::frexp(footprint, &exponent);
  if (!std::isfinite(footprint) || exponent - 1 >= coarsest()) return {coarsest(), 0};
  return {exponent - 1, 2 * mantissa - 1};
}

}  // namespace intaglio::surface
