#include "intaglio/render/programs.h"

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

Result<Programs> Programs::create(const RendererOptions& options, const ShaderFiles& files) {
  using Names = std::vector<std::string>;
  const std::string search = options.march == March::classic ? "march_classic.glsl" : "march_pyramid.glsl";
  // RELIEF: whether the surface is drawn as relief.
  const auto make = [&](gl::Program& program, const char* name, const std::string& constant,
                        const Names& vertex, const Names& fragment) -> Result<void> {
    const auto pieces = [&](const Names& names) {
      std::vector<gl::Program::Piece> out{{"(constants)", constant + "\n"}};
      for (const std::string& file : names) out.push_back({file, files.at(file)});
      return out;
    };
    auto created = gl::Program::create(name, pieces(vertex), pieces(fragment));
    if (!created) return tl::unexpected(created.error());
    program = std::move(*created);
    connect(program);
    return {};
  };
  const auto surface = [&](gl::Program& program, const char* name, const char* vertex, bool relief) {
    return make(program, name, fmt::format("const bool RELIEF = {};", relief), {"frame.glsl", vertex},
                {"frame.glsl", "heights.glsl", search, "shadow.glsl", "lighting.glsl", "surface_shading.glsl",
                 fmt::format("{}.frag", name)});
  };
  const auto solid = [&](gl::Program& program, const char* name) {
    return make(program, name, "#define RELIEF (count.z == 2)", {"frame.glsl", "solid.vert"},
                {"frame.glsl", "heights.glsl", "shadow.glsl", "lighting.glsl", fmt::format("{}.frag", name)});
  };
  Programs result;
  Result<void> ok = surface(result.relief_slab, "slab", "slab.vert", true);
  if (ok) ok = surface(result.slab, "slab", "slab.vert", false);
  if (ok) ok = surface(result.mesh, "mesh", "solid.vert", true);
  if (ok) ok = surface(result.relief_shell, "shell", "shell.vert", true);
  if (ok) ok = surface(result.shell, "shell", "shell.vert", false);
  if (ok) ok = solid(result.ball, "ball");
  if (ok) ok = solid(result.plain, "plain");
  if (ok) ok = solid(result.pen, "pen");
  if (ok)
    ok = make(result.resolve, "resolve", fmt::format("const int SUPERSAMPLE = {};", options.supersample),
              {"screen.vert"}, {"resolve.frag"});
  if (!ok) return tl::unexpected(ok.error());
  return result;
}

}  // namespace intaglio::render
