#include <doctest/doctest.h>
#include <rapidcheck.h>

#include <cmath>

#include "intaglio/core/random.h"
#include "tests/surface/brick_surface.h"

using namespace intaglio;
using namespace intaglio::surface;
using tests::brick_surface;
using tests::made_surface;

TEST_CASE("depth at a texel's centre is the texel's depth, and between texels it is within theirs") {
  const auto s = brick_surface(64);
  Random random(1);
  for (int k = 0; k < 2000; ++k) {
    const int i = static_cast<int>(random.uniform(0, 64));
    const int j = static_cast<int>(random.uniform(0, 64));
    CHECK(s->depth({(i + 0.5) / 64, (j + 0.5) / 64}) == doctest::Approx(-s->texel_z(i, j)).epsilon(1e-12));
    const Cell cell = s->cell(i, j);
    const Vec2 uv((cell.x0 + random.uniform() * cell.width()) / s->placement().size_u(), (cell.y0 + random.uniform() * cell.height()) / s->placement().size_v());
    CHECK(-s->depth(uv) <= cell.max_z() + 1e-12);
    CHECK(-s->depth(uv) >= cell.min_z() - 1e-12);
  }
}

TEST_CASE("wrap is seamless: depth, normal and gradient repeat with period 1") {
  const auto s = brick_surface(64);
  CHECK(rc::check("periodic", [&] {
    const Vec2 uv(*rc::gen::inRange(0, 10000) / 10000.0, *rc::gen::inRange(0, 10000) / 10000.0);
    const Vec2 shifted = uv + Vec2(*rc::gen::inRange(-5, 5), *rc::gen::inRange(-5, 5));
    RC_ASSERT(std::abs(s->depth(uv) - s->depth(shifted)) < 1e-9);
    RC_ASSERT((s->normal(uv) - s->normal(shifted)).norm() < 1e-6);
    RC_ASSERT((s->gradient(uv) - s->gradient(shifted)).norm() < 1e-6);
  }));
}

TEST_CASE("clamp goes on with the border") {
  const auto s = made_surface(8, [](Vec2 uv) { return uv.x(); }, [](Vec2) { return Vec3::UnitZ(); }, 0.02, tests::flat_placement(), Edge::clamp);
  CHECK(s->depth({-3, 0.5}) == doctest::Approx(0.02 * 0.5 / 8));
  CHECK(s->depth({4, 0.5}) == doctest::Approx(0.02 * 7.5 / 8));
}

TEST_CASE("the gradient is the derivative of minus the depth") {
  const auto s = brick_surface(64);
  Random random(2);
  const double h = 1e-6;
  for (int k = 0; k < 500; ++k) {
    // Inside a cell: at its border the patches' slopes differ.
    const Vec2 uv((std::floor(random.uniform(0, 64)) + random.uniform(0.55, 1.45)) / 64, (std::floor(random.uniform(0, 64)) + random.uniform(0.55, 1.45)) / 64);
    const Vec2 numeric(-(s->depth(uv + Vec2(h, 0)) - s->depth(uv - Vec2(h, 0))) / (2 * h), -(s->depth(uv + Vec2(0, h)) - s->depth(uv - Vec2(0, h))) / (2 * h));
    CHECK((s->gradient(uv) - numeric).norm() < 1e-4 * (1 + numeric.norm()));
  }
}

TEST_CASE("the brick's normals are those of its depth: central differences, to 16 bits") {
  const auto s = brick_surface(256);
  double worst = 0;
  for (int j = 0; j < 256; ++j) {
    for (int i = 0; i < 256; ++i) {
      const double dz_dx = (s->texel_z(i + 1, j) - s->texel_z(i - 1, j)) / (2 * s->texel_u());
      const double dz_dy = (s->texel_z(i, j + 1) - s->texel_z(i, j - 1)) / (2 * s->texel_v());
      worst = std::max(worst, (s->texel_normal({(i + 0.5) / 256, (j + 0.5) / 256}) - Vec3(-dz_dx, -dz_dy, 1).normalized()).norm());
    }
  }
  MESSAGE("largest difference: " << worst);
  CHECK(worst < 5e-4);
}

TEST_CASE("turning the placement turns the answers and changes nothing else") {
  const Quat turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, -0.5).normalized()) * Quat::Identity();
  const Placement flat = tests::flat_placement();
  const Placement turned(Vec3(3, -1, 2), turn, 1, 1);
  CHECK(rc::check("rotation", [&] {
    const Vec3 local(*rc::gen::inRange(-200, 1200) / 1000.0, *rc::gen::inRange(-200, 1200) / 1000.0, *rc::gen::inRange(-100, 100) / 1000.0);
    RC_ASSERT((turned.to_local(turned.to_world(local)) - local).norm() < 1e-12);
    const Vec3 world = flat.to_world(local);
    RC_ASSERT((turn * world + Vec3(3, -1, 2) - turned.to_world(local)).norm() < 1e-12);
  }));
}

TEST_CASE("v goes up the image: the first row of a file is at v = 1") {
  TextureImages images{Image16(4, 4, 4), Image8(4, 4, 3)};
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 4; ++x) {
      images.relief.at(x, y, 0) = images.relief.at(x, y, 1) = 32768;
      images.relief.at(x, y, 2) = 65535;
      images.relief.at(x, y, 3) = y == 0 ? 65535 : 0;  // only the top row is deep
    }
  }
  const Surface s(to_texels(images), tests::flat_placement(), 0.02, Edge::wrap);
  CHECK(s.depth({0.5, 0.875}) == doctest::Approx(0.02));
  CHECK(s.depth({0.5, 0.125}) == doctest::Approx(0));
}

TEST_CASE("a 512 x 512 surface is at most 3 MiB, its colours aside") {
  const auto s = brick_surface(512);
  const std::size_t bytes = s->memory_bytes() - s->colour().data.size();
  MESSAGE("512 x 512 surface: " << bytes << " bytes");
  CHECK(bytes <= 3u << 20);
}
