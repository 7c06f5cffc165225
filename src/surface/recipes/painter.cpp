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

// Applies a function to fractal noise.
template <class Shape>
class Shaped : public DetailField {
 public:
  Shaped(const LayerRecipe& layer, std::uint64_t seed, Shape shape)
      : noise_(fractal_of(layer, seed)), shape_(std::move(shape)) {}
  double at(const DetailPoint& place) const override { return shape_(noise_(place.x, place.y)); }

 private:
  Fractal noise_;
  Shape shape_;
};

template <class Shape>
std::unique_ptr<DetailField> shaped(const LayerRecipe& layer, std::uint64_t seed, Shape shape) {
  return std::make_unique<Shaped<Shape>>(layer, seed, std::move(shape));
}

// Terraces: the noise in `count` flat steps between -1 and 1 whose risers take up the fraction 1 -
// `threshold`.
double terraced(double noise, int count, double threshold) {
  const double level = (0.5 + 0.5 * noise) * count;
  const double step = std::floor(level);
  return 2 * (step + smoothstep(threshold, 1, level - step)) / count - 1;
}

// Round heads in a row along each side of a rectangular piece.
class Rivets : public DetailField {
 public:
  explicit Rivets(const LayerRecipe& layer) : layer_(layer) {}

  double at(const DetailPoint& place) const override {
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
  // The nearest to x of `count` positions from -last to last.
  double nearest(double x, double last) const {
    const double gap = 2 * last / (layer_.count - 1);
    return std::clamp(std::round((x + last) / gap) * gap - last, -last, last);
  }

  LayerRecipe layer_;
};

// A flower of `count` petals in a circle, and quarter circles in the corners that meet those of the next
// pieces. The proportions are chosen by eye.
class Rosette : public DetailField {
 public:
  explicit Rosette(const LayerRecipe& layer) : layer_(layer) {}

