#include "evaluate/sight.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/portable_math.h"
#include "render/renderer.h"
#include "scene/picture.h"
#include "session/cost_meter.h"

namespace intaglio::evaluate {

namespace {

double process_seconds() {
  return 1e-9 * double(session::process_cpu_ns());
}

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

// The same surface with a white colour map of the same size, which costs as much to draw.
surface::Surface white(const surface::Surface& surface) {
  surface::Texels texels;
  texels.width = surface.width();
  texels.height = surface.height();
  texels.depth = surface.depth_texture();
  const std::vector<float> normals = surface.normal_texture();
  for (std::size_t k = 0; k < normals.size(); k += 3)
    texels.normal.push_back({double(normals[k]), double(normals[k + 1]), double(normals[k + 2])});
  const Image8& colour = surface.colour();
  texels.colour = Image8(std::max(colour.width, 1), std::max(colour.height, 1), 3);
  std::fill(texels.colour.data.begin(), texels.colour.data.end(), std::uint8_t{255});
  return {std::move(texels), surface.placement(), surface.max_depth(), surface.edge()};
}

}  // namespace

Result<Sight> Sight::look(const Subject& subject, const Candidate& candidate, int pixels,
                          const surface::Surface* drawn) {
  return look(drawn ? *drawn : *subject.surface(candidate).surface, candidate, pixels);
}

Result<Sight> Sight::look(const surface::Surface& surface, const Candidate& candidate, int pixels) {
  static const std::array<double, 256> light = light_of_pixels();
  const surface::Surface shown = white(surface);
  const double side = shown.placement().size().maxCoeff();
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
  frame.light.colour = Vec3::Constant(1.5);  // the film curve is steep in all of what it gives
  std::array<Image8, 4> pictures;
  const double tan_height = steepest;
  const std::array<Vec3, 4> lamps = {Vec3(1, tan_height, 0), Vec3(-1, tan_height, 0), Vec3(0, tan_height, -1),
                                     Vec3(0, tan_height, 1)};
  const double start = process_seconds();
  for (std::size_t k = 0; k < 4; ++k) {
    frame.light.direction = lamps[k];
    pictures[k] = (*renderer)->draw(frame);
  }
  sight.cost_ = (process_seconds() - start) / 4;
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
