// Two draws of the same scene are the same bytes.
#include "tests/render/scenes.h"

namespace intaglio::render::test {

TEST_CASE("two draws of the same scene are equal, byte by byte, and so are two renderers") {
  if (!have_gl()) return;
  FrameScene scene = target_scene();
  scene.balls.push_back({.pose = {Vec3(0.05, 0.035, 0.1), Quat::Identity()}});
  scene.pen = Pen{.tip = Vec3(-0.1, -0.01, 0.1), .direction = Vec3(-1, 2, 1)};
  RendererOptions options = small_options();
  options.supersample = 2;
  const auto surface = brick();
  const auto renderer = make_renderer(surface, options);
  const Image8 first = renderer->draw(scene);
  const std::vector<float> first_depth = renderer->depth();
  CHECK(first.data == renderer->draw(scene).data);
  CHECK(first_depth == renderer->depth());
  CHECK(first.data == make_renderer(surface, options)->draw(scene).data);
}

}  // namespace intaglio::render::test
