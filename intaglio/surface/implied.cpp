#include "intaglio/surface/implied.h"

#include <algorithm>
#include <cmath>

#include "intaglio/surface/fuse.h"

namespace intaglio::surface {

namespace {

constexpr double least_mean_slope = 1e-3;

// Height differences from texel to texel, metres, and their mean.
struct Differences {
  Slopes slopes;
  Vec2 mean = Vec2::Zero();
};

Differences differences(const Surface& map) {
  const int w = map.width(), h = map.height();
  const std::vector<float> normals = map.normal_texture();
  Differences out{{Field(w, h), Field(w, h)}, Vec2::Zero()};
  for (std::size_t k = 0; k < out.slopes.x.value.size(); ++k) {
    const Vec2 slope = slope_of(Vec3(normals[3 * k], normals[3 * k + 1], normals[3 * k + 2]));
    const Vec2 d(slope.x() * map.texel_u(), slope.y() * map.texel_v());
    out.slopes.x.value[k] = static_cast<float>(d.x());
    out.slopes.y.value[k] = static_cast<float>(d.y());
    out.mean += d;
  }
  out.mean /= static_cast<double>(out.slopes.x.value.size());
  for (float& d : out.slopes.x.value) d -= static_cast<float>(out.mean.x());
  for (float& d : out.slopes.y.value) d -= static_cast<float>(out.mean.y());
  return out;
}

Placement raised(const Placement& place, double by) {
  Mat3 axes;
  axes << place.t(), place.n(), -place.b();
  const Vec3 centre = place.to_world({place.size_u() / 2, place.size_v() / 2, by});
  return {centre, Quat(axes), place.size_u(), place.size_v()};
}

}  // namespace

ImpliedRelief implied_relief(const Surface& map) {
  const Differences given = differences(map);
  FuseInput input;
  input.slopes = given.slopes;
  input.edge = map.edge() == Edge::wrap ? FuseEdge::periodic : FuseEdge::mirrored;
  Field height = fuse(input).height;

  ImpliedRelief out;
  const Vec2 mean(given.mean.x() / map.texel_u(), given.mean.y() / map.texel_v());
  if (mean.norm() > least_mean_slope) out.mean_slope = mean;
  std::vector<double> z(height.value.begin(), height.value.end());
  for (int j = 0; j < height.height; ++j) {
    for (int i = 0; i < height.width; ++i) {
      const Vec2 from_middle((i + 0.5 - 0.5 * height.width) * map.texel_u(),
                             (j + 0.5 - 0.5 * height.height) * map.texel_v());
      z[std::size_t(j) * std::size_t(height.width) + std::size_t(i)] += out.mean_slope.dot(from_middle);
    }
  }
  const auto [low, high] = std::minmax_element(z.begin(), z.end());
  const double range = *high - *low, top = *high;
  Texels texels;
  texels.width = map.width();
  texels.height = map.height();
  const std::vector<float> normals = map.normal_texture();
  for (std::size_t k = 0; k < z.size(); ++k) {
    texels.depth.push_back(range > 0 ? static_cast<float>((top - z[k]) / range) : 0);
    texels.normal.push_back(Vec3(normals[3 * k], normals[3 * k + 1], normals[3 * k + 2]).normalized());
  }
  texels.colour = Image8(1, 1, 3);
  const Edge edge = out.mean_slope.isZero() ? map.edge() : Edge::clamp;
  out.surface = std::make_shared<const Surface>(std::move(texels), raised(map.placement(), top), range, edge);
  return out;
}

}  // namespace intaglio::surface
