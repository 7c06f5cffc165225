// From modes of nodes to a modal model: what ringing modes have, how they radiate, the surface sampled.
#pragma once

#include "intaglio/sound/modal_model.h"

namespace intaglio::sound {

struct ModalSurface {
  std::vector<Vec3> points;
  std::vector<Triangle> triangles;
  std::vector<int> nodes;  // of each point, among the rows of the modes
  double thickness = 0;    // m, of a shell that has one side here; 0: the surface of a body
};

// Overdamped modes are left out.
ModalModel model_of_modes(const Modes& modes, ModalSurface surface, double mass, const Material& material,
                          const BakeOptions& options);

// What would make a bake meaningless.
Result<void> check_material(const Material& material);

// The boundary as flat triangles, four to each curved one.
ModalSurface boundary_surface(const TetMesh& mesh);

}  // namespace intaglio::sound