  double at(const DetailPoint& place) const override {
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

// The growth rings of wood: early wood darkens into late wood, then ends abruptly; distorted by noise and
// deflected around knots. The constants are chosen by eye.
//
// Along the tile, rings run along u, `count` per side. Along a piece they are circles about a pith a little
// below the face, at a per-piece offset: the look of plain-sawn boards, wide in the middle and narrow at the
// sides.
struct Knot {
  Vec2 middle;
  double radius;
  PiecePoint home;  // on the only piece that shows it
};

class Grain : public DetailField {
 public:
  Grain(const LayerRecipe& layer, const Layout& layout, std::uint64_t seed)
      : layer_(layer),
        seed_(seed),
        bend_(layer.frequency_u, layer.frequency_v, layer.octaves, layer.gain, seed) {
    Random random(seed + 50);
    for (int k = 0; k < layer.knots; ++k) {
      const double v = random.uniform(), u = random.uniform();  // sequenced, unlike function arguments
      const Vec2 middle(u, v);
      knots_.push_back({middle, layer.knot * random.uniform(0.45, 1), layout.at(middle.x(), middle.y())});
    }
  }

  double at(const DetailPoint& place) const override {
    const KnotEffect knot_effect = around_knots(place);
    const double rings =
        ring(place, knot_effect.shift) + layer_.bend * bend_(place.x, place.y + knot_effect.shift);
    const double wood = late_wood(rings);
    return wood + knot_effect.in_knot * (knot_effect.knot - wood);
  }

 private:
  struct KnotEffect {
    double shift = 0;    // across the rings, of the rings that appear at the point
    double in_knot = 0;  // weight of the knot itself
    double knot = 0;     // and its darkness
  };

  // Number of rings from the pith.
  double ring(const DetailPoint& place, double shift) const {
    if (layer_.along == Axes::tile) return layer_.count * (place.y + shift);
    const auto random_value = [&](std::uint64_t k) {
      return lattice_hash(place.spot.i, place.spot.j, seed_ + k);
    };
    const double pith = 1.6 * (random_value(60) - 0.5) * place.spot.half.y();
    const double under = (0.15 + 1.2 * random_value(61)) * place.spot.half.y();
    return layer_.count * elementary::hypot(place.spot.local.y() + shift - pith, under);
  }

  // 0 in early wood to 1 in late wood, with a random strength per ring.
  double late_wood(double rings) const {
    const double ring_index = std::floor(rings);
    const double t = rings - ring_index;
    const double strength = 0.45 + 0.55 * lattice_hash(wrapped(int(ring_index), layer_.count), 0, seed_ + 62);
    return strength * t * t * smoothstep(1, 0.86, t) * 1.25;
  }

  // Knot darkness at `rho` radii: dark core, rings, dark bark edge.
  static double knot_darkness(double rho) {
    const double rings = 0.10 * elementary::cos(2 * std::numbers::pi * 2.5 * rho);
    const double heart = 0.55 + 0.20 * smoothstep(0.5, 0.0, rho) + 0.25 * smoothstep(0.6, 0.95, rho);
    return heart + rings;
  }

  KnotEffect around_knots(const DetailPoint& place) const {
    KnotEffect knot_effect;
    for (const Knot& knot : knots_) {
      if (!knot.home.same_piece(place.spot)) continue;
      const double dx = nearest_image(place.u - knot.middle.x()) / knot.radius;
      const double dy = nearest_image(place.v - knot.middle.y()) / knot.radius;
      if (std::abs(dx) > 14 || std::abs(dy) > 8) continue;
      knot_effect.shift -= dy * knot.radius * elementary::exp(-dx * dx / 14 - dy * dy / 5);
      const double rho = elementary::hypot(dx / 1.3, dy) * (1 + 0.35 * bend_(3 * place.u, 3 * place.v));
      if (rho > 1.12) continue;
      knot_effect.in_knot = smoothstep(1.12, 0.95, rho);
      knot_effect.knot = knot_darkness(rho);
    }
    return knot_effect;
  }

  LayerRecipe layer_;
  std::uint64_t seed_;
  Fractal bend_;
  std::vector<Knot> knots_;
};

// Straight scratches with random positions and directions, tapering at the ends.
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
      const double direction = layer.direction + layer.spread * (random.uniform() - 0.5);
      const double angle = direction * std::numbers::pi / 180;
      const double v = random.uniform(), u = random.uniform();  // sequenced, unlike function arguments
      const Vec2 middle(u, v);
      const double length = layer.length * random.uniform(0.25, 1);
      scratches_.push_back({middle, Vec2(elementary::cos(angle), elementary::sin(angle)), 0.5 * length,
                            0.5 * layer.width, random.uniform(0.3, 1)});
      put_in_bins(k);
    }
  }

