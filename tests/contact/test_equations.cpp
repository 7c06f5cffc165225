#include <doctest/doctest.h>
#include <rapidcheck.h>

#include "contact/contact_point.h"

using namespace intaglio;

namespace {

Vec3 any_vector(int range) {
  return Vec3(*rc::gen::inRange(-range, range), *rc::gen::inRange(-range, range),
              *rc::gen::inRange(-range, range)) /
         100.0;
}

Vec3 any_direction() {
  Vec3 v = any_vector(1000);
  RC_PRE(v.norm() > 0.1);
  return v.normalized();
}

}  // namespace

TEST_CASE("Eq. 1.1: momentum gained is force times time, along n") {
  CHECK(rc::check("m dv = F dt n", [] {
    const Vec3 n = any_direction();
    const double force = *rc::gen::inRange(0, 100000) / 100.0;
    const double mass = *rc::gen::inRange(1, 100000) / 1000.0;
    const double dt = *rc::gen::inRange(1, 1000) / 10000.0;
    const Vec3 dv = contact::velocity_change(force, dt, mass, n);
    RC_ASSERT((mass * dv - force * dt * n).norm() <= 1e-12 * (1 + force));
    // Two half steps are one whole step.
    RC_ASSERT((contact::velocity_change(force, dt / 2, mass, n) * 2 - dv).norm() <= 1e-12 * (1 + dv.norm()));
  }));
}

TEST_CASE("Eq. 1.2: an impulse along n_s through q leaves the angular velocity unchanged") {
  CHECK(rc::check("no torque about the centre", [] {
    const Vec3 c = any_vector(1000);
    const Vec3 n_s = any_direction();
    const double r = *rc::gen::inRange(1, 1000) / 1000.0;
    const Vec3 q = contact::sphere_contact_point(c, r, n_s);
    const Vec3 torque = (q - c).cross(3.0 * n_s);
    RC_ASSERT(torque.norm() < 1e-12);
    RC_ASSERT(std::abs((q - c).norm() - r) < 1e-12);  // and q is on the sphere
  }));
}
