// Searches for the triangles of a mesh: near a point (TriangleTree), at a texture coordinate (UvGrid), around
// a vertex (VertexTriangles). Immutable after construction; searches are safe from any thread and do not
// allocate.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mesh/triangle_mesh.h"

namespace intaglio::surface {

// Which triangles of a mesh are near a point: a bounding volume hierarchy by Embree, hidden from this header.
//
// The boxes are made a little too large, so that Embree's single precision never hides a triangle; the
// caller's own test is exact. Triangles come in an order that may differ between machines: a caller's answer
// must not depend on it.
class TriangleTree {
 public:
  // Error: Embree could not be initialised or has no memory. `mesh` must be checked; it is not needed
  // afterwards.
  static Result<TriangleTree> make(const TriangleMesh& mesh, const std::string& name);
  TriangleTree(TriangleTree&&) noexcept;
  TriangleTree& operator=(TriangleTree&&) noexcept;
  ~TriangleTree();

  // Calls visit(triangle) for every triangle nearer to `point` than `radius` metres (and some others),
  // roughly nearest first. It returns the radius that is still of interest, never a larger one.
  template <class Visit>
  void search(const Vec3& point, double radius, Visit visit) const {
    search_with(
        point, radius, [](void* context, int triangle) { return (*static_cast<Visit*>(context))(triangle); },
        &visit);
  }

 private:
  struct Scene;
  explicit TriangleTree(std::unique_ptr<Scene> scene);
  void search_with(const Vec3& point, double radius, double (*visit)(void*, int), void* context) const;

  std::unique_ptr<Scene> scene_;
};

struct UvHit {
  int triangle;
  Vec3 weights;  // of its corners; sum 1, none below -1e-9
};

// Which triangle of a mesh a texture coordinate lies in: a uniform grid over the UVs.
//
// Cost: one test for each triangle that overlaps the grid cell, a few where triangles have similar sizes in
// the texture. Memory: about 10 numbers a triangle.
class UvGrid {
 public:
  explicit UvGrid(const TriangleMesh& mesh);

  // The triangle that contains uv; where UVs overlap, the first. Absent where the mesh has no texture.
  std::optional<UvHit> find(const Vec2& uv) const;

 private:
  struct UvTriangle {
    Vec2 a;
    Eigen::Matrix2d to_weights;  // (w1, w2) = to_weights * (uv - a)
  };

  int cell_of(double coordinate, int axis) const;
  // Calls visit(cell) for each cell under the bounding box of the triangle.
  template <class Visit>
  void for_each_cell(const TriangleMesh& mesh, std::size_t triangle, Visit visit) const;
  void choose_resolution(const TriangleMesh& mesh);
  void fill(const TriangleMesh& mesh);

  Vec2 low_ = Vec2::Zero();
  Vec2 size_ = Vec2::Zero();
  std::array<int, 2> cells_{1, 1};
  std::vector<UvTriangle> triangles_;
  std::vector<std::size_t> begin_;  // of each cell in items_, and one past the last
  std::vector<int> items_;          // triangles, ascending in each cell
};

// The triangles that meet at a vertex, merging vertices stored twice at the same position. Memory: 28 bytes a
// triangle.
class VertexTriangles {
 public:
  VertexTriangles() = default;
  explicit VertexTriangles(const TriangleMesh& mesh);

  // Id of the merged vertex at corner 0, 1 or 2 of a triangle.
  int vertex(int triangle, int corner) const { return vertices_[std::size_t(triangle)][std::size_t(corner)]; }
  std::span<const int> triangles_at(int vertex) const {
    const auto begin = begin_[std::size_t(vertex)], end = begin_[std::size_t(vertex) + 1];
    return std::span(items_).subspan(begin, end - begin);
  }
  // The corner of a triangle that is this vertex; -1 when none is.
  int corner_at(int triangle, int vertex) const;
  // Whether no other triangle has the edge opposite to this corner: the mesh ends there.
  bool is_border(int triangle, int opposite) const;

 private:
  std::vector<std::array<int, 3>> vertices_;
  std::vector<std::size_t> begin_;  // of each vertex in items_, and one past the last
  std::vector<int> items_;          // triangles
};

// The group of each of `count` items, where items with equal keys are one group; in ascending order of keys.
template <class Key>
std::vector<int> group_equal(std::size_t count, const Key& key) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return key(a) < key(b); });
  std::vector<int> group(count);
  for (std::size_t k = 1; k < count; ++k)
    group[order[k]] = group[order[k - 1]] + (key(order[k]) == key(order[k - 1]) ? 0 : 1);
  return group;
}

}  // namespace intaglio::surface
