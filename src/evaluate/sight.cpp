#include "evaluate/sight.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/portable_math.h"
#include "evaluate/cpu_timer.h"
#include "render/renderer.h"
#include "scene/picture.h"

namespace intaglio::evaluate {

namespace {

// Scene light of a pixel: the inverse of sRGB and of the film curve of shaders/lighting.glsl.
std::array<double, 256> light_of_pixels() {
  std::array<double, 256> light;
  for (std::size_t k = 0; k < light.size(); ++k) {
    const double encoded = double(k) / 255;
    const double shown = encoded <= 0.04045
                             ? encoded / 12.92
                             : elementary::exp(2.4 * elementary::log((encoded + 0.055) / 1.055));
    double low = 0, high = 20;
    for (int step = 0; step < 60; ++step) {
      const double x = 0.5 * (low + high);
      const double film = x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14);
      (film < shown ? low : high) = x;
    }
    light[k] = 0.5 * (low + high);
  }
  return light;
}

}  // namespace

Result<Sight> Sight::look(const Subject& subject, const Candidate& candidate, int pixels) {
  static const std::array<double, 256> light = light_of_pixels();
  const double side = subject.options().size;
  const surface::Surface& shown = *subject.surface(candidate).surface;
  render::RendererOptions options;
  options.width = options.height = pixels;
  options.supersample = 2;
  options.shadow_steps = 0;
  options.roughness = 1;
  options.slab_thickness = 0.05 * side;
  if (candidate.is_papers) options.march = render::March::classic;
  options.displaced_mesh_cells = candidate.mesh_cells;
  auto renderer = render::Renderer::create(shown, options);
  if (!renderer) return tl::unexpected(renderer.error());
  Sight sight;
  sight.pixels_ = pixels;
  sight.height_ = 100 * side;  // far away: a ball hides nothing else than what is under it
  sight.placement_ = shown.placement();
  render::FrameScene frame;
  frame.representation = candidate.representation;
  frame.camera = {.eye = {0, sight.height_, 0}, .target = Vec3::Zero(), .up = -Vec3::UnitZ()};
  const double tangent = 0.51 * side / sight.height_;
  frame.camera.fov_y_degrees = 2 * elementary::atan2(tangent, 1) * 180 / std::numbers::pi;
  frame.camera.near = 0.9 * sight.height_;
  frame.camera.far = 1.1 * sight.height_;
  sight.focal_ = 0.5 * pixels / tangent;
  frame.light.sky = frame.light.ground = Vec3::Zero();
  frame.light.colour = Vec3::Constant(5);
  std::array<Image8, 4> pictures;
  const double tan_height = std::sqrt(3.0);  // of 60 degrees
  const std::array<Vec3, 4> lamps = {Vec3(1, tan_height, 0), Vec3(-1, tan_height, 0), Vec3(0, tan_height, -1),
                                     Vec3(0, tan_height, 1)};
  const double start = cpu_seconds(CLOCK_PROCESS_CPUTIME_ID);
  for (std::size_t k = 0; k < 4; ++k) {
    frame.light.direction = lamps[k];
    pictures[k] = (*renderer)->draw(frame);
  }
  sight.cost_ = (cpu_seconds(CLOCK_PROCESS_CPUTIME_ID) - start) / 4;
  const auto count = std::size_t(pixels) * std::size_t(pixels);
  sight.slopes_.resize(count, Vec2::Zero());
  for (std::size_t p = 0; p < count; ++p) {
    std::array<double, 4> seen{};
    for (std::size_t k = 0; k < 4; ++k)
      for (std::size_t c = 0; c < 3; ++c) seen[k] += light[pictures[k].data[3 * p + c]];
    for (int axis = 0; axis < 2; ++axis) {
      const double plus = seen[std::size_t(2 * axis)], minus = seen[std::size_t(2 * axis + 1)];
      if (plus + minus > 0) sight.slopes_[p][axis] = -(plus - minus) / (plus + minus) * tan_height;
    }
  }
  return sight;
}

Vec2 Sight::slope(const Vec3& point) const {
  const Vec3 world = placement_.to_world(point);
  const double depth = height_ - world.y();
  const double x = 0.5 * pixels_ + focal_ * world.x() / depth - 0.5;
  const double y = 0.5 * pixels_ + focal_ * world.z() / depth - 0.5;
  const double i = std::floor(x), j = std::floor(y);
  const auto at = [&](double a, double b) {
    const auto column = std::size_t(std::clamp(a, 0.0, pixels_ - 1.0));
    const auto row = std::size_t(std::clamp(b, 0.0, pixels_ - 1.0));
    return slopes_[row * std::size_t(pixels_) + column];
  };
  const double s = x - i, t = y - j;
  return (1 - t) * ((1 - s) * at(i, j) + s * at(i + 1, j)) +
         t * ((1 - s) * at(i, j + 1) + s * at(i + 1, j + 1));
}

}  // namespace intaglio::evaluate
