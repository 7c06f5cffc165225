#include "intaglio/surface/mesh/triangle_tree.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

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

}  // namespace intaglio::surface
