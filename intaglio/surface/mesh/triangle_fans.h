// Which triangles of a mesh meet at a corner, wherever the file stored it twice: corners at the same place
// are one.
//
// Immutable; any thread. Memory: 28 bytes a triangle.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "intaglio/surface/mesh/triangle_mesh.h"

namespace intaglio::surface {

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
