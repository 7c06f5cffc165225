// Which triangles of a mesh are near a point: a bounding volume hierarchy, Embree's (its headers do not leak
// from here).
//
// The boxes are made a little too large, so that Embree's single precision never hides a triangle; what is
// exact is the caller's test. Immutable after construction; searches are safe from any thread and do not
// allocate. Triangles come in an order that may differ between machines: a caller whose answer must not, may
// not let it depend on the order.
#pragma once

#include <memory>
#include <string>

#include "intaglio/surface/mesh/triangle_mesh.h"

namespace intaglio::surface {

class TriangleTree {
 public:
  // Error: Embree is not able to start or has no memory. `mesh` must be checked; it is not needed afterwards.
  static Result<TriangleTree> make(const TriangleMesh& mesh, const std::string& name);
  TriangleTree(TriangleTree&&) noexcept;
  TriangleTree& operator=(TriangleTree&&) noexcept;
  ~TriangleTree();

  // Calls `visit(triangle)` for every triangle that comes nearer to `point` than `radius` metres (and some
  // others), near ones first by and large. It returns the radius that is still of interest, never a larger
  // one.
  template <class Visit>
  void search(const Vec3& point, double radius, Visit visit) const {
    search_with(
        point, radius, [](void* context, int triangle) { return (*static_cast<Visit*>(context))(triangle); },
        &visit);
  }

 private:
  struct Scene;
  explicit TriangleTree(std::unique_ptr<Scene> scene);
  void search_with(const Vec3& point, double radius, double (*visit)(void*, int), void* context) const;

  std::unique_ptr<Scene> scene_;
};

}  // namespace intaglio::surface
