#include "intaglio/surface/builtin/painter.h"

#include <algorithm>

#include "intaglio/core/elementary.h"
#include "intaglio/surface/noise.h"

namespace intaglio::surface {

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

}  // namespace intaglio::surface
