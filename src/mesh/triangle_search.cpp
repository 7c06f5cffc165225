#include "mesh/triangle_search.h"

#include <embree3/rtcore.h>

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <vector>

#include "mesh/triangle_mesh.h"

namespace intaglio::surface {

// Coordinates are relative to the middle of the mesh: single precision is best there, wherever the mesh lies
// in the world.
struct TriangleTree::Scene {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  Vec3 middle = Vec3::Zero();
  double extent = 0;  // metres, from the middle to the farthest corner of the bounding box

  Scene() = default;
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;
  ~Scene() {
    if (scene) rtcReleaseScene(scene);
    if (device) rtcReleaseDevice(device);
  }
};

namespace {

constexpr double single_precision = 1e-6;  // a generous bound of Embree's relative rounding

struct BoundsSource {
  const TriangleMesh* mesh;
  Vec3 middle;
  double margin;
};

void triangle_bounds(const RTCBoundsFunctionArguments* arguments) {
  const auto& source = *static_cast<const BoundsSource*>(arguments->geometryUserPtr);
  Eigen::AlignedBox3d box;
  for (const int index : source.mesh->triangles[arguments->primID])
    box.extend(source.mesh->positions[std::size_t(index)] - source.middle);
  const Eigen::Vector3f low = (box.min().array() - source.margin).cast<float>();
  const Eigen::Vector3f high = (box.max().array() + source.margin).cast<float>();
  *arguments->bounds_o = {low.x(), low.y(), low.z(), 0, high.x(), high.y(), high.z(), 0};
}

struct Search {
  double (*visit)(void*, int);
  void* context;
  double margin;
};

bool visit_triangle(RTCPointQueryFunctionArguments* arguments) {
  const auto& search = *static_cast<const Search*>(arguments->userPtr);
  const double radius = search.visit(search.context, int(arguments->primID)) + search.margin;
  if (!(radius < double(arguments->query->radius))) return false;
  arguments->query->radius = float(radius);
  return true;
}

}  // namespace

TriangleTree::TriangleTree(std::unique_ptr<Scene> scene) : scene_(std::move(scene)) {}
TriangleTree::TriangleTree(TriangleTree&&) noexcept = default;
TriangleTree& TriangleTree::operator=(TriangleTree&&) noexcept = default;
TriangleTree::~TriangleTree() = default;

Result<TriangleTree> TriangleTree::make(const TriangleMesh& mesh, const std::string& name) {
  auto scene = std::make_unique<Scene>();
  Eigen::AlignedBox3d box;
  for (const Vec3& position : mesh.positions) box.extend(position);
  scene->middle = box.center();
  scene->extent = 0.5 * box.diagonal().norm();
  scene->device = rtcNewDevice(nullptr);
  if (!scene->device)
    return fail(name, "Embree could not be initialised", "is the processor older than SSE2?");

  BoundsSource source{&mesh, scene->middle, single_precision * scene->extent};
  scene->scene = rtcNewScene(scene->device);
  RTCGeometry geometry = rtcNewGeometry(scene->device, RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(geometry, unsigned(mesh.triangles.size()));
  rtcSetGeometryUserData(geometry, &source);
  rtcSetGeometryBoundsFunction(geometry, triangle_bounds, nullptr);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene->scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene->scene);
  if (const RTCError error = rtcGetDeviceError(scene->device); error != RTC_ERROR_NONE)
    return fail(name,
                fmt::format("Embree cannot build its tree of {} triangles (its error {})",
                            mesh.triangles.size(), int(error)),
                "is there enough memory?");
  return TriangleTree(std::move(scene));
}

void TriangleTree::search_with(const Vec3& point, double radius, double (*visit)(void*, int),
                               void* context) const {
  const Vec3 from_middle = point - scene_->middle;
  const double away = from_middle.norm();
  if (!(away - scene_->extent <= radius)) return;  // also when the point is not finite
  const double margin = single_precision * (away + scene_->extent);
  Search search{visit, context, margin};
  RTCPointQuery query;
  query.x = float(from_middle.x());
  query.y = float(from_middle.y());
  query.z = float(from_middle.z());
  query.time = 0;
  // A radius beyond everything is the same as one that just reaches everything, and is finite in single
  // precision.
  query.radius = float(std::min(radius, away + scene_->extent) + margin);
  RTCPointQueryContext query_context;
  rtcInitPointQueryContext(&query_context);
  rtcPointQuery(scene_->scene, &query, &query_context, visit_triangle, &search);
}

namespace {

constexpr double overlap_tolerance = 1e-9;
constexpr std::size_t max_items_per_triangle = 8;  // on average

Eigen::AlignedBox2d uv_box(const TriangleMesh& mesh, std::size_t triangle) {
  Eigen::AlignedBox2d box;
  for (const int index : mesh.triangles[triangle]) box.extend(mesh.uvs[std::size_t(index)]);
  const Vec2 margin = Vec2::Constant(2 * overlap_tolerance * box.diagonal().maxCoeff());
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
    const Vec2& a = mesh.uvs[std::size_t(mesh.triangles[k][0])];
    Eigen::Matrix2d edges;
    edges << mesh.uvs[std::size_t(mesh.triangles[k][1])] - a, mesh.uvs[std::size_t(mesh.triangles[k][2])] - a;
    const bool has_area = !uv_derivatives(mesh, k).by_u.isZero(0);
    triangles_[k] = {a,
                     has_area ? Eigen::Matrix2d(edges.inverse()) : Eigen::Matrix2d::Constant(std::nan(""))};
  }
  choose_resolution(mesh);
  fill(mesh);
}

int UvGrid::cell_of(double coordinate, int axis) const {
  const double cell = std::floor((coordinate - low_[axis]) / size_[axis] * cells_[std::size_t(axis)]);
  return int(std::clamp(cell, 0.0, cells_[std::size_t(axis)] - 1.0));
}

template <class Visit>
void UvGrid::for_each_cell(const TriangleMesh& mesh, std::size_t triangle, Visit visit) const {
  const Eigen::AlignedBox2d box = uv_box(mesh, triangle);
  for (int j = cell_of(box.min().y(), 1); j <= cell_of(box.max().y(), 1); ++j) {
    for (int i = cell_of(box.min().x(), 0); i <= cell_of(box.max().x(), 0); ++i)
      visit(std::size_t(j) * std::size_t(cells_[0]) + std::size_t(i));
  }
}

// About one cell a triangle; coarser when triangles are so large that each would be in many cells.
void UvGrid::choose_resolution(const TriangleMesh& mesh) {
  const auto side = int(std::ceil(std::sqrt(double(mesh.triangles.size()))));
  const auto count_items = [&] {
    std::size_t sum = 0;
    for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
      const Eigen::AlignedBox2d box = uv_box(mesh, k);
      sum += std::size_t(cell_of(box.max().x(), 0) - cell_of(box.min().x(), 0) + 1) *
             std::size_t(cell_of(box.max().y(), 1) - cell_of(box.min().y(), 1) + 1);
    }
    return sum;
  };
  cells_ = {side, side};
  while (cells_[0] > 1 && count_items() > max_items_per_triangle * mesh.triangles.size())
    cells_ = {cells_[0] / 2, cells_[1] / 2};
}

