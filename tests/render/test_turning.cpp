// The picture depends on relative poses only, not on the world's axes.
#include <random>

#include "tests/render/scenes.h"

namespace intaglio::render::test {

TEST_CASE("turning the patch, the camera, the light and the bodies together does not change the picture") {
  if (!have_gl()) return;
  FrameScene scene = target_scene();
  scene.balls.push_back({.pose = {Vec3(0.06, 0.03, 0.1), Quat::Identity()}});
  scene.pen = Pen{.tip = Vec3(-0.1, 0, 0.1), .direction = Vec3(-1, 2, 1)};
  const Image8 straight = make_renderer(brick(), small_options())->draw(scene);
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 5; ++trial) {
    const Quat turn = Quat(normal(random), normal(random), normal(random), normal(random)).normalized();
    FrameScene turned = scene;
    turned.camera.eye = turn * scene.camera.eye;
    turned.camera.target = turn * scene.camera.target;
    turned.camera.up = turn * scene.camera.up;
    turned.light.direction = turn * scene.light.direction;
    turned.balls[0].pose = {turn * scene.balls[0].pose.position, turn * scene.balls[0].pose.orientation};
    turned.pen->tip = turn * scene.pen->tip;
    turned.pen->direction = turn * scene.pen->direction;
    const Image8 picture = make_renderer(brick(turn), small_options())->draw(turned);
    double sum = 0;
    std::size_t far_off = 0;
    for (std::size_t k = 0; k < picture.data.size(); ++k) {
      const int difference = std::abs(picture.data[k] - straight.data[k]);
      sum += difference;
      far_off += difference > 8;
    }
    CHECK(sum / double(picture.data.size()) < 0.1);
    CHECK(double(far_off) / double(picture.data.size()) < 0.002);  // pixels on an edge
  }
}

}  // namespace intaglio::render::test
