// The curved base of a scene's texture: its mesh, and the rectangle that measures the texture on it.
#pragma once

#include "intaglio/core/error.h"
#include "intaglio/session/scene.h"
#include "intaglio/surface/mesh/mesh_placement.h"

namespace intaglio::session {

// About its own middle, with the texture as often over it as is wanted; triangles end where it does. A mesh
// of a file as it is there.
Result<surface::MeshPlacement> make_base(const BaseScene& base, const Pose& pose);

// m, how long one texture is along u and v, the mean over the base.
Vec2 texture_size(const surface::TriangleMesh& mesh);

}  // namespace intaglio::session
