#include "mesh/mesh_placement.h"

#include <cassert>
#include <cmath>
#include <limits>
#include <utility>
#include <fmt/format.h>

#include "core/portable_math.h"
#include "mesh/base_patch.h"
#include "mesh/triangle_search.h"

namespace intaglio::surface {

namespace {

struct Fold {
  double depth = std::numeric_limits<double>::infinity();
  int triangle = -1;
};

// Heights nearer to each other than this, relative, are the same base point seen from both sides of an edge.
constexpr double same_height = 1e-12;

struct Candidate {
  Projection projection;
  int triangle = -1;
};

// Whether `next` is nearer than `best`; on an edge the triangle of lower number wins, in whichever order they
// are found.
bool nearer(const Candidate& next, const Candidate& best) {
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

  BasePatch patch(int triangle) const {
    const auto [a, b, c] = mesh.triangles[static_cast<std::size_t>(triangle)];
    const auto& p = mesh.positions;
    const auto& n = mesh.normals;
    const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(b),
               k = static_cast<std::size_t>(c);
    return {{p[i], p[j], p[k]}, {n[i], n[j], n[k]}};
  }

  void measure_patches();
  Candidate nearest_flat(const Vec3& world, double reach) const;
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
  for (int k = 0; k < static_cast<int>(mesh.triangles.size()); ++k) {
    const BasePatch it = patch(k);
    bounds.emplace_back(it);
    if (const double depth = surface::fold_depth(it); depth < fold.depth) fold = {depth, k};
  }
}

// The triangle nearest to the point, normals aside.
Candidate MeshPlacement::Base::nearest_flat(const Vec3& world, double reach) const {
  Candidate best{{Vec3::Zero(), reach}, -1};
  tree.search(world, reach, [&](int triangle) {
    const double distance = flat_distance(patch(triangle), world);
    if (distance <= best.projection.height) best = {{Vec3::Zero(), distance}, triangle};
    return best.projection.height;
  });
  return best;
}

Candidate MeshPlacement::Base::nearest_base(const Vec3& world, double reach) const {
  Candidate best;
  double radius = reach;
  // The base point lies on the flat triangle, exactly |height| away: the best height so far bounds the
  // search.
  tree.search(world, reach, [&](int triangle) {
    if (!bounds[static_cast<std::size_t>(triangle)].may_reach(world, radius)) return radius;
    if (const auto projection = project(patch(triangle), world, radius)) {
      const Candidate next{*projection, triangle};
      if (nearer(next, best)) best = next;
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
  const Candidate flat = base_->nearest_flat(world, reach);
  if (flat.triangle < 0) return std::nullopt;
  // No base point is nearer than the flat triangles, and most are hardly farther: so the search grows from
  // there, first over a disc of one triangle's size around the foot of the point, each time over one twice as
  // wide.
  const double distance = flat.projection.height;
  reach = std::min(reach, distance + base_->size);
  Candidate best;
  for (double disc = 2 * base_->bounds[static_cast<std::size_t>(flat.triangle)].radius; best.triangle < 0;
       disc *= 2) {
    const double radius = std::min(reach, elementary::hypot(distance, disc));
    best = base_->nearest_base(world, radius);
    if (radius == reach) break;
  }
  if (best.triangle < 0) return std::nullopt;
  return at(best.triangle, best.projection.weights, best.projection.height);
}

BasePoint MeshPlacement::at(int triangle, const Vec3& weights, double height) const {
  assert(triangle >= 0 && static_cast<std::size_t>(triangle) < base_->mesh.triangles.size());
  const auto k = static_cast<std::size_t>(triangle);
  const Triangle& corners = base_->mesh.triangles[k];
  const BasePatch patch = base_->patch(triangle);
  Vec2 uv = Vec2::Zero();
  Vec3 tangent = Vec3::Zero();
  for (std::size_t corner = 0; corner < 3; ++corner) {
    const double weight = weights[static_cast<Eigen::Index>(corner)];
    uv += weight * base_->mesh.uvs[static_cast<std::size_t>(corners[corner])];
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
  const UvDerivatives derivatives = uv_derivatives(base_->mesh, static_cast<std::size_t>(at.triangle));
  Eigen::Matrix2d metres;
  metres << at.t.dot(derivatives.by_u), at.t.dot(derivatives.by_v), at.b.dot(derivatives.by_u),
      at.b.dot(derivatives.by_v);
  return metres;
}

double MeshPlacement::fold_depth() const {
  return base_->fold.depth;
}

int MeshPlacement::fold_triangle() const {
  return base_->fold.triangle;
}

Result<void> MeshPlacement::check_depth(double wanted) const {
  const Fold& fold = base_->fold;
  if (wanted < fold.depth) return {};
  if (fold.depth == 0)
    return fail(
        base_->name,
        fmt::format("the normals of triangle {} turn away from it: no relief is possible", fold.triangle),
        "recompute the normals, or export the mesh without them");
  const Vec3 middle = base_->patch(fold.triangle).position(Vec3::Constant(1.0 / 3));
  return fail(base_->name,
              fmt::format("relief {:.4g} m deep folds at triangle {}, near ({:.4g}, {:.4g}, {:.4g}), whose "
                          "radius of curvature is {:.4g} m",
                          wanted, fold.triangle, middle.x(), middle.y(), middle.z(), fold.depth),
              fmt::format("its depth must be less than {:.4g} m there", fold.depth));
}

}  // namespace intaglio::surface
