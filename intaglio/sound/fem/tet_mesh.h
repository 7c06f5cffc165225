// A solid body as ten-node tetrahedra: what modal analysis works on.
//
// Nodes are in metres in the body's own frame. A tetrahedron lists its four corners, then its six mid-edge
// nodes in the order of `tet_edges`; mid-edge nodes may lie off the straight edge, which is how a curved
// surface is met. Corners are positively oriented: (c1 - c0) x (c2 - c0) . (c3 - c0) > 0.
#pragma once

#include <array>
#include <vector>

#include "intaglio/core/vec.h"

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

}  // namespace intaglio::sound
