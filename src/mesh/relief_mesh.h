// Boxes in a binary tree: which of them may hold what is nearest. The order of visits depends on nothing but
// the boxes, so that an answer is the same on every machine.
//
// Immutable; any thread; a search does not allocate. Built by median splits; 64 bytes a node, one to
// two nodes a box.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "intaglio/vec.h"
#include "mesh/mesh_placement.h"
#include "mesh/relief_piece.h"
#include "mesh/triangle_search.h"

namespace intaglio::surface {

using Box = Eigen::AlignedBox3d;

class PrismTree {
 public:
  PrismTree() = default;
  explicit PrismTree(std::span<const Box> boxes);

  // Of all that was put in.
  Box whole() const { return nodes_.empty() ? Box() : nodes_.front().box; }

  // Calls visit(item) for those whose box has least(box) < limit(), nearer ones first by and large; limit()
  // may fall meanwhile.
  template <class Least, class Limit, class Visit>
  void search(const Least& least, const Limit& limit, const Visit& visit) const {
    if (nodes_.empty()) return;
    struct Entry {
      double least;
      int node;
    };
    std::array<Entry, deepest> stack;
    std::size_t count = 0;
    stack[count++] = {least(nodes_[0].box), 0};
    while (count > 0) {
      const Entry entry = stack[--count];
      if (!(entry.least < limit())) continue;
      const Node& node = nodes_[static_cast<std::size_t>(entry.node)];
      if (node.count > 0) {
        for (int k = 0; k < node.count; ++k) visit(items_[static_cast<std::size_t>(node.next + k)]);
        continue;
      }
      Entry near{least(nodes_[static_cast<std::size_t>(entry.node) + 1].box), entry.node + 1},
          far{least(nodes_[static_cast<std::size_t>(node.next)].box), node.next};
      if (far.least < near.least) std::swap(near, far);
      if (far.least < limit()) stack[count++] = far;
      if (near.least < limit()) stack[count++] = near;
    }
  }

  std::size_t memory_bytes() const {
    return nodes_.capacity() * sizeof(Node) + items_.capacity() * sizeof(int);
  }

 private:
  static constexpr std::size_t deepest = 64;
  static constexpr int per_leaf = 2;

  // A leaf holds items_[next] and on; otherwise the first child follows it and the second is `next`.
  struct Node {
    Box box;
    int next, count;
  };
  int build(std::span<const Box> boxes, int first, int count);

  std::vector<Node> nodes_;
  std::vector<int> items_;
};

// A relief on a curved base: a Surface's depth along the interpolated normals of a mesh (MeshPlacement).
//
// The field is X = p + z n of relief_piece.h, z = -depth, bilinear between texels: what the haptic sense and
// the pictures mean by the same mesh and texture, up to how they filter it. Depth is in metres along n,
// whatever the size of the mesh; the Surface's own rectangle does not matter. The solid is below; an open
// mesh has a border and no back. Where UVs jump (a seam) the relief may be torn, and there is nothing in the
// gap.
//
// Immutable and cheap to copy; queries neither allocate nor lock, from any thread. Memory: 250 bytes a
// triangle beside the mesh. Built in about 1 us a triangle, and what bounds of the texture under each cost
// (bench_curved).

class ReliefMesh {
 public:
  // Errors: no surface; relief so deep that it folds (MeshPlacement::check_depth says where).
  static Result<ReliefMesh> make(std::shared_ptr<const Surface> surface, MeshPlacement base);

  const Surface& surface() const { return *data_->surface; }
  const MeshPlacement& base() const { return data_->base; }
  // What the relief is within, metres.
  Box bounds() const { return data_->tree.whole(); }
  // The shorter side of a texel on the mesh, the mean over it, metres; of a flat relief the size of a
  // triangle.
  double texel() const { return data_->texel; }
  const TriangleFans& fans() const { return data_->fans; }
  std::size_t memory_bytes() const { return data_->tree.memory_bytes() + data_->fans.memory_bytes(); }

  // The relief at weights of a triangle's corners, and the base below it.
  Vec3 point(int triangle, const Vec3& weights) const;
  // The base point under a point of the relief of that triangle, for its frame and (u, v).
  BasePoint under(int triangle, const Vec2& weights) const;
  // The same from the point alone: of the triangle whose relief holds it.
  std::optional<BasePoint> under(int triangle, const Vec3& point) const;

  // Metres of the texture, along u and v, that a metre of motion in the world sweeps over, with the mesh turned
  // by `orientation`. Zero where a triangle is too flat to have directions along u and v.
  Eigen::Matrix<double, 2, 3> sweep(const BasePoint& under, const Quat& orientation) const;