  double at(const DetailPoint& place) const override {
    double deepest = 0;
    for (const int k : bins_.at(place.x, place.y)) {
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
  // Adds the scratch to every bin it crosses, walking along it in steps of a quarter bin.
  void put_in_bins(int k) {
    const Scratch& s = scratches_[std::size_t(k)];
    const int steps = int(std::ceil(8 * s.half_length * bins_.per_side())) + 1;
    for (int step = 0; step <= steps; ++step) {
      const Vec2 p = s.middle + s.direction * s.half_length * (2.0 * step / steps - 1);
      for (const double du : {-s.half_width, s.half_width}) {
        for (const double dv : {-s.half_width, s.half_width}) {
          std::vector<int>& here = bins_.at(bins_.coordinate(p.x() + du), bins_.coordinate(p.y() + dv));
          if (here.empty() || here.back() != k) here.push_back(k);
        }
      }
    }
  }

  std::vector<Scratch> scratches_;
  Bins bins_{64};
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
      return std::make_unique<Grain>(layer, layout, seed);
    case Detail::scratches:
      return std::make_unique<Scratches>(layer, seed);
    case Detail::rivets:
      return std::make_unique<Rivets>(layer);
    case Detail::rosette:
      break;
  }
  return std::make_unique<Rosette>(layer);
}

Painter::Painter(const Recipe& recipe) : r_(recipe), layout_(recipe.layout, recipe.seed) {
  for (const LayerRecipe& layer : r_.layers) {
    layers_.push_back({layer, make_detail(layer, layout_, r_.seed + std::uint64_t(layer.stream))});
  }
}

PaintedPoint Painter::at(double u, double v) const {
  const PiecePoint spot = layout_.at(u, v);
  const double bevel = r_.profile.bevel;
  const double on_piece = smoothstep(0.0, bevel, spot.inside);
  const double coloured = smoothstep(0.1 * bevel, 0.7 * bevel, spot.inside);
  PaintedPoint joint{r_.profile.joint, r_.colour.joint};
  if (on_piece < 1) joint = in_joint(u, v, spot);
  if (on_piece <= 0) return joint;
  const PaintedPoint piece = on_face(u, v, spot);
  return {std::clamp(joint.depth + on_piece * (piece.depth - joint.depth), 0.0, 1.0),
          joint.colour + coloured * (piece.colour - joint.colour)};
}

double Painter::random_value(const PiecePoint& spot, std::uint64_t k) const {
  return lattice_hash(spot.i, spot.j, r_.seed + k);
}

Painter::LayerSum Painter::sum_layers(AppliesTo on, double u, double v, const PiecePoint& spot,
                                      const Vec3& colour) const {
  LayerSum sum{0, 1, colour};
  const DetailPoint on_tile{u, v, u, v, spot};
  const DetailPoint on_piece{u, v, spot.local.x() + random_value(spot, 5),
                             spot.local.y() + random_value(spot, 6), spot};
  for (const auto& [layer, detail] : layers_) {
    if (layer.on != on && layer.on != AppliesTo::both) continue;
    const double value = detail->at(layer.along == Axes::tile ? on_tile : on_piece);
    sum.depth += layer.depth * value;
    sum.shade += layer.shade * value;
    sum.colour += std::clamp(layer.paint_amount * value, 0.0, 1.0) * (layer.paint - sum.colour);
  }
  sum.shade = std::max(sum.shade, 0.0);
  return sum;
}

PaintedPoint Painter::in_joint(double u, double v, const PiecePoint& spot) const {
  const LayerSum c = sum_layers(AppliesTo::joints, u, v, spot, r_.colour.joint);
  return {std::clamp(r_.profile.joint + c.depth, 0.0, 1.0), (c.colour * c.shade).cwiseMin(1.0)};
}

PaintedPoint Painter::on_face(double u, double v, const PiecePoint& spot) const {
  const ProfileRecipe& p = r_.profile;
  const LayerSum c = sum_layers(AppliesTo::pieces, u, v, spot, piece_colour(spot));
  const double tilt = (random_value(spot, 1) - 0.5) * spot.local.x() / spot.half.x() +
                      (random_value(spot, 2) - 0.5) * spot.local.y() / spot.half.y();
  const double wear = p.wear * elementary::exp(-std::max(0.0, spot.inside - p.bevel) / (0.6 * p.bevel));
  const double depth =
      p.face + p.lift * random_value(spot, 0) + p.tilt * tilt + p.crown * (1 - spot.rise) + c.depth + wear;
  const double rim =
      r_.colour.rim_amount * elementary::exp(-std::max(0.0, spot.inside) / r_.colour.rim_reach);
  const Vec2& range = r_.colour.shade;
  const double shade = c.shade * (range.x() + (range.y() - range.x()) * random_value(spot, 3));
  return {depth, ((c.colour + rim * (r_.colour.rim - c.colour)) * shade).cwiseMin(1.0)};
}

// A random colour along the list, or the colours in turn as on a chessboard.
Vec3 Painter::piece_colour(const PiecePoint& spot) const {
  const std::vector<Vec3>& list = r_.colour.pieces;
  if (list.size() == 1) return list[0];
  if (r_.colour.checker) return list[std::size_t(spot.i + spot.j) % list.size()];
  const double along = random_value(spot, 4) * double(list.size() - 1);
  const auto k = std::size_t(along);
  return list[k] + (along - double(k)) * (list[k + 1] - list[k]);
}

}  // namespace intaglio::surface
