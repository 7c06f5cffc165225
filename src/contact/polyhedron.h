// A closed polyhedron in the body frame: what contact needs of a convex hull or of a concave mesh.
//
// Metres; faces are planar polygons, counter-clockwise seen from outside. Built once by `convex_hull` or
// `closed_mesh`, which say in one line why something cannot be built; immutable afterwards, so any thread may
// read it.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <utility>
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
  double radius = 0;  // how far the farthest vertex is from the origin
  std::vector<Vec3> vertices;
  std::vector<Face> faces;
  std::vector<int> loop;    // the faces' vertices, one face after the other
  std::vector<Edge> edges;  // where faces meet at an angle that points outwards; the others touch nothing
  // The vertices around vertex k, neighbours[first_neighbour[k]] up to first_neighbour[k + 1].
  std::vector<int> neighbours, first_neighbour;
};

}  // namespace intaglio

namespace intaglio::contact {

using intaglio::max_hull_points;
using intaglio::max_mesh_triangles;
using intaglio::Polyhedron;

// The convex hull of points: faces that share a plane are one face. Errors: fewer than four points that are
// not in one plane, numbers that are not finite, more than max_hull_points corners. Cost: milliseconds.
Result<std::shared_ptr<const Polyhedron>> convex_hull(std::span<const Vec3> points);

// A closed mesh of triangles, counter-clockwise seen from outside, concave as it may be. Errors: an index out
// of range, a triangle without area, an edge that does not belong to two triangles that run along it in
// opposite directions, inside out, more than max_mesh_triangles.
Result<std::shared_ptr<const Polyhedron>> closed_mesh(std::span<const Vec3> vertices,
                                                      std::span<const std::array<int, 3>> triangles);

// From faces to the edges and neighbours of a polyhedron. Internal to contact/.

// Half edges (from, to) and the face to their left.
using HalfEdges = std::map<std::pair<int, int>, int>;

// Half edges of all loops; an error when one belongs to two faces or has no partner the other way.
Result<HalfEdges> half_edges(const Polyhedron& form, const std::string& what);

// Fills edges, neighbours and radius from vertices, faces and loop.
void link(Polyhedron& form, const HalfEdges& half);

}  // namespace intaglio::contact
