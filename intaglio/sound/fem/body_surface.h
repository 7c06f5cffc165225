// The surface of a solid body, made ready for tetrahedra from any triangle mesh, and what was wrong with it.
//
// Vertices at one place become one, triangles of no area are dropped, windings are made to agree and to face
// outwards: each mended thing is a note. What stays open, doubled or self-intersecting is left to the winding
// number (winding_number.h). Metres. Cost: about 2 s a million triangles.
#pragma once

#include <string>
#include <vector>

#include "intaglio/core/error.h"
#include "intaglio/sound/triangle_grid.h"
#include "intaglio/surface/mesh/triangle_mesh.h"

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

}  // namespace intaglio::sound
