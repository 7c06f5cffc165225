// Voronoi cells about the sites of a jittered lattice: flagstones; without jitter and with every other row
// shifted, hexagons.
#include <algorithm>
#include <limits>
#include <vector>

#include "intaglio/surface/builtin/layout.h"
#include "intaglio/surface/noise.h"

namespace intaglio::surface {

namespace {

class Voronoi : public Cells {
 public:
  Voronoi(const LayoutRecipe& recipe, std::uint64_t seed) : r_(recipe) {
    for (int j = 0; j < r_.rows; ++j) {
      for (int i = 0; i < r_.columns; ++i) {
        const double shift = (j & 1) != 0 ? r_.shift : 0.0;
        sites_.emplace_back(
            (i + 0.5 + shift + r_.jitter * (lattice_hash(i, j, seed + 20) - 0.5)) / r_.columns,
            (j + 0.5 + r_.jitter * (lattice_hash(i, j, seed + 21) - 0.5)) / r_.rows);
      }
    }
  }

  Spot at(double u, double v) const override {
    const Vec2 p(u, v);
    int nearest_i = 0, nearest_j = 0;
    double least = std::numeric_limits<double>::max();
    const int i0 = static_cast<int>(std::floor(u * r_.columns));
    const int j0 = static_cast<int>(std::floor(v * r_.rows));
    for (int j = j0 - 2; j <= j0 + 2; ++j) {
      for (int i = i0 - 2; i <= i0 + 2; ++i) {
        const double distance = (site(i, j) - p).squaredNorm();
        if (distance < least) least = distance, nearest_i = i, nearest_j = j;
      }
    }
    const Vec2 middle = site(nearest_i, nearest_j);
    return {wrapped(nearest_i, r_.columns),        wrapped(nearest_j, r_.rows),
            inside(p, nearest_i, nearest_j),       p - middle,
            Vec2(0.5 / r_.columns, 0.5 / r_.rows), 1};
  }

 private:
  // Of the lattice cell (i, j), any integers.
  Vec2 site(int i, int j) const {
    const int column = wrapped(i, r_.columns);
    const int row = wrapped(j, r_.rows);
    const Vec2& home = sites_[std::size_t(row) * std::size_t(r_.columns) + std::size_t(column)];
    return home + Vec2(double(i - column) / r_.columns, double(j - row) / r_.rows);
  }

  // Distance to the borders of site (i, j), corners rounded: within `corner` of several borders it is the
  // distance to an arc.
  double inside(const Vec2& p, int i, int j) const {
    const Vec2 own = site(i, j);
    double least = std::numeric_limits<double>::max();
    double into_corner = 0;
    for (int dj = -2; dj <= 2; ++dj) {
      for (int di = -2; di <= 2; ++di) {
        if (di == 0 && dj == 0) continue;
        const Vec2 other = site(i + di, j + dj);
        const double border = (0.5 * (own + other) - p).dot((other - own).normalized()) - 0.5 * r_.joint;
        least = std::min(least, border);
        const double past = std::max(r_.corner - border, 0.0);
        into_corner += past * past;
      }
    }
    return least < r_.corner ? r_.corner - std::sqrt(into_corner) : least;
  }

  LayoutRecipe r_;
  std::vector<Vec2> sites_;
};

}  // namespace

std::unique_ptr<Cells> make_voronoi(const LayoutRecipe& recipe, std::uint64_t seed) {
  return std::make_unique<Voronoi>(recipe, seed);
}

}  // namespace intaglio::surface
