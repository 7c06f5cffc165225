// Modal models from shapes and meshes: how a body of a given material rings. Links MUMPS and METIS; the
// sound run time (sound.h) does not.
//
//   auto model = intaglio::bake(intaglio::Sphere{0.05}, "steel");     // examples/struck_ball.cpp
//   if (model) model->save("ball.modes");
//
// Quadratic finite elements of the free body, one core. Solids are fast (a box takes less than a second),
// shells are slow (BakeOptions::thickness; a crate of 0.2 m takes 52 s). Any thread, one bake at a time in a
// process (the solver has global state): calls wait for each other. docs/bake.md says how accurate the models
// are.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "intaglio/error.h"
#include "intaglio/material.h"
#include "intaglio/shape.h"
#include "intaglio/sound.h"
#include "intaglio/triangle_mesh.h"

namespace intaglio {

struct BakeOptions {
  std::string name = {};          // of the model, for people
  int modes = 100;                // at most
  double max_frequency = 20'000;  // Hz
  // m, of an element; unset: a quarter of the shortest wave that is wanted, a fifth for thin bodies.
  std::optional<double> element_size = {};
  int max_elements = 40'000;
  double thickness = 0;   // m; above 0 a mesh is the middle surface of a shell, open or closed
  double merge_db = 0.5;  // merges modes that sound alike, changing no auditory band by more; 0: merges none
  std::function<void(double done)> progress = {};  // 0..1, in the calling thread
};

// Sphere, Box or Cylinder, of structured elements. Errors: another shape, a material out of range, no mode
// that rings below max_frequency.
Result<ModalModel> bake(const Shape& shape, const MaterialChoice& material, const BakeOptions& options = {});

// Any mesh in metres, even a dirty one. Errors: as above; a mesh that encloses nothing.
Result<ModalModel> bake(const TriangleMesh& mesh, const MaterialChoice& material,
                        const BakeOptions& options = {});

}  // namespace intaglio
