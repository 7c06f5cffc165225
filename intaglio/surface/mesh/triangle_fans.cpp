#include "intaglio/surface/mesh/triangle_fans.h"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace intaglio::surface {

TriangleFans::TriangleFans(const TriangleMesh& mesh) : places_(mesh.triangles.size()) {
  const auto key = [&](int vertex) {
    const Vec3& p = mesh.positions[static_cast<std::size_t>(vertex)];
    return std::tuple(p.x(), p.y(), p.z());
  };
  std::vector<int> order(mesh.positions.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int a, int b) { return key(a) < key(b); });
  std::vector<int> place(order.size());
  int count = 0;
  for (std::size_t k = 0; k < order.size(); ++k) {
    if (k > 0 && key(order[k]) != key(order[k - 1])) ++count;
    place[static_cast<std::size_t>(order[k])] = count;
  }
  begin_.assign(static_cast<std::size_t>(count) + 2, 0);
  for (std::size_t k = 0; k < places_.size(); ++k) {
    for (std::size_t corner = 0; corner < 3; ++corner) {
      places_[k][corner] = place[static_cast<std::size_t>(mesh.triangles[k][corner])];
      ++begin_[static_cast<std::size_t>(places_[k][corner]) + 1];
    }
  }
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  held_.resize(begin_.back());
  std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
  for (std::size_t k = 0; k < places_.size(); ++k) {
    for (const int at : places_[k]) held_[next[static_cast<std::size_t>(at)]++] = static_cast<int>(k);
  }
}

int TriangleFans::corner_at(int triangle, int place) const {
  const auto& own = places_[static_cast<std::size_t>(triangle)];
  const auto at = std::find(own.begin(), own.end(), place);
  return at == own.end() ? -1 : static_cast<int>(at - own.begin());
}

bool TriangleFans::is_border(int triangle, std::size_t opposite) const {
  const int a = place(triangle, (opposite + 1) % 3), b = place(triangle, (opposite + 2) % 3);
  const auto fan = around(a);
  return std::none_of(fan.begin(), fan.end(),
                      [&](int other) { return other != triangle && corner_at(other, b) >= 0; });
}

}  // namespace intaglio::surface
