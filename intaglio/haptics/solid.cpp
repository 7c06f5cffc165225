#include "intaglio/haptics/solid.h"

#include <algorithm>

namespace intaglio::haptics {

namespace {

// Catmull-Rom overshoots an edge by at most an eighth of its height along each axis.
constexpr double overshoot = 0.27;

double mean_height(const surface::Surface& s) {
  const double coarsest = 4 * std::max(s.placement().size_u(), s.placement().size_v());
  return s.smooth({0.5, 0.5}, coarsest).height;
}

}  // namespace

FeltRelief::FeltRelief(std::shared_ptr<const surface::Surface> surface, const SolidOptions& options)
    : surface_(std::move(surface)),
      footprint_(options.footprint),
      flat_(options.representation == Representation::flat || surface_->is_flat()) {
  if (flat_) return;
  if (options.representation == Representation::normal) offset_ = mean_height(*surface_);
  top_ = overshoot * surface_->max_depth() - offset_;
}

TexturedSlab::TexturedSlab(std::shared_ptr<const surface::Surface> surface, const SolidOptions& options)
    : relief_(std::move(surface), options), thickness_(options.thickness) {}

Penetration TexturedSlab::at(const Vec3& p) const {
  const surface::Placement& place = relief_.surface().placement();
  const Vec3 local = place.to_local(p);
  // The nearest of four sides and the underside.
  Penetration nearest{local.x(), Vec3::UnitX()};
  const auto offer = [&](double depth, const Vec3& gradient) {
    if (depth < nearest.depth) nearest = {depth, gradient};
  };
  offer(place.size_u() - local.x(), -Vec3::UnitX());
  offer(local.y(), Vec3::UnitY());
  offer(place.size_v() - local.y(), -Vec3::UnitY());
  offer(local.z() + thickness_, Vec3::UnitZ());
  if (local.z() > relief_.top()) {
    offer(relief_.top() - local.z(), -Vec3::UnitZ());
  } else if (nearest.depth > 0) {
    const surface::Smooth s = relief_.at(place.uv(local));
    offer(s.height - local.z(), {s.gradient.x(), s.gradient.y(), -1});
  }
  return {nearest.depth, place.direction_to_world(nearest.gradient)};
}

TexturedMesh::TexturedMesh(std::shared_ptr<const surface::Surface> surface, surface::MeshPlacement mesh,
                           double reach, const SolidOptions& options)
    : relief_(std::move(surface), options), mesh_(std::move(mesh)), reach_(reach) {}

Penetration TexturedMesh::at(const Vec3& p) const {
  const auto base = mesh_.closest(p, reach_);
  if (!base) return {};
  const surface::Smooth s = relief_.at(base->uv);
  const surface::Placement& place = relief_.surface().placement();
  // Slope per unit of (u, v), then along the base: the inverse transpose of what a step of (u, v) is there.
  const Vec2 per_uv(s.gradient.x() * place.size_u(), s.gradient.y() * place.size_v());
  const Eigen::Matrix2d stretch = mesh_.stretch(*base);
  const double area = stretch.determinant();
  Vec2 slope = Vec2::Zero();
  if (std::abs(area) > 1e-300) {
    slope = {(stretch(1, 1) * per_uv.x() - stretch(1, 0) * per_uv.y()) / area,
             (stretch(0, 0) * per_uv.y() - stretch(0, 1) * per_uv.x()) / area};
  }
  return {s.height - base->height, base->direction_to_world({slope.x(), slope.y(), -1})};
}

}  // namespace intaglio::haptics
