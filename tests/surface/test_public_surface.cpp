// intaglio::Surface, as users have it, against what it is made of.
#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "intaglio/surface.h"

using namespace intaglio;

namespace {

// A plane of slopes (0.02, -0.05), 8 x 4 texels over 2 x 3 m.
constexpr int width = 8, height = 4;
const Vec2 size(2, 3), slope(0.02, -0.05);

std::vector<float> plane() {
  std::vector<float> heights;
  for (int j = 0; j < height; ++j)
    for (int i = 0; i < width; ++i)
      heights.push_back(float(slope.x() * size.x() * (i + 0.5) / width + slope.y() * size.y() * (j + 0.5) / height));
  return heights;
}

}  // namespace

TEST_CASE("a surface from heights has these heights below the highest, and their slopes up to a border that is clamped") {
  const std::vector<float> heights = plane();
  const auto surface = Surface::from_heights(width, height, heights, {.size = size, .edge = Edge::clamp});
  REQUIRE(surface);
  const double top = double(heights[width - 1]);
  CHECK(surface->depth() == doctest::Approx(top - double(heights[(height - 1) * width])));
  for (int j = 0; j < height; ++j) {
    for (int i = 0; i < width; ++i) {
      const Vec2 uv((i + 0.5) / width, (j + 0.5) / height);
      CHECK(surface->height(uv) == doctest::Approx(double(heights[std::size_t(j * width + i)]) - top).epsilon(1e-5));
      const Vec3 n = surface->normal(uv);  // u is +X, v is -Z
      CHECK(-n.x() / n.y() == doctest::Approx(slope.x()).epsilon(1e-3));
      CHECK(n.z() / n.y() == doctest::Approx(slope.y()).epsilon(1e-3));
    }
  }
}

TEST_CASE("rays, closest points and points agree on where a placed surface is") {
  const Pose pose{Vec3(1, 2, 3), rotation(0.7, Vec3(1, 2, -1).normalized())};
  const auto surface = Surface::from_heights(width, height, plane(), {.size = size, .pose = pose, .edge = Edge::clamp});
  REQUIRE(surface);
  const Vec2 uv(0.4, 0.6);
  const Vec3 on = surface->point(uv), up = pose.orientation * Vec3::UnitY();
  CHECK((surface->uv(on) - uv).norm() < 1e-12);
  CHECK(surface->covers(on));
  const auto hit = surface->ray(on + 0.5 * up, -up);
  REQUIRE(hit);
  CHECK((hit->point - on).norm() < 1e-9);
  CHECK(hit->t == doctest::Approx(0.5));
  const auto near = surface->closest(on + 0.01 * hit->normal);
  REQUIRE(near);
  CHECK(near->distance == doctest::Approx(0.01).epsilon(1e-6));
  CHECK(near->normal.dot(hit->normal) == doctest::Approx(1));
  CHECK(surface->closest(on - 0.001 * hit->normal)->distance < 0);
}

TEST_CASE("a built-in texture brings its material and has the depth that is asked for") {
  const auto bricks = Surface::load("brick", {.size = {4, 4}, .depth = 0.08, .generated_size = 64});
  REQUIRE(bricks);
  CHECK(bricks->material().name == "brick");
  CHECK(bricks->depth() == doctest::Approx(0.08));
  CHECK(bricks->texels_u() == 64);
}

TEST_CASE("what cannot be a surface is an error that says why") {
  const std::vector<float> heights = plane();
  CHECK_FALSE(Surface::from_heights(width + 1, height, heights));
  CHECK_FALSE(Surface::from_heights(width, height, heights, {.size = {0, 1}}));
  CHECK_FALSE(Surface::load("brick", {.depth = -1.0}));
  const auto missing = Surface::load("no such texture");
  REQUIRE_FALSE(missing);
  CHECK(missing.error().message().find("no such texture") != std::string::npos);
}
