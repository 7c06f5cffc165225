// From a scene and where its bodies are to what the renderer draws: the same for a video and for the window.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "contact/shape.h"
#include "mesh/triangle_mesh.h"
#include "render/frame_scene.h"
#include "render/mesh.h"
#include "render/renderer.h"
#include "scene/scene.h"
#include "scene/surfaces.h"

namespace intaglio::scene {

class ScenePicture {
 public:
  ScenePicture(const Scene& scene, const SceneSurface& surface);

  // Camera, light and representation are the scene's; change what you like.
  render::FrameScene frame(std::span<const Pose> balls, std::span<const Pose> bodies,
                           const std::optional<Vec3>& pen_tip) const;

 private:
  void add_body(std::size_t k, const std::vector<SceneSurface>& reliefs);

  Scene scene_;
  std::vector<render::Solid>
      solids_;  // where they were at the start: of bodies, then the backs of curved ground
  std::vector<render::FrameScene::PartPose> part_poses_;
  // Of each body: which of these it has.
  struct Drawn {
    std::optional<std::size_t> solid;
    std::size_t first_part = 0, parts = 0;
  };
  std::vector<Drawn> drawn_;
};

// What the renderer shows of a scene's surfaces: the floor, then the grounds, then the reliefs of bodies.
std::vector<render::SurfacePart> surface_parts(const Scene& scene, const SceneSurface& surface);

// What a body's shape looks like: a mesh in the body's frame for the renderer. Pure; milliseconds.

render::Mesh shape_mesh(const contact::Shape& shape);

// The other side of an open curved base that is some metres thick, with its rim: what one sees of a bowl from
// outside. Pure; milliseconds.

// Empty where the base is closed. The rim is drawn from `relief` metres below the base, where the layer of
// the relief, which has a side of its own, ends.
render::Mesh back_mesh(const surface::TriangleMesh& base, double relief, double thickness);

}  // namespace intaglio::scene
