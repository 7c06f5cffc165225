#include "surface/recipes/layout.h"

#include <algorithm>
#include <limits>
#include <numbers>
#include <vector>

#include "core/portable_math.h"
#include "surface/recipes/noise.h"

namespace intaglio::surface {

namespace {

// No joints at all: one endless piece.
class Sheet : public Cells {
 public:
  Spot at(double u, double v) const override { return {0, 0, 1, Vec2(u, v), Vec2(endless, endless), 1}; }
};

std::unique_ptr<Cells> make_cells(const LayoutRecipe& recipe, std::uint64_t seed) {
  switch (recipe.pattern) {
    case Pattern::sheet:
      break;
    case Pattern::bond:
      return make_bond(recipe, seed);
    case Pattern::herringbone:
      return make_herringbone(recipe, seed);
    case Pattern::voronoi:
      return make_voronoi(recipe, seed);
    case Pattern::scatter:
      return make_scatter(recipe, seed);
    case Pattern::lugs:
      return make_lugs(recipe, seed);
    case Pattern::weave:
      return make_weave(recipe, seed);
  }
  return std::make_unique<Sheet>();
}

}  // namespace

double inside_box(const Vec2& local, const Vec2& half, const LayoutRecipe& recipe) {
  const double qx = std::abs(local.x()) - (half.x() - 0.5 * recipe.joint - recipe.corner);
  const double qy = std::abs(local.y()) - (half.y() - 0.5 * recipe.joint - recipe.corner);
  const double past_corner = elementary::hypot(std::max(qx, 0.0), std::max(qy, 0.0));
  return recipe.corner - past_corner - std::min(std::max(qx, qy), 0.0);
}

Layout::Layout(const LayoutRecipe& r, std::uint64_t seed) : cells_(make_cells(r, seed)) {
  if (r.warp > 0) {
    warp_ = Bend{r.warp,
                 {r.warp_frequency, r.warp_frequency, 3, 0.5, seed + 100},
                 {r.warp_frequency, r.warp_frequency, 3, 0.5, seed + 200}};
  }
  if (r.chip > 0) {
    chip_ = Bend{r.chip,
                 {r.chip_frequency, r.chip_frequency, 2, 0.6, seed + 300},
                 {r.chip_frequency, r.chip_frequency, 2, 0.6, seed + 400}};
  }
}

Spot Layout::at(double u, double v) const {
  double du = 0;
  double dv = 0;
  for (const auto* bend : {&warp_, &chip_}) {
    if (!*bend) continue;
    du += (*bend)->reach * (*bend)->u(u, v);
    dv += (*bend)->reach * (*bend)->v(u, v);
  }
  return cells_->at(u + du, v + dv);
}

// Rows of rectangles: bricks, tiles, planks, ashlar; without columns, endless strips.

namespace {

class Bond : public Cells {
 public:
  Bond(const LayoutRecipe& recipe, std::uint64_t seed) : r_(recipe), seed_(seed) {}

  Spot at(double u, double v) const override {
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

  // The k with border(k) <= x < border(k + 1); borders stray less than half a cell.
  template <class Border>
  static int cell(double x, const Border& border) {
    const int k = static_cast<int>(std::floor(x));
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

  Spot strip(double u, double v, int row, double low_v, double high_v) const {
    const Vec2 half(endless, 0.5 * (high_v - low_v));
    const Vec2 local(u, v - 0.5 * (low_v + high_v));
    return {0, row, inside_box(local, half, r_), local, half, 1};
  }

  // The piece, or that part of it that holds the point when chance cuts it across its longer side.
  Spot cut(double u, double v, int column, int row, Box box) const {
    if (r_.split > 0 && lattice_hash(column, row, seed_ + 13) < r_.split) {
      const double share = 0.36 + 0.28 * lattice_hash(column, row, seed_ + 14);
      const bool along_u = box.high_u - box.low_u > box.high_v - box.low_v;
      double& low = along_u ? box.low_u : box.low_v;
      double& high = along_u ? box.high_u : box.high_v;
      const double middle = low + share * (high - low);
      const bool upper = (along_u ? u : v) >= middle;
      (upper ? low : high) = middle;
      if (upper) column += r_.columns;  // a name of its own
    }
    const Vec2 half(0.5 * (box.high_u - box.low_u), 0.5 * (box.high_v - box.low_v));
    const Vec2 local(u - 0.5 * (box.low_u + box.high_u), v - 0.5 * (box.low_v + box.high_v));
    return {column, row, inside_box(local, half, r_), local, half, 1};
  }

  LayoutRecipe r_;
  std::uint64_t seed_;
};

}  // namespace

std::unique_ptr<Cells> make_bond(const LayoutRecipe& recipe, std::uint64_t seed) {
  return std::make_unique<Bond>(recipe, seed);
}

// Parquet in herringbone: pieces of 1 x `length` cells, lying and standing in turn.
//
// In cell (i, j) let k = (i - j) mod 2 length. Where k < length a lying piece began k cells to the left;
// elsewhere a standing one began 2 length - 1 - k cells below. It repeats when the cells a side are a
// multiple of 2 length.

namespace {

class Herringbone : public Cells {
 public:
  explicit Herringbone(const LayoutRecipe& recipe) : r_(recipe) {}

