// The texts of the shaders by the names of their files: those built in, or a folder's in their place while
// one works on them.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

#include "intaglio/error.h"
#include "render/frame_scene.h"
#include "render/gl.h"
#include "render/renderer.h"
#include "surface/surface.h"

namespace intaglio::render {

using ShaderFiles = std::map<std::string, std::string>;

ShaderFiles embedded_shaders();

// The built-in ones, but for those that `folder` has a file for. Fails when it has none, or one that cannot
// be read.
Result<ShaderFiles> shaders_from(const std::filesystem::path& folder);

// The scene as the shaders want it: one block of floats in the surface's local frame. Pure; no OpenGL.

inline constexpr int max_shadow_balls = 32;

// Mirrors the uniform block Frame of shaders/frame.glsl, std140: the names and meanings are documented there.
struct FrameBlock {
  using Four = std::array<float, 4>;

  std::array<float, 16> view_projection;
  Four eye, light, light_colour, sky, ground, size, texels, material;
  std::array<std::int32_t, 4> steps, count;
  Four pen_tip, pen_direction, pen_cone;
  std::array<Four, max_shadow_balls> ball;
};
static_assert(sizeof(FrameBlock) == 64 + 13 * 16 + max_shadow_balls * 16);

// What of the block follows from a surface and the options, once for all frames. `pyramid_levels` is how
// many levels the height pyramid has.
FrameBlock surface_block(const SurfacePart& part, const RendererOptions& options, int pyramid_levels);

// The rest, for one frame. Matrices are column major, as OpenGL reads them.
void fill_frame(FrameBlock& block, const FrameScene& scene, const surface::Placement& placement,
                const RendererOptions& options);

// Which of the frame's casters of shadows a curved part is, or -1.
int caster_of_part(const FrameScene& scene, std::size_t part);

// A body's pose in the surface's frame, its mesh scaled by `scale`.
Eigen::Matrix4f model_matrix(const Pose& pose, double scale, const surface::Placement& placement);

// The pose of a pen's mesh, which stands on its tip along +Z.
Pose pen_pose(const Pen& pen);

// The shader programs of a picture, and where they find the frame and the textures. Needs a current context.

inline constexpr GLuint frame_binding = 0;
enum Unit { heights_unit, bounds_unit, normals_unit, colour_unit, samples_unit };

// What does not change within a picture is a constant of its program: drivers without branches (llvmpipe) run
// whatever might be needed, so the march and its shadow must not be in the program of a bare base.
struct Programs {
  gl::Program slab, shell;                // flat and normal mapped
  gl::Program relief_slab, relief_shell;  // traced
  gl::Program mesh, ball, plain, pen, resolve;

  static Result<Programs> create(const RendererOptions& options, const ShaderFiles& files);
};

}  // namespace intaglio::render
