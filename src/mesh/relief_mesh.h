// A relief on a curved base: a Surface's depth along the interpolated normals of a mesh (MeshPlacement).
//
// The field is X = p + z n of relief_piece.h, z = -depth, bilinear between texels: the same that touch and
// pictures use for this mesh and texture, apart from filtering. Depth is in metres along n, whatever the size
// of the mesh; the rectangle of the Surface itself is not used. The solid is below; an open mesh has a border
// and no back. At a UV seam the relief may have a gap.
//
// Immutable and cheap to copy; queries neither allocate nor lock, from any thread. Memory: 250 bytes a
// triangle beside the mesh. Cost to build: about 1 us a triangle, plus the cost of bounding the texture under
// each (bench_curved).
#pragma once

#include <array>
#include <cassert>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "intaglio/vec.h"
#include "mesh/mesh_placement.h"
#include "mesh/relief_piece.h"
#include "mesh/triangle_search.h"

namespace intaglio::surface {

using Bounds = Eigen::AlignedBox3d;

// Bounding volume hierarchy for nearest-first searches. The order of visits depends on nothing but the boxes,
// so that an answer is the same on every machine.
//
// Immutable; any thread; a search does not allocate. Built by median splits; 64 bytes a node, one to two
// nodes a box.
class BoxTree {
 public:
  BoxTree() = default;
  explicit BoxTree(std::span<const Bounds> boxes);

  // Bounds of all boxes.
  Bounds bounds() const { return nodes_.empty() ? Bounds() : nodes_.front().box; }

  // Calls visit(item) for those whose box has lower_bound(box) < limit(), roughly nearest first; limit() may
  // shrink during the search.
  template <class LowerBound, class Limit, class Visit>
  void search(const LowerBound& lower_bound, const Limit& limit, const Visit& visit) const {
    if (nodes_.empty()) return;
    struct Entry {
      double bound;
      int node;
    };
    std::array<Entry, max_depth> stack;
    std::size_t count = 0;
    stack[count++] = {lower_bound(nodes_[0].box), 0};
    while (count > 0) {
      const Entry entry = stack[--count];
      if (!(entry.bound < limit())) continue;
      const Node& node = nodes_[std::size_t(entry.node)];
      if (node.count > 0) {
        for (int k = 0; k < node.count; ++k) visit(items_[std::size_t(node.next + k)]);
        continue;
      }
      Entry near{lower_bound(nodes_[std::size_t(entry.node) + 1].box), entry.node + 1},
          far{lower_bound(nodes_[std::size_t(node.next)].box), node.next};
      if (far.bound < near.bound) std::swap(near, far);
      if (far.bound < limit()) stack[count++] = far;
      if (near.bound < limit()) stack[count++] = near;
    }
  }

 private:
  static constexpr std::size_t max_depth = 64;
  static constexpr int per_leaf = 2;

  // A leaf holds items_[next] and on; otherwise the first child follows it and the second is `next`.
  struct Node {
    Bounds box;
    int next, count;
  };
  int build(std::span<const Bounds> boxes, int first, int count);

  std::vector<Node> nodes_;
  std::vector<int> items_;
};

class ReliefMesh {
 public:
  // Errors: no surface; relief so deep that it folds (MeshPlacement::check_depth says where).
  static Result<ReliefMesh> make(std::shared_ptr<const Surface> surface, MeshPlacement base);

  const Surface& surface() const { return *data_->surface; }
  const MeshPlacement& base() const { return data_->base; }
  // Bounding box of the relief, metres.
  Bounds bounds() const { return data_->tree.bounds(); }
  // The side of a texel on the mesh in metres: the square root of its mean area. For a flat relief, the size
  // of a triangle.
  double texel_size() const { return data_->texel_size; }
  const VertexTriangles& vertex_triangles() const { return data_->vertex_triangles; }

  // The relief at weights of a triangle's corners, and the base below it.
  Vec3 point(int triangle, const Vec3& weights) const;
  // The base point under a point of the relief of that triangle, for its frame and (u, v).
  BasePoint base_below(int triangle, const Vec2& weights) const;
  // The same from the point alone: of the triangle whose relief contains it.
  std::optional<BasePoint> base_below(int triangle, const Vec3& point) const;

  // Metres of the texture, along u and v, that a metre of motion in the world sweeps over, with the mesh
  // turned by `orientation`. Zero where a triangle is too flat to have directions along u and v.
  Eigen::Matrix<double, 2, 3> sweep(const BasePoint& under, const Quat& orientation) const;

  ReliefTriangle triangle(int k) const;
  const CellGrid& cells() const { return data_->cells; }

