// The surface of a solid body, made ready for tetrahedra from any triangle mesh, and what was wrong with it.
//
// Vertices at one place become one, triangles of no area are dropped, windings are made to agree and to face
// outwards: each mended thing is a note. What stays open, doubled or self-intersecting is left to the winding
// number (inside.h). Metres. Cost: about 2 s a million triangles.
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
  int open_edges = 0;               // that have not as many triangles on one side as on the other
  int shells = 0;                   // parts joined by edges
  double thickness = 0;             // metres; 0: it bounds a solid; else it is the middle of a shell
  double volume = 0;                // m^3; of an open surface a guess
  double area = 0;                  // m^2
  Vec3 low = Vec3::Zero(), high = Vec3::Zero();  // bounding box
  std::vector<std::string> notes;                // what was found and repaired, a sentence each

  bool is_closed() const { return open_edges == 0; }
};

// Errors: nothing is left of it, or it bounds a solid and is flat. `name` is for them. With a `thickness` it
// is the middle surface of a shell, open or closed: volume and area are then those of the shell.
Result<BodySurface> body_surface(const surface::TriangleMesh& mesh, const std::string& name,
                                 double thickness = 0);

// What a body's surface is near to: its nearest point, and where a line meets it.
//
// Immutable, safe from any thread; a query takes some microseconds, more where triangles are much smaller
// than its reach. Source of the line test: Möller & Trumbore, "Fast, minimum storage ray/triangle
// intersection", 1997.

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
