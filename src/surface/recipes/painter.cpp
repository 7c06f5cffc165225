#include "surface/recipes/painter.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/portable_math.h"
#include "surface/recipes/noise.h"

namespace intaglio::surface {

namespace {

Fractal fractal_of(const LayerRecipe& layer, std::uint64_t seed) {
  return {layer.frequency_u, layer.frequency_v, layer.octaves, layer.gain, seed};
}

// What is made from the value of a fractal noise at the place.
template <class Shape>
class Shaped : public DetailField {
 public:
  Shaped(const LayerRecipe& layer, std::uint64_t seed, Shape shape)
      : noise_(fractal_of(layer, seed)), shape_(std::move(shape)) {}
  double at(const Place& place) const override { return shape_(noise_(place.x, place.y)); }

 private:
  Fractal noise_;
  Shape shape_;
};

template <class Shape>
std::unique_ptr<DetailField> shaped(const LayerRecipe& layer, std::uint64_t seed, Shape shape) {
  return std::make_unique<Shaped<Shape>>(layer, seed, std::move(shape));
}

// Terraces: the noise in `count` flat steps between -1 and 1 whose risers take up a share 1 - `threshold`.
double terraced(double noise, int count, double threshold) {
  const double level = (0.5 + 0.5 * noise) * count;
  const double step = std::floor(level);
  return 2 * (step + smoothstep(threshold, 1, level - step)) / count - 1;
}

// Round heads in a row along each side of a rectangular piece.
class Rivets : public DetailField {
 public:
  explicit Rivets(const LayerRecipe& layer) : layer_(layer) {}

  double at(const Place& place) const override {
    const Vec2 last = place.spot.half - Vec2(layer_.inset, layer_.inset);
    const Vec2 p = place.spot.local;
    if (last.minCoeff() <= 0 || !last.allFinite()) return 0;
    const Vec2 in_row(nearest(p.x(), last.x()), nearest(p.y(), last.y()));
    const double along_u = (p - Vec2(in_row.x(), std::copysign(last.y(), p.y()))).norm();
    const double along_v = (p - Vec2(std::copysign(last.x(), p.x()), in_row.y())).norm();
    const double distance = std::min(along_u, along_v) / (0.5 * layer_.width);
    return distance < 1 ? std::sqrt(1 - distance * distance) : 0;
  }

 private:
  // Of `count` places from -last to last, the one nearest to x.
  double nearest(double x, double last) const {
    const double gap = 2 * last / (layer_.count - 1);
    return std::clamp(std::round((x + last) / gap) * gap - last, -last, last);
  }

  LayerRecipe layer_;
};

// A flower of `count` petals in a circle, and quarter circles in the corners that meet those of the next
// pieces.
class Rosette : public DetailField {
 public:
  explicit Rosette(const LayerRecipe& layer) : layer_(layer) {}

  double at(const Place& place) const override {
    const double unit = place.spot.half.minCoeff();
    const Vec2 p = place.spot.local / unit;
    const double r = p.norm();
    const double angle = elementary::atan2(p.y(), p.x());
    const double petals = 0.24 + 0.34 * std::abs(elementary::cos(0.5 * layer_.count * angle));
    const double leaves = 0.20 + 0.18 * std::abs(elementary::sin(0.5 * layer_.count * angle));
    const double corner = (p.cwiseAbs() - Vec2(1, 1)).norm();
    const double width = layer_.width / unit;
    const auto line = [width](double off) { return elementary::exp(-off * off / (width * width)); };
    const double filled = std::max(smoothstep(leaves, leaves - 0.05, r), line(r - petals));
    return std::max({filled, line(r - 0.70), line(corner - 0.46), smoothstep(0.30, 0.25, corner)});
  }

