// Sight reads the slopes of surfaces whose slopes are known, in every way that they are drawn.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "evaluate/sight.h"
#include "render/egl_context.h"
#include "tests/skipped.h"

using namespace intaglio;
using namespace intaglio::evaluate;

namespace {

constexpr int texels = 128;
constexpr double size = 0.7;  // m

// The relief of a height (m, at most 0, over uv) and its slope, lying flat about the origin.
surface::Surface sloped(double depth, const std::function<double(const Vec2&)>& height,
                        const std::function<Vec2(const Vec2&)>& slope, std::uint8_t grey = 255) {
  surface::Texels t;
  t.width = t.height = texels;
  t.colour = Image8(8, 8, 3);
  std::fill(t.colour.data.begin(), t.colour.data.end(), grey);
  for (int j = 0; j < texels; ++j) {
    for (int i = 0; i < texels; ++i) {
      const Vec2 uv = Vec2(i + 0.5, j + 0.5) / texels;
      const Vec2 s = slope(uv);
      t.depth.push_back(float(-height(uv) / depth));
      t.normal.push_back(Vec3(-s.x(), -s.y(), 1).normalized());
    }
  }
  return {std::move(t), surface::Placement(Vec3::Zero(), Quat::Identity(), size, size), depth,
          surface::Edge::wrap};
}

bool have_egl() {
  const auto context = render::EglContext::create();
  if (!context) tests::skipped(context.error().message());
  return context.has_value();
}

// Greatest error of either component over a grid of points, away from the rim.
double worst_error(const Sight& sight, const std::function<double(const Vec2&)>& height,
                   const std::function<Vec2(const Vec2&)>& slope) {
  double worst = 0;
  for (int j = 2; j < 48; ++j) {
    for (int i = 2; i < 48; ++i) {
      const Vec2 uv = Vec2(i + 0.3, j + 0.6) / 50;
      const Vec2 seen = sight.slope({uv.x() * size, uv.y() * size, height(uv)});
      worst = std::max(worst, (seen - slope(uv)).cwiseAbs().maxCoeff());
    }
  }
  return worst;
}

Candidate candidate(Kind kind) {
  return candidates()[std::size_t(kind)];
}

}  // namespace

TEST_CASE("planes of any slope up to 1 are seen with it, whatever their colour") {
  if (!have_egl()) return;
  // A normal map alone: the picture's slope is the map's, at any height.
  const struct {
    Vec2 slope;
    std::uint8_t grey;
  } cases[] = {{{0, 0}, 255}, {{1, 0}, 40}, {{0.3, -0.2}, 40}, {{0, -1}, 255}, {{-0.7, 0.7}, 128}};
  for (const auto& plane : cases) {
    const auto height = [](const Vec2&) { return 0.0; };
    const auto slope = [&](const Vec2&) { return plane.slope; };
    const auto sight = Sight::look(sloped(0.01, height, slope, plane.grey), candidate(Kind::normal), 64);
    REQUIRE_MESSAGE(sight, sight.error().message());
    CAPTURE(plane.slope.transpose());
    CAPTURE(int(plane.grey));
    CHECK(worst_error(*sight, height, slope) < 0.02);
  }
}

TEST_CASE(
    "waves are seen with their slopes as normal map, as relief and as fine mesh, and not at all as a flat floor") {
  if (!have_egl()) return;
  const double waves = 3, depth = size / (2 * std::numbers::pi * waves);  // the greatest slope is 1 along u
  const double phase = 2 * std::numbers::pi * waves;
  const auto height = [&](const Vec2& uv) {
    return 0.25 * depth * (std::cos(phase * uv.x()) + std::sin(phase * uv.y()) - 2);
  };
  const auto slope = [&](const Vec2& uv) {
    return Vec2(-0.25 * std::sin(phase * uv.x()), 0.25 * std::cos(phase * uv.y()));
  };
  const auto steep = [&](const Vec2& uv) { return Vec2(4 * slope(uv)); };
  const surface::Surface gentle = sloped(depth, height, slope), tall = sloped(depth, height, steep);
  for (const Kind kind : {Kind::normal, Kind::relief, Kind::relief_paper, Kind::mesh_512}) {
    const auto sight = Sight::look(gentle, candidate(kind), 192);
    REQUIRE_MESSAGE(sight, sight.error().message());
    CAPTURE(candidate(kind).key);
    CHECK(worst_error(*sight, height, slope) < 0.02);
  }
  const auto sight = Sight::look(tall, candidate(Kind::normal), 192);
  REQUIRE(sight);
  CHECK(worst_error(*sight, height, steep) < 0.02);
  const auto flat = Sight::look(gentle, candidate(Kind::flat), 128);
  REQUIRE(flat);
  CHECK(worst_error(*flat, height, [](const Vec2&) { return Vec2::Zero(); }) < 0.02);
}
