#include <doctest/doctest.h>
#include <rapidcheck.h>

#include <cmath>

#include "core/portable_math.h"
#include "surface/closest.h"
#include "surface/ray.h"
#include "tests/surface/brick_surface.h"

using namespace intaglio;
using namespace intaglio::surface;
using tests::brick_surface;
using tests::made_surface;

TEST_CASE("depth at a texel's centre is the texel's depth, and between texels it is within theirs") {
  const auto s = brick_surface(64);
  Random random(1);
  for (int k = 0; k < 2000; ++k) {
    const int i = int(random.uniform(0, 64));
    const int j = int(random.uniform(0, 64));
    CHECK(s->depth({(i + 0.5) / 64, (j + 0.5) / 64}) == doctest::Approx(-s->texel_z(i, j)).epsilon(1e-12));
    const Cell cell = s->cell(i, j);
    const Vec2 uv((cell.x0 + random.uniform() * cell.width()) / s->placement().size_u(),
                  (cell.y0 + random.uniform() * cell.height()) / s->placement().size_v());
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

TEST_CASE("clamp extends the border") {
  const auto s = made_surface(
      8, [](Vec2 uv) { return uv.x(); }, [](Vec2) { return Vec3::UnitZ(); }, 0.02, tests::flat_placement(),
      surface::Edge::clamp);
  CHECK(s->depth({-3, 0.5}) == doctest::Approx(0.02 * 0.5 / 8));
  CHECK(s->depth({4, 0.5}) == doctest::Approx(0.02 * 7.5 / 8));
}

TEST_CASE("the gradient is the derivative of minus the depth") {
  const auto s = brick_surface(64);
  Random random(2);
  const double h = 1e-6;
  for (int k = 0; k < 500; ++k) {
    // Inside a cell: at its border the patches' slopes differ.
    const Vec2 uv((std::floor(random.uniform(0, 64)) + random.uniform(0.55, 1.45)) / 64,
                  (std::floor(random.uniform(0, 64)) + random.uniform(0.55, 1.45)) / 64);
    const Vec2 numeric(-(s->depth(uv + Vec2(h, 0)) - s->depth(uv - Vec2(h, 0))) / (2 * h),
                       -(s->depth(uv + Vec2(0, h)) - s->depth(uv - Vec2(0, h))) / (2 * h));
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
      worst = std::max(
          worst, (s->texel_normal({(i + 0.5) / 256, (j + 0.5) / 256}) - Vec3(-dz_dx, -dz_dy, 1).normalized())
                     .norm());
    }
  }
  MESSAGE("largest difference: " << worst);
  CHECK(worst < 5e-4);
}

TEST_CASE("rotating the placement rotates the answers and changes nothing else") {
  const Quat turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, -0.5).normalized()) * Quat::Identity();
  const Placement flat = tests::flat_placement();
  const Placement turned(Vec3(3, -1, 2), turn, 1, 1);
  CHECK(rc::check("rotation", [&] {
    const Vec3 local(*rc::gen::inRange(-200, 1200) / 1000.0, *rc::gen::inRange(-200, 1200) / 1000.0,
                     *rc::gen::inRange(-100, 100) / 1000.0);
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
  const surface::Surface s(to_texels(images), tests::flat_placement(), 0.02, surface::Edge::wrap);
  CHECK(s.depth({0.5, 0.875}) == doctest::Approx(0.02));
  CHECK(s.depth({0.5, 0.125}) == doctest::Approx(0));
}

TEST_CASE("a 512 x 512 surface is at most 3 MiB, its colours aside") {
  const auto s = brick_surface(512);
  const std::size_t bytes = s->memory_bytes() - s->colour().data.size();
  MESSAGE("512 x 512 surface: " << bytes << " bytes");
  CHECK(bytes <= 3u << 20);
}

TEST_CASE("a sample at footprint 0 equals depth, normal and gradient") {
  for (const auto& s : tests::various_surfaces()) {
    Random random(30);
    for (int k = 0; k < 200; ++k) {
      const Vec2 uv(random.uniform(-1, 2), random.uniform(-1, 2));
      for (const double footprint : {0.0, 0.9 * std::min(s->texel_u(), s->texel_v()), -1.0, std::nan("")}) {
        const Sample sample = s->sample(uv, footprint);
        CHECK(sample.depth == s->depth(uv));
        CHECK(sample.normal == s->normal(uv));
        CHECK(sample.gradient == s->gradient(uv));
        CHECK(sample.roughness == 0);
      }
    }
  }
}

TEST_CASE(
    "at every footprint a sample is the derivative of itself, bounded, and continuous in the footprint") {
  for (const auto& s : tests::various_surfaces()) {
    Random random(31);
    for (int k = 0; k < 300; ++k) {
      const Vec2 uv(random.uniform(-0.5, 1.5), random.uniform(-0.5, 1.5));
      const double footprint = std::pow(10.0, random.uniform(-3, 1));
      const Sample sample = s->sample(uv, footprint), next = s->sample(uv, footprint * (1 + 1e-9));
      CHECK(std::abs(sample.depth - next.depth) < 1e-8);
      CHECK((sample.normal - next.normal).norm() < 1e-6);
      CHECK(std::abs(sample.roughness * sample.roughness - next.roughness * next.roughness) < 1e-6);
      CHECK(sample.normal.norm() == doctest::Approx(1));
      const Pyramid::Range range = s->pyramid().total_range();
      CHECK(sample.depth >= s->max_depth() * (range.shallow - 1e-5));
      CHECK(sample.depth <= s->max_depth() * (range.deep + 1e-5));
      const double h = 1e-7;
      const Vec2 metres(s->placement().size_u(), s->placement().size_v());
      const Vec2 numeric =
          -Vec2(s->sample(uv + Vec2(h, 0), footprint).depth - s->sample(uv - Vec2(h, 0), footprint).depth,
                s->sample(uv + Vec2(0, h), footprint).depth - s->sample(uv - Vec2(0, h), footprint).depth)
               .cwiseQuotient(2 * h * metres);
      // The chance that a patch's border lies within h of uv is one in ten thousand.
      CHECK((sample.gradient - numeric).norm() < 1e-5 * (1 + numeric.norm()));
    }
  }
}

TEST_CASE("the gradient of smooth() is the derivative of its height, and continuous across texels") {
  for (const auto& s : tests::various_surfaces()) {
    Random random(32);
    const Vec2 metres(s->placement().size_u(), s->placement().size_v());
    for (int k = 0; k < 300; ++k) {
      Vec2 uv(random.uniform(-0.5, 1.5), random.uniform(-0.5, 1.5));
      if (k % 2 == 0) uv.x() = (std::round(uv.x() * s->width()) + 0.5) / s->width();  // on a border of cells
      const double footprint = k % 3 == 0 ? 0.0 : std::pow(10.0, random.uniform(-3, 1));
      const auto height = [&](const Vec2& at) { return s->smooth(at, footprint).height; };
      const double h = 1e-5 / std::max(s->width(), s->height());
      const Vec2 numeric = Vec2(height(uv + Vec2(h, 0)) - height(uv - Vec2(h, 0)),
                                height(uv + Vec2(0, h)) - height(uv - Vec2(0, h)))
                               .cwiseQuotient(2 * h * metres);
      const surface::SmoothHeight here = s->smooth(uv, footprint);
      CHECK((here.gradient - numeric).norm() < 1e-4 * (1 + numeric.norm()));
      for (const Vec2& step : {Vec2(1e-9, 0), Vec2(-1e-9, 0), Vec2(0, 1e-9)}) {
        CHECK((s->smooth(uv + step, footprint).gradient - here.gradient).norm() <
              1e-5 * (1 + here.gradient.norm()));
      }
    }
  }
}

TEST_CASE("smooth() goes through the texels, and without a depth map it is the plane") {
  const auto s = tests::rough_surface(37, 53, surface::Edge::wrap);
  for (int j = 0; j < 53; ++j) {
    for (int i = 0; i < 37; ++i)
      CHECK(std::abs(s->smooth({(i + 0.5) / 37, (j + 0.5) / 53}).height - s->texel_z(i, j)) < 1e-12);
  }
  Texels texels;
  texels.width = texels.height = 2;
  texels.normal.assign(4, Vec3(0.6, 0, 0.8));
  const surface::Surface flat(std::move(texels), tests::flat_placement(), 0.02, surface::Edge::wrap);
  CHECK(flat.smooth({0.3, 0.4}, 0.1).height == 0);
  CHECK(flat.smooth({0.3, 0.4}, 0.1).gradient.norm() == 0);
  const Sample sample = flat.sample({0.3, 0.4}, 0.8);
  CHECK(sample.depth == 0);
  CHECK((sample.normal - Vec3(0.6, 0, 0.8)).norm() < 1e-4);
  CHECK(sample.roughness < 1e-3);
}

TEST_CASE("wrap is seamless at every footprint, and clamp extends the border") {
  for (const auto& s : tests::various_surfaces()) {
    Random random(33);
    for (int k = 0; k < 200; ++k) {
      const double footprint = std::pow(10.0, random.uniform(-3, 1));
      const Vec2 uv(random.uniform(), random.uniform());
      if (s->edge() == surface::Edge::wrap) {
        const Vec2 shifted = uv + Vec2(std::floor(random.uniform(-4, 4)), std::floor(random.uniform(-4, 4)));
        const Sample a = s->sample(uv, footprint), b = s->sample(shifted, footprint);
        CHECK(std::abs(a.depth - b.depth) < 1e-9);
        CHECK((a.normal - b.normal).norm() < 1e-6);
        CHECK(std::abs(a.roughness - b.roughness) < 1e-5);
        CHECK(std::abs(s->smooth(uv, footprint).height - s->smooth(shifted, footprint).height) < 1e-9);
        CHECK((s->smooth(uv, footprint).gradient - s->smooth(shifted, footprint).gradient).norm() < 1e-6);
      } else {
        const double v = uv.y();
        CHECK(s->sample({-7, v}, footprint).depth ==
              doctest::Approx(s->sample({-3, v}, footprint).depth).epsilon(1e-9));
        CHECK(s->sample({5, v}, footprint).normal == s->sample({9, v}, footprint).normal);
        CHECK(std::abs(s->smooth({5, v}, footprint).gradient.x()) < 1e-15);
      }
    }
  }
}

TEST_CASE("non-finite and huge arguments give finite results") {
  const double infinity = std::numeric_limits<double>::infinity();
  for (const auto& s : tests::various_surfaces()) {
    for (const double bad : {std::nan(""), infinity, -infinity, 1e6, -1e6, 1e300}) {
      for (const double footprint : {0.0, 0.05, infinity, std::nan("")}) {
        const Sample sample = s->sample({bad, 0.5}, footprint);
        CHECK((std::isfinite(sample.depth) && sample.normal.allFinite() && sample.gradient.allFinite() &&
               std::isfinite(sample.roughness)));
        const surface::SmoothHeight smooth = s->smooth({0.5, bad}, footprint);
        CHECK((std::isfinite(smooth.height) && smooth.gradient.allFinite()));
      }
    }
  }
}

TEST_CASE("memory grows linearly with the texels") {
  const auto bytes = [](int size) {
    const auto s = tests::rough_surface(size, size, surface::Edge::wrap);
    return double(s->memory_bytes() - sizeof *s - s->colour().data.size()) / size / size;
  };
  const double small = bytes(128), large = bytes(512);
  MESSAGE("bytes a texel: " << small << " at 128 x 128, " << large << " at 512 x 512");
  CHECK(large == doctest::Approx(small).epsilon(0.02));
}

TEST_CASE("queries agree however the placement is rotated") {
  const Quat turn(Eigen::AngleAxisd(1.1, Vec3(0.3, -1, 0.5).normalized()));
  const auto depth = [](Vec2 uv) { return 0.5 + 0.4 * std::sin(12 * uv.x()) * std::cos(9 * uv.y()); };
  const auto normal = [](Vec2) { return Vec3::UnitZ(); };
  const auto flat = made_surface(32, depth, normal);
  const auto turned = made_surface(32, depth, normal, 0.02, Placement(Vec3(3, -1, 2), turn, 1, 1));
  Random random(34);
  for (int k = 0; k < 500; ++k) {
    const Vec3 local(random.uniform(-0.1, 1.1), random.uniform(-0.1, 1.1), random.uniform(-0.02, 0.1));
    const Vec3 here = flat->placement().to_world(local), there = turn * here + Vec3(3, -1, 2);
    const auto a = closest_point(*flat, flat->placement().to_local(here)),
               b = closest_point(*turned, turned->placement().to_local(there));
    REQUIRE((a && b));
    CHECK(std::abs(a->distance - b->distance) < 1e-12);
    const Vec3 down =
        flat->placement().direction_to_world({random.uniform(-1, 1), random.uniform(-1, 1), -1});
    const auto hit_a =
        intersect(*flat, flat->placement().to_local(here), flat->placement().direction_to_local(down), 0, 10);
    const auto hit_b = intersect(*turned, turned->placement().to_local(there),
                                 turned->placement().direction_to_local(turn * down), 0, 10);
    if (hit_a && hit_b) CHECK(std::abs(hit_a->t - hit_b->t) < 1e-9);
  }
}
