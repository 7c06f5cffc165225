// The newest value from one thread to another: the writer never waits, the reader never waits, values in
// between are dropped.
//
// Three copies: one is being written, one is being read, one lies ready; publish() and update() swap with the
// one that lies ready by a single atomic exchange. Exactly one writer and one reader thread. No allocation
// after construction.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace intaglio {

template <class T>
class LatestValue {
 public:
  LatestValue() = default;
  explicit LatestValue(const T& initial) { slots_.fill(initial); }

  // Writer: the copy to fill in (what it holds is some older value), then publish().
  T& draft() { return slots_[write_]; }
  void publish() { write_ = ready_.exchange(write_ | fresh, std::memory_order_acq_rel) & ~fresh; }
  void publish(const T& value) {
    draft() = value;
    publish();
  }

  // Reader: takes the newest value, if there is one since the last call; then value() is that.
  bool update() {
    if ((ready_.load(std::memory_order_relaxed) & fresh) == 0) return false;
    read_ = ready_.exchange(read_, std::memory_order_acq_rel) & ~fresh;
    return true;
  }
  const T& value() const { return slots_[read_]; }

 private:
  static constexpr std::uint32_t fresh = 4;

  std::array<T, 3> slots_{};
  alignas(64) std::atomic<std::uint32_t> ready_{1};
  alignas(64) std::uint32_t write_ = 0;  // the writer's
  alignas(64) std::uint32_t read_ = 2;   // the reader's
};

}  // namespace intaglio
