// Which triangles of a mesh are near a point: a bounding volume hierarchy, Embree's (its headers do not leak
// from here).
//
// The boxes are made a little too large, so that Embree's single precision never hides a triangle; what is
// exact is the caller's test. Immutable after construction; searches are safe from any thread and do not
// allocate. Triangles come in an order that may differ between machines: a caller whose answer must not, may
// not let it depend on the order.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mesh/triangle_mesh.h"

namespace intaglio::surface {

class TriangleTree {
 public:
  // Error: Embree is not able to start or has no memory. `mesh` must be checked; it is not needed afterwards.
  static Result<TriangleTree> make(const TriangleMesh& mesh, const std::string& name);
  TriangleTree(TriangleTree&&) noexcept;
  TriangleTree& operator=(TriangleTree&&) noexcept;
  ~TriangleTree();

  // Calls `visit(triangle)` for every triangle that comes nearer to `point` than `radius` metres (and some
  // others), near ones first by and large. It returns the radius that is still of interest, never a larger
  // one.
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

// Which triangle of a mesh a texture coordinate lies in: a uniform grid over the UVs.
//
// Immutable after construction; a search does not allocate and is safe from any thread. Cost: one test for
// each triangle that overlaps the grid cell, a few where triangles are of like size in the texture. Memory:
// about 10 numbers a triangle.

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

// Which triangles of a mesh meet at a corner, wherever the file stored it twice: corners at the same place
// are one.
//
// Immutable; any thread. Memory: 28 bytes a triangle.

class TriangleFans {
 public:
  TriangleFans() = default;
  explicit TriangleFans(const TriangleMesh& mesh);

  // A number for the place of a triangle's corner 0, 1 or 2.
  int place(int triangle, std::size_t corner) const {
    return places_[static_cast<std::size_t>(triangle)][corner];
  }
  // The triangles around a place.
  std::span<const int> around(int place) const {
    const auto begin = begin_[static_cast<std::size_t>(place)],
               end = begin_[static_cast<std::size_t>(place) + 1];
    return std::span(held_).subspan(begin, end - begin);
  }
  // Which corner of a triangle is at a place; -1 when none is.
  int corner_at(int triangle, int place) const;
  // Whether no other triangle has the edge opposite to this corner: the mesh ends there.
  bool is_border(int triangle, std::size_t opposite) const;

  std::size_t memory_bytes() const {
    return places_.capacity() * sizeof(places_[0]) + begin_.capacity() * sizeof(std::size_t) +
           held_.capacity() * sizeof(int);
  }

 private:
  std::vector<std::array<int, 3>> places_;
  std::vector<std::size_t> begin_;
  std::vector<int> held_;
};

}  // namespace intaglio::surface