  Spot at(double u, double v) const override {
    const int n = r_.columns;
    const int length = r_.length;
    const int i = static_cast<int>(std::floor(u * n));
    const int j = static_cast<int>(std::floor(v * n));
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

}  // namespace

std::unique_ptr<Cells> make_herringbone(const LayoutRecipe& recipe, std::uint64_t) {
  return std::make_unique<Herringbone>(recipe);
}

// Voronoi cells about the sites of a jittered lattice: flagstones; without jitter and with every other row
// shifted, hexagons.

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

// Pebbles: ellipsoids of many sizes thrown on a bed, the large ones first, each where it finds room.

namespace {

struct Stone {
  Vec2 middle;
  Vec2 half;         // of its axes, the longer first
  Vec2 axis;         // unit, of the longer one
  double top, dome;  // how high it rises, and by how much its edge is lower

  // Along its axes, from its middle; tile of side 1.
  Vec2 local(const Vec2& p) const {
    const Vec2 d(nearest_image(p.x() - middle.x()), nearest_image(p.y() - middle.y()));
    return {d.dot(axis), d.y() * axis.x() - d.x() * axis.y()};
  }
};

class Scatter : public Cells {
 public:
  Scatter(const LayoutRecipe& recipe, std::uint64_t seed) {
    throw_stones(recipe, seed);
    for (std::size_t s = 0; s < stones_.size(); ++s) put_in_bins(static_cast<int>(s));
  }

  Spot at(double u, double v) const override {
    const Vec2 p(u, v);
    Spot best{0, 0, -1, Vec2::Zero(), Vec2(1, 1), 0};
    bool covered = false;
    for (const int s : bins_[bin(u) + bins_a_side * bin(v)]) {
      const Stone& stone = stones_[std::size_t(s)];
      const Vec2 local = stone.local(p);
      const double rho = local.cwiseQuotient(stone.half).norm();
      const double inside = (1 - rho) * stone.half.y();
      const double rise = rho < 1 ? stone.top - stone.dome * (1 - std::sqrt(1 - rho * rho)) : 0;
      // The highest stone is seen; off all stones, the nearest says how far.
      const bool better = rho < 1 ? !covered || rise > best.rise : !covered && inside > best.inside;
      if (!better) continue;
      covered = covered || rho < 1;
      best = {s, 0, inside, local, stone.half, rise};
    }
    return best;
  }

 private:
  static constexpr int bins_a_side = 32;
  static constexpr int tries = 60;  // for a place for one stone

  static std::size_t bin(double x) {
    return static_cast<std::size_t>(wrapped(static_cast<int>(std::floor(x * bins_a_side)), bins_a_side));
  }

  void throw_stones(const LayoutRecipe& recipe, std::uint64_t seed) {
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
      for (int t = 0; t < tries; ++t) {
        const double v = random.uniform(), u = random.uniform();  // in one order on every compiler
        stone.middle = Vec2(u, v);
        if (!has_room(stone)) continue;
        stones_.push_back(stone);
        break;
      }
    }
  }

  // Ellipses taken as touching where each one's radius towards the other meets; pebbles rest a little on
  // others.
  bool has_room(const Stone& stone) const {
    return std::all_of(stones_.begin(), stones_.end(), [&](const Stone& other) {
      const Vec2 there = stone.local(other.middle);
      const double distance = there.norm();
      if (distance > stone.half.x() + other.half.x()) return true;
      const double own = distance / std::max(1e-9, there.cwiseQuotient(stone.half).norm());
      const double its =
          distance / std::max(1e-9, other.local(stone.middle).cwiseQuotient(other.half).norm());
      return distance > 0.93 * (own + its);
    });
  }

