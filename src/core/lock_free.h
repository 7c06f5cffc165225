// Data from one thread to another: the latest value, or a queue. Neither thread waits, neither allocates
// after construction. One writer thread, one reader thread.
#pragma once

#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace intaglio {

// The latest value. Values that are not fetched in time are overwritten; a read never sees a partial value.
//
// Three slots: the writer fills one, the reader holds one, and both swap theirs with the third by an atomic
// exchange. About 10 ns.
template <class T>
class Latest {
 public:
  // Writer.
  void publish(const T& value) {
    slots_[write_] = value;
    write_ = shared_.exchange(write_ | fresh, std::memory_order_acq_rel) & index;
  }

  // Reader: the newest value, which may be the one of the last call; before the first publish(), T{}. Valid
  // until the next call.
  const T& fetch() {
    if ((shared_.load(std::memory_order_relaxed) & fresh) != 0)
      read_ = shared_.exchange(read_, std::memory_order_acq_rel) & index;
    return slots_[read_];
  }

 private:
  static constexpr std::uint8_t index = 3, fresh = 4;

  std::array<T, 3> slots_{};
  // Apart, so that the two threads do not share a cache line.
  alignas(64) std::uint8_t read_ = 0;
  alignas(64) std::uint8_t write_ = 1;
  alignas(64) std::atomic<std::uint8_t> shared_{2};
};

// A bounded queue. T is copied in and out.
template <class T>
class SpscQueue {
 public:
  // Room for at least `capacity` values.
  explicit SpscQueue(std::size_t capacity) : slots_(std::bit_ceil(capacity + 1)) {}

  // Producer: false when full.
  bool push(const T& value) {
    const std::size_t tail = tail_.load(std::memory_order_relaxed);
    const std::size_t next = (tail + 1) & (slots_.size() - 1);
    if (next == head_.load(std::memory_order_acquire)) return false;
    slots_[tail] = value;
    tail_.store(next, std::memory_order_release);
    return true;
  }

  // Consumer: the oldest value, or null. Valid until pop().
  const T* front() const {
    const std::size_t head = head_.load(std::memory_order_relaxed);
    return head == tail_.load(std::memory_order_acquire) ? nullptr : &slots_[head];
  }
  // Consumer, after a front() that was not null.
  void pop() {
    head_.store((head_.load(std::memory_order_relaxed) + 1) & (slots_.size() - 1), std::memory_order_release);
  }

 private:
  std::vector<T> slots_;
  alignas(64) std::atomic<std::size_t> head_{0};
  alignas(64) std::atomic<std::size_t> tail_{0};
};

}  // namespace intaglio
