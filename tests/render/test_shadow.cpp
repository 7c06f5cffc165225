// Shadows fall exactly where geometry says.
#include <numbers>

#include "tests/render/scenes.h"

namespace intaglio::render::test {

namespace {

constexpr double trench_depth = 0.06;
constexpr double wall = 0.01;  // width of the slope of a side

// A trench along v, floor 0.3..0.7 of u; its floor is the mortar, its sides the bricks'.
double trench(double u, double) {
  return std::clamp((std::min(u - 0.3, 0.7 - u) + wall) / wall, 0.0, 1.0);
}

// Straight down on the trench with a hard, low or high sun and hardly any sky.
FrameScene sun_over_trench(double elevation_degrees, double towards_x) {
  FrameScene scene;
  scene.camera.eye = Vec3(0, 1.3, 0);
  scene.camera.up = -Vec3::UnitZ();
  scene.camera.fov_y_degrees = 30;
  const double e = elevation_degrees * std::numbers::pi / 180;
  scene.light.direction = Vec3(towards_x * std::cos(e), std::sin(e), 0);
  scene.light.radius_degrees = 0.3;
  scene.light.sky = scene.light.ground = Vec3::Constant(0.02);
  return scene;
}

// Brightness of the middle row of the picture, at every x in -0.2..0.2 of the trench's floor.
std::vector<std::pair<double, int>> floor_profile(const Image8& image) {
  const double metres = 2 * std::tan(15 * std::numbers::pi / 180) * (1.3 + trench_depth) / image.height;
  std::vector<std::pair<double, int>> out;
  for (int x = 0; x < image.width; ++x) {
    const double at = (x + 0.5 - 0.5 * image.width) * metres;
    if (std::abs(at) < 0.19) out.emplace_back(at, image.at(x, image.height / 2, 0));
  }
  return out;
}

int brightest(const std::vector<std::pair<double, int>>& profile) {
  int most = 0;
  for (const auto& [x, value] : profile) most = std::max(most, value);
  return most;
}

}  // namespace

TEST_CASE(
    "a low sun darkens the floor next to the side it stands behind, as far as geometry says; the zenith "
    "nothing") {
  if (!have_gl()) return;
  const auto renderer = make_renderer(make_surface(256, 1.0, trench_depth, trench), small_options());
  const auto noon = floor_profile(renderer->draw(sun_over_trench(90, 1)));
  for (const auto& [x, value] : noon) CHECK(value >= 0.8 * brightest(noon));

  for (const double towards_x : {1.0, -1.0}) {
    for (const double elevation : {20.0, 30.0, 45.0}) {
      const auto profile = floor_profile(renderer->draw(sun_over_trench(elevation, towards_x)));
      // The brink of the side is `wall` outside the floor, which ends at 0.2.
      const double shadow = trench_depth / std::tan(elevation * std::numbers::pi / 180);
      const double edge = 0.2 + wall - shadow;
      for (const auto& [x, value] : profile) {
        const double towards_sun = x * towards_x;
        CAPTURE(elevation);
        CAPTURE(towards_sun);
        if (towards_sun > edge + 0.012) CHECK(value < 0.5 * brightest(profile));
        if (towards_sun < edge - 0.012) CHECK(value > 0.75 * brightest(profile));
      }
    }
  }
}

TEST_CASE("a ball and a pen throw shadows on the relief, to the side away from the sun") {
  if (!have_gl()) return;
  const auto renderer =
      make_renderer(make_surface(8, 1.0, 0.02, [](double, double) { return 0.5; }), small_options());
  FrameScene scene = sun_over_trench(45, 1);
  scene.camera.fov_y_degrees = 40;
  const Image8 empty = renderer->draw(scene);
  const double metres = 2 * std::tan(20 * std::numbers::pi / 180) * 1.31 / 90;
  const auto darkness_at = [&](const Image8& image, double x) {
    const int column = int(80 + x / metres);
    return double(image.at(column, 45, 0)) / empty.at(column, 45, 0);
  };
  scene.balls.push_back({.pose = {Vec3(0, 0.2, 0), Quat::Identity()}, .radius = 0.05});
  const Image8 ball = renderer->draw(scene);
  CHECK(darkness_at(ball, -0.21) < 0.5);  // its middle is thrown 0.2 + 0.01 to the left
  CHECK(darkness_at(ball, 0.21) > 0.9);
  CHECK(darkness_at(ball, -0.35) > 0.9);

  scene.balls.clear();
  scene.pen = Pen{.tip = Vec3(0, 0.2, -0.1), .direction = Vec3(0, 0, 1), .length = 0.4, .radius = 0.02};
  const Image8 pen = renderer->draw(scene);
  CHECK(darkness_at(pen, -0.21) < 0.5);
  CHECK(darkness_at(pen, 0.21) > 0.9);
  CHECK(darkness_at(pen, -0.35) > 0.9);
}

TEST_CASE("a lamp very far away is the sun") {
  if (!have_gl()) return;
  const auto renderer = make_renderer(brick(), small_options());
  FrameScene scene = target_scene();
  scene.balls.push_back({.pose = {Vec3(0.05, 0.035, 0.1), Quat::Identity()}});
  const Image8 sun = renderer->draw(scene);
  scene.light.position = 1000 * scene.light.direction.normalized();
  const Image8 lamp = renderer->draw(scene);
  int most = 0;
  for (std::size_t k = 0; k < sun.data.size(); ++k)
    most = std::max(most, std::abs(sun.data[k] - lamp.data[k]));
  CHECK(most <= 12);
}

}  // namespace intaglio::render::test
