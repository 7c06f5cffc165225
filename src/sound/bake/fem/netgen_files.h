// The files between us and intaglio-netgen: the request that we write, and the result, which is not trusted
// (apps/netgen/main.cpp has the formats).
#pragma once

#include <string>
#include <string_view>

#include "sound/bake/fem/body_surface.h"
#include "sound/bake/fem/tet_mesh.h"

namespace intaglio::sound {

std::string netgen_request(const BodySurface& body, double element_size);

// Finite points and tetrahedra between them; `program` is its writer, for errors.
Result<CornerMesh> parse_netgen_result(std::string_view text, const std::string& program);

// Whether every tetrahedron has volume, all together have the body's, and no face belongs to three.
bool fills(const CornerMesh& mesh, const BodySurface& body);

}  // namespace intaglio::sound
