// The truth of pictures: closed forms of depth and normals, equality with itself, the order of methods.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "evaluate/picture_truth.h"
#include "render/egl_context.h"
#include "tests/skipped.h"

using namespace intaglio;
using namespace intaglio::evaluate;

namespace {

const surface::Placement square(Vec3::Zero(), Quat::Identity(), 1, 1);

// Everywhere at that fraction of a depth of 0.1 m.
Reference plane(float fraction) {
  surface::Texels texels;
  texels.width = texels.height = 4;
  texels.depth.assign(16, fraction);
  texels.normal.assign(16, Vec3::UnitZ());
  return {surface::Surface(std::move(texels), square, 0.1, surface::Edge::wrap), 64};
}

// Pictures of 256 pixels, a reference of 512 points a side. Null without EGL.
struct Brick {
  Subject subject;
  PictureReference reference;
};
const Brick* brick() {
  static const auto made = []() -> std::unique_ptr<Brick> {
    if (const auto context = render::EglContext::create(); !context) {
      tests::skipped(context.error().message());
      return nullptr;
    }
    SubjectOptions options;
    options.grid = 512;
    auto subject = Subject::make(options);
    REQUIRE_MESSAGE(subject, subject.error().message());
    auto reference = PictureReference::make(*subject, 256);
    REQUIRE_MESSAGE(reference, reference.error().message());
    return std::make_unique<Brick>(Brick{std::move(*subject), std::move(*reference)});
  }();
  return made.get();
}

Candidate kind(Kind which) {
  return candidates()[std::size_t(which)];
}

Sight seen(const Brick& brick, Kind which, int pixels) {
  auto sight = Sight::look(brick.subject, kind(which), pixels);
  REQUIRE_MESSAGE(sight, sight.error().message());
  return std::move(*sight);
}

PictureTruth measured(const Brick& brick, Kind which, const Sight& sight) {
  const auto truth = measure_picture(brick.subject, kind(which), sight, brick.reference);
  REQUIRE_MESSAGE(truth, truth.error().message());
  return *truth;
}

}  // namespace

TEST_CASE("depths of a flat reference are those of the plane, where its rectangle is hit") {
  render::Camera camera;
  camera.eye = {0.3, 0.5, 1.1};
  camera.target = {0.1, -0.02, 0};
  camera.fov_y_degrees = 50;
  for (const float fraction : {0.0f, 0.37f, 1.0f}) {
    const double level = -0.1 * double(fraction);
    const Reference reference = plane(fraction);
    for (const int supersample : {1, 2, 3}) {
      const DepthGrid grid{.width = 120, .height = 70, .supersample = supersample, .stride = 7};
      const std::vector<double> depths = reference_depths(reference, square, camera, grid);
      REQUIRE(int(depths.size()) == grid.columns() * grid.rows());
      const render::CameraBasis basis = render::basis_of(camera);
      const double half = std::tan(25 * std::numbers::pi / 180);
      int hits = 0;
      for (int row = 0; row < grid.rows(); ++row) {
        for (int column = 0; column < grid.columns(); ++column) {
          // The middle sample of an odd number; of two, that above and right of the centre.
          const double off = supersample % 2 == 1 ? 0 : 0.5 / supersample;
          const double x = double(grid.pixel(column, row) % 120) + 0.5 + off;
          const double y = double(grid.pixel(column, row) / 120) + 0.5 - off;
          const Vec3 ray =
              -basis.back + (x / 60 - 1) * half * 120 / 70 * basis.right + (1 - y / 35) * half * basis.up;
          const double t = (level - camera.eye.y()) / ray.y();
          const Vec3 hit = camera.eye + t * ray;
          const double depth = depths[std::size_t(row * grid.columns() + column)];
          const double out = t > 0 ? std::max(std::abs(hit.x()), std::abs(hit.z())) : 1;
          if (out > 0.5) CHECK_FALSE(std::isfinite(depth));
          if (out > 0.45) continue;  // the rim is an edge
          CHECK(depth == doctest::Approx(t).epsilon(1e-7));
          ++hits;
        }
      }
      CHECK(hits > 20);
    }
  }
}

TEST_CASE("a picture compared with itself differs in nothing") {
  const Brick* made = brick();
  if (!made) return;
  const auto same = made->reference.compare(made->reference.pictures());
  REQUIRE(same);
  CHECK(same->flip == 0);
  CHECK(same->silhouette == 0);
  // Rasterised against brute force: the mesh's interpolation, and edges that one of the two sees past.
  MESSAGE("rasterised against brute force: " << same->depth_mm << " mm");
  CHECK(same->depth_mm < 0.2);
}

TEST_CASE("a flat floor's normals are off by the mean angle of the reference's") {
  const Brick* made = brick();
  if (!made) return;
  const Reference& reference = made->subject.reference();
  const Sight sight = seen(*made, Kind::flat, 64);
  constexpr int points = 301;
  const double width = 2.0 / 512, steepest = std::sqrt(3.0);
  double sum = 0;
  for (int j = 0; j < points; ++j) {
    for (int i = 0; i < points; ++i) {
      Vec2 mean = Vec2::Zero();
      for (int k = 0; k < 16; ++k) {
        const Vec2 in_square = Vec2(k % 4 - 1.5, k / 4 - 1.5) * width / 4;
        const Vec2 slope = reference.slope(Vec2(i + 0.5, j + 0.5) / points + in_square);
        mean += slope.cwiseMax(-steepest).cwiseMin(steepest) / 16;
      }
      sum += std::atan(mean.norm());
    }
  }
  const double expected = sum / (points * points) * 180 / std::numbers::pi;
  CHECK(expected > 5);
  CHECK(normal_angle(reference, sight) == doctest::Approx(expected).epsilon(0.02));
}

TEST_CASE(
    "our relief is nearer to the truth than the paper's march, both than a normal map, a fine mesh than a coarse") {
  const Brick* made = brick();
  if (!made) return;
  const Sight blind = seen(*made, Kind::flat, 64), sight = seen(*made, Kind::normal, 512);
  const PictureTruth flat = measured(*made, Kind::flat, blind), normal = measured(*made, Kind::normal, sight),
                     papers = measured(*made, Kind::relief_paper, sight),
                     ours = measured(*made, Kind::relief, sight),
                     coarse = measured(*made, Kind::mesh_256, sight),
                     fine = measured(*made, Kind::mesh_512, sight);
  CHECK(ours.depth_mm <= papers.depth_mm);
  CHECK(papers.depth_mm < normal.depth_mm);
  CHECK(normal.depth_mm == doctest::Approx(flat.depth_mm).epsilon(1e-6));
  CHECK(fine.depth_mm < coarse.depth_mm);
  CHECK(ours.flip < normal.flip);
  CHECK(normal.flip < flat.flip);
  CHECK(fine.flip < coarse.flip);
  CHECK(normal.normal_angle < flat.normal_angle / 3);
  CHECK(ours.silhouette < flat.silhouette);
  CHECK(fine.device_bytes > coarse.device_bytes);
  CHECK(coarse.device_bytes > ours.device_bytes);
}

TEST_CASE("pictures too small to compare are an error that says so") {
  const Brick* made = brick();
  if (!made) return;
  const auto small = PictureReference::make(made->subject, 63);
  REQUIRE_FALSE(small);
  CHECK(small.error().message().find("at least 64") != std::string::npos);
}
