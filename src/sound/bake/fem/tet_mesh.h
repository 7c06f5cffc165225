// A solid body as ten-node tetrahedra: what modal analysis works on.
//
// Nodes are in metres in the body's own frame. A tetrahedron lists its four corners, then its six mid-edge
// nodes in the order of `tet_edges`; mid-edge nodes may lie off the straight edge, which is how a curved
// surface is met. Corners are positively oriented: (c1 - c0) x (c2 - c0) . (c3 - c0) > 0.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "intaglio/error.h"
#include "intaglio/vec.h"

namespace intaglio::sound {

// The corners that mid-edge node 4 + i lies between.
inline constexpr std::array<std::array<int, 2>, 6> tet_edges{
    {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};
// The corners of the four faces, counter-clockwise seen from outside.
inline constexpr std::array<std::array<int, 3>, 4> tet_faces{{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

using Tet10 = std::array<int, 10>;
// Three corners, counter-clockwise seen from outside, then the mid-edge nodes 01, 12 and 20.
using Triangle6 = std::array<int, 6>;

struct TetMesh {
  std::vector<Vec3> nodes;
  std::vector<Tet10> tets;
  std::vector<Triangle6> boundary;
};

// Tetrahedra of four nodes, either way round.
struct CornerMesh {
  std::vector<Vec3> points;
  std::vector<std::array<int, 4>> tets;
};

// The ten-node mesh of a mesh of corners: tetrahedra are turned positive, mid-edge nodes are made halfway,
// and faces that belong to one tetrahedron only become the boundary. A tetrahedron of no volume is the
// caller's error.
TetMesh quadratic_mesh(std::vector<Vec3> corners, std::vector<std::array<int, 4>> tets);

// Volume in m^3, by the quadrature of the elements: of the curved body, not of its corners.
double volume(const TetMesh& mesh);

// A prism of nodes as tetrahedra.

// The three tetrahedra of a prism with bottom 0 1 2 under top 3 4 5. Every side face is cut from its corner
// of smallest global index, so that neighbours agree: Dompierre et al., "How to subdivide pyramids, prisms
// and hexahedra into tetrahedra", 1999.
std::array<std::array<int, 4>, 3> prism_tets(std::array<int, 6> p);

// Structured ten-node meshes of the built-in shapes, centred at the origin, in metres.
//
// The curved ones are straight-sided lattices mapped radially, mid-edge nodes included, so that elements stay
// well shaped everywhere and no corner of one degenerates on the curved surface. Sizes must be positive and
// counts at least 1.

// A ball: an icosahedron of 20 tetrahedra around the centre, each cut into eight `level` times (20 * 8^level
// in all). Level 2 puts the first modes within 0.1 %.
TetMesh ball(double radius, int level);

// A box of `size`, cut into nx * ny * nz bricks of six tetrahedra, each the mirror image of its neighbours:
// where counts are even the mesh has the symmetry of the box, and modes that are degenerate stay so.
TetMesh box(const Vec3& size, int nx, int ny, int nz);

// A cylinder whose axis is local Y: a disk of 6 * rings^2 triangles, extruded through `layers`.
TetMesh cylinder(double radius, double length, int rings, int layers);

// Built-in solid shapes by name, as a command line writes them: "sphere:r=0.05", "box:x=0.3,y=0.01,z=0.2",
// "plate:a=0.3,t=0.01" (square, lying: side and thickness), "cylinder:r=0.02,h=0.2" (axis along Y). Metres.

struct SolidShape {
  enum class Kind { sphere, box, cylinder } kind = Kind::sphere;
  Vec3 size = Vec3::Zero();  // of the bounding box

  double volume() const;
  double area() const;
  // Structured elements (tet_mesh.h) about as large as asked for, larger where more than `max_elements` would
  // be needed.
  TetMesh mesh(double element_size, int max_elements) const;
};

// Whether `text` means a shape and not a file: it starts with a shape's name and ":".
bool is_solid_shape(const std::string& text);
Result<SolidShape> solid_shape(const std::string& text);

}  // namespace intaglio::sound
