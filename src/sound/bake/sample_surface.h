// A modal model's surface, no finer than its sound needs: points are taken out while mode shapes between
// those that stay, linear over the triangles, are what they were.
//
// Bending and shear waves are centimetres long where elements must be as small as a body is thin; a model
// that kept every node would be many times larger, and no truer. Points that stay keep their exact shapes.
// Cost: about 1 s for 20,000 points. Source: Hoppe et al., "Mesh optimization", 1993 (edge collapse, with the
// error measured at the points taken out).
#pragma once

#include "sound/modal_model.h"

namespace intaglio::sound {

// How finely the surface is sampled.
struct SampleOptions {
  double shape_error =
      0.06;                 // at most, at any point, of a mode's largest displacement; 0: every node is kept
  double distance = 0.004;  // of the bounding box's diagonal, between the old surface and the new
};

// Replaces points, triangles and shapes, and sets `shape_error`; the grid is the caller's to make again.
void sample_surface(ModalModel& model, const SampleOptions& options = {});

}  // namespace intaglio::sound
