// One SI clock for a session, shared by loops of different rates.
//
// Time is counted in whole ticks of 1 / lcm(all rates) seconds, so that "the 147th audio sample" and "the
// 160th servo tick" fall in the right order and no loop drifts, however long the session. Rates are whole
// hertz.
#pragma once

#include <cassert>
#include <cstdint>
#include <initializer_list>
#include <numeric>

namespace intaglio {

using Ticks = std::int64_t;

class Clock {
 public:
  // A clock in which each of `rates_hz` (all > 0) has a whole number of ticks a period.
  explicit Clock(std::initializer_list<int> rates_hz) {
    for (const int rate : rates_hz) {
      assert(rate > 0);
      ticks_per_second_ = std::lcm(ticks_per_second_, Ticks(rate));
    }
  }

  Ticks ticks_per_second() const { return ticks_per_second_; }
  double seconds(Ticks t) const { return double(t) / double(ticks_per_second_); }
  // When step `index` of a loop of `rate_hz` is due.
  Ticks due(std::int64_t index, int rate_hz) const { return index * (ticks_per_second_ / rate_hz); }
  // How many steps of a loop of `rate_hz` fit into `duration_s`, rounded up.
  std::int64_t steps(double duration_s, int rate_hz) const {
    const double exact = duration_s * rate_hz;
    const auto whole = std::int64_t(exact);
    return exact - double(whole) > 1e-9 ? whole + 1 : whole;
  }

 private:
  Ticks ticks_per_second_ = 1;
};

}  // namespace intaglio
