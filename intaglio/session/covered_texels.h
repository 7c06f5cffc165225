// How many texels of a curved relief a ball lies over: what a step of contact costs there, about 25 ns each
// (`intaglio render` of scenes/bowl.toml with repeat = [64, 64]; 2 cores, AMD EPYC, Debian 12, 22 November
// 2026).
#pragma once

#include "intaglio/core/error.h"
#include "intaglio/session/scene_surface.h"

namespace intaglio::session {

// Those within the relief's depth of where a ball of that radius, m, touches: the cap 2 pi R d. Of a
// rectangle, whose contact does not look at all of them, and of no depth 0.
double covered_texels(const SceneSurface& relief, double radius);

// Grounds on which a ball of the scene covers more than a million are errors of the base's line; from a
// hundred thousand on there is a note that steps take long.
Result<void> check_covered_texels(const Scene& scene, SceneSurface& floor);

}  // namespace intaglio::session
