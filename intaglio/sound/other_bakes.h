// The coarser ways to a modal model, for comparison with `bake`: four-node elements, and the paper's
// spring-mass shell (paper §1.4).
#pragma once

#include "intaglio/sound/fem/body_surface.h"
#include "intaglio/sound/modal_model.h"

namespace intaglio::sound {

// With linear tetrahedra between the corners of `mesh`; its mid-edge nodes follow. A quarter of the degrees
// of freedom, and thin bodies come out tens of per cent sharp: use it where the paper's own pitch is wanted.
Result<ModalModel> bake_linear(const TetMesh& mesh, const Material& material,
                               const BakeOptions& options = {});

// A hollow shell of `thickness` metres over the surface, open or closed: masses at its vertices, a spring
// E t along every edge, and against folding a hinge with the shell's bending stiffness D = E t^3 / (12 (1 -
// nu^2)), since springs alone leave flat parts loose. One piece; the pitch depends on the triangles, evenly
// shaped ones give it within some ten per cent. `name` is for errors. Sources: Raghuvanshi & Lin,
// "Interactive sound synthesis for large scale environments", 2006 (springs); Grinspun et al., "Discrete
// shells", 2003 (hinges).
Result<ModalModel> bake_spring_shell(const BodySurface& surface, double thickness, const Material& material,
                                     const BakeOptions& options, const std::string& name);

}  // namespace intaglio::sound
