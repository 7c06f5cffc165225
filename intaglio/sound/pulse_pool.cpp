#include "intaglio/sound/pulse_pool.h"

#include <algorithm>
#include <cmath>

namespace intaglio::sound {

PulsePool::PulsePool(int capacity, int gains_each)
    : gains_each_(gains_each),
      pulses_(std::size_t(capacity)),
      gains_(std::size_t(capacity) * std::size_t(gains_each)) {
  active_.reserve(pulses_.size());
  for (int slot = capacity - 1; slot >= 0; --slot) free_.push_back(slot);
}

std::span<float> PulsePool::row(int slot) {
  return std::span(gains_).subspan(std::size_t(slot) * std::size_t(gains_each_), std::size_t(gains_each_));
}

std::span<const float> PulsePool::gains(int i) const {
  const auto slot = static_cast<std::size_t>(active_[std::size_t(i)]);
  return std::span(gains_).subspan(slot * std::size_t(gains_each_), std::size_t(gains_each_));
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
