// Where the pieces of a built-in material lie: bricks, planks, stones, studs, wires.
//
// A layout answers one question: which piece is at (u, v), and how does the point lie in it? Everything
// repeats with period 1. Each pattern is one file; all are made by `make_cells`.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>

#include "intaglio/vec.h"
#include "surface/recipes/noise.h"
#include "surface/recipes/recipe.h"

namespace intaglio::surface {

constexpr double endless = std::numeric_limits<double>::infinity();

// One point of the tile, described. Lengths are fractions of the tile's side.
struct Spot {
  int i, j;         // which piece: what its chances hang on
  double inside;    // signed distance to the outline of the piece's foot, > 0 on the piece
  Vec2 local;       // from the piece's middle, x along its longer axis
  Vec2 half;        // half its extent, along the same axes; `endless` where it goes around the tile
  double rise = 1;  // of the layout's own relief, 0..1, 1 = highest

  bool same_piece(const Spot& other) const { return i == other.i && j == other.j; }
};

// A pattern with straight outlines.
class Cells {
 public:
  virtual ~Cells() = default;
  virtual Spot at(double u, double v) const = 0;
};

std::unique_ptr<Cells> make_bond(const LayoutRecipe& recipe, std::uint64_t seed);
std::unique_ptr<Cells> make_herringbone(const LayoutRecipe& recipe, std::uint64_t seed);
std::unique_ptr<Cells> make_voronoi(const LayoutRecipe& recipe, std::uint64_t seed);
std::unique_ptr<Cells> make_scatter(const LayoutRecipe& recipe, std::uint64_t seed);
std::unique_ptr<Cells> make_lugs(const LayoutRecipe& recipe, std::uint64_t seed);
std::unique_ptr<Cells> make_weave(const LayoutRecipe& recipe, std::uint64_t seed);

// The pattern with its outlines bent by a slow noise, as laid by hand, and chipped by a fine one.
class Layout {
 public:
  Layout(const LayoutRecipe& recipe, std::uint64_t seed);
  Spot at(double u, double v) const;

 private:
  struct Bend {
    double reach;
    Fractal u, v;
  };

  std::unique_ptr<Cells> cells_;
  std::optional<Bend> warp_, chip_;
};

inline int wrapped(int i, int n) {
  if (static_cast<unsigned>(i) < static_cast<unsigned>(n)) return i;  // nearly always, and a division is slow
  return ((i % n) + n) % n;
}

// The nearest image of a difference on a tile of side 1: in -0.5..0.5.
inline double nearest_image(double difference) {
  return difference - static_cast<int>(difference + std::copysign(0.5, difference));
}

inline double smoothstep(double low, double high, double x) {
  const double t = std::min(std::max((x - low) / (high - low), 0.0), 1.0);
  return t * t * (3 - 2 * t);
}

// Signed distance into a rectangle of half extents `half`, shrunk by half a joint and rounded at the corners.
double inside_box(const Vec2& local, const Vec2& half, const LayoutRecipe& recipe);

}  // namespace intaglio::surface
