// Simplifies a modal model's surface as far as its mode shapes allow: removes points as long as the shapes,
// interpolated linearly between the remaining points, change by less than a given error.
//
// Bending and shear waves are centimetres long, but elements must be as small as the body is thin, so a model
// that kept every node would be many times larger, with no gain in accuracy. The remaining points keep their
// exact shapes. Cost: about 1 s for 20,000 points. Source: Hoppe et al., "Mesh optimization", 1993 (edge
// collapse, with the error measured at the removed points).
#pragma once

#include <atomic>

#include "sound/modal_model.h"

namespace intaglio::sound {

struct SampleOptions {
  // At most, at any point, as a fraction of a mode's largest displacement; 0: every node is kept.
  double shape_error = 0.06;
  double distance = 0.004;  // of the bounding box's diagonal, between the old surface and the new
};

// Replaces points, triangles and shapes, and sets `shape_error`; the caller rebuilds the grid. If `stop` is
// set, ends early with a valid surface that is simplified less.
void sample_surface(ModalModel& model, const SampleOptions& options = {},
                    const std::atomic<bool>* stop = nullptr);

}  // namespace intaglio::sound
