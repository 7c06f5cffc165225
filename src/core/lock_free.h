// The latest value, from one thread to another: the writer never waits, the reader never waits, neither
// allocates. What the reader did not fetch in time is overwritten; what it gets is always one whole value.
//
// Three slots: one the writer fills, one the reader holds, one between that both swap with by one atomic
// exchange. One writer thread, one reader thread. About 10 ns.
#pragma once

#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

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

// The newest value from one thread to another: the writer never waits, the reader never waits, values in
// between are dropped.
//
// Three copies: one is being written, one is being read, one lies ready; publish() and update() swap with the
// one that lies ready by a single atomic exchange. Exactly one writer and one reader thread. No allocation
// after construction.

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

// A bounded queue from one thread to another: neither waits, neither allocates after construction.
//
// One producer, one consumer. T is copied in and out. A full queue refuses, and the producer decides.

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
