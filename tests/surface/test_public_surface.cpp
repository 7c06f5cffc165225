// intaglio::Surface, as users have it, against what it is made of.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "intaglio/surface.h"

using namespace intaglio;

namespace {

// A plane of slopes (0.02, -0.05), 8 x 4 texels over 2 x 3 m.
constexpr int plane_columns = 8, plane_rows = 4;
const Vec2 plane_size(2, 3), plane_slope(0.02, -0.05);

std::vector<float> plane() {
  std::vector<float> heights;
  for (int j = 0; j < plane_rows; ++j)
    for (int i = 0; i < plane_columns; ++i)
      heights.push_back(float(plane_slope.x() * plane_size.x() * (i + 0.5) / plane_columns +
                              plane_slope.y() * plane_size.y() * (j + 0.5) / plane_rows));
  return heights;
}

}  // namespace

TEST_CASE(
    "a surface from heights has these heights below the highest, and their slopes up to a border that is clamped") {
  const std::vector<float> heights = plane();
  const auto surface = intaglio::Surface::from_heights(plane_columns, plane_rows, heights,
                                                       {.size = plane_size, .edge = intaglio::Edge::clamp});
  REQUIRE(surface);
  const double top = double(heights[plane_columns - 1]);
  CHECK(surface->depth() == doctest::Approx(top - double(heights[(plane_rows - 1) * plane_columns])));
  for (int j = 0; j < plane_rows; ++j) {
    for (int i = 0; i < plane_columns; ++i) {
      const Vec2 uv((i + 0.5) / plane_columns, (j + 0.5) / plane_rows);
      CHECK(surface->height(uv) ==
            doctest::Approx(double(heights[std::size_t(j * plane_columns + i)]) - top).epsilon(1e-5));
      const Vec3 n = surface->normal(uv);  // u is +X, v is -Z
      CHECK(-n.x() / n.y() == doctest::Approx(plane_slope.x()).epsilon(1e-3));
      CHECK(n.z() / n.y() == doctest::Approx(plane_slope.y()).epsilon(1e-3));
    }
  }
}

TEST_CASE("rays, closest points and points agree on where a placed surface is") {
  const Pose pose{Vec3(1, 2, 3), rotation(0.7, Vec3(1, 2, -1).normalized())};
  const auto surface = intaglio::Surface::from_heights(
      plane_columns, plane_rows, plane(), {.size = plane_size, .pose = pose, .edge = intaglio::Edge::clamp});
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
  const auto bricks = intaglio::Surface::load("brick", {.size = {4, 4}, .depth = 0.08, .generated_size = 64});
  REQUIRE(bricks);
  CHECK(bricks->material().name == "brick");
  CHECK(bricks->depth() == doctest::Approx(0.08));
  CHECK(bricks->texels_u() == 64);
}

TEST_CASE("what cannot be a surface is an error that says why") {
  const std::vector<float> heights = plane();
  CHECK_FALSE(intaglio::Surface::from_heights(plane_columns + 1, plane_rows, heights));
  CHECK_FALSE(intaglio::Surface::from_heights(plane_columns, plane_rows, heights, {.size = {0, 1}}));
  CHECK_FALSE(intaglio::Surface::load("brick", {.depth = -1.0}));
  for (const int size : {-1, 0, 5, 63, 8193}) {
    CAPTURE(size);
    const auto refused = intaglio::Surface::load("brick", {.generated_size = size});
    REQUIRE_FALSE(refused);
    CHECK(refused.error().message() == "SurfaceOptions::generated_size: a generated texture cannot have " +
                                           std::to_string(size) + " texels a side; 64 to 8192 are possible");
  }
  const auto missing = intaglio::Surface::load("no such texture");
  REQUIRE_FALSE(missing);
  CHECK(missing.error().message().find("no such texture") != std::string::npos);
}

TEST_CASE(
    "each name of the list loads; \"brick\" is another name of one of them; a misspelt one is answered") {
  const auto names = intaglio::builtin_textures();
  for (const std::string& name : names) CHECK(intaglio::Surface::load(name, {.generated_size = 64}));
  CHECK(std::count(names.begin(), names.end(), "brick_running") == 1);
  CHECK(std::count(names.begin(), names.end(), "brick") == 0);
  const auto alias = intaglio::Surface::load("brick", {.generated_size = 64}),
             named = intaglio::Surface::load("brick_running", {.generated_size = 64});
  REQUIRE(alias);
  REQUIRE(named);
  CHECK(alias->height({0.3, 0.4}) == named->height({0.3, 0.4}));
  CHECK(alias->import_report().empty());
  const auto misspelt = intaglio::Surface::load("bricks");
  REQUIRE_FALSE(misspelt);
  CHECK(misspelt.error().message().starts_with(
      "no built-in texture is called \"bricks\"; did you mean \"brick\"? known: "));
}
