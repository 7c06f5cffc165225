// Boxes in a binary tree: which of them may hold what is nearest. The order of visits depends on nothing but
// the boxes, so that an answer is the same on every machine.
//
// Immutable; any thread; a search does not allocate. Built by median splits; 64 bytes a node, one to
// two nodes a box.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "intaglio/core/vec.h"

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

}  // namespace intaglio::surface
