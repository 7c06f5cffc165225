#include <doctest/doctest.h>
#include <rapidcheck.h>

#include <cmath>
#include <functional>
#include <limits>
#include <type_traits>

#include "core/portable_math.h"
#include "haptics/guard.h"
#include "tests/surface/brick_surface.h"

using namespace intaglio;
using namespace intaglio::haptics;

static_assert(!std::is_constructible_v<GuardedForce, Vec3>, "only a Guard makes a force that a device takes");
static_assert(!std::is_default_constructible_v<GuardedForce>);

TEST_CASE("for any requested force the device gets a finite one within the peak and the slew rate") {
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

namespace {

// A tick of a healthy loop at rest.
GuardInput healthy(double time, const Vec3& force = {0, 2, 0}) {
  GuardInput input;
  input.wanted.force = force;
  input.time = input.scene_time = input.link_time = time;
  return input;
}

// A number that servo code sometimes gets wrong.
double nasty(Random& random, double usual) {
  switch (random.next() % 100000) {
    case 0:
      return std::numeric_limits<double>::quiet_NaN();
    case 1:
      return std::numeric_limits<double>::infinity();
    case 2:
      return -1e308;
    case 3:
      return 1e300 * random.normal();
    default:
      return usual;
  }
}

Vec3 nasty(Random& random, const Vec3& usual) {
  return {nasty(random, usual.x()), nasty(random, usual.y()), nasty(random, usual.z())};
}

}  // namespace

TEST_CASE(
    "adversarial ticks stay within the limits, and exceed the slew rate only to drop to zero on a fault") {
  const int ticks = tests::poses(1000000, 10000000);
  GuardLimits limits;
  limits.peak_torque = 0.5;
  limits.continuous_torque = 0.2;
  Guard guard(limits);
  Random random(11);
  Vec3 force = Vec3::Zero(), torque = Vec3::Zero(), tip = Vec3::Zero();
  double time = 0;
  bool bad_number = false, over_peak = false, over_slew = false, over_torque = false, too_warm = false;
  int faults = 0, strong = 0;
  for (int k = 0; k < ticks; ++k) {
    if (random.next() % 300 == 0 && (guard.status() & guard_status::fault) != 0)
      guard.rearm(), force.setZero(), torque.setZero();
    const double dt = random.next() % 40000 == 0 ? 0.05 : random.next() % 30000 == 0 ? 0.0 : 0.001;
    time += dt;
    GuardInput input = healthy(nasty(random, time));
    if (!std::isfinite(input.time)) input.time = time;
    // A normal 80 degrees off, stiff springs, a jump of the tip; the request changes every tick.
    const double press = random.uniform(0, 40);
    input.wanted.force = nasty(random, Vec3(press * 5.67, press, random.normal()));
    if (random.next() % 3 == 0) input.wanted.force = -input.wanted.force;
    input.wanted.torque = nasty(random, Vec3(random.normal(), random.normal(), random.normal()));
    const double speed = random.uniform(0, random.next() % 3000 == 0 ? 3 : 1.4);
    tip += 1e-3 * speed * Vec3(random.normal(), random.normal(), random.normal()).normalized();
    if (random.next() % 40000 == 0) tip += Vec3(0.3, 0, 0);
    input.tip = nasty(random, tip);
    if (random.next() % 30000 == 0) input.scene_time = time - 0.03;
    if (random.next() % 30000 == 0) input.link_time = nasty(random, time - 0.03);
    const GuardedForce guarded = guard.pass(input);
    const Vec3 f = guarded.newtons(), t = guarded.newton_metres();
    const bool fault = (guard.status() & guard_status::fault) != 0;
    bad_number |= !f.allFinite() || !t.allFinite();
    over_peak |= f.norm() > 7.9 * (1 + 1e-12);
    over_torque |= t.norm() > 0.5 * (1 + 1e-12);
    over_slew |= !fault && (f - force).norm() > 2000 * std::max(dt, 0.0) * (1 + 1e-9);
    over_slew |= !fault && (t - torque).norm() > 100 * std::max(dt, 0.0) * (1 + 1e-9);
    over_slew |= fault && (f != Vec3::Zero() || t != Vec3::Zero());
    too_warm |= guard.heat() > 1 + 1e-9;
    faults += fault;
    strong += f.norm() > 1;
    force = f;
    torque = t;
  }
  MESSAGE(ticks << " ticks, " << faults << " in fault, " << strong << " with more than 1 N");
  CHECK_FALSE(bad_number);
  CHECK_FALSE(over_peak);
  CHECK_FALSE(over_torque);
  CHECK_FALSE(over_slew);
  CHECK_FALSE(too_warm);
  CHECK(faults > ticks / 50);  // the test is able to fail
  CHECK(strong > ticks / 10);
}

TEST_CASE("each cause of a fault is named; the force is zero at once and until rearmed") {
  using namespace guard_status;
  const struct {
    std::uint32_t reason;
    std::function<void(GuardInput&)> spoil;
  } causes[] = {
      {not_a_number, [](GuardInput& i) { i.wanted.torque.x() = std::nan(""); }},
      {not_a_number, [](GuardInput& i) { i.tip.y() = std::nan(""); }},
      {scene_stalled, [](GuardInput& i) { i.scene_time -= 0.0201; }},
      {scene_stalled, [](GuardInput& i) { i.scene_time += 10; }},
      {link_lost, [](GuardInput& i) { i.link_time -= 0.0201; }},
      {link_lost, [](GuardInput& i) { i.link_time = std::nan(""); }},
      {loop_stalled, [](GuardInput& i) { i.time += 0.05, i.scene_time += 0.05, i.link_time += 0.05; }},
      {jumped, [](GuardInput& i) { i.tip.z() += 0.06; }},
  };
  for (const auto& cause : causes) {
    Guard guard{{}};
    double time = 5;
    for (int k = 0; k < 600; ++k) guard.pass(healthy(time += 0.001));
    CHECK(guard.status() == 0);
    GuardInput bad = healthy(time += 0.001);
    cause.spoil(bad);
    CHECK(guard.pass(bad).newtons() == Vec3::Zero());
    CHECK(guard.status() == (fault | cause.reason));
    for (int k = 0; k < 600; ++k) CHECK(guard.pass(healthy(time += 0.001)).newtons() == Vec3::Zero());
    CHECK(guard.status() == (fault | cause.reason));
    guard.rearm();
    for (int k = 0; k < 600; ++k) guard.pass(healthy(time += 0.001));
    CHECK(guard.pass(healthy(time += 0.001)).newtons().y() == doctest::Approx(2));
  }
}

TEST_CASE("a hand over the velocity limit gets no force, and a new ramp-in once it is slow again") {
  Guard guard{{}};
  double time = 0;
  for (int k = 0; k < 600; ++k) guard.pass(healthy(time += 0.001));
  GuardInput input = healthy(time);
  Vec3 force;
  for (int k = 0; k < 10; ++k) {
    input = healthy(time += 0.001);
    input.tip.x() = 0.002 * (k + 1);  // 2 m/s
    force = guard.pass(input).newtons();
  }
  CHECK(force == Vec3::Zero());
  CHECK((guard.status() & guard_status::hand_too_fast) != 0);
  CHECK((guard.status() & guard_status::fault) == 0);
  for (int k = 0; k < 250; ++k) {
    GuardInput slow = healthy(time += 0.001);
    slow.tip = input.tip;
    force = guard.pass(slow).newtons();
  }
  CHECK(force.y() == doctest::Approx(1).epsilon(0.02));
}

TEST_CASE("the force settles at the continuous limit, and may reach the peak for a while") {
  Guard guard{{}};
  double time = 0, square = 0, at_peak = 0, force = 0;
  constexpr int ticks = 300000;
  for (int k = 0; k < ticks; ++k) {
    force = guard.pass(healthy(time += 0.001, {0, 7.9, 0})).newtons().y();
    square += force * force / ticks;
    if (force > 7) at_peak += 0.001;
    CHECK_FALSE(guard.heat() > 1 + 1e-9);
  }
  MESSAGE("above 7 N for " << at_peak << " s; after 300 s " << force << " N, root mean square "
                           << std::sqrt(square));
  CHECK(force == doctest::Approx(1.75).epsilon(0.02));
  CHECK(at_peak > 0.1);
}

TEST_CASE("the ramp-in is never shorter than half a second") {
  GuardLimits limits;
  limits.ramp_in = 0;
  Guard guard(limits);
  for (int k = 0; k < 100; ++k)
    CHECK(guard.pass({0, 2, 0}, 0.001).newtons().y() <= 2 * 0.001 * k / 0.5 + 1e-12);
}
