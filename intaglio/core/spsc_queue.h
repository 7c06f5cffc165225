// A bounded queue from one thread to another: neither waits, neither allocates after construction.
//
// One producer, one consumer. T is copied in and out. A full queue refuses, and the producer decides.
#pragma once

#include <atomic>
#include <bit>
#include <cstddef>
#include <vector>

namespace intaglio {

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
  // Apart, so that the two threads do not share a cache line.
  alignas(64) std::atomic<std::size_t> head_{0};
  alignas(64) std::atomic<std::size_t> tail_{0};
};

}  // namespace intaglio
