#include "mesh/mesh_placement.h"

#include <fmt/format.h>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "core/portable_math.h"
#include "mesh/base_patch.h"
#include "mesh/triangle_search.h"

namespace intaglio::surface {

namespace {

struct Fold {
  double depth = std::numeric_limits<double>::infinity();
  int triangle = -1;
};

// Heights that differ by less than this, relative, are the same base point seen from both sides of an edge.
constexpr double same_height = 1e-12;

struct Candidate {
  Projection projection;
  int triangle = -1;
};

// Whether `next` is nearer than `best`; on an edge the triangle of lower number wins, independent of visiting
// order.
bool is_nearer(const Candidate& next, const Candidate& best) {
  if (best.triangle < 0) return true;
  const double difference = std::abs(next.projection.height) - std::abs(best.projection.height);
  const double same = same_height * std::abs(best.projection.height);
  return difference < -same || (difference <= same && next.triangle < best.triangle);
}

}  // namespace

struct MeshPlacement::Base {
  std::string name;
  TriangleMesh mesh;
  CornerTangents tangents;
  UvGrid grid;
  TriangleTree tree;
  std::vector<PatchBounds> bounds;
  double size = 0;  // metres: no two points of the mesh are farther apart
  Fold fold;

  BasePatch patch(int triangle) const { return patch_of(mesh, triangle); }

