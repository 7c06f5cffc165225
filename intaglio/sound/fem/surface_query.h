// What a body's surface is near to: its nearest point, and where a line meets it.
//
// Immutable, safe from any thread; a query takes some microseconds, more where triangles are much smaller
// than its reach. Source of the line test: Möller & Trumbore, "Fast, minimum storage ray/triangle
// intersection", 1997.
#pragma once

#include <optional>

#include "intaglio/sound/fem/body_surface.h"
#include "intaglio/surface/mesh/triangle_tree.h"

namespace intaglio::sound {

class SurfaceQuery {
 public:
  // `body` must outlive it; `name` is for errors.
  static Result<SurfaceQuery> make(const BodySurface& body, const std::string& name);

  struct Foot {
    Vec3 point;
    int triangle;
    Vec3 barycentric;
  };
  // The nearest point of the surface, if it is nearer than `reach`.
  std::optional<Foot> foot(const Vec3& p, double reach) const;
  std::optional<Vec3> nearest(const Vec3& p, double reach) const;
  // The distance to the surface, or `reach` if that is less.
  double distance(const Vec3& p, double reach) const;

  // Where the surface is from 0 at `a` to 1 at `b`, if it is met at one place only.
  std::optional<double> only_crossing(const Vec3& a, const Vec3& b) const;

 private:
  SurfaceQuery(const BodySurface& body, surface::TriangleTree tree) : body_(&body), tree_(std::move(tree)) {}

  const BodySurface* body_;
  surface::TriangleTree tree_;
};

}  // namespace intaglio::sound
