#include "intaglio/surface/extent.h"

#include <algorithm>

#include "intaglio/surface/mip_filter.h"

namespace intaglio::surface {

namespace {

// Depth fractions met so far.
struct Found {
  double shallow = std::numeric_limits<double>::infinity();
  double deep = -std::numeric_limits<double>::infinity();

  void add(double depth) {
    shallow = std::min(shallow, depth);
    deep = std::max(deep, depth);
  }
};

// A stretch of one axis in texels (texel centres at integers).
struct Stretch {
  double low, high;
};

// The bilinear patches over `x` x `y`, which is within one period of cells.
class Search {
 public:
  Search(const Surface& surface, const Stretch& x, const Stretch& y, Found& found)
      : surface_(surface), pyramid_(surface.pyramid()), x_(x), y_(y), found_(found) {}

  void run() { descend(pyramid_.levels() - 1, 0, 0); }

 private:
  void descend(int level, int x, int y) {
    const Pyramid::Bounds4 quad = pyramid_.quad(level, x, y);
    for (int k = 0; k < 4; ++k) {
      const int side = Pyramid::side(level), cx = 2 * x + (k & 1), cy = 2 * y + (k >> 1);
      const double shallow = quad.shallow[std::size_t(k)], deep = quad.deep[std::size_t(k)];
      if (shallow > deep || (shallow >= found_.shallow && deep <= found_.deep))
        continue;  // missing, or nothing new in it
      const double x0 = pyramid_.first() + cx * side,
                   x1 = std::min(x0 + side, double(pyramid_.first() + pyramid_.columns()));
      const double y0 = pyramid_.first() + cy * side,
                   y1 = std::min(y0 + side, double(pyramid_.first() + pyramid_.rows()));
      if (x_.high < x0 || x_.low > x1 || y_.high < y0 || y_.low > y1) continue;
      const bool inside = x_.low <= x0 && x_.high >= x1 && y_.low <= y0 && y_.high >= y1;
      if (inside && level > 0) {
        found_.add(shallow);
        found_.add(deep);
      } else if (level > 0) {
        descend(level - 1, cx, cy);
      } else {
        cells({std::max(x_.low, x0), std::min(x_.high, x1)}, {std::max(y_.low, y0), std::min(y_.high, y1)});
      }
    }
  }

  // The corners of the rectangle and of its intersections with the cells: the patches' extremes.
  void cells(const Stretch& x, const Stretch& y) {
    for (double b = y.low;; b = std::min(std::floor(b) + 1, y.high)) {
      for (double a = x.low;; a = std::min(std::floor(a) + 1, x.high)) {
        found_.add(depth(a, b));
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
  Stretch x_, y_;
  Found& found_;
};

// The stretches of one period [0, n] that a..b covers: one, or two when it crosses the seam.
struct Stretches {
  std::array<Stretch, 2> part;
  std::size_t count;

  Stretches(double a, double b, int n, Edge edge) : part{}, count(1) {
    if (edge == Edge::clamp) {
      // Beyond the outermost texel centres nothing changes.
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

Extent extent(const Surface& surface, const Vec2& uv_a, const Vec2& uv_b) {
  if (!surface.has_depth()) return {};
  const double z = -surface.max_depth();
  if (!uv_a.allFinite() || !uv_b.allFinite()) {
    const Pyramid::Range whole = surface.pyramid().whole();
    return {z * whole.deep, z * whole.shallow};
  }
  const Vec2 low = uv_a.cwiseMin(uv_b), high = uv_a.cwiseMax(uv_b);
  const Grid& grid = surface.grid();
  const Stretches across(low.x() * grid.width - 0.5, high.x() * grid.width - 0.5, grid.width, grid.edge);
  const Stretches along(low.y() * grid.height - 0.5, high.y() * grid.height - 0.5, grid.height, grid.edge);
  Found found;
  for (std::size_t b = 0; b < along.count; ++b) {
    for (std::size_t a = 0; a < across.count; ++a)
      Search(surface, across.part[a], along.part[b], found).run();
  }
  return {z * found.deep, z * found.shallow};
}

}  // namespace intaglio::surface