  void measure_patches();
  Candidate nearest_triangle(const Vec3& world, double reach) const;
  Candidate nearest_base(const Vec3& world, double reach) const;
};

MeshPlacement::MeshPlacement(std::shared_ptr<const Base> base) : base_(std::move(base)) {}

Result<MeshPlacement> MeshPlacement::make(TriangleMesh raw, const std::string& name) {
  auto mesh = checked(std::move(raw), name);
  if (!mesh) return tl::unexpected(mesh.error());
  auto tree = TriangleTree::make(*mesh, name);
  if (!tree) return tl::unexpected(tree.error());
  CornerTangents tangents = corner_tangents(*mesh);
  UvGrid grid(*mesh);
  auto base = std::make_shared<Base>(
      Base{name, std::move(*mesh), std::move(tangents), std::move(grid), std::move(*tree), {}, 0, Fold{}});
  base->measure_patches();
  return MeshPlacement(std::move(base));
}

void MeshPlacement::Base::measure_patches() {
  Eigen::AlignedBox3d box;
  for (const Vec3& position : mesh.positions) box.extend(position);
  size = box.diagonal().norm();
  bounds.reserve(mesh.triangles.size());
  for (int k = 0; k < int(mesh.triangles.size()); ++k) {
    const BasePatch it = patch(k);
    bounds.emplace_back(it);
    if (const double depth = surface::fold_depth(it); depth < fold.depth) fold = {depth, k};
  }
}

// The triangle nearest to the point, ignoring normals.
Candidate MeshPlacement::Base::nearest_triangle(const Vec3& world, double reach) const {
  Candidate best{{Vec3::Zero(), reach}, -1};
  tree.search(world, reach, [&](int triangle) {
    const double distance = triangle_distance(patch(triangle), world);
    if (distance <= best.projection.height) best = {{Vec3::Zero(), distance}, triangle};
    return best.projection.height;
  });
  return best;
}

Candidate MeshPlacement::Base::nearest_base(const Vec3& world, double reach) const {
  Candidate best;
  double radius = reach;
  // The base point lies on the flat triangle, exactly |height| away, so the best height so far bounds the
  // search.
  tree.search(world, reach, [&](int triangle) {
    if (!bounds[std::size_t(triangle)].may_reach(world, radius)) return radius;
    if (const auto projection = project(patch(triangle), world, radius)) {
      const Candidate next{*projection, triangle};
      if (is_nearer(next, best)) best = next;
      radius = std::min(reach, std::abs(best.projection.height) * (1 + 2 * same_height));
    }
    return radius;
  });
  return best;
}

const TriangleMesh& MeshPlacement::mesh() const {
  return base_->mesh;
}

std::optional<BasePoint> MeshPlacement::closest(const Vec3& world, double reach) const {
  if (!world.allFinite() || !(reach > 0)) return std::nullopt;
  const Candidate flat = base_->nearest_triangle(world, reach);
  if (flat.triangle < 0) return std::nullopt;
  // No base point is nearer than the nearest flat triangle, and most are only slightly farther: so the search
  // begins with the distance of a base point in a disc of one triangle's size around the foot of the point,
  // and grows. Each answer is exact within its radius; only the radii are a guess.
  const double distance = flat.projection.height;
  reach = std::min(reach, distance + base_->size);
  Candidate best;
  for (double disc = 2 * base_->bounds[std::size_t(flat.triangle)].radius; best.triangle < 0; disc *= 2) {
    const double radius = std::min(reach, elementary::hypot(distance, disc));
    best = base_->nearest_base(world, radius);
    if (radius == reach) break;
  }
  if (best.triangle < 0) return std::nullopt;
  return at(best.triangle, best.projection.weights, best.projection.height);
}

BasePoint MeshPlacement::at(int triangle, const Vec3& weights, double height) const {
  assert(triangle >= 0 && std::size_t(triangle) < base_->mesh.triangles.size());
  const auto k = std::size_t(triangle);
  const Triangle& corners = base_->mesh.triangles[k];
  const BasePatch patch = base_->patch(triangle);
  Vec2 uv = Vec2::Zero();
  Vec3 tangent = Vec3::Zero();
  for (std::size_t corner = 0; corner < 3; ++corner) {
    const double weight = weights[Eigen::Index(corner)];
    uv += weight * base_->mesh.uvs[std::size_t(corners[corner])];
    tangent += weight * base_->tangents.t[k][corner];
  }
  const TangentFrame frame = frame_along(patch.normal(weights), tangent, base_->tangents.handedness[k]);
  return {uv, height, patch.position(weights), frame.t, frame.b, frame.n, triangle, weights};
}

std::optional<BasePoint> MeshPlacement::at(const Vec2& uv, double height) const {
  const auto hit = base_->grid.find(uv);
  if (!hit) return std::nullopt;
  return at(hit->triangle, hit->weights, height);
}

Vec3 MeshPlacement::to_world(int triangle, const Vec3& weights, double height) const {
  const BasePatch patch = base_->patch(triangle);
  return patch.position(weights) + height * patch.normal(weights);
}

std::optional<Vec3> MeshPlacement::to_world(const Vec2& uv, double height) const {
  const auto hit = base_->grid.find(uv);
  if (!hit) return std::nullopt;
  return to_world(hit->triangle, hit->weights, height);
}

Eigen::Matrix2d MeshPlacement::stretch(const BasePoint& at) const {
  const UvDerivatives derivatives = uv_derivatives(base_->mesh, std::size_t(at.triangle));
  Eigen::Matrix2d metres;
  metres << at.t.dot(derivatives.by_u), at.t.dot(derivatives.by_v), at.b.dot(derivatives.by_u),
      at.b.dot(derivatives.by_v);
  return metres;
}

double MeshPlacement::fold_depth() const {
  return base_->fold.depth;
}

Result<void> MeshPlacement::check_depth(double depth) const {
  const Fold& fold = base_->fold;
  if (depth < fold.depth) return {};
  if (fold.depth == 0)
    return fail(base_->name,
                fmt::format("triangle {} faces away from its vertex normals, so no relief is possible",
                            fold.triangle),
                "recompute the normals, or export the mesh without them");
  const Vec3 middle = base_->patch(fold.triangle).position(Vec3::Constant(1.0 / 3));
  return fail(base_->name,
              fmt::format("relief {:.4g} m deep folds at triangle {}, near ({:.4g}, {:.4g}, {:.4g}), whose "
                          "radius of curvature is {:.4g} m",
                          depth, fold.triangle, middle.x(), middle.y(), middle.z(), fold.depth),
              fmt::format("its depth must be less than {:.4g} m there", fold.depth));
}

}  // namespace intaglio::surface
