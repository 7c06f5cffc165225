// The shader programs of a picture: their source files, the uniform block that they share, and how they are
// compiled. Private to render/ and its tests.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "intaglio/error.h"
#include "render/frame_scene.h"
#include "render/gl.h"
#include "render/renderer.h"
#include "surface/surface.h"

namespace intaglio::render {

// Shader sources by file name.
using ShaderFiles = std::map<std::string, std::string>;

ShaderFiles embedded_shaders();

// The built-in shaders, replaced by files of the same name in `folder`. Fails when the folder has none of
// them, or one that cannot be read.
Result<ShaderFiles> shaders_from(const std::filesystem::path& folder);

// The spheres that stand for a frame's bodies in shadows: all balls, then the solids and the curved parts
// with a shadow radius; the first max_shadow_balls of them.
inline constexpr int max_shadow_balls = 32;

struct ShadowCasters {
  struct Sphere {
    Vec3 centre;
    double radius;
  };
  std::vector<Sphere> spheres;
  std::vector<int> balls, solids, parts;  // of each of the frame's: its index in `spheres`, or -1
};
ShadowCasters shadow_casters(const FrameScene& scene);

// The uniform block of one frame, in a surface's local frame. Mirrors the block Frame of shaders/frame.glsl
// (std140), which documents the names. Pure; no OpenGL.
struct FrameBlock {
  using Vec4 = std::array<float, 4>;

  std::array<float, 16> view_projection;
  Vec4 eye, light, light_colour, sky, ground, size, texels, material;
  std::array<std::int32_t, 4> steps, count;
  Vec4 pen_tip, pen_direction, pen_cone;
  std::array<Vec4, max_shadow_balls> ball;
};
static_assert(sizeof(FrameBlock) == 64 + 13 * 16 + max_shadow_balls * 16);

// The part of the block that is constant for a surface, of whose height pyramid `pyramid_levels` are traced.
FrameBlock make_surface_block(const SurfacePart& part, const RendererOptions& options, int pyramid_levels);

// The rest, for one frame. Matrices are column major, as OpenGL reads them.
void update_frame_block(FrameBlock& block, const FrameScene& scene, const ShadowCasters& casters,
                        const surface::Placement& placement, const RendererOptions& options);

// A body's pose in the surface's frame, its mesh scaled by `scale`.
Eigen::Matrix4f model_matrix(const Pose& pose, double scale, const surface::Placement& placement);

// The pose of a pen's mesh, which stands on its tip along +Z.
Pose pen_pose(const Pen& pen);

inline constexpr GLuint frame_binding = 0;
enum TextureUnit { heights_unit, bounds_unit, normals_unit, colour_unit, samples_unit };

// The compiled programs; needs a current context. Anything fixed for a picture is a compile-time constant of
// its program: llvmpipe executes both sides of a branch, so a bare base must not have the march and its
// shadow compiled in.
struct Programs {
  gl::Program slab, shell;                // flat and normal mapped
  gl::Program relief_slab, relief_shell;  // traced
  gl::Program mesh, ball, plain, pen, resolve;

  static Result<Programs> create(const RendererOptions& options, const ShaderFiles& files);
};

}  // namespace intaglio::render
