// Any triangle mesh as a solid ten-node mesh: winding numbers say what is inside, a lattice fills it
// (lattice.h) along the body's flat faces (lattice.h), mid-edge nodes of the boundary are curved onto the
// surface where that keeps every element positive, and of a closed surface the exact volume is restored,
// since a shift of pitch follows its error.
//
// A surface with a thickness is filled half of it to either side (inside.h).
//
// Open, self-intersecting and doubled surfaces are filled too; what was found is in `notes`. Refused: what
// encloses no volume or only by a lid that is not there, loose parts, and what is too thin for the greatest
// number of elements. Cost: about 0.1 s for 2,500 elements from 5,000 triangles.
#pragma once

#include "intaglio/error.h"
#include "sound/bake/fem/body_surface.h"
#include "sound/bake/fem/tet_mesh.h"

namespace intaglio::sound {

struct FillOptions {
  double element_size = 0;    // metres, wanted
  int max_elements = 40'000;  // the size grows until about so many are enough
};

struct FilledSurface {
  TetMesh mesh;
  double element_size = 0;  // of a lattice cell, metres
  std::vector<std::string> notes;
  std::string mesher = "lattice";  // "netgen", or "structured" of a built-in shape
};

// `mesh` is checked; `name` is for errors.
Result<FilledSurface> fill_surface(const surface::TriangleMesh& mesh, const FillOptions& options,
                                   const std::string& name);
// The same, of a surface that was made ready already.
Result<FilledSurface> fill_surface(const BodySurface& body, const FillOptions& options,
                                   const std::string& name);

// Ten-node elements fitted to the surface that they fill: mid-edge nodes of the boundary are moved onto it
// where that keeps every element positive, and of a closed surface the exact volume is restored, since a
// shift of pitch follows its error. Faceting cost 0.25 % of a ball's pitch.

// Adds to `notes` when the volume is too far off to be scaled.
void fit_surface(TetMesh& mesh, const BodySurface& body, const SurfaceQuery& surface,
                 std::vector<std::string>& notes);

}  // namespace intaglio::sound
