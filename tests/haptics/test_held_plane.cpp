#include <doctest/doctest.h>
#include <rapidcheck.h>

#include "haptics/held_plane.h"
#include "haptics/servo.h"
#include "intaglio/representation.h"
#include "tests/surface/brick_surface.h"

using namespace intaglio;
using namespace intaglio::haptics;

namespace {

Vec3 any_vector() {
  return Vec3(*rc::gen::inRange(-1000, 1000), *rc::gen::inRange(-1000, 1000),
              *rc::gen::inRange(-1000, 1000)) /
         100.0;
}

Vec3 any_direction() {
  Vec3 v = any_vector();
  RC_PRE(v.norm() > 0.1);
  return v.normalized();
}

}  // namespace

TEST_CASE("Eq. 1.3: the plane passes through p with normal n_s") {
  CHECK(rc::check("through p, normal n_s", [] {
    const Vec3 p = any_vector();
    const Vec3 n_s = any_direction();
    const Plane plane = tangent_plane(p, n_s);
    RC_ASSERT(std::abs(plane.distance(p)) < 1e-12);
    RC_ASSERT((plane.normal - n_s).norm() == 0);
    // Moving within the plane keeps the distance; moving along n_s changes it by as much.
    const Vec3 within = n_s.cross(any_vector());
    RC_ASSERT(std::abs(plane.distance(p + within)) < 1e-9);
    RC_ASSERT(std::abs(plane.distance(p + 0.25 * n_s) - 0.25) < 1e-9);
  }));
}

TEST_CASE("the plane's force pushes along n_s and never pulls") {
  CHECK(rc::check("one-sided", [] {
    const Plane plane = tangent_plane(any_vector(), any_direction());
    const Vec3 x = any_vector();
    const Vec3 force = plane_force(plane, {600, 1}, x, any_vector());
    RC_ASSERT(force.dot(plane.normal) >= 0);
    RC_ASSERT(force.cross(plane.normal).norm() <= 1e-9 * (1 + force.norm()));
    if (plane.distance(x) >= 0) RC_ASSERT(force.norm() == 0);
  }));
}

TEST_CASE("§1.3.2: in relief the tip collides only below the depth map") {
  const auto s = tests::brick_surface(128);
  CHECK(rc::check("depth test", [&] {
    const Vec3 tip(*rc::gen::inRange(0, 1000) / 1000.0, *rc::gen::inRange(0, 1000) / 1000.0,
                   *rc::gen::inRange(-30, 10) / 1000.0);
    const DepthTest relief = depth_test(*s, Representation::relief, tip);
    RC_ASSERT(relief.collides == (tip.z() < -s->depth({tip.x(), tip.y()})));
    RC_ASSERT(std::abs(relief.projected.z() + s->depth({tip.x(), tip.y()})) < 1e-12);
    RC_ASSERT(depth_test(*s, Representation::normal, tip).collides == (tip.z() < 0));
  }));
  CHECK_FALSE(depth_test(*s, Representation::relief, {1.2, 0.5, -1}).collides);
}
