// The shader programs of a picture, and where they find the frame and the textures. Needs a current context.
#pragma once

#include "intaglio/render/gl.h"
#include "intaglio/render/renderer.h"
#include "intaglio/render/shader_files.h"

namespace intaglio::render {

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
