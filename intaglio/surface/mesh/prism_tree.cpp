#include "intaglio/surface/mesh/prism_tree.h"

#include <algorithm>
#include <numeric>

namespace intaglio::surface {

PrismTree::PrismTree(std::span<const Box> boxes) : items_(boxes.size()) {
  std::iota(items_.begin(), items_.end(), 0);
  nodes_.reserve(2 * boxes.size());
  if (!boxes.empty()) build(boxes, 0, static_cast<int>(boxes.size()));
  nodes_.shrink_to_fit();
}

// Depth is the logarithm of the count, give or take one: median splits.
int PrismTree::build(std::span<const Box> boxes, int first, int count) {
  const int index = static_cast<int>(nodes_.size());
  Box box, middles;
  for (int k = first; k < first + count; ++k) {
    const Box& item = boxes[static_cast<std::size_t>(items_[static_cast<std::size_t>(k)])];
    box.extend(item);
    middles.extend(item.center());
  }
  nodes_.push_back({box, first, count});
  if (count <= per_leaf) return index;
  Eigen::Index axis = 0;
  middles.sizes().maxCoeff(&axis);
  const int half = count / 2;
  std::nth_element(items_.begin() + first, items_.begin() + first + half, items_.begin() + first + count,
                   [&](int a, int b) {
                     const double at_a = boxes[static_cast<std::size_t>(a)].center()[axis],
                                  at_b = boxes[static_cast<std::size_t>(b)].center()[axis];
                     return at_a < at_b || (at_a == at_b && a < b);
                   });
  build(boxes, first, half);
  const int second = build(boxes, first + half, count - half);
  nodes_[static_cast<std::size_t>(index)].next = second;
  nodes_[static_cast<std::size_t>(index)].count = 0;
  return index;
}

}  // namespace intaglio::surface
