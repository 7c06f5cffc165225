// The reference picture, by brute force, in double, on the CPU.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "render/frame_scene.h"
#include "render/renderer.h"
#include "surface/surface.h"

namespace intaglio::render::test {

inline constexpr double nothing = std::numeric_limits<double>::infinity();

struct Ray {
  Vec3 origin;
  Vec3 direction;  // 1 along the camera's axis, so that t is linear depth
};

// The ray through the middle of pixel (x, y), row 0 at the top.
inline Ray pixel_ray(const Camera& camera, int width, int height, int x, int y) {
  const Vec3 forward = (camera.target - camera.eye).normalized();
  const Vec3 right = forward.cross(camera.up).normalized();
  const Vec3 up = right.cross(forward);
  const double half = std::tan(0.5 * camera.fov_y_degrees * std::numbers::pi / 180);
  const double sx = (2 * (x + 0.5) / width - 1) * half * width / height;
  const double sy = (1 - 2 * (y + 0.5) / height) * half;
  return {camera.eye, forward + sx * right + sy * up};
}

// The steepest the bilinear field can be: the height changes by at most this much a metre.
inline double steepest(const surface::Surface& surface) {
  double along_u = 0;
  double along_v = 0;
  for (int j = -1; j <= surface.height(); ++j) {
    for (int i = -1; i <= surface.width(); ++i) {
      const double z = surface.texel_z(i, j);
      along_u = std::max(along_u, std::abs(surface.texel_z(i + 1, j) - z));
      along_v = std::max(along_v, std::abs(surface.texel_z(i, j + 1) - z));
    }
  }
  return std::hypot(along_u / surface.texel_u(), along_v / surface.texel_v());
}

// t at which the ray meets the slab with its relief; the slab's walls count. Walks down the ray by steps too
// short to pass through a field of that steepness, or of 1/1000 texel, whichever is longer.
inline double meet_slab(const surface::Surface& surface, double slab, double slope, const Ray& ray) {
  const auto& place = surface.placement();
  const Vec3 o = place.to_local(ray.origin);
  const Vec3 d = place.direction_to_local(ray.direction);
  const Vec3 low(0, 0, -slab);
  const Vec3 high(place.size_u(), place.size_v(), 0);
  double from = 0;
  double to = nothing;
  for (int k = 0; k < 3; ++k) {
    const double a = (low[k] - o[k]) / d[k];
    const double b = (high[k] - o[k]) / d[k];
    from = std::max(from, std::min(a, b));
    to = std::min(to, std::max(a, b));
  }
  const double fastest = std::abs(d.z()) + slope * d.head<2>().norm();
  const double least = 0.001 * std::min(surface.texel_u(), surface.texel_v()) / d.norm();
  for (double t = from; t < to;) {
    const Vec3 p = o + t * d;
    const double over = p.z() + surface.depth(place.uv(p));
    if (over <= 0) return t;
    t += std::max(over / fastest, least);
  }
  return nothing;
}

inline double meet_ball(const Ball& ball, const Ray& ray) {
  const Vec3 w = ray.origin - ball.pose.position;
  const double a = ray.direction.squaredNorm();
  const double b = w.dot(ray.direction);
  const double discriminant = b * b - a * (w.squaredNorm() - ball.radius * ball.radius);
  return discriminant < 0 ? nothing : (-b - std::sqrt(discriminant)) / a;
}

// Linear depth picture of the slab alone.
inline std::vector<double> slab_depth(const surface::Surface& surface, const RendererOptions& options,
                                      const Camera& camera) {
  const double slab = std::max(options.slab_thickness, 1.25 * surface.max_depth());
  const double slope = steepest(surface);
  std::vector<double> out;
  for (int y = 0; y < options.height; ++y) {
    for (int x = 0; x < options.width; ++x) {
      out.push_back(meet_slab(surface, slab, slope, pixel_ray(camera, options.width, options.height, x, y)));
    }
  }
  return out;
}

// How two depth pictures differ: RMS over the pixels that see something in both, and the share that only one
// sees.
struct DepthDifference {
  double rms = 0;
  double share_lost = 0;
};

template <class A, class B>
DepthDifference compare_depth(const A& a, const B& b) {
  double sum = 0;
  std::size_t both = 0;
  std::size_t one = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    const bool seen_a = std::isfinite(a[k]);
    const bool seen_b = std::isfinite(b[k]);
    if (seen_a && seen_b) {
      sum += (double(a[k]) - double(b[k])) * (double(a[k]) - double(b[k]));
      ++both;
    } else if (seen_a != seen_b) {
      ++one;
    }
  }
  return {std::sqrt(sum / double(std::max<std::size_t>(both, 1))),
          double(one) / double(std::max<std::size_t>(a.size(), 1))};
}

}  // namespace intaglio::render::test
