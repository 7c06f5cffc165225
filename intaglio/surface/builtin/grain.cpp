// The growth rings of wood: pale early wood that darkens into late wood and ends abruptly, bent by noise, led
// around knots.
//
// Over a tile rings run along u, `count` a side. Along a piece they are circles about a pith that lies a
// little under the face, at a place of the piece's own: what plain sawing shows, wide in the middle and
// narrow at the sides.
#include <algorithm>
#include <numbers>
#include <vector>

#include "intaglio/core/elementary.h"
#include "intaglio/core/random.h"
#include "intaglio/surface/builtin/detail.h"
#include "intaglio/surface/builtin/fractal.h"
#include "intaglio/surface/noise.h"

namespace intaglio::surface {

namespace {

struct Knot {
  Vec2 middle;
  double radius;
  Spot home;  // it lies on this piece only
};

class Grain : public DetailField {
 public:
  Grain(const LayerRecipe& layer, const Layout& layout, std::uint64_t seed)
      : layer_(layer),
        seed_(seed),
        bend_(layer.frequency_u, layer.frequency_v, layer.octaves, layer.gain, seed) {
    Random random(seed + 50);
    for (int k = 0; k < layer.knots; ++k) {
      const double v = random.uniform(), u = random.uniform();  // in one order on every compiler
      const Vec2 middle(u, v);
      knots_.push_back({middle, layer.knot * random.uniform(0.45, 1), layout.at(middle.x(), middle.y())});
    }
  }

  double at(const Place& place) const override {
    const Detour detour = around_knots(place);
    const double rings = ring(place, detour.shift) + layer_.bend * bend_(place.x, place.y + detour.shift);
    const double wood = late_wood(rings);
    return wood + detour.in_knot * (detour.knot - wood);
  }

 private:
  // What knots do near a point: the rings seen there are those `shift` further across.
  struct Detour {
    double shift = 0;
    double in_knot = 0;  // share of the knot itself ...
    double knot = 0;     // ... and how dark it is
  };

  // Rings from the middle of the tree.
  double ring(const Place& place, double shift) const {
    if (layer_.along == Along::tile) return layer_.count * (place.y + shift);
    const auto chance = [&](std::uint64_t k) { return lattice_hash(place.spot.i, place.spot.j, seed_ + k); };
    const double pith = 1.6 * (chance(60) - 0.5) * place.spot.half.y();
    const double under = (0.15 + 1.2 * chance(61)) * place.spot.half.y();
    return layer_.count * elementary::hypot(place.spot.local.y() + shift - pith, under);
  }

  // 0 in the early wood to 1 in the late; a ring is stronger or weaker by chance.
  double late_wood(double rings) const {
    const double whole = std::floor(rings);
    const double t = rings - whole;
    const double strength =
        0.45 + 0.55 * lattice_hash(wrapped(static_cast<int>(whole), layer_.count), 0, seed_ + 62);
    return strength * t * t * smoothstep(1, 0.86, t) * 1.25;
  }

  // From a dark heart over rings of its own to the darker bark that it keeps, at `rho` radii.
  static double knot_darkness(double rho) {
    const double rings = 0.10 * elementary::cos(2 * std::numbers::pi * 2.5 * rho);
    const double heart = 0.55 + 0.20 * smoothstep(0.5, 0.0, rho) + 0.25 * smoothstep(0.6, 0.95, rho);
    return heart + rings;
  }

  Detour around_knots(const Place& place) const {
    Detour detour;
    for (const Knot& knot : knots_) {
      if (!knot.home.same_piece(place.spot)) continue;
      const double dx = nearest_image(place.u - knot.middle.x()) / knot.radius;
      const double dy = nearest_image(place.v - knot.middle.y()) / knot.radius;
      if (std::abs(dx) > 14 || std::abs(dy) > 8) continue;
      detour.shift -= dy * knot.radius * elementary::exp(-dx * dx / 14 - dy * dy / 5);
      const double rho = elementary::hypot(dx / 1.3, dy) * (1 + 0.35 * bend_(3 * place.u, 3 * place.v));
      if (rho > 1.12) continue;
      detour.in_knot = smoothstep(1.12, 0.95, rho);
      detour.knot = knot_darkness(rho);
    }
    return detour;
  }

  LayerRecipe layer_;
  std::uint64_t seed_;
  Fractal bend_;
  std::vector<Knot> knots_;
};

}  // namespace

std::unique_ptr<DetailField> make_grain(const LayerRecipe& layer, const Layout& layout, std::uint64_t seed) {
  return std::make_unique<Grain>(layer, layout, seed);
}

}  // namespace intaglio::surface
