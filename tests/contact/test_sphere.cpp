#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "intaglio/contact/sphere.h"
#include "intaglio/core/random.h"
#include "tests/surface/brick_surface.h"

using namespace intaglio;
using namespace intaglio::contact;

namespace {

// A sphere that rests on the relief: lowered until its deepest contact just touches.
Sphere resting(const surface::Surface& s, double x, double z, double radius) {
  double low = -0.05, high = 0.2;
  for (int k = 0; k < 50; ++k) {
    const double y = 0.5 * (low + high);
    const ContactSet set = relief_contacts(s, {Vec3(x, y, z), radius}, 0);
    (set.count > 0 && set.points[0].distance < 0 ? low : high) = y;
  }
  return {Vec3(x, 0.5 * (low + high), z), radius};
}

}  // namespace

TEST_CASE("§1.3.1: directional contacts are the most negative height differences over the footprint") {
  const auto s = tests::brick_surface(64);
  Random random(31);
  for (int k = 0; k < 100; ++k) {
    const Sphere sphere{
        Vec3(random.uniform(-0.4, 0.4), random.uniform(0.02, 0.04), random.uniform(-0.4, 0.4)), 0.04};
    const Vec3 local = s->placement().to_local(sphere.centre);
    double deepest = 1;
    for (int j = 0; j < 64; ++j) {
      for (int i = 0; i < 64; ++i) {
        const double x = (i + 0.5) / 64 - local.x();
        const double y = (j + 0.5) / 64 - local.y();
        if (x * x + y * y < 0.04 * 0.04)
          deepest = std::min(deepest, local.z() - std::sqrt(0.04 * 0.04 - x * x - y * y) - s->texel_z(i, j));
      }
    }
    const ContactSet set = directional_contacts(*s, sphere, 0);
    if (deepest > 0) {
      CHECK(set.count == 0);
    } else {
      REQUIRE(set.count > 0);
      CHECK(set.points[0].distance == doctest::Approx(deepest).epsilon(1e-9));
    }
  }
}

TEST_CASE("on a flat relief every method finds the plane's contact") {
  const auto s = tests::made_surface(
      64, [](Vec2) { return 0.0; }, [](Vec2) { return Vec3::UnitZ(); });
  const Sphere sphere{Vec3(0.1, 0.038, -0.2), 0.04};
  for (const auto method : {relief_contacts, normal_map_contacts, flat_contacts}) {
    const ContactSet set = method(*s, sphere, 0.001);
    REQUIRE(set.count >= 1);
    CHECK(set.points[0].distance == doctest::Approx(-0.002).epsilon(1e-6));
    CHECK((set.points[0].normal - Vec3::UnitY()).norm() < 1e-4);
  }
}

TEST_CASE("moving the sphere out along its contact normal by the penetration makes it just touch") {
  const auto s = tests::brick_surface(128);
  Random random(32);
  for (int k = 0; k < 200; ++k) {
    Sphere sphere = resting(*s, random.uniform(-0.4, 0.4), random.uniform(-0.4, 0.4), 0.04);
    sphere.centre.y() -= 0.0005;
    const ContactSet set = relief_contacts(*s, sphere, 0);
    REQUIRE(set.count > 0);
    const ContactPoint& deepest = set.points[0];
    CHECK(deepest.distance < 0);
    CHECK((sphere.centre - deepest.point).norm() ==
          doctest::Approx(sphere.radius + deepest.distance).epsilon(1e-9));
    CHECK(deepest.normal.dot((sphere.centre - deepest.point).normalized()) == doctest::Approx(1));
  }
}

TEST_CASE("a ball in the mortar between two bricks is held from both sides") {
  const auto s = tests::brick_surface(256);
  int held = 0;
  for (int k = 0; k < 40; ++k) {
    // Along the bed joints (v = 1/8, 2/8, ...), which run along X.
    Sphere sphere = resting(*s, -0.4 + 0.02 * k, 0.5 - 0.25, 0.04);
    sphere.centre.y() -= 0.0004;
    const ContactSet set = relief_contacts(*s, sphere, 0.002);
    bool towards = false, away = false;
    for (const ContactPoint& contact : set) {
      towards = towards || contact.normal.z() > 0.2;
      away = away || contact.normal.z() < -0.2;
    }
    held += towards && away ? 1 : 0;
  }
  MESSAGE("held from both sides at " << held << " of 40 places of a bed joint");
  CHECK(held >= 20);
}

TEST_CASE("degenerate spheres are answered with nothing, not with nonsense") {
  const auto s = tests::brick_surface(64);
  for (const auto method : {relief_contacts, directional_contacts, normal_map_contacts, flat_contacts}) {
    CHECK(method(*s, {Vec3(std::nan(""), 0, 0), 0.04}, 0.001).count == 0);
    CHECK(method(*s, {Vec3(0, std::numeric_limits<double>::infinity(), 0), 0.04}, 0.001).count == 0);
    CHECK(method(*s, {Vec3(1e6, 0, 0), 0.04}, 0.001).count == 0);
    CHECK(method(*s, {Vec3(0, 1e6, 0), 0.04}, 0.001).count == 0);
    for (const ContactPoint& contact : method(*s, {Vec3(0.1, 0, 0.1), 0}, 0.001))
      CHECK(contact.point.allFinite());
  }
}
