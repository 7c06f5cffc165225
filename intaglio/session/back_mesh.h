// The other side of an open curved base that is some metres thick, with its rim: what one sees of a bowl from
// outside. Pure; milliseconds.
#pragma once

#include "intaglio/render/mesh.h"
#include "intaglio/surface/mesh/triangle_mesh.h"

namespace intaglio::session {

// Empty where the base is closed.
render::Mesh back_mesh(const surface::TriangleMesh& base, double thickness);

}  // namespace intaglio::session
