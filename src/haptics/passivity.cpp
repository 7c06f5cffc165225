#include "haptics/passivity.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace intaglio::haptics {

double stiffness_limit(const DeviceDynamics& device, double damping) {
  return std::max(0.0, 2 * (device.damping - std::abs(damping)) * device.rate);
}

double damping_limit(const DeviceDynamics& device, double stiffness) {
  return std::max(0.0, device.damping - stiffness / (2 * device.rate));
}

double quantisation_limit(const DeviceDynamics& device) {
  return 2 * device.friction / device.resolution;
}

double damping_noise(const DeviceDynamics& device, double damping) {
  // Each reading is off by an even error of one resolution, variance resolution^2 / 12; two are subtracted.
  return std::abs(damping) * device.resolution * device.rate / std::sqrt(6.0);
}

double finest_wavelength(const DeviceDynamics& device, double speed) {
  return 4 * std::abs(speed) / device.rate;
}

std::optional<std::string> stability_warning(const DeviceDynamics& device, double stiffness, double damping) {
  const double passive = stiffness_limit(device, damping);
  if (stiffness > passive) {
    return fmt::format(
        "stiffness {:.0f} N/m with damping {:.2g} N s/m is over the {:.0f} N/m (K = 2 (b - B) / T) that a device of {:.2g} N "
        "s/m at {:.0f} Hz displays passively; the hand's own damping or the passivity controller must make up for it",
        stiffness, damping, passive, device.damping, device.rate);
  }
  const double fine = quantisation_limit(device);
  if (stiffness > fine) {
    return fmt::format(
        "stiffness {:.0f} N/m is over the {:.0f} N/m whose encoder steps of {:.1f} um the device's friction of {:.2g} N "
        "absorbs; expect a faint hum",
        stiffness, fine, 1e6 * device.resolution, device.friction);
  }
  return std::nullopt;
}

}  // namespace intaglio::haptics
