#include "intaglio/sound/impact.h"

#include <algorithm>
#include <cassert>
#include <numbers>

#include "intaglio/core/elementary.h"

namespace intaglio::sound {

double effective_modulus(const Material& a, const Material& b) {
  const auto compliance = [](const Material& m) {
    return (1 - m.poisson_ratio * m.poisson_ratio) / m.youngs_modulus;
  };
  return 1 / (compliance(a) + compliance(b));
}

double hertz_contact_duration(double mass, double radius, double modulus, double speed) {
  assert(mass > 0 && radius > 0 && modulus > 0);
  if (!(speed > 0)) return longest_contact;
  const double duration = 2.87 * elementary::pow(mass * mass / (radius * modulus * modulus * speed), 0.2);
  return std::clamp(duration, shortest_contact, longest_contact);
}

double hertz_patch_radius(double force, double radius, double modulus) {
  return elementary::cbrt(0.75 * std::max(force, 0.0) * radius / modulus);
}

double HalfSine::given(double time) const {
  const double phase = std::clamp((time - start) / duration, 0.0, 1.0);
  return 0.5 * (1 - elementary::cos(std::numbers::pi * phase));
}

void HalfSine::sample(double time, double dt, std::span<float> out) const {
  double before = given(time);
  for (std::size_t k = 0; k < out.size(); ++k) {
    const double after = given(time + static_cast<double>(k + 1) * dt);
    out[k] = static_cast<float>(after - before);
    before = after;
  }
}

}  // namespace intaglio::sound
