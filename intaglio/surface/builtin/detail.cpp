#include "intaglio/surface/builtin/detail.h"

#include <algorithm>
#include <cmath>

#include "intaglio/core/elementary.h"
#include "intaglio/surface/builtin/fractal.h"

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

}  // namespace intaglio::surface
