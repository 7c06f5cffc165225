#include <doctest/doctest.h>

#include <cmath>

#include "haptics/passivity.h"

using namespace intaglio;
using namespace intaglio::haptics;

namespace {

// Work that a wall of stiffness K and damping B, sampled at the device's rate, does in a second on a tip that
// is shaken into it sinusoidally, J.
double work_of_wall(const DeviceDynamics& device, double stiffness, double damping, double frequency,
                    double amplitude) {
  const double period = 1 / device.rate;
  const auto x = [&](double t) { return amplitude * std::sin(2 * 3.14159265358979 * frequency * t); };
  double work = 0;
  for (int k = 1; k < int(device.rate); ++k) {
    const double t = k * period;
    const double force = -stiffness * x(t) - damping * (x(t) - x(t - period)) / period;
    work += force * (x(t + period) - x(t));
    // The device's own damper, integrated.
    for (int m = 0; m < 20; ++m) {
      const double dx = x(t + (m + 1) * period / 20) - x(t + m * period / 20);
      work -= device.damping * dx * dx / (period / 20);
    }
  }
  return work;
}

}  // namespace

TEST_CASE("springs are passive up to K = 2 (b - B) / T and not beyond") {
  const DeviceDynamics device{0.5, 0.02, 2.3e-5, 1000};
  CHECK(stiffness_limit(device) == doctest::Approx(1000));
  CHECK(stiffness_limit(device, 0.1) == doctest::Approx(800));
  CHECK(stiffness_limit(device, 0.7) == 0);
  for (const double damping : {0.0, 0.2}) {
    const double limit = stiffness_limit(device, damping);
    // Passive at all frequencies below the limit; the worst is at half the sampling rate.
    for (double f = 5; f < 500; f += 31) {
      CHECK(work_of_wall(device, 0.98 * limit, damping, f, 1e-3) <= 1e-9);
      if (damping == 0 && f < 200) CHECK(work_of_wall(device, 1.2 * limit, damping, f, 1e-3) > 0);
    }
    CHECK(stability_warning(device, 1.02 * limit, damping).has_value());
  }
  CHECK_FALSE(stability_warning(device, 700, 0).has_value());
}

TEST_CASE("encoder steps are absorbed up to K = 2 friction / resolution") {
  const DeviceDynamics device{10, 0.02, 2e-5, 1000};
  CHECK(quantisation_limit(device) == doctest::Approx(2000));
  CHECK_FALSE(stability_warning(device, 1900, 0).has_value());
  CHECK(stability_warning(device, 2100, 0).has_value());
}

TEST_CASE("a sampled spring gives a shaken hand energy, but not under the passivity controller") {
  constexpr double stiffness = 2000, period = 1e-3;
  for (const bool controlled : {false, true}) {
    PassivityController passivity({stiffness * period * 2, 1e-4, 2e-3});
    double work = 0;
    Vec3 last = Vec3::Zero(), force = Vec3::Zero();
    for (int k = 0; k < 5000; ++k) {
      const Vec3 x(0, 0.004 * std::sin(2 * 3.14159265358979 * 7.3 * k * period), 0);
      work += force.dot(x - last);
      passivity.observe(x - last, 0.5 * stiffness * x.squaredNorm());
      force = -stiffness * x;
      if (controlled) force += passivity.damping_force(x - last, period);
      passivity.set_sent(force);
      CHECK(passivity.work_on_hand() == doctest::Approx(work));
      last = x;
    }
    MESSAGE("work on the hand in 5 s " << 1e3 * work << " mJ, controller " << controlled);
    if (controlled) CHECK(work < 2.5e-3);  // never more than the cap on the deficit and a tick
    if (!controlled) CHECK(work > 0.05);
  }
}

TEST_CASE("stone feels as stiff as the device can display, foam as soft as it is") {
  Material foam;
  foam.youngs_modulus = 5e4;
  foam.poisson_ratio = 0;
  CHECK(felt_stiffness(foam, 0.001, 800) == doctest::Approx(800.0 * 100 / 900));
  for (const Material& material : materials())
    CHECK(felt_stiffness(material, 0.001, 800) == doctest::Approx(800).epsilon(0.001));
  CHECK(felt_stiffness(foam, 0, 800) == 800);
}