  // Calls visit(k) for the triangles whose relief may reach into a box.
  template <class Visit>
  void for_each_triangle(const Bounds& box, const Visit& visit) const {
    data_->tree.search([&](const Bounds& own) { return own.intersects(box) ? 0.0 : 2.0; }, [] { return 1.0; },
                       visit);
  }

  // Visits the pieces of the relief that may be below a limit, roughly nearest first. A visitor provides
  //   double limit()                            pieces not below this are skipped; it may shrink meanwhile
  //   double lower_bound(const Bounds&)            for anything in the box
  //   double lower_bound(const LinearPiece&)    for a piece
  //   void visit(const ReliefPiece&)
  template <class Visitor>
  void visit_pieces(Visitor& visitor) const {
    data_->tree.search([&](const Bounds& box) { return visitor.lower_bound(box); },
                       [&] { return visitor.limit(); }, [&](int k) { visit_triangle(triangle(k), visitor); });
  }

 private:
  struct Data {
    std::shared_ptr<const Surface> surface;
    MeshPlacement base;
    CellGrid cells;
    BoxTree tree;
    VertexTriangles vertex_triangles;
    double texel_size = 0;
  };
  explicit ReliefMesh(std::shared_ptr<const Data> data) : data_(std::move(data)) {}

  template <class Visitor>
  void visit_triangle(const ReliefTriangle& triangle, Visitor& visitor) const;
  template <class Visitor>
  void visit_cell(const ReliefTriangle& triangle, const BarycentricPolygon& outline, const CellRange& one,
                  Visitor& visitor) const;

  std::shared_ptr<const Data> data_;
};

template <class Visitor>
void ReliefMesh::visit_cell(const ReliefTriangle& triangle, const BarycentricPolygon& outline,
                            const CellRange& one, Visitor& visitor) const {
  const ReliefPiece piece = data_->cells.piece(triangle, outline, one);
  if (visitor.lower_bound(piece.linear()) < visitor.limit()) visitor.visit(piece);
}

// Splits a triangle at the blocks of the pyramid until each part lies in one cell.
template <class Visitor>
void ReliefMesh::visit_triangle(const ReliefTriangle& triangle, Visitor& visitor) const {
  const CellGrid& cells = data_->cells;
  const BarycentricPolygon whole = BarycentricPolygon::triangle();
  const CellRange all = cells.range(triangle, whole);
  if (all.is_one()) return visit_cell(triangle, whole, all, visitor);
  struct Node {
    BarycentricPolygon outline;
    CellRange range;
    double bound;
  };
  const auto make = [&](Node& node) {
    const CellRange own = cells.range(triangle, node.outline);
    CellRange& r = node.range;
    r = {std::max(r.i0, own.i0), std::min(r.i1, own.i1), std::max(r.j0, own.j0), std::min(r.j1, own.j1)};
    if (r.i0 > r.i1 || r.j0 > r.j1) return false;  // a sliver that rounding left on a line
    const Vec2 centroid = node.outline.centroid();
    const HeightBounds heights = cells.heights(r, triangle.cells(centroid));
    node.bound = visitor.lower_bound(LinearPiece(triangle, node.outline, heights, centroid));
    return node.bound < visitor.limit();
  };
  // One pending sibling for each split, and a split halves a range along one axis: enough for 2^35 cells
  // along both axes.
  std::array<Node, 72> stack;
  std::size_t count = 1;
  stack[0].outline = whole;
  stack[0].range = all;
  if (!make(stack[0])) return;
  while (count > 0) {
    const Node node = stack[--count];
    if (!(node.bound < visitor.limit())) continue;
    if (node.range.is_one()) {
      visit_cell(triangle, node.outline, node.range, visitor);
      continue;
    }
    const CellGrid::Split split = cells.split(node.range);
    Node &below = stack[count], &above = stack[count + 1];
    below.outline = above.outline = BarycentricPolygon();
    below.range = above.range = node.range;
    (split.axis == 0 ? below.range.i1 : below.range.j1) = split.cell - 1;
    (split.axis == 0 ? above.range.i0 : above.range.j0) = split.cell;
    node.outline.split({triangle.cell_a[split.axis], triangle.cell_b[split.axis]},
                       triangle.cell[split.axis] - double(split.cell), below.outline, above.outline);
    const bool keep_below = !below.outline.is_empty() && make(below);
    const bool keep_above = !above.outline.is_empty() && make(above);
    if (keep_below && keep_above) {
      if (below.bound < above.bound) std::swap(below, above);
      count += 2;
    } else if (keep_below || keep_above) {
      if (keep_above) below = above;
      ++count;
    }
    assert(count + 2 <= stack.size());
    if (count + 2 > stack.size()) return;
  }
}

}  // namespace intaglio::surface
