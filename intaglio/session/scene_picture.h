// From a scene and where its bodies are to what the renderer draws: the same for a video and for the window.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "intaglio/render/frame_scene.h"
#include "intaglio/render/renderer.h"
#include "intaglio/session/scene.h"
#include "intaglio/session/scene_surface.h"

namespace intaglio::session {

class ScenePicture {
 public:
  explicit ScenePicture(const Scene& scene);

  // Camera, light and representation are the scene's; change what you like.
  render::FrameScene frame(std::span<const Pose> balls, std::span<const Pose> bodies,
                           const std::optional<Vec3>& pen_tip) const;

 private:
  Scene scene_;
  std::vector<render::Solid> solids_;  // where they were at the start
};

// What the renderer shows of a scene's surfaces: the floor, then the grounds.
std::vector<render::SurfacePart> surface_parts(const Scene& scene, const SceneSurface& surface);

}  // namespace intaglio::session