  ReliefTriangle triangle(int k) const;
  const ReliefCells& cells() const { return data_->cells; }

  // Calls visit(k) for the triangles whose relief may reach into a box.
  template <class Visit>
  void for_each_triangle(const Box& wanted, const Visit& visit) const {
    data_->tree.search([&](const Box& box) { return box.intersects(wanted) ? 0.0 : 2.0; }, [] { return 1.0; },
                       visit);
  }

  // Visits the pieces of the relief that may be wanted, nearest first by and large. An asker has
  //   double limit()                   what is not below is not wanted; it may fall meanwhile
  //   double least(const Box&)         a lower bound of what anything in the box is worth
  //   double least(const FlatPiece&)   of what a piece is worth
  //   void visit(const ReliefPiece&)
  template <class Asker>
  void walk(Asker& asker) const {
    data_->tree.search([&](const Box& box) { return asker.least(box); }, [&] { return asker.limit(); },
                       [&](int k) { walk_triangle(triangle(k), asker); });
  }

 private:
  struct Data {
    std::shared_ptr<const Surface> surface;
    MeshPlacement base;
    ReliefCells cells;
    PrismTree tree;
    TriangleFans fans;
    double texel = 0;
  };
  explicit ReliefMesh(std::shared_ptr<const Data> data) : data_(std::move(data)) {}

  template <class Asker>
  void walk_triangle(const ReliefTriangle& triangle, Asker& asker) const;
  template <class Asker>
  void visit_cell(const ReliefTriangle& triangle, const WeightPolygon& outline, const CellRange& one,
                  Asker& asker) const;

  std::shared_ptr<const Data> data_;
};

template <class Asker>
void ReliefMesh::visit_cell(const ReliefTriangle& triangle, const WeightPolygon& outline,
                            const CellRange& one, Asker& asker) const {
  ReliefPiece piece{triangle, 0, 0, 0, 0, 0, 0, outline};
  data_->cells.load(one, piece);
  const Vec2 middle = outline.middle();
  if (asker.least(FlatPiece(triangle, outline, piece.heights(middle), middle)) < asker.limit())
    asker.visit(piece);
}

template <class Asker>
void ReliefMesh::walk_triangle(const ReliefTriangle& triangle, Asker& asker) const {
  const ReliefCells& cells = data_->cells;
  const WeightPolygon whole = WeightPolygon::triangle();
  const CellRange all = cells.range(triangle, whole);
  if (all.is_one()) return visit_cell(triangle, whole, all, asker);
  struct Node {
    WeightPolygon outline;
    CellRange range;
    double least;
  };
  const auto make = [&](Node& node) {
    const CellRange own = cells.range(triangle, node.outline);
    CellRange& r = node.range;
    r = {std::max(r.i0, own.i0), std::min(r.i1, own.i1), std::max(r.j0, own.j0), std::min(r.j1, own.j1)};
    if (r.i0 > r.i1 || r.j0 > r.j1) return false;  // a sliver that rounding left on a line
    const Vec2 middle = node.outline.middle();
    const Heights heights = cells.heights(r, triangle.cells(middle));
    node.least = asker.least(FlatPiece(triangle, node.outline, heights, middle));
    return node.least < asker.limit();
  };
  // A sibling for each cut: 2^35 cells along both axes.
  std::array<Node, 72> stack;
  std::size_t count = 1;
  stack[0].outline = whole;
  stack[0].range = all;
  if (!make(stack[0])) return;
  while (count > 0) {
    const Node node = stack[--count];
    if (!(node.least < asker.limit())) continue;
    if (node.range.is_one()) {
      visit_cell(triangle, node.outline, node.range, asker);
      continue;
    }
    const ReliefCells::Cut cut = cells.cut(node.range);
    Node &below = stack[count], &above = stack[count + 1];
    below.outline = above.outline = WeightPolygon();
    below.range = above.range = node.range;
    (cut.axis == 0 ? below.range.i1 : below.range.j1) = cut.cell - 1;
    (cut.axis == 0 ? above.range.i0 : above.range.j0) = cut.cell;
    node.outline.split({triangle.x_a[cut.axis], triangle.x_b[cut.axis]},
                       triangle.x[cut.axis] - static_cast<double>(cut.cell), below.outline, above.outline);
    const bool keep_below = !below.outline.is_empty() && make(below);
    const bool keep_above = !above.outline.is_empty() && make(above);
    if (keep_below && keep_above) {
      if (below.least < above.least) std::swap(below, above);
      count += 2;
    } else if (keep_below || keep_above) {
      if (keep_above) below = above;
      ++count;
    }
    if (count + 2 > stack.size()) return;
  }
}

}  // namespace intaglio::surface
