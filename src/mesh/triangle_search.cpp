#include "mesh/triangle_search.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>
#include <vector>
#include <fmt/format.h>

#include "mesh/triangle_mesh.h"

namespace intaglio::surface {

// Coordinates are taken from the middle of the mesh: single precision is best there, wherever the mesh lies
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
    box.extend(source.mesh->positions[static_cast<std::size_t>(index)] - source.middle);
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
  const double radius = search.visit(search.context, static_cast<int>(arguments->primID)) + search.margin;
  if (!(radius < static_cast<double>(arguments->query->radius))) return false;
  arguments->query->radius = static_cast<float>(radius);
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
  if (!scene->device) return fail(name, "Embree does not start", "is the processor older than SSE2?");

  BoundsSource source{&mesh, scene->middle, single_precision * scene->extent};
  scene->scene = rtcNewScene(scene->device);
  RTCGeometry geometry = rtcNewGeometry(scene->device, RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(mesh.triangles.size()));
  rtcSetGeometryUserData(geometry, &source);
  rtcSetGeometryBoundsFunction(geometry, triangle_bounds, nullptr);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene->scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene->scene);
  if (const RTCError error = rtcGetDeviceError(scene->device); error != RTC_ERROR_NONE)
    return fail(name,
                fmt::format("Embree cannot build its tree of {} triangles (its error {})",
                            mesh.triangles.size(), static_cast<int>(error)),
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
  query.x = static_cast<float>(from_middle.x());
  query.y = static_cast<float>(from_middle.y());
  query.z = static_cast<float>(from_middle.z());
  query.time = 0;
  // A radius beyond everything is the same as one that just reaches everything, and is finite in single
  // precision.
  query.radius = static_cast<float>(std::min(radius, away + scene_->extent) + margin);
  RTCPointQueryContext query_context;
  rtcInitPointQueryContext(&query_context);
  rtcPointQuery(scene_->scene, &query, &query_context, visit_triangle, &search);
}

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
