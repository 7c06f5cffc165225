// Relief on curved bases, drawn without a window: a bowl, a column and a ball of stone on a brick floor.
//   example_curved_picture [PICTURE.png]
#include <fmt/format.h>

#include "core/file.h"
#include "mesh/triangle_mesh.h"
#include "render/renderer.h"
#include "surface/import.h"

using namespace intaglio;

namespace {

// A built-in texture on a rectangle of width x height metres about the origin.
Result<surface::Surface> textured(const char* name, double width, double height, double depth) {
  auto imported = surface::import_texture(name, {});
  if (!imported) return tl::unexpected(imported.error());
  return surface::Surface(std::move(imported->texels),
                          surface::Placement(Vec3::Zero(), Quat::Identity(), width, height), depth,
                          surface::Edge::wrap);
}

Result<void> draw(const char* path) {
  const double around = 6.28;
  const auto floor = textured("brick", 1.4, 1.4, 0.02),
             pebbles = textured("pebbles", 0.2 * around, 0.63, 0.012),
             flags = textured("stone_flags", 0.1 * around, 0.6, 0.01),
             studs = textured("metal_studs", 0.12 * around, 0.38, 0.006);
  for (const auto* s : {&floor, &pebbles, &flags, &studs})
    if (!*s) return tl::unexpected(s->error());
  const auto bowl = surface::make_bowl(0.2, 96, 48), column = surface::make_cylinder(0.1, 0.5, 96, 1),
             ball = surface::make_sphere(0.12, 96, 48);

  render::RendererOptions options;
  options.width = 960;
  options.height = 540;
  auto renderer = render::Renderer::create(*floor, options);
  if (!renderer) return tl::unexpected(renderer.error());
  const render::SurfacePart parts[] = {{.surface = &*floor},
                                       {.surface = &*pebbles, .base = &bowl},
                                       {.surface = &*flags, .base = &column},
                                       {.surface = &*studs, .base = &ball}};
  if (const auto shown = (*renderer)->show(parts); !shown) return shown;

  render::FrameScene scene;
  scene.camera.eye = Vec3(0.25, 0.75, 1.1);
  scene.camera.target = Vec3(0, 0.1, 0);
  const Quat turned(Eigen::AngleAxisd(0.6, Vec3(0.3, 1, 0.2).normalized()));
  scene.part_poses = {{},
                      {.pose = {Vec3(0.3, 0.2, 0.1), Quat::Identity()}},
                      {.pose = {Vec3(-0.1, 0.25, -0.3), Quat::Identity()}},
                      {.pose = {Vec3(-0.28, 0.12, 0.15), turned}, .shadow_radius = 0.12}};
  scene.balls.push_back({.pose = {Vec3(0.3, 0.06, 0.1), Quat::Identity()}, .radius = 0.05});
  return write_file(path, encode_png((*renderer)->draw(scene)));
}

}  // namespace

int main(int argc, char** argv) {
  const char* path = argc > 1 ? argv[1] : "curved_picture.png";
  const auto drawn = draw(path);
  fmt::print("{}\n", drawn ? path : drawn.error().message());
  return drawn ? 0 : 1;
}
