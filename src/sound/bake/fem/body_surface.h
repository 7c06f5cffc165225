// The surface of a solid body, prepared from any triangle mesh for filling with tetrahedra, with notes on
// repairs.
//
// Coincident vertices are welded, degenerate triangles dropped, windings made to agree and to face outwards:
// each repair adds a note. Open, doubled and self-intersecting parts are left to the winding number
// (inside.h). Metres. Cost: about 2 s per million triangles.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "intaglio/error.h"
#include "mesh/triangle_mesh.h"
#include "mesh/triangle_search.h"
#include "sound/triangle_grid.h"

namespace intaglio::sound {

struct BodySurface {
  std::vector<Vec3> points;
  std::vector<Triangle> triangles;  // outward
  int open_edges = 0;               // edges with unequal numbers of triangles in the two directions
  int shells = 0;                   // parts joined by edges
  double thickness = 0;             // metres; 0: it bounds a solid; else it is the middle of a shell
  double volume = 0;                // m^3; an estimate if open
  double area = 0;                  // m^2
  Vec3 low = Vec3::Zero(), high = Vec3::Zero();  // bounding box
  std::vector<std::string> notes;                // what was found and repaired, one sentence each

  bool is_closed() const { return open_edges == 0; }
};

// Fails if no triangle is left, or if a solid's surface encloses no volume. `name` appears in errors. With a
// `thickness` it is the middle surface of a shell, open or closed: volume and area are then those of the
// shell.
Result<BodySurface> body_surface(const surface::TriangleMesh& mesh, const std::string& name,
                                 double thickness = 0);

// Nearest-point and line queries on a body's surface.
//
// Immutable, safe from any thread; a query takes some microseconds, more if triangles are much smaller than
// its reach. Source of the line test: Möller & Trumbore, "Fast, minimum storage ray/triangle
// intersection", 1997.

class SurfaceQuery {
 public:
  // `body` must outlive it; `name` appears in errors.
  static Result<SurfaceQuery> make(const BodySurface& body, const std::string& name);

  struct NearestPoint {
    Vec3 point;
    int triangle;
    Vec3 barycentric;
  };
  // The nearest point of the surface, if it is nearer than `reach`.
  std::optional<NearestPoint> nearest_on_triangle(const Vec3& p, double reach) const;
  std::optional<Vec3> nearest(const Vec3& p, double reach) const;
  // The distance to the surface, or `reach` if that is less.
  double distance(const Vec3& p, double reach) const;

  // Parameter of the surface on the segment, 0 at `a` to 1 at `b`, if the segment crosses the surface exactly
  // once.
  std::optional<double> single_crossing(const Vec3& a, const Vec3& b) const;

 private:
  SurfaceQuery(const BodySurface& body, surface::TriangleTree tree) : body_(&body), tree_(std::move(tree)) {}

  const BodySurface* body_;
  surface::TriangleTree tree_;
};

}  // namespace intaglio::sound
