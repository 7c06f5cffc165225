// The blows that are sounding or about to: a fixed number of half-sine pulses, each with the gains of the
// body it strikes.
//
// All memory is taken at construction. One thread; nothing here allocates, locks or throws afterwards.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "intaglio/sound/impact.h"

namespace intaglio::sound {

struct Pulse {
  HalfSine shape;
  double impulse = 0;  // N s
  int body = 0;        // whom it strikes: an index of the caller's
};

class PulsePool {
 public:
  PulsePool(int capacity, int gains_each);

  // A place for one more pulse: its gains, for the caller to fill. When all are taken, the smallest pulse,
  // maybe the new one, is dropped and counted; gains of a dropped new one are empty.
  std::span<float> add(const Pulse& pulse);
  // Forgets the pulses that have ended by `time`.
  void remove_ended(double time);

  int size() const { return static_cast<int>(active_.size()); }
  const Pulse& pulse(int i) const { return pulses_[std::size_t(active_[std::size_t(i)])]; }
  std::span<const float> gains(int i) const;
  std::uint64_t dropped() const { return dropped_; }

 private:
  std::span<float> row(int slot);

  int gains_each_;
  std::vector<Pulse> pulses_;  // by slot
  std::vector<float> gains_;   // by slot
  std::vector<int> active_, free_;
  std::uint64_t dropped_ = 0;
};

}  // namespace intaglio::sound
