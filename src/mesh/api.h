// What is behind intaglio::CurvedSurface (include/intaglio/mesh.h), for the libraries that are handed one.
#pragma once

#include "intaglio/mesh.h"
#include "mesh/relief_mesh.h"
#include "surface/api.h"

namespace intaglio {

struct CurvedSurface::Impl {
  Surface surface;
  surface::ReliefMesh relief;
};

}  // namespace intaglio

namespace intaglio::surface {

// m, how long one texture is along u and v, the mean over the base.
Vec2 texture_size(const TriangleMesh& mesh);

}  // namespace intaglio::surface
