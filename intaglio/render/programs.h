// The shader programs of a picture, and where they find the frame and the textures. Needs a current context.
#pragma once

#include "intaglio/render/gl.h"
#include "intaglio/render/renderer.h"
#include "intaglio/render/shader_files.h"

namespace intaglio::render {

inline constexpr GLuint frame_binding = 0;
enum Unit { heights_unit, bounds_unit, normals_unit, colour_unit, samples_unit };

struct Programs {
  gl::Program slab, mesh, shell, ball, plain, pen, resolve;

  static Result<Programs> create(March march, const ShaderFiles& files);
};

}  // namespace intaglio::render
