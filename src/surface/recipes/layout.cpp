#include "surface/recipes/layout.h"

#include <algorithm>
#include <limits>
#include <numbers>
#include <vector>

#include "core/portable_math.h"
#include "surface/recipes/noise.h"

namespace intaglio::surface {

namespace {

// Signed distance into a rectangle of half extents `half`, shrunk by half a joint and rounded at the corners.
double inside_box(const Vec2& local, const Vec2& half, const LayoutRecipe& recipe) {
  const double qx = std::abs(local.x()) - (half.x() - 0.5 * recipe.joint - recipe.corner);
  const double qy = std::abs(local.y()) - (half.y() - 0.5 * recipe.joint - recipe.corner);
  const double past_corner = elementary::hypot(std::max(qx, 0.0), std::max(qy, 0.0));
  return recipe.corner - past_corner - std::min(std::max(qx, qy), 0.0);
}

// No joints: one unbounded piece.
class Sheet : public PiecePattern {
 public:
  PiecePoint at(double u, double v) const override {
    return {0, 0, 1, Vec2(u, v), Vec2(unbounded, unbounded), 1};
  }
};

// Rows of rectangles: bricks, tiles, planks, ashlar; with columns = 0, unbounded strips.
class Bond : public PiecePattern {
 public:
  Bond(const LayoutRecipe& recipe, std::uint64_t seed) : r_(recipe), seed_(seed) {}

  PiecePoint at(double u, double v) const override {
    const double y = v * r_.rows;
    const int j = cell(y, [&](int k) { return row_border(k); });
    const int row = wrapped(j, r_.rows);
    const double low_v = row_border(j) / r_.rows;
    const double high_v = row_border(j + 1) / r_.rows;
    if (r_.columns == 0) return strip(u, v, row, low_v, high_v);
    const double shift = ((j & 1) != 0 ? r_.shift : 0.0) +
                         (r_.stagger > 0 ? r_.stagger * lattice_hash(row, 0, seed_ + 12) : 0.0);
    const int i = cell(u * r_.columns + shift, [&](int k) { return column_border(k, row); });
    const Box box{(column_border(i, row) - shift) / r_.columns,
                  (column_border(i + 1, row) - shift) / r_.columns, low_v, high_v};
    return cut(u, v, wrapped(i, r_.columns), row, box);
  }

 private:
  struct Box {
    double low_u, high_u, low_v, high_v;
  };

  // The k with border(k) <= x < border(k + 1); borders are displaced by less than half a cell.
  template <class Border>
  static int cell(double x, const Border& border) {
    const int k = int(std::floor(x));
    if (x < border(k)) return k - 1;
    return x < border(k + 1) ? k : k + 1;
  }

  double row_border(int k) const {
    return r_.uneven.y() > 0 ? k + r_.uneven.y() * (lattice_hash(0, wrapped(k, r_.rows), seed_ + 10) - 0.5)
                             : k;
  }
  double column_border(int k, int row) const {
    if (r_.uneven.x() <= 0) return k;
    return k + r_.uneven.x() * (lattice_hash(wrapped(k, r_.columns), row, seed_ + 11) - 0.5);
  }

  PiecePoint strip(double u, double v, int row, double low_v, double high_v) const {
    const Vec2 half(unbounded, 0.5 * (high_v - low_v));
    const Vec2 local(u, v - 0.5 * (low_v + high_v));
    return {0, row, inside_box(local, half, r_), local, half, 1};
  }

  // The piece, or the part of it that contains the point if it is randomly split across its longer side.
  PiecePoint cut(double u, double v, int column, int row, Box box) const {
    if (r_.split > 0 && lattice_hash(column, row, seed_ + 13) < r_.split) {
      const double share = 0.36 + 0.28 * lattice_hash(column, row, seed_ + 14);
      const bool along_u = box.high_u - box.low_u > box.high_v - box.low_v;
      double& low = along_u ? box.low_u : box.low_v;
      double& high = along_u ? box.high_u : box.high_v;
      const double middle = low + share * (high - low);
      const bool upper = (along_u ? u : v) >= middle;
      (upper ? low : high) = middle;
      if (upper) column += r_.columns;  // gives the second part its own index
    }
    const Vec2 half(0.5 * (box.high_u - box.low_u), 0.5 * (box.high_v - box.low_v));
    const Vec2 local(u - 0.5 * (box.low_u + box.high_u), v - 0.5 * (box.low_v + box.high_v));
    return {column, row, inside_box(local, half, r_), local, half, 1};
  }

