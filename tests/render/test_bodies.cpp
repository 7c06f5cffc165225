// Balls and pens share the relief's depth buffer.
#include "tests/render/oracle.h"
#include "tests/render/scenes.h"

namespace intaglio::render::test {

TEST_CASE("a ball half sunk in a pit is cut along the brink") {
  if (!have_gl()) return;
  // A round pit with steep walls; the ball sits on its floor, half below the base plane.
  const auto pit = [](double u, double v) {
    return 1 - std::clamp((std::hypot(u - 0.5, v - 0.5) - 0.2) / 0.03, 0.0, 1.0);
  };
  const auto surface = make_surface(128, 1.0, 0.15, pit);
  const RendererOptions options = small_options();
  for (const double elevation : {0.25, 0.6, 1.4}) {
    FrameScene scene;
    scene.camera.eye = Vec3(0.3, elevation, 1.0);
    scene.camera.fov_y_degrees = 35;
    scene.balls.push_back({.pose = {Vec3(0.02, 0.0, 0.03), Quat::Identity()}, .radius = 0.14});
    const auto renderer = make_renderer(surface, options);
    renderer->draw(scene);
    const auto drawn = renderer->depth();
    const auto slab = slab_depth(surface, options, scene.camera);
    std::size_t ball_pixels = 0;
    std::size_t wrong = 0;
    for (std::size_t k = 0; k < drawn.size(); ++k) {
      const int x = int(k) % options.width;
      const int y = int(k) / options.width;
      const double ball =
          meet_ball(scene.balls[0], pixel_ray(scene.camera, options.width, options.height, x, y));
      const double expected = std::min(ball, slab[k]);
      ball_pixels += ball < slab[k];
      wrong += std::isfinite(expected) != bool(std::isfinite(drawn[k])) ||
               (std::isfinite(expected) && std::abs(drawn[k] - expected) > 0.01);
    }
    MESSAGE("ball covers " << ball_pixels << " pixels, " << wrong << " pixels of the picture differ");
    CHECK(ball_pixels > 300);
    CHECK(double(wrong) <= 0.01 * double(ball_pixels));
  }
}

TEST_CASE("a pen is drawn where its pose says, and its sunk tip is hidden") {
  if (!have_gl()) return;
  const auto surface = brick();
  RendererOptions options = small_options();
  const auto renderer = make_renderer(surface, options);
  FrameScene scene = target_scene();
  const Pen pen{.tip = Vec3(-0.1, -0.05, 0.1), .direction = Vec3(-1, 3, 0.5), .length = 0.3, .radius = 0.02};
  renderer->draw(scene);
  const auto without = renderer->depth();
  scene.pen = pen;
  renderer->draw(scene);
  const auto with = renderer->depth();
  const Vec3 forward = (scene.camera.target - scene.camera.eye).normalized();
  int above = 0;
  int below = 0;
  for (int y = 0; y < options.height; ++y) {
    for (int x = 0; x < options.width; ++x) {
      const std::size_t k = std::size_t(y * options.width + x);
      if (with[k] == without[k]) continue;
      const Ray ray = pixel_ray(scene.camera, options.width, options.height, x, y);
      const Vec3 hit = ray.origin + double(with[k]) * ray.direction;
      const double s = (hit - pen.tip).dot(pen.direction.normalized());
      const double off_axis = (hit - pen.tip - s * pen.direction.normalized()).norm();
      CHECK(off_axis <= pen.radius * 1.01);
      CHECK(s <= pen.length * 1.001);
      hit.y() > 0 ? ++above : ++below;
    }
  }
  CHECK(forward.y() < 0);
  CHECK(above > 100);
  CHECK(below < above / 4);
}

TEST_CASE("a ball's stripes turn with it") {
  if (!have_gl()) return;
  const auto renderer = make_renderer(brick(), small_options());
  FrameScene scene = target_scene();
  scene.balls.push_back({.pose = {Vec3(0, 0.15, 0.1), Quat::Identity()}, .radius = 0.15});
  const Image8 still = renderer->draw(scene);
  const auto still_depth = renderer->depth();
  for (const Vec3& axis : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)}) {
    scene.balls[0].pose.orientation = Quat(Eigen::AngleAxisd(0.3, axis));
    const Image8 turned = renderer->draw(scene);
    int changed = 0;
    for (std::size_t k = 0; k < still.data.size(); k += 3)
      changed += std::abs(still.data[k] - turned.data[k]) > 40;
    CHECK(changed > 60);
    CHECK(compare_depth(renderer->depth(), still_depth).rms < 1e-3);
  }
}

}  // namespace intaglio::render::test
