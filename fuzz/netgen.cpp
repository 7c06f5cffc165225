// Any text as a request to intaglio-netgen (apps/netgen/) and as its result: nothing, or a surface whose
// corners exist; one clear error, or tetrahedra whose corners exist, of which only those that fill the body
// are accepted.
#include <sstream>

#include "apps/netgen/request.h"
#include "fuzz/require.h"
#include "sound/bake/fem/netgen_files.h"

using namespace intaglio;
using namespace intaglio::sound;
using fuzz::require;

namespace {

// A tetrahedron with three edges of 1 m.
BodySurface corner() {
  BodySurface body;
  body.points = {Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};
  body.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  body.volume = 1.0 / 6;
  return body;
}

void examine(const netgen::Request& request) {
  require(request.size > 0);
  for (const auto& triangle : request.triangles)
    for (const std::size_t corner : triangle) require(corner < request.points.size());
}

void examine(const CornerMesh& mesh) {
  for (const Vec3& point : mesh.points) require(point.allFinite());
  for (const auto& tet : mesh.tets)
    for (const int corner : tet) require(corner >= 0 && std::size_t(corner) < mesh.points.size());
  static const BodySurface body = corner();
  double volume = 0;
  for (const auto& tet : mesh.tets) volume += std::abs(signed_volume(mesh.points, tet));
  if (fills(mesh, body)) require(std::abs(volume - body.volume) < 0.1 * body.volume);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::istringstream file{std::string(fuzz::as_text(data, size))};
  if (const auto request = netgen::read_request(file)) examine(*request);
  const auto mesh = parse_netgen_result(fuzz::as_text(data, size), "fuzz");
  if (mesh)
    examine(*mesh);
  else
    fuzz::require_clear(mesh.error(), "fuzz");
  return 0;
}