 private:
  LayerRecipe layer_;
};

}  // namespace

std::unique_ptr<DetailField> make_detail(const LayerRecipe& layer, const Layout& layout, std::uint64_t seed) {
  switch (layer.detail) {
    case Detail::noise:
      return shaped(layer, seed, [](double noise) { return noise; });
    case Detail::pits:
      return shaped(layer, seed, [t = layer.threshold](double noise) { return std::max(0.0, -(noise + t)); });
    case Detail::veins:
      return shaped(layer, seed,
                    [w = layer.width](double noise) { return elementary::exp(-noise * noise / (w * w)); });
    case Detail::steps:
      return shaped(layer, seed,
                    [n = layer.count, t = layer.threshold](double noise) { return terraced(noise, n, t); });
    case Detail::grain:
      return make_grain(layer, layout, seed);
    case Detail::scratches:
      return make_scratches(layer, seed);
    case Detail::rivets:
      return std::make_unique<Rivets>(layer);
    case Detail::rosette:
      break;
  }
  return std::make_unique<Rosette>(layer);
}

Painter::Painter(const BuiltinRecipe& recipe) : r_(recipe), layout_(recipe.layout, recipe.seed) {
  for (const LayerRecipe& layer : r_.layers) {
    layers_.push_back(
        {layer, make_detail(layer, layout_, r_.seed + static_cast<std::uint64_t>(layer.stream))});
  }
}

Sample Painter::at(double u, double v) const {
  const Spot spot = layout_.at(u, v);
  const double bevel = r_.profile.bevel;
  const double on_piece = smoothstep(0.0, bevel, spot.inside);
  const double coloured = smoothstep(0.1 * bevel, 0.7 * bevel, spot.inside);
  Sample joint{r_.profile.joint, r_.colour.joint};
  if (on_piece < 1) joint = in_joint(u, v, spot);
  if (on_piece <= 0) return joint;
  const Sample piece = on_face(u, v, spot);
  return {std::clamp(joint.depth + on_piece * (piece.depth - joint.depth), 0.0, 1.0),
          joint.colour + coloured * (piece.colour - joint.colour)};
}

double Painter::chance(const Spot& spot, std::uint64_t k) const {
  return lattice_hash(spot.i, spot.j, r_.seed + k);
}

Painter::Coat Painter::coat(On on, double u, double v, const Spot& spot, const Vec3& colour) const {
  Coat sum{0, 1, colour};
  const Place on_tile{u, v, u, v, spot};
  const Place on_piece{u, v, spot.local.x() + chance(spot, 5), spot.local.y() + chance(spot, 6), spot};
  for (const auto& [layer, detail] : layers_) {
    if (layer.on != on && layer.on != On::both) continue;
    const double value = detail->at(layer.along == Along::tile ? on_tile : on_piece);
    sum.depth += layer.depth * value;
    sum.shade += layer.shade * value;
    sum.colour += std::clamp(layer.paint_amount * value, 0.0, 1.0) * (layer.paint - sum.colour);
  }
  sum.shade = std::max(sum.shade, 0.0);
  return sum;
}

Sample Painter::in_joint(double u, double v, const Spot& spot) const {
  const Coat c = coat(On::joints, u, v, spot, r_.colour.joint);
  return {std::clamp(r_.profile.joint + c.depth, 0.0, 1.0), (c.colour * c.shade).cwiseMin(1.0)};
}

Sample Painter::on_face(double u, double v, const Spot& spot) const {
  const ProfileRecipe& p = r_.profile;
  const Coat c = coat(On::pieces, u, v, spot, piece_colour(spot));
  const double tilt = (chance(spot, 1) - 0.5) * spot.local.x() / spot.half.x() +
                      (chance(spot, 2) - 0.5) * spot.local.y() / spot.half.y();
  const double wear = p.wear * elementary::exp(-std::max(0.0, spot.inside - p.bevel) / (0.6 * p.bevel));
  const double depth =
      p.face + p.lift * chance(spot, 0) + p.tilt * tilt + p.crown * (1 - spot.rise) + c.depth + wear;
  const double rim =
      r_.colour.rim_amount * elementary::exp(-std::max(0.0, spot.inside) / r_.colour.rim_reach);
  const Vec2& range = r_.colour.shade;
  const double shade = c.shade * (range.x() + (range.y() - range.x()) * chance(spot, 3));
  return {depth, ((c.colour + rim * (r_.colour.rim - c.colour)) * shade).cwiseMin(1.0)};
}

// Somewhere along the list of colours, or in turn like a chessboard.
Vec3 Painter::piece_colour(const Spot& spot) const {
  const std::vector<Vec3>& list = r_.colour.pieces;
  if (list.size() == 1) return list[0];
  if (r_.colour.checker) return list[static_cast<std::size_t>(spot.i + spot.j) % list.size()];
  const double along = chance(spot, 4) * static_cast<double>(list.size() - 1);
  const auto k = static_cast<std::size_t>(along);
  return list[k] + (along - static_cast<double>(k)) * (list[k + 1] - list[k]);
}

// The growth rings of wood: pale early wood that darkens into late wood and ends abruptly, bent by noise, led
// around knots.
//
// Over a tile rings run along u, `count` a side. Along a piece they are circles about a pith that lies a
// little under the face, at a place of the piece's own: what plain sawing shows, wide in the middle and
// narrow at the sides.

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

// Straight scratches at places and in directions of chance, thinning towards their ends.

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
