// The scene's textures on their rectangles and curved bases, and what they are made of.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/error.h"
#include "mesh/mesh_placement.h"
#include "mesh/relief_mesh.h"
#include "scene/scene.h"

namespace intaglio::scene {

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
dynamics::ShapeBody textured(const BodySettings& body, const std::vector<SceneSurface>& reliefs);

// The floor with all grounds and bodies' reliefs. Tenths of a second a texture of 512 x 512.
Result<SceneSurface> make_surface(const Scene& scene);

// The curved base of a scene's texture: its mesh, and the rectangle that measures the texture on it.

// About its own middle, with the texture as often over it as is wanted; triangles end where it does. A mesh
// of a file as it is there.
Result<surface::MeshPlacement> make_base(const BaseSettings& base, const Pose& pose);

// m, how long one texture is along u and v, the mean over the base.
Vec2 texture_size(const surface::TriangleMesh& mesh);

// How many texels of a curved relief a ball lies over: what a step of contact costs there, about 25 ns each
// (`intaglio render` of scenes/bowl.toml with repeat = [64, 64]; 2 cores, AMD EPYC, Debian 12, 22 November
// 2026).

// Those within the relief's depth of where a ball of that radius, m, touches: the cap 2 pi R d. Of a
// rectangle, whose contact does not look at all of them, and of no depth 0.
double covered_texels(const SceneSurface& relief, double radius);

// Grounds on which a ball of the scene covers more than a million are errors of the base's line; from a
// hundred thousand on there is a note that steps take long.
Result<void> check_covered_texels(const Scene& scene, SceneSurface& floor);

}  // namespace intaglio::scene
