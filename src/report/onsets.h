// Loud onsets in audio: milliseconds whose energy is at least 6 dB above each of the previous 30 and within
// 40 dB of the loudest; at most one per 30 ms.
//
// The energy is that of the first difference, which emphasises treble: low modes ring on from one impact to
// the next, high ones start anew. Whether an onset is loud is known at the end only: until then all are kept
// that may be.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "report/bounded.h"

namespace intaglio::report {

class OnsetFinder {
 public:
  explicit OnsetFinder(double sample_rate);

  void add(float sample);
  // s, ascending; as TouchFinder::touches().
  std::vector<double> onsets(std::size_t stride) const;
  std::size_t stride() const { return rises_.stride(); }

 private:
  static constexpr std::size_t rest = 30;  // slots

  struct Rise {
    double time = 0;       // s, of the slot's begin
    std::size_t slot = 0;  // a millisecond
    double energy = 0;
  };
  void close_slot();
  bool is_loud(const Rise& rise) const { return rise.energy >= 1e-4 * loudest_; }

  double sample_rate_;
  std::size_t slot_samples_, in_slot_ = 0, slot_ = 0;
  float last_ = 0;
  double energy_ = 0, loudest_ = 0;
  std::array<double, rest> before_{};  // energies of the last slots
  TimeSample<Rise> rises_{1 << 15};
};

}  // namespace intaglio::report
