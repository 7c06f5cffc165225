// What lies around a point of a relief on a curved base: neighbours across the edges of cells and triangles,
// or nothing, at the mesh's border. No allocation; any thread; 0.2 us for each piece around.
#pragma once

#include "intaglio/surface/mesh/relief_closest.h"

namespace intaglio::surface {

// Whether the relief comes no nearer to p in any direction from this feature.
bool is_local_minimum(const ReliefMesh& relief, const MeshFeature& feature, const Vec3& p);

// A place on the edge of several triangles as the first of them sees it: the same from whichever it is asked.
struct MeshPlace {
  int triangle;
  Vec2 weights;
};
MeshPlace first_of(const ReliefMesh& relief, int triangle, const Vec2& weights);

// Whether a point at weights of a triangle is on the mesh's border and `away` leads out over it: not along
// the relief's normal.
bool is_beyond_border(const ReliefMesh& relief, int triangle, const Vec2& weights, const Vec3& away);

}  // namespace intaglio::surface
