// Straight scratches at places and in directions of chance, thinning towards their ends.
#include <algorithm>
#include <numbers>
#include <vector>

#include "intaglio/core/elementary.h"
#include "intaglio/core/random.h"
#include "intaglio/surface/builtin/detail.h"

namespace intaglio::surface {

namespace {

struct Scratch {
  Vec2 middle;
  Vec2 direction;
  double half_length, half_width, strength;
};

class Scratches : public DetailField {
 public:
  Scratches(const LayerRecipe& layer, std::uint64_t seed) {
    Random random(seed);
    for (int k = 0; k < layer.count; ++k) {
      const double degrees = layer.direction + layer.spread * (random.uniform() - 0.5);
      const double angle = degrees * std::numbers::pi / 180;
      const double v = random.uniform(), u = random.uniform();  // in one order on every compiler
      const Vec2 middle(u, v);
      const double length = layer.length * random.uniform(0.25, 1);
      scratches_.push_back({middle, Vec2(elementary::cos(angle), elementary::sin(angle)), 0.5 * length,
                            0.5 * layer.width, random.uniform(0.3, 1)});
      put_in_bins(k);
    }
  }

  double at(const Place& place) const override {
    double deepest = 0;
    for (const int k : bins_[bin(place.x) + bins_a_side * bin(place.y)]) {
      const Scratch& s = scratches_[std::size_t(k)];
      const Vec2 d(nearest_image(place.x - s.middle.x()), nearest_image(place.y - s.middle.y()));
      const double along = d.dot(s.direction) / s.half_length;
      const double across = (d.y() * s.direction.x() - d.x() * s.direction.y()) / s.half_width;
      const double depth = (1 - along * along) * (1 - across * across);
      if (std::abs(along) < 1 && std::abs(across) < 1) deepest = std::max(deepest, s.strength * depth);
    }
    return deepest;
  }

 private:
  static constexpr int bins_a_side = 64;

  static std::size_t bin(double x) {
    return static_cast<std::size_t>(wrapped(static_cast<int>(std::floor(x * bins_a_side)), bins_a_side));
  }

  // Every bin that the scratch comes through: walked in steps of a quarter bin, with its neighbours.
  void put_in_bins(int k) {
    const Scratch& s = scratches_[std::size_t(k)];
    const int steps = static_cast<int>(std::ceil(8 * s.half_length * bins_a_side)) + 1;
    for (int step = 0; step <= steps; ++step) {
      const Vec2 p = s.middle + s.direction * s.half_length * (2.0 * step / steps - 1);
      for (const double du : {-s.half_width, s.half_width}) {
        for (const double dv : {-s.half_width, s.half_width}) {
          std::vector<int>& here = bins_[bin(p.x() + du) + bins_a_side * bin(p.y() + dv)];
          if (here.empty() || here.back() != k) here.push_back(k);
        }
      }
    }
  }

  std::vector<Scratch> scratches_;
  std::vector<std::vector<int>> bins_ = std::vector<std::vector<int>>(bins_a_side * bins_a_side);
};

}  // namespace

std::unique_ptr<DetailField> make_scratches(const LayerRecipe& layer, std::uint64_t seed) {
  return std::make_unique<Scratches>(layer, seed);
}

}  // namespace intaglio::surface