  LayoutRecipe r_;
  std::uint64_t seed_;
};

// Herringbone parquet: pieces of 1 x `length` cells, alternately horizontal and vertical.
//
// In cell (i, j) let k = (i - j) mod 2 length. Where k < length, a horizontal piece began k cells to the
// left; elsewhere a vertical one began 2 length - 1 - k cells below. It repeats when the cells per side are a
// multiple of 2 length.
class Herringbone : public PiecePattern {
 public:
  explicit Herringbone(const LayoutRecipe& recipe) : r_(recipe) {}

  PiecePoint at(double u, double v) const override {
    const int n = r_.columns;
    const int length = r_.length;
    const int i = int(std::floor(u * n));
    const int j = int(std::floor(v * n));
    const int k = wrapped(i - j, 2 * length);
    const Vec2 half(0.5 * length / n, 0.5 / n);
    const bool lying = k < length;
    const int start_i = lying ? i - k : i;
    const int start_j = lying ? j : j - (2 * length - 1 - k);
    const Vec2 from_start(u - double(start_i) / n, v - double(start_j) / n);
    const Vec2 local =
        lying ? Vec2(from_start - half) : Vec2(from_start.y() - half.x(), half.y() - from_start.x());
    return {wrapped(start_i, n), wrapped(start_j, n), inside_box(local, half, r_), local, half, 1};
  }

 private:
  LayoutRecipe r_;
};

// Voronoi cells about the sites of a jittered lattice: flagstones; without jitter and with every other row
// shifted, hexagons.
class Voronoi : public PiecePattern {
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

