// Pebbles: ellipsoids of many sizes thrown on a bed, the large ones first, each where it finds room.
#include <algorithm>
#include <numbers>
#include <vector>

#include "intaglio/core/elementary.h"
#include "intaglio/core/random.h"
#include "intaglio/surface/builtin/layout.h"

namespace intaglio::surface {

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

}  // namespace intaglio::surface
