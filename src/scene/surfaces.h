// Builds the surfaces of a scene: floor, grounds and body reliefs, flat or on curved bases.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "intaglio/error.h"
#include "mesh/mesh_placement.h"
#include "mesh/relief_mesh.h"
#include "scene/scene.h"

namespace intaglio::scene {

struct SceneSurface {
  // On a curved base: over a rectangle of the size of one texture period.
  std::shared_ptr<const surface::Surface> surface;
  // Set on curved bases; in the body's frame for a body's skin, otherwise world.
  std::optional<surface::ReliefMesh> curved;
  // Drawn for a box's top or bottom, in the body's frame.
  std::shared_ptr<const surface::TriangleMesh> quad;
  Material material;
  double roughness = 0.55;                         // for the renderer, 0..1
  std::vector<std::string> notes;                  // import notes, one per line
  std::vector<SceneSurface> grounds;               // floor only: the scene's grounds
  std::vector<std::vector<SceneSurface>> reliefs;  // floor only: reliefs, one list per body
  // Floor only: what a sense is given in place of all this, where its cue says so (cues.h); null: this.
  std::array<std::shared_ptr<const SceneSurface>, all_cues.size()> instead;
};

// The surface as a sense is given it.
const SceneSurface& given(const SceneSurface& floor, Cue cue);

// The floor's textures as sound knows them: its own, then the others that its contacts are given.
std::vector<std::shared_ptr<const surface::Surface>> heard_textures(const SceneSurface& floor);
// Where among them the texture of that sound is.
int heard_texture(const SceneSurface& floor, Cue sound);

// The physics body with its reliefs attached.
dynamics::ShapeBody textured(const BodySettings& body, const std::vector<SceneSurface>& reliefs);

// All that the texels of a surface depend on: surfaces with equal keys share them.
using TextureKey = std::tuple<std::string, std::optional<surface::Green>, std::optional<surface::Polarity>,
                              surface::Edge, surface::ImportMode, std::optional<std::array<double, 2>>>;
TextureKey texture_key(const SurfaceSettings& surface);

// The floor with all grounds and bodies' reliefs. Some 0.1 s per different 512 x 512 texture. Fails when the
// scene would need more memory than it is allowed (cost.h).
Result<SceneSurface> make_surface(const Scene& scene);

// The base mesh at `pose`, its texture coordinates scaled by `repeat`; triangle edges fall on the texture's
// borders. A mesh file is taken as it is.
Result<surface::MeshPlacement> make_base(const BaseSettings& base, const Pose& pose,
                                         std::uint64_t allowed_memory = default_allowed_memory);

// Texels of a curved relief that a ball of `radius` metres covers: those under the spherical cap whose height
// is the relief's depth d. A cap of a sphere of radius R has area 2 pi R d (Archimedes); the base's curvature
// is ignored, so in a bowl of radius B the area is larger by 1 / (1 - R / B). 0 for rectangles, whose contact
// does not visit every texel, and for zero depth.
//
// This is what a contact step costs, about 25 ns a texel (`intaglio render` of scenes/bowl.toml with repeat =
// [64, 64]; 2 cores, AMD EPYC, Debian 12, 22 November 2026).
double covered_texels(const SceneSurface& relief, double radius);

// An error at the base's line where a ball of the scene covers more than a million texels of a ground; above
// a hundred thousand, a note.
Result<void> check_contact_cost(const Scene& scene, SceneSurface& floor);

}  // namespace intaglio::scene
