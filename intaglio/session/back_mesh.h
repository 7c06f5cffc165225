// The other side of an open curved base that is some metres thick, with its rim: what one sees of a bowl from
// outside. Pure; milliseconds.
#pragma once

#include "intaglio/render/mesh.h"
#include "intaglio/surface/mesh/triangle_mesh.h"

namespace intaglio::session {

// Empty where the base is closed. The rim is drawn from `relief` metres below the base, where the layer of
// the relief, which has a side of its own, ends.
render::Mesh back_mesh(const surface::TriangleMesh& base, double relief, double thickness);

}  // namespace intaglio::session
