// Relief on curved bases, drawn without a window: a bowl, a column and a ball of stone on a brick floor.
//
//   example_curved_picture [PICTURE.png]
#include <intaglio/render.h>

#include <iostream>

using namespace intaglio;

namespace {

Result<void> draw(const char* path) {
  const auto floor = Surface::load("brick", {.size = {1.4, 1.4}, .depth = 0.02});
  const auto bowl = CurvedSurface::load("pebbles", bowl_mesh(0.2), {.depth = 0.012}),
             column = CurvedSurface::load("stone_flags", cylinder_mesh(0.1, 0.5), {.depth = 0.01}),
             ball = CurvedSurface::load("metal_studs", sphere_mesh(0.12), {.depth = 0.006});
  if (!floor) return tl::unexpected(floor.error());
  for (const auto* s : {&bowl, &column, &ball})
    if (!*s) return tl::unexpected(s->error());
  auto renderer = Renderer::headless(960, 540);
  if (!renderer) return tl::unexpected(renderer.error());

  const auto picture =
      renderer->draw({.surfaces = {*floor},
                      .curved = {{.surface = *bowl, .pose = {Vec3(0.3, 0.2, 0.1)}},
                                 {.surface = *column, .pose = {Vec3(-0.1, 0.25, -0.3)}},
                                 {.surface = *ball,
                                  .pose = {Vec3(-0.28, 0.12, 0.15), rotation(0.6, Vec3(0.3, 1, 0.2).normalized())},
                                  .shadow_radius = 0.12}},
                      .balls = {{.pose = {Vec3(0.3, 0.06, 0.1)}, .radius = 0.05}},
                      .camera = {.eye = {0.25, 0.75, 1.1}, .target = {0, 0.1, 0}}});
  if (!picture) return tl::unexpected(picture.error());
  return picture->save(path);
}

}  // namespace

int main(int argc, char** argv) {
  const char* path = argc > 1 ? argv[1] : "curved_picture.png";
  const auto drawn = draw(path);
  if (drawn)
    std::cout << path << '\n';
  else
    std::cerr << drawn.error() << '\n';
  return drawn ? 0 : 1;
}
