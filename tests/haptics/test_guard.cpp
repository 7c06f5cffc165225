#include <doctest/doctest.h>
#include <rapidcheck.h>

#include <cmath>
#include <limits>
#include <type_traits>

#include "intaglio/haptics/guard.h"

using namespace intaglio;
using namespace intaglio::haptics;

static_assert(!std::is_constructible_v<GuardedForce, Vec3>, "only a Guard makes a force that a device takes");
static_assert(!std::is_default_constructible_v<GuardedForce>);

TEST_CASE("whatever is asked for, the device gets a finite force within the peak and the slew rate") {
  CHECK(rc::check("limits", [] {
    Guard guard{{}};
    Vec3 last = Vec3::Zero();
    for (int k = 0; k < 1200; ++k) {
      const double size = *rc::gen::elementOf(std::vector<double>{0, 1e-3, 1, 5, 7.9, 8, 1e3, 1e12, 1e300});
      const Vec3 wanted =
          size * Vec3(*rc::gen::inRange(-10, 10), *rc::gen::inRange(-10, 10), *rc::gen::inRange(-10, 10)) /
          10.0;
      const Vec3 force = guard.pass(wanted, 0.001).newtons();
      RC_ASSERT(force.allFinite());
      RC_ASSERT(force.norm() <= 7.9 * (1 + 1e-12));
      RC_ASSERT((force - last).norm() <= 8.0 * (1 + 1e-9));
      last = force;
    }
  }));
}

TEST_CASE("the ramp-in takes half a second") {
  Guard guard{{}};
  double force = 0;
  for (int k = 0; k < 250; ++k) force = guard.pass({0, 2, 0}, 0.001).newtons().y();
  CHECK(force == doctest::Approx(1).epsilon(0.01));
  for (int k = 0; k < 260; ++k) force = guard.pass({0, 2, 0}, 0.001).newtons().y();
  CHECK(force == doctest::Approx(2));
  CHECK(guard.status() == 0);
}

TEST_CASE("not-a-number gives zero and latches until rearmed") {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Guard guard{{}};
    for (int k = 0; k < 600; ++k) guard.pass({0, 2, 0}, 0.001);
    CHECK(guard.pass({0, bad, 0}, 0.001).newtons().norm() == 0);
    CHECK(guard.pass({0, 2, 0}, 0.001).newtons().norm() == 0);
    CHECK((guard.status() & guard_status::fault) != 0);
    guard.rearm();
    for (int k = 0; k < 600; ++k) guard.pass({0, 2, 0}, 0.001);
    CHECK(guard.pass({0, 2, 0}, 0.001).newtons().y() == doctest::Approx(2));
  }
}
