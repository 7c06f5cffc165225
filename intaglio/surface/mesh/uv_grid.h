// Which triangle of a mesh a texture coordinate lies in: a uniform grid over the UVs.
//
// Immutable after construction; a search does not allocate and is safe from any thread. Cost: one test for
// each triangle that overlaps the grid cell, a few where triangles are of like size in the texture. Memory:
// about 10 numbers a triangle.
#pragma once

#include <optional>
#include <vector>

#include "intaglio/surface/mesh/triangle_mesh.h"

namespace intaglio::surface {

struct UvHit {
  int triangle;
  Vec3 weights;  // of its corners; sum 1, none below -1e-9
};

class UvGrid {
 public:
  explicit UvGrid(const TriangleMesh& mesh);

  // The triangle that holds uv; where UVs overlap, the first. Absent where the mesh has no texture.
  std::optional<UvHit> find(const Vec2& uv) const;

 private:
  struct UvTriangle {
    Vec2 a;
    Eigen::Matrix2d to_weights;  // (w1, w2) = to_weights * (uv - a)
  };

  int cell_of(double coordinate, int axis) const;
  // Calls visit(cell) for each cell under the bounding box of the triangle.
  template <class Visit>
  void each_cell(const TriangleMesh& mesh, std::size_t triangle, Visit visit) const;
  void choose_resolution(const TriangleMesh& mesh);
  void fill(const TriangleMesh& mesh);

  Vec2 low_ = Vec2::Zero();
  Vec2 size_ = Vec2::Zero();
  std::array<int, 2> cells_{1, 1};
  std::vector<UvTriangle> triangles_;
  std::vector<std::size_t> begin_;  // of each cell in held_, and one past the last
  std::vector<int> held_;           // triangles, ascending in each cell
};

}  // namespace intaglio::surface
