// Element matrices added up into the matrices of a whole body, for elements of N nodes each.
#pragma once

#include <algorithm>
#include <array>

#include "intaglio/sound/fem/assemble.h"

namespace intaglio::sound {

template <int N>
struct ElementSystem {
  Eigen::Matrix<double, 3 * N, 3 * N> stiffness;
  Eigen::Matrix<double, N, N> mass;  // the same for every axis
};

namespace assembling {

using Neighbours = std::vector<std::vector<int>>;  // of each node, itself included, ascending

// All-zero matrices of these nodes.
ElasticSystem zero_system(const Neighbours& neighbours);

}  // namespace assembling

// `element_of(e)` gives the matrices of element e, whose nodes are `elements[e]`; a node may be named twice
// if the matrices give its second naming nothing.
template <int N, class ElementOf>
ElasticSystem assemble_elements(std::size_t node_count, const std::vector<std::array<int, N>>& elements,
                                ElementOf element_of) {
  assembling::Neighbours neighbours(node_count);
  for (const auto& element : elements) {
    for (const int a : element)
      neighbours[std::size_t(a)].insert(neighbours[std::size_t(a)].end(), element.begin(), element.end());
  }
  for (auto& list : neighbours) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  ElasticSystem system = assembling::zero_system(neighbours);
  double* const stiffness = system.stiffness.valuePtr();
  double* const mass = system.mass.valuePtr();
  for (std::size_t e = 0; e < elements.size(); ++e) {
    const ElementSystem<N> element = element_of(e);
    for (int a = 0; a < N; ++a) {
      const int node = elements[e][std::size_t(a)];
      const auto& list = neighbours[std::size_t(node)];
      const auto place_of = [&](int other) {
        return std::lower_bound(list.begin(), list.end(), other) - list.begin();
      };
      const auto diagonal = place_of(node);
      for (int b = 0; b < N; ++b) {
        const int other = elements[e][std::size_t(b)];
        const auto place = place_of(other);
        mass[system.mass.outerIndexPtr()[node] + place] += element.mass(b, a);
        if (other < node) continue;
        for (int axis = 0; axis < 3; ++axis) {
          // A column begins at its own diagonal: `axis` rows of the first block are above it.
          double* const rows =
              stiffness + system.stiffness.outerIndexPtr()[3 * node + axis] + 3 * (place - diagonal) - axis;
          for (int row = other == node ? axis : 0; row < 3; ++row)
            rows[row] += element.stiffness(3 * b + row, 3 * a + axis);
        }
      }
    }
  }
  return system;
}

}  // namespace intaglio::sound
