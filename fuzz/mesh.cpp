// Any bytes as a mesh file, as OBJ, glTF and STL: a valid mesh or one clear error on one line, and any small
// valid mesh can be placed and queried. fuzz/gltf.cpp makes glTF files that get further.
#include "fuzz/mesh_checks.h"
#include "mesh/mesh_file.h"

using namespace intaglio;
using namespace intaglio::surface;
using fuzz::examine;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  examine(parse_obj(fuzz::as_text(data, size), "fuzz"));
  examine(parse_gltf({data, size}, "fuzz"));
  examine(parse_obj(fuzz::as_text(data, size), "fuzz", MeshUse::shape));
  examine(parse_gltf({data, size}, "fuzz", {}, MeshUse::shape));
  examine(parse_stl({data, size}, "fuzz"));
  return 0;
}
