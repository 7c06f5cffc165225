// The size of the texture: contact, touch, sound, picture, memory, and the making of a surface from its
// texels.
#include <memory>

#include "bench/floors.h"
#include "bench/scaling/law.h"
#include "bench/sliding_tip.h"
#include "bench/timing.h"
#include "haptics/servo.h"
#include "render/renderer.h"

namespace intaglio::bench {

namespace {

constexpr double ball_radius = 0.1;  // m
constexpr int balls = 100, batch_ticks = 4000, stroke_samples = 20'000;
volatile double texture_sink = 0;

// One texture with all that its senses need. The floor is 4 m, as elsewhere; a pen slides over 1 m.
struct Sized {
  explicit Sized(int size)
      : surface(bricks(size)),
        floor(textured("", surface, {})),
        world(floor),
        small(std::make_shared<const surface::Surface>(
            surface->placed({Vec3::Zero(), Quat::Identity(), 1, 1}, surface->max_depth() / floor_side))),
        path(sliding_path(small, batch_ticks)),
        device(path),
        servo(small, haptics::ServoOptions{}) {
    for (int k = 0; k < balls; ++k) world.add(ball);
  }

  SharedSurface surface;
  Floor floor;
  btSphereShape ball{btScalar(ball_radius)};
  FloorWorld world;
  SharedSurface small;
  std::vector<Vec3> path;
  LedDevice device;
  haptics::PenServo servo;
  std::unique_ptr<render::Renderer> renderer;
  double made_ms = 0;
};

double contact_us(Sized& it) {
  std::vector<double> us;
  roll_balls(it.world, it.floor, ball_radius, 77, us);
  return summary(us).median;
}

double tick_us(Sized& it) {
  double sum = 0;
  const double start = cpu_seconds();
  for (int k = 0; k < batch_ticks; ++k) {
    it.servo.tick(it.device);
    sum += it.device.last();
  }
  texture_sink = texture_sink + sum;
  return 1e6 * (cpu_seconds() - start) / batch_ticks;
}

// Slopes along a stroke of half the texture, as a scrape asks for them: a block of 64 samples.
double slope_us(const surface::Surface& s) {
  double sum = 0;
  const double start = cpu_seconds();
  for (int k = 0; k < stroke_samples; ++k) {
    const double along = 0.5 * k / stroke_samples;
    sum += s.smooth({0.1 + along, 0.2 + 0.7 * along}).gradient.x();
  }
  texture_sink = texture_sink + sum;
  return 64e6 * (cpu_seconds() - start) / stroke_samples;
}

double frame_ms(render::Renderer& renderer) {
  render::FrameScene scene;
  scene.camera.eye = Vec3(0.2, 1.9, 2.5);
  const double start = process_seconds();
  renderer.draw(scene);
  return 1e3 * (process_seconds() - start);
}

// The surface anew, from its texels.
double make_ms(const surface::Surface& s) {
  surface::Texels texels;
  texels.width = s.width();
  texels.height = s.height();
  texels.depth = s.depth_texture();
  const std::vector<float> normals = s.normal_texture();
  for (std::size_t k = 0; k + 2 < normals.size(); k += 3)
    texels.normal.emplace_back(double(normals[k]), double(normals[k + 1]), double(normals[k + 2]));
  texels.colour = Image8(1, 1, 3);
  const double start = cpu_seconds();
  const surface::Surface made(std::move(texels), s.placement(), s.max_depth(), s.edge());
  texture_sink = texture_sink + made.max_depth();
  return 1e3 * (cpu_seconds() - start);
}

}  // namespace

Result<std::vector<Law>> scale_texture(const Effort& effort) {
  std::vector<int> sizes =
      effort.quick ? std::vector{256, 512, 1024} : std::vector{256, 512, 1024, 2048, 4096};
  if (effort.large) sizes.push_back(8192);
  std::vector<std::unique_ptr<Sized>> all;
  for (const int size : sizes) {
    all.push_back(std::make_unique<Sized>(size));
    Sized& it = *all.back();
    it.made_ms = make_ms(*it.surface);
    render::RendererOptions options;
    options.width = 320;
    options.height = 180;
    options.supersample = 1;
    auto renderer = render::Renderer::create(*it.surface, options);
    if (!renderer) return tl::unexpected(renderer.error());
    it.renderer = std::move(*renderer);
    frame_ms(*it.renderer);
  }
  const int rounds = effort.quick ? 2 : 9;
  const std::vector<double> n(sizes.begin(), sizes.end());
  const auto measured = [&](const auto& cost) {
    return interleaved(all.size(), rounds, [&](std::size_t k) { return cost(*all[k]); });
  };
  const std::string axis = "texels a side";
  std::vector<Law> laws;
  laws.push_back(
      {axis, "contact", "us a step of 100 balls, 60 Hz", n, measured(contact_us), 1e6 / 60, "1/60 s"});
  laws.push_back({axis, "touch", "us a tick", n, measured(tick_us), 1000, "1 ms"});
  laws.push_back({axis, "sound", "us of slopes a block of 64 samples", n,
                  measured([](Sized& it) { return slope_us(*it.surface); }), 64e6 / 44'100, "64 samples"});
  laws.push_back({axis, "picture", "ms a frame of 320 x 180", n,
                  measured([](Sized& it) { return frame_ms(*it.renderer); }), 1e3 / 30, "1/30 s"});
  std::vector<double> bytes, made;
  for (const auto& it : all) {
    bytes.push_back(double(it->surface->memory_bytes() - it->surface->colour().data.size()) / 1e6);
    made.push_back(it->made_ms);
  }
  laws.push_back({axis, "memory", "MB, without colours", n, bytes, 0, ""});
  laws.push_back({axis, "making", "ms from texels to surface", n, made, 0, ""});
  return laws;
}

}  // namespace intaglio::bench
