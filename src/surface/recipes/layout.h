// The layout of a built-in material's pieces: bricks, planks, stones, studs, wires.
//
// A layout answers one question: which piece contains (u, v), and where in the piece is it? Everything
// repeats with period 1.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "intaglio/vec.h"
#include "surface/recipes/noise.h"
#include "surface/recipes/recipe.h"

namespace intaglio::surface {

constexpr double unbounded = std::numeric_limits<double>::infinity();

// A point of the tile and the piece it is on or next to. Lengths are fractions of the tile's side.
struct PiecePoint {
  int i, j;         // index of the piece, which seeds its random values
  double inside;    // signed distance to the outline of the piece's foot, > 0 on the piece
  Vec2 local;       // from the piece's middle, x along its longer axis
  Vec2 half;        // half its extent, along the same axes; `unbounded` where it goes around the tile
  double rise = 1;  // of the pattern's own relief, 0..1, 1 = highest

  bool same_piece(const PiecePoint& other) const { return i == other.i && j == other.j; }
};

// A pattern with straight outlines.
class PiecePattern {
 public:
  virtual ~PiecePattern() = default;
  virtual PiecePoint at(double u, double v) const = 0;
};

// The pattern with its outlines distorted by low-frequency noise (a hand-laid look) and chipped by
// high-frequency noise.
class Layout {
 public:
  Layout(const LayoutRecipe& recipe, std::uint64_t seed);
  PiecePoint at(double u, double v) const;

 private:
  struct Distortion {
    double amplitude;
    Fractal u, v;
  };

  std::unique_ptr<PiecePattern> pattern_;
  std::optional<Distortion> warp_, chip_;
};

inline int wrapped(int i, int n) {
  if (unsigned(i) < unsigned(n)) return i;  // nearly always true, and a division is slow
  return ((i % n) + n) % n;
}

// The nearest image of a difference on a tile of side 1: in -0.5..0.5.
inline double nearest_image(double difference) {
  return difference - int(difference + std::copysign(0.5, difference));
}

inline double smoothstep(double low, double high, double x) {
  const double t = std::min(std::max((x - low) / (high - low), 0.0), 1.0);
  return t * t * (3 - 2 * t);
}

// A square tile divided into bins that list the things (stones, scratches) near them.
class Bins {
 public:
  explicit Bins(int per_side) : per_side_(per_side), bins_(std::size_t(per_side) * std::size_t(per_side)) {}

  // The bin of bin coordinates (i, j), any integers, or of a point.
  std::vector<int>& at(int i, int j) {
    return bins_[std::size_t(wrapped(i, per_side_) + per_side_ * wrapped(j, per_side_))];
  }
  const std::vector<int>& at(double u, double v) const {
    return bins_[std::size_t(wrapped(coordinate(u), per_side_) +
                             per_side_ * wrapped(coordinate(v), per_side_))];
  }
  int coordinate(double x) const { return int(std::floor(x * per_side_)); }
  int per_side() const { return per_side_; }

 private:
  int per_side_;
  std::vector<std::vector<int>> bins_;
};

}  // namespace intaglio::surface
