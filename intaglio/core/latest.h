// The latest value, from one thread to another: the writer never waits, the reader never waits, neither
// allocates. What the reader did not fetch in time is overwritten; what it gets is always one whole value.
//
// Three slots: one the writer fills, one the reader holds, one between that both swap with by one atomic
// exchange. One writer thread, one reader thread. About 10 ns.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace intaglio {

template <class T>
class Latest {
 public:
  // Writer.
  void publish(const T& value) {
    slots_[back_] = value;
    back_ = between_.exchange(back_ | fresh, std::memory_order_acq_rel) & index;
  }

  // Reader: the newest value, or the one of last time. Valid until the next call.
  const T& fetch() {
    if ((between_.load(std::memory_order_relaxed) & fresh) != 0)
      front_ = between_.exchange(front_, std::memory_order_acq_rel) & index;
    return slots_[front_];
  }

 private:
  static constexpr std::uint8_t index = 3, fresh = 4;

  std::array<T, 3> slots_{};
  std::uint8_t front_ = 0, back_ = 1;
  std::atomic<std::uint8_t> between_{2};
};

}  // namespace intaglio
