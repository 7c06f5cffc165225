// Simplifies a modal model's surface as far as its mode shapes allow: points are removed while shapes
// interpolated linearly between the remaining ones stay what they were.
//
// Bending and shear waves are centimetres long where elements must be as small as a body is thin; a model
// that kept every node would be many times larger, with no gain in accuracy. Remaining points keep their
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
