#include "intaglio/render/programs.h"

#include "intaglio_shaders.h"

namespace intaglio::render {

namespace {

// Those that a program does not use are ignored.
void connect(const gl::Program& program) {
  program.bind_block("Frame", frame_binding);
  program.use();
  program.set("heights", heights_unit);
  program.set("bounds", bounds_unit);
  program.set("normals", normals_unit);
  program.set("colour", colour_unit);
  program.set("samples", samples_unit);
  program.set("self_caster", -1);
}

}  // namespace

Result<Programs> Programs::create(March march) {
  using namespace shaders;
  const char* search = march == March::classic ? march_classic_glsl : march_pyramid_glsl;
  Programs result;
  const auto make = [](gl::Program& program, const char* name, gl::Program::Pieces vertex,
                       gl::Program::Pieces fragment) -> Result<void> {
    auto created = gl::Program::create(name, vertex, fragment);
    if (!created) return tl::unexpected(created.error());
    program = std::move(*created);
    connect(program);
    return {};
  };
  const auto surface = [&](gl::Program& program, const char* name, const char* vertex, const char* fragment) {
    return make(
        program, name, {frame_glsl, vertex},
        {frame_glsl, heights_glsl, search, shadow_glsl, lighting_glsl, surface_shading_glsl, fragment});
  };
  const auto solid = [&](gl::Program& program, const char* name, const char* fragment) {
    return make(program, name, {frame_glsl, solid_vert},
                {frame_glsl, heights_glsl, shadow_glsl, lighting_glsl, fragment});
  };
  Result<void> ok = surface(result.slab, "slab", slab_vert, slab_frag);
  if (ok) ok = surface(result.mesh, "mesh", solid_vert, mesh_frag);
  if (ok) ok = surface(result.shell, "shell", shell_vert, shell_frag);
  if (ok) ok = solid(result.ball, "ball", ball_frag);
  if (ok) ok = solid(result.plain, "plain", plain_frag);
  if (ok) ok = solid(result.pen, "pen", pen_frag);
  if (ok) ok = make(result.resolve, "resolve", {screen_vert}, {resolve_frag});
  if (!ok) return tl::unexpected(ok.error());
  return result;
}

}  // namespace intaglio::render