  void put_in_bins(int s) {
    const Stone& stone = stones_[std::size_t(s)];
    // A margin of half a bin, so that points just off a stone know how far it is.
    const double reach = stone.half.x() + 0.5 / bins_a_side;
    const auto first = [](double x) { return static_cast<int>(std::floor(x * bins_a_side)); };
    for (int j = first(stone.middle.y() - reach); j <= first(stone.middle.y() + reach); ++j) {
      for (int i = first(stone.middle.x() - reach); i <= first(stone.middle.x() + reach); ++i) {
        bins_[std::size_t(wrapped(i, bins_a_side) + bins_a_side * wrapped(j, bins_a_side))].push_back(s);
      }
    }
  }

  std::vector<Stone> stones_;
  std::vector<std::vector<int>> bins_ = std::vector<std::vector<int>>(bins_a_side * bins_a_side);
};

}  // namespace

std::unique_ptr<Cells> make_scatter(const LayoutRecipe& recipe, std::uint64_t seed) {
  return std::make_unique<Scatter>(recipe, seed);
}

// The studs of tread plate: lenses in a lattice, turned by 45 degrees one way and the other in turn. As wide
// as they are long they are round.

namespace {

class Lugs : public Cells {
 public:
  explicit Lugs(const LayoutRecipe& recipe) : r_(recipe) {}

  Spot at(double u, double v) const override {
    const int i = static_cast<int>(std::floor(u * r_.columns));
    const int j = static_cast<int>(std::floor(v * r_.rows));
    const Vec2 d(u - (i + 0.5) / r_.columns, v - (j + 0.5) / r_.rows);
    const double turn = ((i + j) & 1) != 0 ? 1 : -1;
    const Vec2 local = Vec2(d.x() + turn * d.y(), d.y() - turn * d.x()) / std::numbers::sqrt2;
    return {
        wrapped(i, r_.columns), wrapped(j, r_.rows), inside(local), local, {r_.radius.y(), r_.radius.x()}, 1};
  }

 private:
  // Signed distance into the lens that two equal circles share.
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

}  // namespace

std::unique_ptr<Cells> make_lugs(const LayoutRecipe& recipe, std::uint64_t) {
  return std::make_unique<Lugs>(recipe);
}

// Woven wire: round wires that go over and under each other in turn.

namespace {

class Weave : public Cells {
 public:
  explicit Weave(const LayoutRecipe& recipe)
      : r_(recipe), radius_(0.5 * recipe.wire / std::max(recipe.columns, recipe.rows)) {}

  Spot at(double u, double v) const override {
    const Spot standing = wire(u * r_.columns, v * r_.rows, r_.columns, v, 0);
    const Spot lying = wire(v * r_.rows, u * r_.columns, r_.rows, u, 1);
    if (standing.inside <= 0 || lying.inside <= 0) return standing.inside > lying.inside ? standing : lying;
    return standing.rise > lying.rise ? standing : lying;
  }

 private:
  // The wire of a family nearest to a point: `across` and `along` count wires of this family and of the
  // other.
  Spot wire(double across, double along, int wires, double along_side, int family) const {
    const int k = static_cast<int>(std::floor(across));
    const double off = (across - k - 0.5) / wires;
    const double inside = radius_ - std::abs(off);
    const double over = ((k + family) & 1) != 0 ? -1 : 1;
    // From -1 to 2 radii: the middle swings by one radius, the round wire stands one above.
    const double swing = over * elementary::cos(std::numbers::pi * (along - 0.5));
    const double height = swing + std::sqrt(std::max(0.0, 1 - off * off / (radius_ * radius_)));
    return {wrapped(k, wires),      family,          inside, Vec2(along_side, off),
            Vec2(endless, radius_), (height + 1) / 3};
  }

  LayoutRecipe r_;
  double radius_;
};

}  // namespace

std::unique_ptr<Cells> make_weave(const LayoutRecipe& recipe, std::uint64_t) {
  return std::make_unique<Weave>(recipe);
}

}  // namespace intaglio::surface
