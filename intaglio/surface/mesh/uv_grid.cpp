#include "intaglio/surface/mesh/uv_grid.h"

#include <algorithm>
#include <cmath>

#include "intaglio/surface/mesh/tangent_frame.h"

namespace intaglio::surface {

namespace {

constexpr double edge_tolerance = 1e-9;
constexpr std::size_t most_held = 8;  // grid entries a triangle, on the mean

Eigen::AlignedBox2d uv_box(const TriangleMesh& mesh, std::size_t triangle) {
  Eigen::AlignedBox2d box;
  for (const int index : mesh.triangles[triangle]) box.extend(mesh.uvs[static_cast<std::size_t>(index)]);
  const Vec2 margin = Vec2::Constant(2 * edge_tolerance * box.diagonal().maxCoeff());
  return {box.min() - margin, box.max() + margin};
}

}  // namespace

UvGrid::UvGrid(const TriangleMesh& mesh) {
  Eigen::AlignedBox2d box;
  for (std::size_t k = 0; k < mesh.triangles.size(); ++k) box.extend(uv_box(mesh, k));
  low_ = box.min();
  size_ = box.diagonal().cwiseMax(1e-12);
  triangles_.resize(mesh.triangles.size());
  for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
    const Vec2& a = mesh.uvs[static_cast<std::size_t>(mesh.triangles[k][0])];
    Eigen::Matrix2d edges;
    edges << mesh.uvs[static_cast<std::size_t>(mesh.triangles[k][1])] - a,
        mesh.uvs[static_cast<std::size_t>(mesh.triangles[k][2])] - a;
    const bool has_area = !uv_derivatives(mesh, k).by_u.isZero(0);
    triangles_[k] = {a,
                     has_area ? Eigen::Matrix2d(edges.inverse()) : Eigen::Matrix2d::Constant(std::nan(""))};
  }
  choose_resolution(mesh);
  fill(mesh);
}

int UvGrid::cell_of(double coordinate, int axis) const {
  const double cell =
      std::floor((coordinate - low_[axis]) / size_[axis] * cells_[static_cast<std::size_t>(axis)]);
  return static_cast<int>(std::clamp(cell, 0.0, cells_[static_cast<std::size_t>(axis)] - 1.0));
}

template <class Visit>
void UvGrid::each_cell(const TriangleMesh& mesh, std::size_t triangle, Visit visit) const {
  const Eigen::AlignedBox2d box = uv_box(mesh, triangle);
  for (int j = cell_of(box.min().y(), 1); j <= cell_of(box.max().y(), 1); ++j) {
    for (int i = cell_of(box.min().x(), 0); i <= cell_of(box.max().x(), 0); ++i)
      visit(static_cast<std::size_t>(j) * static_cast<std::size_t>(cells_[0]) + static_cast<std::size_t>(i));
  }
}

// About one cell a triangle; coarser when triangles are so large that each would be held in many cells.
void UvGrid::choose_resolution(const TriangleMesh& mesh) {
  const auto side = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(mesh.triangles.size()))));
  const auto held = [&] {
    std::size_t sum = 0;
    for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
      const Eigen::AlignedBox2d box = uv_box(mesh, k);
      sum += static_cast<std::size_t>(cell_of(box.max().x(), 0) - cell_of(box.min().x(), 0) + 1) *
             static_cast<std::size_t>(cell_of(box.max().y(), 1) - cell_of(box.min().y(), 1) + 1);
    }
    return sum;
  };
  cells_ = {side, side};
  while (cells_[0] > 1 && held() > most_held * mesh.triangles.size()) cells_ = {cells_[0] / 2, cells_[1] / 2};
}

void UvGrid::fill(const TriangleMesh& mesh) {
  begin_.assign(static_cast<std::size_t>(cells_[0]) * static_cast<std::size_t>(cells_[1]) + 1, 0);
  for (std::size_t k = 0; k < mesh.triangles.size(); ++k)
    each_cell(mesh, k, [&](std::size_t cell) { ++begin_[cell + 1]; });
  for (std::size_t cell = 1; cell < begin_.size(); ++cell) begin_[cell] += begin_[cell - 1];
  held_.resize(begin_.back());
  std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
  for (std::size_t k = 0; k < mesh.triangles.size(); ++k)
    each_cell(mesh, k, [&](std::size_t cell) { held_[next[cell]++] = static_cast<int>(k); });
}

std::optional<UvHit> UvGrid::find(const Vec2& uv) const {
  if (!uv.allFinite()) return std::nullopt;
  const auto cell = static_cast<std::size_t>(cell_of(uv.y(), 1)) * static_cast<std::size_t>(cells_[0]) +
                    static_cast<std::size_t>(cell_of(uv.x(), 0));
  for (std::size_t k = begin_[cell]; k < begin_[cell + 1]; ++k) {
    const UvTriangle& triangle = triangles_[static_cast<std::size_t>(held_[k])];
    const Vec2 w = triangle.to_weights * (uv - triangle.a);
    if (w.x() >= -edge_tolerance && w.y() >= -edge_tolerance && w.x() + w.y() <= 1 + edge_tolerance)
      return UvHit{held_[k], {1 - w.x() - w.y(), w.x(), w.y()}};
  }
  return std::nullopt;
}

}  // namespace intaglio::surface
