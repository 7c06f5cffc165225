// Any bytes as a mesh file, as OBJ, glTF and STL: a valid mesh or one clear error on one line, and any small
// valid mesh can be placed and queried.
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "mesh/mesh_file.h"
#include "mesh/mesh_placement.h"

using namespace intaglio;
using namespace intaglio::surface;

namespace {

void query(const TriangleMesh& mesh) {
  if (mesh.triangles.size() > 1000) return;
  const auto placement = MeshPlacement::make(mesh, "fuzz");
  if (!placement) std::abort();  // it was checked already
  const BasePoint on = placement->at(0, Vec3::Constant(1.0 / 3), 0);
  if (!on.world().allFinite() || !on.t.allFinite() || std::abs(on.n.norm() - 1) > 1e-6) std::abort();
  const Vec3 asked = on.point + 0.01 * on.n;
  if (const auto at = placement->closest(asked, 1)) {
    if (!((at->world() - asked).norm() <= 1e-6 * (1 + asked.norm()))) std::abort();
  }
  placement->to_world(on.uv, 0.1);
  static_cast<void>(placement->check_depth(1));
}

void examine(const Result<TriangleMesh>& mesh) {
  if (mesh) return query(*mesh);
  const std::string message = mesh.error().message();
  if (message.find('\n') != std::string::npos || message.find("fuzz") != 0) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  examine(parse_obj({reinterpret_cast<const char*>(data), size}, "fuzz"));
  examine(parse_gltf({data, size}, "fuzz"));
  examine(parse_obj({reinterpret_cast<const char*>(data), size}, "fuzz", MeshUse::shape));
  examine(parse_gltf({data, size}, "fuzz", {}, MeshUse::shape));
  examine(parse_stl({data, size}, "fuzz"));
  return 0;
}
