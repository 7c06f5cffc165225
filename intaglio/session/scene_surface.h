// The scene's textures on their rectangles, and what they are made of.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "intaglio/core/error.h"
#include "intaglio/session/scene.h"

namespace intaglio::session {

struct SceneSurface {
  std::shared_ptr<const surface::Surface> surface;
  Material material;
  double roughness = 0.55;            // for the renderer, 0..1
  std::vector<std::string> notes;     // what import found, a line each
  std::vector<SceneSurface> grounds;  // of a scene's floor: the surfaces beside it
};
// The floor with all grounds. Tenths of a second a texture of 512 x 512.
Result<SceneSurface> make_surface(const Scene& scene);

}  // namespace intaglio::session
