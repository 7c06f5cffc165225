#include "haptics/passivity.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace intaglio::haptics {

void PassivityController::observe(const Vec3& displacement, double stored) {
  const double work = -sent_.dot(displacement);
  surplus_ += work - (stored - stored_);
  stored_ = stored;
  work_by_hand_ += work;
  surplus_ = std::clamp(surplus_, -options_.deficit_cap, options_.surplus_cap);
}

Vec3 PassivityController::damping_force(const Vec3& displacement, double dt) const {
  const double square = displacement.squaredNorm();
  if (surplus_ >= 0 || !(square > 0)) return Vec3::Zero();
  const double alpha = std::min(-surplus_ * dt / square, options_.max_damping);
  return -alpha / dt * displacement;
}

double stiffness_limit(const DeviceDynamics& device, double damping) {
  return std::max(0.0, 2 * (device.damping - std::abs(damping)) * device.rate);
}

double quantisation_limit(const DeviceDynamics& device) {
  return 2 * device.friction / device.resolution;
}

std::optional<std::string> stability_warning(const DeviceDynamics& device, double stiffness, double damping) {
  const double passive = stiffness_limit(device, damping);
  if (stiffness > passive) {
    return fmt::format(
        "stiffness {:.0f} N/m with damping {:.2g} N s/m exceeds the {:.0f} N/m (K = 2 (b - B) / T) that a "
        "device of {:.2g} N s/m at {:.0f} Hz displays passively; the hand's own damping or the passivity "
        "controller must compensate",
        stiffness, damping, passive, device.damping, device.rate);
  }
  const double fine = quantisation_limit(device);
  if (stiffness > fine) {
    return fmt::format(
        "stiffness {:.0f} N/m exceeds {:.0f} N/m, up to which the device's friction of {:.2g} N absorbs "
        "encoder steps of {:.1f} um; expect a faint hum",
        stiffness, fine, device.friction, 1e6 * device.resolution);
  }
  return std::nullopt;
}

}  // namespace intaglio::haptics
