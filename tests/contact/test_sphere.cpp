#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "contact/surface_contacts.h"
#include "core/portable_math.h"
#include "tests/surface/brick_surface.h"

using namespace intaglio;
using namespace intaglio::contact;

namespace {

struct Ball {
  Vec3 centre;
  double radius;

  Sphere shape() const { return {radius}; }
  Pose pose() const { return {centre, Quat::Identity()}; }
};

// A sphere that rests on the relief: lowered until its deepest contact just touches.
Ball resting(const surface::Surface& s, double x, double z, double radius) {
  double low = -0.05, high = 0.2;
  for (int k = 0; k < 50; ++k) {
    const double y = 0.5 * (low + high);
    const ContactSet set = relief_contacts(s, Sphere{radius}, {Vec3(x, y, z), Quat::Identity()}, 0);
    (set.count > 0 && set.points[0].distance < 0 ? low : high) = y;
  }
  return {Vec3(x, 0.5 * (low + high), z), radius};
}

}  // namespace

TEST_CASE("§1.3.1: directional contacts are the most negative height differences over the footprint") {
  const auto s = tests::brick_surface(64);
  Random random(31);
  for (int k = 0; k < 100; ++k) {
    const Ball sphere{Vec3(random.uniform(-0.4, 0.4), random.uniform(0.02, 0.04), random.uniform(-0.4, 0.4)),
                      0.04};
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
    const ContactSet set = directional_contacts(*s, sphere.shape(), sphere.pose(), 0);
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
  const Ball sphere{Vec3(0.1, 0.038, -0.2), 0.04};
  for (const auto method : {relief_contacts, normal_map_contacts, flat_contacts}) {
    const ContactSet set = method(*s, sphere.shape(), sphere.pose(), 0.001);
    REQUIRE(set.count >= 1);
    CHECK(set.points[0].distance == doctest::Approx(-0.002).epsilon(1e-6));
    CHECK((set.points[0].normal - Vec3::UnitY()).norm() < 1e-4);
  }
}

TEST_CASE("moving the sphere out along its contact normal by the penetration makes it just touch") {
  const auto s = tests::brick_surface(128);
  Random random(32);
  for (int k = 0; k < 200; ++k) {
    Ball sphere = resting(*s, random.uniform(-0.4, 0.4), random.uniform(-0.4, 0.4), 0.04);
    sphere.centre.y() -= 0.0005;
    const ContactSet set = relief_contacts(*s, sphere.shape(), sphere.pose(), 0);
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
    Ball sphere = resting(*s, -0.4 + 0.02 * k, 0.5 - 0.25, 0.04);
    sphere.centre.y() -= 0.0004;
    const ContactSet set = relief_contacts(*s, sphere.shape(), sphere.pose(), 0.002);
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

TEST_CASE("degenerate spheres get a status and no contact") {
  const auto s = tests::brick_surface(64);
  const Quat upright = Quat::Identity();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const auto method : {relief_contacts, directional_contacts, normal_map_contacts, flat_contacts}) {
    const auto asked = [&](const Vec3& centre, double radius, double margin = 0.001) {
      const ContactSet set = method(*s, Sphere{radius}, {centre, upright}, margin);
      for (const ContactPoint& c : set)
        CHECK((c.point.allFinite() && c.normal.allFinite() && std::isfinite(c.distance)));
      return set;
    };
    CHECK(asked({std::nan(""), 0, 0}, 0.04).status == status::bad_pose);
    CHECK(asked({0, infinity, 0}, 0.04).status == status::bad_pose);
    CHECK(asked({1e6, 0, 0}, 0.04).status == status::far);
    CHECK(asked({0, 1e6, 0}, 0.04).status == status::far);
    CHECK(asked({0.1, 0, 0.1}, 0).status == status::no_size);
    CHECK(asked({0.1, 0, 0.1}, std::nan("")).status == status::no_size);
    CHECK(asked({0.8, 0, 0.1}, 0.04).status == status::off_edge);
    CHECK(asked({0.1, 0.5, 0.1}, 0.04).status == status::ok);
    CHECK((asked({0.1, 0.02, 0.1}, 0.04, 1e9).status & status::wide_margin) != 0);
    CHECK((asked({0.1, 0.02, 0.1}, 0.04, std::nan("")).status & status::wide_margin) != 0);
    CHECK(asked({0.1, 0.5, 0.1}, 0.04).count == 0);
  }
}

TEST_CASE("a compound of spheres touches where its spheres do, each with its own feature") {
  const auto s = tests::brick_surface(128);
  Random random(33);
  for (int k = 0; k < 100; ++k) {
    const Vec3 arm(0.06, 0, 0);
    const Compound pair =
        make_compound({{Sphere{0.03}, {arm, Quat::Identity()}}, {Sphere{0.03}, {-arm, Quat::Identity()}}});
    const Pose pose{Vec3(random.uniform(-0.3, 0.3), 0.028, random.uniform(-0.3, 0.3)),
                    Quat(Eigen::AngleAxisd(random.uniform(0, 6), Vec3::UnitY()))};
    const ContactSet set = relief_contacts(*s, pair, pose, 0.002);
    double deepest = 1;
    for (const double side : {1.0, -1.0}) {
      const ContactSet one =
          relief_contacts(*s, Sphere{0.03}, {pose.to_world(side * arm), Quat::Identity()}, 0.002);
      if (one.count > 0) deepest = std::min(deepest, one.points[0].distance);
    }
    REQUIRE((set.count > 0) == (deepest < 1));
    if (set.count > 0) CHECK(set.points[0].distance == doctest::Approx(deepest).epsilon(1e-9));
    for (std::size_t a = 0; a < set.count; ++a) {
      for (std::size_t b = a + 1; b < set.count; ++b) CHECK(set.points[a].feature != set.points[b].feature);
    }
  }
}
