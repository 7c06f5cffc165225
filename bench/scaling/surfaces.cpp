// The number of textured surfaces in a scene: contact, touch, picture.
#include <cmath>
#include <memory>

#include "bench/brick.h"
#include "bench/scaling/law.h"
#include "bench/sliding_tip.h"
#include "bench/timing.h"
#include "core/portable_math.h"
#include "dynamics/world.h"
#include "haptics/servo.h"
#include "render/renderer.h"
#include "session/scene_loop.h"

namespace intaglio::bench {

namespace {

using SharedSurface = std::shared_ptr<const surface::Surface>;
constexpr int balls = 64, steps = 120, ticks = 4000;

// A square number of squares of 1 m side by side, all of the same texels.
std::vector<SharedSurface> tiled(int count) {
  const surface::Surface one = brick(512);
  const int across = int(std::ceil(std::sqrt(count)));
  std::vector<SharedSurface> out;
  for (int k = 0; k < count; ++k) {
    const Vec3 centre(k % across - 0.5 * (across - 1), 0, k / across - 0.5 * (across - 1));
    out.push_back(std::make_shared<const surface::Surface>(
        one.placed({centre, Quat::Identity(), 1, 1}, one.max_depth())));
  }
  return out;
}

// 64 balls that roll slowly, shared out among the surfaces.
double step_us(const std::vector<SharedSurface>& surfaces) {
  const Material material = *find_material("stone");
  dynamics::WorldOptions options;
  options.bodies_collide = false;
  dynamics::World world(surfaces[0], material, options);
  for (std::size_t k = 1; k < surfaces.size(); ++k) world.add_surface(surfaces[k], material);
  Random random(3);
  for (int k = 0; k < balls; ++k) {
    const surface::Placement& on = surfaces[std::size_t(k) % surfaces.size()]->placement();
    const double x = random.uniform(0.3, 0.7);
    const double y = random.uniform(0.3, 0.7);
    dynamics::SphereBody ball;
    ball.radius = 0.03;
    ball.position = on.to_world({x, y, 0.031});
    ball.velocity = Vec3(random.uniform(-0.3, 0.3), 0, 0);
    world.add(ball);
  }
  std::vector<double> us;
  for (int k = 0; k < steps; ++k) {
    const double start = cpu_seconds();
    world.step();
    us.push_back(1e6 * (cpu_seconds() - start));
  }
  return summary(us).median;
}

double tick_us(const std::vector<SharedSurface>& surfaces) {
  auto all = std::make_shared<session::UnionSolid>();
  for (const SharedSurface& s : surfaces)
    all->add(std::make_unique<haptics::TexturedSlab>(s, haptics::SolidOptions{}));
  const std::vector<Vec3> path = sliding_path(surfaces[0], ticks);
  LedDevice device(path);
  haptics::PenServo servo(surfaces[0], all, haptics::ServoOptions{});
  const double start = cpu_seconds();
  for (int k = 0; k < ticks; ++k) servo.tick(device);
  return 1e6 * (cpu_seconds() - start) / ticks;
}

Result<std::unique_ptr<render::Renderer>> shown(const std::vector<SharedSurface>& surfaces) {
  render::RendererOptions options;
  options.width = 320;
  options.height = 180;
  options.supersample = 1;
  auto renderer = render::Renderer::create(*surfaces[0], options);
  if (!renderer) return renderer;
  std::vector<render::SurfacePart> parts;
  for (const SharedSurface& s : surfaces) {
    parts.emplace_back();
    parts.back().surface = s.get();
  }
  if (auto ready = (*renderer)->show(parts); !ready) return tl::unexpected(ready.error());
  return renderer;
}

// From so far that all surfaces fill the same part of the picture.
double frame_ms(render::Renderer& renderer, std::size_t count) {
  render::FrameScene scene;
  scene.camera.eye = std::ceil(std::sqrt(double(count))) * Vec3(0.05, 0.48, 0.62);
  const double start = process_seconds();
  renderer.draw(scene);
  return 1e3 * (process_seconds() - start);
}

}  // namespace

Result<std::vector<Law>> scale_surfaces(const Effort& effort) {
  const std::vector<double> n =
      effort.quick ? std::vector<double>{1, 4, 16} : std::vector<double>{1, 4, 9, 16, 36, 64};
  const int rounds = effort.quick ? 1 : 7;
  std::vector<std::vector<SharedSurface>> all;
  std::vector<std::unique_ptr<render::Renderer>> renderers;
  for (const double count : n) {
    all.push_back(tiled(int(count)));
    auto renderer = shown(all.back());
    if (!renderer) return tl::unexpected(renderer.error());
    renderers.push_back(std::move(*renderer));
    frame_ms(*renderers.back(), all.back().size());
  }
  const std::string axis = "surfaces";
  std::vector<Law> laws;
  laws.push_back({axis, "contact", "us a step of 64 balls, 480 Hz", n,
                  interleaved(n.size(), rounds, [&](std::size_t k) { return step_us(all[k]); }), 1e6 / 480,
                  "1/480 s"});
  laws.push_back({axis, "touch", "us a tick", n,
                  interleaved(n.size(), rounds, [&](std::size_t k) { return tick_us(all[k]); }), 1000,
                  "1 ms"});
  laws.push_back(
      {axis, "picture", "ms a frame of 320 x 180", n,
       interleaved(n.size(), rounds, [&](std::size_t k) { return frame_ms(*renderers[k], all[k].size()); }),
       1e3 / 30, "1/30 s"});
  return laws;
}

}  // namespace intaglio::bench
