// The scene's textures on their rectangles and curved bases, and what they are made of.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "intaglio/core/error.h"
#include "intaglio/session/scene.h"
#include "intaglio/surface/mesh/relief_mesh.h"

namespace intaglio::session {

struct SceneSurface {
  std::shared_ptr<const surface::Surface> surface;  // on a curved base: its rectangle measures u and v
  std::optional<surface::ReliefMesh> curved;  // the same on its base; of a body in its frame, else world
  std::shared_ptr<const surface::TriangleMesh> quad;  // the rectangle of a body's side, in its frame, to draw
  Material material;
  double roughness = 0.55;                         // for the renderer, 0..1
  std::vector<std::string> notes;                  // what import found, a line each
  std::vector<SceneSurface> grounds;               // of a scene's floor: the surfaces beside it
  std::vector<std::vector<SceneSurface>> reliefs;  // and those on its bodies, one list a body
};

// A body with its reliefs.
dynamics::ShapeBody textured(const BodyScene& body, const std::vector<SceneSurface>& reliefs);

// The floor with all grounds and bodies' reliefs. Tenths of a second a texture of 512 x 512.
Result<SceneSurface> make_surface(const Scene& scene);

}  // namespace intaglio::session
