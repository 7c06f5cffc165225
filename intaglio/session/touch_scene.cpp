#include "intaglio/session/touch_scene.h"

#include "intaglio/session/simulation.h"

namespace intaglio::session {

namespace {

constexpr double ball_radius = 0.01, falls_from = 0.01, rolling_speed = 0.6, scraping_speed = 0.15;

PenScene scraping_pen() {
  PenScene pen;
  pen.workspace.scale = 3;
  pen.tip_radius = 0.0005;
  pen.hand.stiffness = 1000;
  pen.hand.damping = 15;
  for (double t = 0; t < 2.05; t += 0.1) {
    const double x = -0.14 + scraping_speed * std::max(0.0, t - 0.3);
    const double y = std::max(-0.012, 0.02 - 0.1 * t);
    pen.path.push_back({t, {x, y, 0.03 - 0.15 * x}});
  }
  return pen;
}

}  // namespace

std::string touch_name(Touch touch) {
  return touch == Touch::strike ? "strike" : touch == Touch::scrape ? "scrape" : "roll";
}

Scene touch_scene(Touch touch, const std::string& texture) {
  Scene scene;
  scene.name = scene.title = texture + ", " + touch_name(touch);
  scene.duration = 2;
  scene.surface.texture = texture;
  scene.surface.size = {0.5, 0.5};
  scene.surface.thickness = 0.03;
  scene.sound.modes = 80;
  scene.camera.eye = {0, 0.35, 0.35};
  scene.camera.target = Vec3::Zero();
  BallScene ball;
  ball.radius = ball_radius;
  ball.material = *find_material(touch == Touch::strike ? "wood" : "steel");
  if (touch == Touch::strike) {
    ball.position = {0.03, falls_from + ball_radius, 0.04};
    scene.balls.push_back(ball);
  } else if (touch == Touch::roll) {
    ball.position = {-0.22, ball_radius + 0.001, 0.12};
    ball.velocity = {rolling_speed, 0, -0.4 * rolling_speed};
    ball.angular_velocity = Vec3::UnitY().cross(ball.velocity) / ball_radius;
    scene.balls.push_back(ball);
  } else {
    scene.pen = scraping_pen();
  }
  return scene;
}

Result<Recording> play(const Scene& scene) {
  const auto surface = make_surface(scene);
  if (!surface) return tl::unexpected(surface.error());
  auto simulation = Simulation::create(scene, *surface);
  if (!simulation) return tl::unexpected(simulation.error());
  (*simulation)->finish();
  return std::move((*simulation)->recording());
}

}  // namespace intaglio::session
