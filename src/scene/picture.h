// Turns a scene and its bodies' poses into a render::FrameScene, for videos and the window alike. Its
// surfaces are those that the picture is given (cues.h).
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "contact/shape.h"
#include "intaglio/error.h"
#include "mesh/triangle_mesh.h"
#include "render/frame_scene.h"
#include "render/mesh.h"
#include "render/renderer.h"
#include "scene/scene.h"
#include "scene/surfaces.h"

namespace intaglio::scene {

class ScenePicture {
 public:
  ScenePicture(const Scene& scene, const SceneSurface& all);

  // Camera, light and representation are the scene's; the caller may change them.
  render::FrameScene frame(std::span<const Pose> balls, std::span<const Pose> bodies,
                           const std::optional<Vec3>& pen_tip) const;

 private:
  void add_body(std::size_t k, const std::vector<SceneSurface>& reliefs);
  std::shared_ptr<const render::Mesh> shared(render::Mesh mesh);

  Scene scene_;
  std::multimap<std::uint64_t, std::shared_ptr<const render::Mesh>> meshes_;  // by the hash of their bytes
  std::vector<render::Solid> solids_;  // bodies at their start, then the backs of curved grounds
  std::vector<render::FrameScene::PartPose> part_poses_;
  // Indices of a body's drawings in the two lists above.
  struct BodyDrawing {
    std::optional<std::size_t> solid;
    std::size_t first_part = 0, parts = 0;
  };
  std::vector<BodyDrawing> drawings_;
};

// The surfaces of a scene for the renderer: the floor, then the grounds, then the reliefs of bodies.
std::vector<render::SurfacePart> surface_parts(const Scene& scene, const SceneSurface& all);

// An off-screen renderer of the scene's pictures, which shows its surfaces. Tenths of a second.
Result<std::unique_ptr<render::Renderer>> make_renderer(const Scene& scene, const SceneSurface& all);

// Render mesh of a contact shape, in the body's frame. Pure; milliseconds.
render::Mesh shape_mesh(const contact::Shape& shape);

// Back face and rim of an open curved base of that thickness, m: the outside of a bowl. Empty for a closed
// base. The rim starts `relief` metres below the base, where the relief layer's own side wall ends. Pure;
// milliseconds.
render::Mesh back_mesh(const surface::TriangleMesh& base, double relief, double thickness);

}  // namespace intaglio::scene
