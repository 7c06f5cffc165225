// Surfaces and scenes that the tests of render/ share.
#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <string>

#include "render/egl_context.h"
#include "render/renderer.h"
#include "surface/surface.h"
#include "tests/skipped.h"

namespace intaglio::render::test {

// A position or normal of a vertex.
inline Vec3 vec(const std::array<float, 3>& a) {
  return {a[0], a[1], a[2]};
}

// A surface whose depth fraction is a function of uv, with the normals that follow from it, lying flat about
// the origin.
inline surface::Surface make_surface(int texels, double size, double max_depth,
                                     const std::function<double(double, double)>& fraction,
                                     const Quat& orientation = Quat::Identity(),
                                     surface::Edge edge = surface::Edge::clamp) {
  surface::Texels t;
  t.width = t.height = texels;
  const double h = 1.0 / texels;
  for (int j = 0; j < texels; ++j) {
    for (int i = 0; i < texels; ++i) {
      const double u = (i + 0.5) * h;
      const double v = (j + 0.5) * h;
      const double slope = max_depth / (2 * h * size);
      t.depth.push_back(float(fraction(u, v)));
      t.normal.push_back(Vec3(slope * (fraction(u + h, v) - fraction(u - h, v)),
                              slope * (fraction(u, v + h) - fraction(u, v - h)), 1)
                             .normalized());
    }
  }
  return surface::Surface(std::move(t), surface::Placement(Vec3::Zero(), orientation, size, size), max_depth,
                          edge);
}

// Running bond: 0 on the bricks, 1 in the mortar, a smooth bevel between, a little roughness on top.
inline double brick_depth(double u, double v) {
  const double row = v * 8;
  const double shift = std::fmod(std::floor(row) + 16, 2) * 0.5;
  const double column = u * 4 + shift;
  const double x =
      std::abs(column - std::floor(column) - 0.5) / 4;  // from the brick's middle, fractions of the tile
  const double y = std::abs(row - std::floor(row) - 0.5) / 8;
  const double outside = std::max(x - (0.125 - 0.019), y - (0.0625 - 0.019));
  const double s = std::clamp(outside / 0.010, 0.0, 1.0);
  const double rough = 0.02 + 0.02 * std::sin(97 * u) * std::sin(83 * v);
  return rough + (0.94 - rough) * s * s * (3 - 2 * s);
}

inline surface::Surface brick(const Quat& orientation = Quat::Identity()) {
  return make_surface(256, 1.0, 0.02, brick_depth, orientation);
}

// The camera of the target picture.
inline FrameScene target_scene() {
  FrameScene scene;
  scene.camera.eye = Vec3(0.05, 0.48, 0.62);
  scene.camera.target = Vec3(0, 0, -0.02);
  return scene;
}

inline RendererOptions small_options() {
  RendererOptions options;
  options.width = 160;
  options.height = 90;
  options.supersample = 1;
  options.detail = Detail::every_texel;  // as the brute force
  return options;
}

// False, with a message, if there is no EGL: then the test is skipped.
inline bool have_gl() {
  static const std::string missing = [] {
    const auto context = EglContext::create();
    return context ? std::string() : context.error().message();
  }();
  if (!missing.empty()) tests::skipped(missing);
  return missing.empty();
}

inline std::unique_ptr<Renderer> make_renderer(const surface::Surface& surface,
                                               const RendererOptions& options) {
  auto renderer = Renderer::create(surface, options);
  REQUIRE_MESSAGE(renderer.has_value(), (renderer ? "" : renderer.error().message()));
  return std::move(*renderer);
}

}  // namespace intaglio::render::test
