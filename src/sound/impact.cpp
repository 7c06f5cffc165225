#include "sound/impact.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "core/portable_math.h"

namespace intaglio::sound {

double effective_modulus(const Material& a, const Material& b) {
  const auto compliance = [](const Material& m) {
    return (1 - m.poisson_ratio * m.poisson_ratio) / m.youngs_modulus;
  };
  return 1 / (compliance(a) + compliance(b));
}

double hertz_contact_duration(double mass, double radius, double modulus, double speed) {
  assert(mass > 0 && radius > 0 && modulus > 0);
  if (!(speed > 0)) return max_contact_duration;
  const double duration = 2.87 * elementary::pow(mass * mass / (radius * modulus * modulus * speed), 0.2);
  return std::clamp(duration, min_contact_duration, max_contact_duration);
}

double hertz_patch_radius(double force, double radius, double modulus) {
  return elementary::cbrt(0.75 * std::max(force, 0.0) * radius / modulus);
}

double HalfSine::impulse_by(double time) const {
  const double phase = std::clamp((time - start) / duration, 0.0, 1.0);
  return 0.5 * (1 - elementary::cos(std::numbers::pi * phase));
}

void HalfSine::sample(double time, double dt, std::span<float> out) const {
  double before = impulse_by(time);
  for (std::size_t k = 0; k < out.size(); ++k) {
    const double after = impulse_by(time + double(k + 1) * dt);
    out[k] = float(after - before);
    before = after;
  }
}

namespace {

constexpr double flat_pair_radius = 0.01, min_radius = 1e-4;  // m
constexpr double min_curvature_ratio = 0.1;                   // of the curvature without a groove

}  // namespace

double relief_curvature(const surface::Surface& surface, const Vec2& uv, double footprint) {
  if (surface.is_flat()) return 0;
  const double reach = std::max({footprint, 2 * surface.texel_u(), 2 * surface.texel_v()});
  const Vec2 du(0.5 * reach / surface.placement().size_u(), 0),
      dv(0, 0.5 * reach / surface.placement().size_v());
  const auto slope = [&](const Vec2& at) { return surface.smooth(at, reach).gradient; };
  const double bend = (slope(uv + du) - slope(uv - du)).x() + (slope(uv + dv) - slope(uv - dv)).y();
  return -0.5 * bend / reach;
}

double contact_radius(double a, double b, double curvature) {
  double bodies = 1 / a + 1 / b;
  if (!(bodies > 0)) bodies = 1 / flat_pair_radius;
  return 1 / std::clamp(bodies + curvature, min_curvature_ratio * bodies, 1 / min_radius);
}

PulsePool::PulsePool(int capacity, int gains_each)
    : gains_each_(gains_each),
      pulses_(std::size_t(capacity)),
      gains_(std::size_t(capacity) * std::size_t(gains_each)) {
  active_.reserve(pulses_.size());
  for (int slot = capacity - 1; slot >= 0; --slot) free_.push_back(slot);
}

std::span<float> PulsePool::add(const Pulse& pulse) {
  if (free_.empty()) {
    ++dropped_;
    const auto size_of = [this](int slot) { return std::abs(pulses_[std::size_t(slot)].impulse); };
    const auto smallest = std::min_element(active_.begin(), active_.end(),
                                           [&](int a, int b) { return size_of(a) < size_of(b); });
    if (smallest == active_.end() || size_of(*smallest) >= std::abs(pulse.impulse)) return {};
    free_.push_back(*smallest);
    active_.erase(smallest);
  }
  const int slot = free_.back();
  free_.pop_back();
  active_.push_back(slot);
  pulses_[std::size_t(slot)] = pulse;
  return row(slot);
}

void PulsePool::remove_ended(double time) {
  const auto has_ended = [&](int slot) {
    if (pulses_[std::size_t(slot)].shape.end() > time) return false;
    free_.push_back(slot);
    return true;
  };
  active_.erase(std::remove_if(active_.begin(), active_.end(), has_ended), active_.end());
}

}  // namespace intaglio::sound
