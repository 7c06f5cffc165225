// The scene as the shaders want it: one block of floats in the surface's local frame. Pure; no OpenGL.
#pragma once

#include <array>
#include <cstdint>

#include "intaglio/render/frame_scene.h"
#include "intaglio/render/renderer.h"
#include "intaglio/surface/surface.h"

namespace intaglio::render {

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

}  // namespace intaglio::render
