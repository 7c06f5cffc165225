// A solid body as ten-node tetrahedra: input of modal analysis.
//
// Nodes are in metres in the body's own frame. A tetrahedron lists its four corners, then its six mid-edge
// nodes in the order of `tet_edges`; mid-edge nodes may lie off the straight edge, to follow curved surfaces.
// Corners are positively oriented: (c1 - c0) x (c2 - c0) . (c3 - c0) > 0.
#pragma once

#include <array>
#include <cstddef>
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

// Tetrahedra of four nodes, of either orientation.
struct CornerMesh {
  std::vector<Vec3> points;
  std::vector<std::array<int, 4>> tets;
};

// Numbers those of `count` points that are used, in the order of first use.
class Renumbering {
 public:
  explicit Renumbering(std::size_t count) : number_(count, -1) {}

  // The new number of a point; calls copy(point) at its first use.
  template <class Copy>
  int operator()(int point, Copy copy) {
    int& number = number_[std::size_t(point)];
    if (number < 0) {
      number = used_++;
      copy(std::size_t(point));
    }
    return number;
  }
  int used() const { return used_; }

 private:
  std::vector<int> number_;
  int used_ = 0;
};

// Disjoint sets of the numbers below `count` (union-find).
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count);

  std::size_t root(std::size_t k);
  void join(std::size_t k, std::size_t other) { parent_[root(k)] = root(other); }

 private:
  std::vector<std::size_t> parent_;
};

// Volume of a tetrahedron, m^3: positive if its corners are positively oriented.
inline double signed_volume(const std::vector<Vec3>& points, const std::array<int, 4>& t) {
  const Vec3& o = points[std::size_t(t[0])];
  const Vec3 a = points[std::size_t(t[1])] - o, b = points[std::size_t(t[2])] - o,
             c = points[std::size_t(t[3])] - o;
  return a.cross(b).dot(c) / 6;
}

// The ten-node mesh of a mesh of corners: tetrahedra are oriented positively, mid-edge nodes lie halfway, and
// faces of only one tetrahedron become the boundary. Precondition: every tetrahedron has volume.
TetMesh quadratic_mesh(std::vector<Vec3> corners, std::vector<std::array<int, 4>> tets);

// Volume of the curved body, m^3, by the quadrature of the elements.
double volume(const TetMesh& mesh);

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
  // Structured elements (tet_mesh.h) about `element_size` in size, larger if more than `max_elements` would
  // be needed.
  TetMesh mesh(double element_size, int max_elements) const;
};

// Whether `text` names a built-in shape: it starts with a shape's name and ":".
bool is_solid_shape(const std::string& text);
Result<SolidShape> solid_shape(const std::string& text);

}  // namespace intaglio::sound