void UvGrid::fill(const TriangleMesh& mesh) {
  begin_.assign(std::size_t(cells_[0]) * std::size_t(cells_[1]) + 1, 0);
  for (std::size_t k = 0; k < mesh.triangles.size(); ++k)
    for_each_cell(mesh, k, [&](std::size_t cell) { ++begin_[cell + 1]; });
  for (std::size_t cell = 1; cell < begin_.size(); ++cell) begin_[cell] += begin_[cell - 1];
  items_.resize(begin_.back());
  std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
  for (std::size_t k = 0; k < mesh.triangles.size(); ++k)
    for_each_cell(mesh, k, [&](std::size_t cell) { items_[next[cell]++] = int(k); });
}

std::optional<UvHit> UvGrid::find(const Vec2& uv) const {
  if (!uv.allFinite()) return std::nullopt;
  const auto cell =
      std::size_t(cell_of(uv.y(), 1)) * std::size_t(cells_[0]) + std::size_t(cell_of(uv.x(), 0));
  for (std::size_t k = begin_[cell]; k < begin_[cell + 1]; ++k) {
    const UvTriangle& triangle = triangles_[std::size_t(items_[k])];
    const Vec2 w = triangle.to_weights * (uv - triangle.a);
    if (w.x() >= -overlap_tolerance && w.y() >= -overlap_tolerance && w.x() + w.y() <= 1 + overlap_tolerance)
      return UvHit{items_[k], {1 - w.x() - w.y(), w.x(), w.y()}};
  }
  return std::nullopt;
}

VertexTriangles::VertexTriangles(const TriangleMesh& mesh) : vertices_(mesh.triangles.size()) {
  const std::vector<int> vertex = group_equal(mesh.positions.size(), [&](std::size_t k) {
    const Vec3& p = mesh.positions[k];
    return std::tuple(p.x(), p.y(), p.z());
  });
  const int last = vertex.empty() ? 0 : *std::max_element(vertex.begin(), vertex.end());
  begin_.assign(std::size_t(last) + 2, 0);
  for (std::size_t k = 0; k < vertices_.size(); ++k) {
    for (std::size_t corner = 0; corner < 3; ++corner) {
      vertices_[k][corner] = vertex[std::size_t(mesh.triangles[k][corner])];
      ++begin_[std::size_t(vertices_[k][corner]) + 1];
    }
  }
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  items_.resize(begin_.back());
  std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
  for (std::size_t k = 0; k < vertices_.size(); ++k) {
    for (const int at : vertices_[k]) items_[next[std::size_t(at)]++] = int(k);
  }
}

int VertexTriangles::corner_at(int triangle, int vertex) const {
  const auto& own = vertices_[std::size_t(triangle)];
  const auto at = std::find(own.begin(), own.end(), vertex);
  return at == own.end() ? -1 : int(at - own.begin());
}

bool VertexTriangles::is_border(int triangle, int opposite) const {
  const int a = vertex(triangle, (opposite + 1) % 3), b = vertex(triangle, (opposite + 2) % 3);
  const auto around = triangles_at(a);
  return std::none_of(around.begin(), around.end(),
                      [&](int other) { return other != triangle && corner_at(other, b) >= 0; });
}

}  // namespace intaglio::surface
