// Any triangle mesh as a solid ten-node mesh.
//
// Winding numbers tell what is inside, and a lattice along the body's flat faces fills it (lattice.h).
// Mid-edge nodes of the boundary are moved onto the surface where that keeps every element positive, and for
// a closed surface the exact volume is restored, since a shift of pitch follows its error. A surface with a
// thickness is thickened by half on each side (inside.h).
//
// Open, self-intersecting and doubled surfaces are filled too; what was found is in `notes`. Rejects surfaces
// that enclose no volume (or only with a large missing lid), disconnected parts, and bodies too thin for
// max_elements. Cost: about 0.1 s for 2,500 elements from 5,000 triangles.
#pragma once

#include <string>
#include <vector>

#include "intaglio/error.h"
#include "sound/bake/fem/body_surface.h"
#include "sound/bake/fem/tet_mesh.h"

namespace intaglio::sound {

struct FillOptions {
  double element_size = 0;    // wanted, m
  int max_elements = 40'000;  // the size is raised to stay near this limit
};

struct FilledSurface {
  TetMesh mesh;
  double element_size = 0;  // of a lattice cell, m
  std::vector<std::string> notes;
  std::string mesher = "lattice";  // "netgen", or "structured" for a built-in shape
};

// `name` appears in errors.
Result<FilledSurface> fill_surface(const BodySurface& body, const FillOptions& options,
                                   const std::string& name);

// Fits ten-node elements to the surface that they fill: mid-edge nodes as above, then the volume. Faceting
// costs 0.25 % of a ball's pitch. Adds to `notes` if the volume is too far off to be scaled.
void fit_surface(TetMesh& mesh, const BodySurface& body, const SurfaceQuery& surface,
                 std::vector<std::string>& notes);

}  // namespace intaglio::sound
