// Modal models from shapes and meshes: what a body of that material rings like. Links MUMPS and METIS; the sound
// run time (sound.h) does not.
//
//   auto model = intaglio::bake(intaglio::Sphere{0.05}, "steel");     // examples/struck_ball.cpp
//   if (model) model->save("ball.modes");
//
// Quadratic finite elements of the free body; seconds to a minute, one core. Any thread, one bake at a time in a
// process (the solver has global state): calls wait for each other. docs/bake.md says how true it is.
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
  // m, of an element; unset: a quarter of the shortest wave that is wanted, of thin bodies a fifth.
  std::optional<double> element_size = {};
  int max_elements = 40'000;
  double thickness = 0;  // m; above 0 a mesh is the middle surface of a shell, open or closed
  double merge_db = 0.5;  // modes that no listener tells apart become one, by so much a band at most; 0: none
  std::function<void(double done)> progress = {};  // 0..1, in the calling thread
};

// Sphere, Box or Cylinder, of structured elements. Errors: another shape, a material out of range, no mode that
// rings below max_frequency.
Result<ModalModel> bake(const Shape& shape, const MaterialChoice& material, const BakeOptions& options = {});

// Any mesh, also an unclean one, in metres. Errors: as above; a mesh that encloses nothing.
Result<ModalModel> bake(const TriangleMesh& mesh, const MaterialChoice& material, const BakeOptions& options = {});

}  // namespace intaglio
