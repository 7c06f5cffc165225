// A closed polyhedron in the body frame: what contact queries use for convex hulls and concave meshes.
//
// Metres; faces are planar polygons, counter-clockwise seen from outside. Built once by `convex_hull` or
// `closed_mesh`, which return an error of one line when it cannot be built; immutable afterwards, so any
// thread may read it.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "intaglio/error.h"
#include "intaglio/solid.h"
#include "intaglio/vec.h"

namespace intaglio {

struct Polyhedron {
  struct Face {
    Vec3 normal;       // unit, outwards
    double offset;     // normal . x = offset on the face
    int first, count;  // of loop
  };
  struct Edge {
    int a, b;         // vertices; the left face runs from a to b
    int left, right;  // faces
  };
  bool convex = true;
  double radius = 0;  // distance of the farthest vertex from the origin
  std::vector<Vec3> vertices;
  std::vector<Face> faces;
  std::vector<int> loop;    // the faces' vertices, one face after the other
  std::vector<Edge> edges;  // convex edges only; others cannot make contact
  // The vertices around vertex k, neighbours[first_neighbour[k]] up to first_neighbour[k + 1].
  std::vector<int> neighbours, first_neighbour;
};

}  // namespace intaglio

namespace intaglio::contact {

using intaglio::Polyhedron;

// The convex hull of any number of points. Coplanar triangles are one face; vertices keep the order of the
// points. Errors: points in one plane or fewer than four, numbers that are not finite, more than
// max_hull_points corners. Cost: milliseconds. By Qhull: Barber, Dobkin & Huhdanpaa, "The quickhull
// algorithm for convex hulls", 1996.
Result<std::shared_ptr<const Polyhedron>> convex_hull(std::span<const Vec3> points);

// A closed mesh of triangles, counter-clockwise seen from outside; it may be concave. Errors: an index out of
// range, a triangle without area, an edge that does not belong to two triangles that run along it in opposite
// directions, inside out, more than max_mesh_triangles.
Result<std::shared_ptr<const Polyhedron>> closed_mesh(std::span<const Vec3> vertices,
                                                      std::span<const std::array<int, 3>> triangles);

// A cube of side 2 around the origin. Internal to contact/.
Polyhedron make_cube();

}  // namespace intaglio::contact
