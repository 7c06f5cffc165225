// Closest features of a relief on a curved base: nearest to a point, nearest to a segment, lowest along a
// direction.
//
// World metres. Exact: a nearest-first descent of the triangles' prisms and of the texture's pyramid over
// each, pruned by the best so far; within a cell relief_minimum.h. Signed: a point is below where the base's
// normal at its closest feature points away from it, which is right wherever the relief does not fold. Beyond
// an open border nothing is below.
//
// No allocation; any thread; an answer does not depend on the machine. Cost: bench_curved (docs/curved.md).
#pragma once

#include <optional>
#include <span>

#include "mesh/relief_mesh.h"

namespace intaglio::surface {

struct MeshFeature {
  Vec3 point = Vec3::Zero();  // on the relief
  // Unit, from the relief to the query point; away from the query point when that is below.
  Vec3 direction = Vec3::Zero();
  double distance = 0;  // signed: negative when the query point is below
  int triangle = 0;
  Vec2 weights = Vec2::Zero();  // of the triangle's second and third corner
  std::int64_t cell_i = 0, cell_j = 0;
};

// The nearest point of the relief, at most `reach` metres away.
std::optional<MeshFeature> closest_point(const ReliefMesh& relief, const Vec3& p, double reach);

// Local minima of the distance that are nearer than `reach` and face p, nearest first; of two whose
// directions differ by less than `min_angle` (radians) only the nearer is kept, and at most one per cell.
// From below, only the nearest. Returns how many were written to `out` (at most six).
std::size_t closest_features(const ReliefMesh& relief, const Vec3& p, double reach, double min_angle,
                             std::span<MeshFeature> out);

// Where a segment is nearest to the relief, at most `reach` metres: `direction` is from the relief to the
// segment. When the segment crosses the relief, a point where it does, direction along the relief's normal.
std::optional<MeshFeature> closest_to_segment(const ReliefMesh& relief, const Vec3& from, const Vec3& to,
                                              double reach);

// The lowest point of the relief along a unit normal, when it is lower than `below` metres over the plane
// normal . x = offset: distance is its height over the plane, direction -normal. Only points farther than
// `apart` metres from all of `others` count.
std::optional<MeshFeature> lowest_point(const ReliefMesh& relief, const Vec3& normal, double offset,
                                        double below, std::span<const MeshFeature> others = {},
                                        double apart = 0);

// The neighbourhood of a point on a relief: adjacent cells and triangles, and the border of the mesh. Cost:
// 0.2 us for each piece around.

// Whether the feature is a local minimum of the distance to p.
bool is_local_minimum(const ReliefMesh& relief, const MeshFeature& feature, const Vec3& p);

// A point on the edge of several triangles, expressed in its lowest-numbered triangle, so it is unique.
struct SurfacePlace {
  int triangle;
  Vec2 weights;
};
SurfacePlace canonical_place(const ReliefMesh& relief, int triangle, const Vec2& weights);

// Whether a point at weights of a triangle is on the mesh's border and `away` points out across the border:
// not along the relief's normal.
bool is_beyond_border(const ReliefMesh& relief, int triangle, const Vec2& weights, const Vec3& away);

}  // namespace intaglio::surface