  PiecePoint at(double u, double v) const override {
    const Vec2 p(u, v);
    int nearest_i = 0, nearest_j = 0;
    double least = std::numeric_limits<double>::max();
    const int i0 = int(std::floor(u * r_.columns));
    const int j0 = int(std::floor(v * r_.rows));
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
  // Site of lattice cell (i, j); any integers.
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

// Pebbles: ellipsoids of many sizes, placed largest first at random free positions.
struct Stone {
  Vec2 middle;
  Vec2 half;         // of its axes, the longer first
  Vec2 axis;         // unit, of the longer one
  double top, dome;  // height of its top, and of its top above its edge

  // Along its axes, from its middle; tile of side 1.
  Vec2 local(const Vec2& p) const {
    const Vec2 d(nearest_image(p.x() - middle.x()), nearest_image(p.y() - middle.y()));
    return {d.dot(axis), d.y() * axis.x() - d.x() * axis.y()};
  }
};

class Scatter : public PiecePattern {
 public:
  Scatter(const LayoutRecipe& recipe, std::uint64_t seed) {
    place_stones(recipe, seed);
    for (std::size_t s = 0; s < stones_.size(); ++s) put_in_bins(int(s));
  }

  PiecePoint at(double u, double v) const override {
    const Vec2 p(u, v);
    PiecePoint best{0, 0, -1, Vec2::Zero(), Vec2(1, 1), 0};
    bool covered = false;
    for (const int s : bins_.at(u, v)) {
      const Stone& stone = stones_[std::size_t(s)];
      const Vec2 local = stone.local(p);
      const double rho = local.cwiseQuotient(stone.half).norm();
      const double inside = (1 - rho) * stone.half.y();
      const double rise = rho < 1 ? stone.top - stone.dome * (1 - std::sqrt(1 - rho * rho)) : 0;
      // The highest stone wins; outside all stones, the nearest gives the distance.
      const bool better = rho < 1 ? !covered || rise > best.rise : !covered && inside > best.inside;
      if (!better) continue;
      covered = covered || rho < 1;
      best = {s, 0, inside, local, stone.half, rise};
    }
    return best;
  }

 private:
  static constexpr int attempts = 60;  // to place a stone

  void place_stones(const LayoutRecipe& recipe, std::uint64_t seed) {
    Random random(seed + 30);
    for (int s = 0; s < recipe.stones; ++s) {
      // Few large ones, many small.
      const double share = elementary::pow(1 - double(s) / recipe.stones, 2.2);
      const double radius = recipe.radius.x() + share * (recipe.radius.y() - recipe.radius.x());
      const double slender = random.uniform(0.62, 0.95);
      const double angle = random.uniform(0, std::numbers::pi);
      Stone stone{Vec2::Zero(), Vec2(radius, slender * radius),
                  Vec2(elementary::cos(angle), elementary::sin(angle)), 0, 0};
      // Half buried: all rest in the same bed, large ones rise higher.
      stone.dome = 0.90 * stone.half.y() / recipe.radius.y();
      stone.top = std::min(1.0, stone.dome + random.uniform(0.02, 0.16));
      for (int t = 0; t < attempts; ++t) {
        const double v = random.uniform(), u = random.uniform();  // sequenced, unlike function arguments
        stone.middle = Vec2(u, v);
        if (!has_room(stone)) continue;
        stones_.push_back(stone);
        break;
      }
    }
  }

  // Approximate: two ellipses touch where their radii along the centre line meet; 0.93 allows slight overlap.
  bool has_room(const Stone& stone) const {
    return std::all_of(stones_.begin(), stones_.end(), [&](const Stone& other) {
      const Vec2 there = stone.local(other.middle);
      const double distance = there.norm();
      if (distance > stone.half.x() + other.half.x()) return true;
      const double own_radius = distance / std::max(1e-9, there.cwiseQuotient(stone.half).norm());
      const double other_radius =
          distance / std::max(1e-9, other.local(stone.middle).cwiseQuotient(other.half).norm());
      return distance > 0.93 * (own_radius + other_radius);
    });
  }

  void put_in_bins(int s) {
    const Stone& stone = stones_[std::size_t(s)];
    // A margin of half a bin, so that points next to a stone find it.
    const double reach = stone.half.x() + 0.5 / bins_.per_side();
    const int i0 = bins_.coordinate(stone.middle.x() - reach),
              i1 = bins_.coordinate(stone.middle.x() + reach);
    const int j0 = bins_.coordinate(stone.middle.y() - reach),
              j1 = bins_.coordinate(stone.middle.y() + reach);
    for (int j = j0; j <= j1; ++j) {
      for (int i = i0; i <= i1; ++i) bins_.at(i, j).push_back(s);
    }
  }

  std::vector<Stone> stones_;
  Bins bins_{32};
};

// The studs of tread plate: lenses in a lattice, alternately turned by +45 and -45 degrees; round if width
// equals length.
class Lugs : public PiecePattern {
 public:
  explicit Lugs(const LayoutRecipe& recipe) : r_(recipe) {}

  PiecePoint at(double u, double v) const override {
    const int i = int(std::floor(u * r_.columns));
    const int j = int(std::floor(v * r_.rows));
    const Vec2 d(u - (i + 0.5) / r_.columns, v - (j + 0.5) / r_.rows);
    const double turn = ((i + j) & 1) != 0 ? 1 : -1;
    const Vec2 local = Vec2(d.x() + turn * d.y(), d.y() - turn * d.x()) / std::numbers::sqrt2;
    return {
        wrapped(i, r_.columns), wrapped(j, r_.rows), inside(local), local, {r_.radius.y(), r_.radius.x()}, 1};
  }

 private:
  // Signed distance into the lens in which two equal circles overlap. A circle of radius R through both tips
  // whose middle is `offset` below the lens's satisfies R = offset + b and R^2 = offset^2 + l^2 with the half
  // width b and the half length l, so R = (l^2 + b^2) / 2b.
  double inside(const Vec2& local) const {
    const double half_width = r_.radius.x();
    const double half_length = r_.radius.y();
    const double circle = (half_length * half_length + half_width * half_width) / (2 * half_width);
    const double offset = circle - half_width;
    const double x = std::abs(local.x());
    const double y = std::abs(local.y());
    const bool beyond_tip = (x - half_length) * offset > y * half_length;
    return beyond_tip ? -elementary::hypot(x - half_length, y) : circle - elementary::hypot(x, y + offset);
  }

  LayoutRecipe r_;
};

// Woven wire: round wires alternating over and under.
class Weave : public PiecePattern {
 public:
  explicit Weave(const LayoutRecipe& recipe)
      : r_(recipe), radius_(0.5 * recipe.wire / std::max(recipe.columns, recipe.rows)) {}

  PiecePoint at(double u, double v) const override {
    const PiecePoint standing = wire(u * r_.columns, v * r_.rows, r_.columns, v, 0);
    const PiecePoint lying = wire(v * r_.rows, u * r_.columns, r_.rows, u, 1);
    if (standing.inside <= 0 || lying.inside <= 0) return standing.inside > lying.inside ? standing : lying;
    return standing.rise > lying.rise ? standing : lying;
  }

 private:
  // The nearest wire of a family: `across` and `along` are coordinates in wires of this family and of the
  // other.
  PiecePoint wire(double across, double along, int wires, double along_side, int family) const {
    const int k = int(std::floor(across));
    const double off = (across - k - 0.5) / wires;
    const double inside = radius_ - std::abs(off);
    const double over = ((k + family) & 1) != 0 ? -1 : 1;
    // From -1 to 2 radii: the middle swings by one radius, and the round wire rises one above it.
    const double swing = over * elementary::cos(std::numbers::pi * (along - 0.5));
    const double height = swing + std::sqrt(std::max(0.0, 1 - off * off / (radius_ * radius_)));
    return {wrapped(k, wires),        family,          inside, Vec2(along_side, off),
            Vec2(unbounded, radius_), (height + 1) / 3};
  }

  LayoutRecipe r_;
  double radius_;
};

std::unique_ptr<PiecePattern> make_pattern(const LayoutRecipe& recipe, std::uint64_t seed) {
  switch (recipe.pattern) {
    case Pattern::sheet:
      break;
    case Pattern::bond:
      return std::make_unique<Bond>(recipe, seed);
    case Pattern::herringbone:
      return std::make_unique<Herringbone>(recipe);
    case Pattern::voronoi:
      return std::make_unique<Voronoi>(recipe, seed);
    case Pattern::scatter:
      return std::make_unique<Scatter>(recipe, seed);
    case Pattern::lugs:
      return std::make_unique<Lugs>(recipe);
    case Pattern::weave:
      return std::make_unique<Weave>(recipe);
  }
  return std::make_unique<Sheet>();
}

}  // namespace

Layout::Layout(const LayoutRecipe& r, std::uint64_t seed) : pattern_(make_pattern(r, seed)) {
  if (r.warp > 0) {
    warp_ = Distortion{r.warp,
                       {r.warp_frequency, r.warp_frequency, 3, 0.5, seed + 100},
                       {r.warp_frequency, r.warp_frequency, 3, 0.5, seed + 200}};
  }
  if (r.chip > 0) {
    chip_ = Distortion{r.chip,
                       {r.chip_frequency, r.chip_frequency, 2, 0.6, seed + 300},
                       {r.chip_frequency, r.chip_frequency, 2, 0.6, seed + 400}};
  }
}

PiecePoint Layout::at(double u, double v) const {
  double du = 0, dv = 0;
  for (const auto* distortion : {&warp_, &chip_}) {
    if (!*distortion) continue;
    du += (*distortion)->amplitude * (*distortion)->u(u, v);
    dv += (*distortion)->amplitude * (*distortion)->v(u, v);
  }
  return pattern_->at(u + du, v + dv);
}

}  // namespace intaglio::surface
