// Lists that keep what a page needs of a stream of any length, in memory that they take at construction. The
// result depends on the stream only, not on when it is looked at.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace intaglio::report {

// The `count` strongest; of equal ones those of lower rank, which callers give in order of time.
template <class T>
class Strongest {
 public:
  explicit Strongest(std::size_t count) : count_(count) { kept_.reserve(2 * count); }

  void add(double strength, std::size_t rank, const T& value) {
    kept_.push_back({strength, rank, value});
    if (kept_.size() < 2 * count_) return;
    std::nth_element(kept_.begin(), kept_.begin() + std::ptrdiff_t(count_), kept_.end(), is_before);
    kept_.resize(count_);
  }
  // The strongest first.
  std::vector<T> sorted() const {
    std::vector<Entry> entries = kept_;
    std::sort(entries.begin(), entries.end(), is_before);
    std::vector<T> out;
    for (std::size_t k = 0; k < std::min(count_, entries.size()); ++k) out.push_back(entries[k].value);
    return out;
  }

 private:
  struct Entry {
    double strength = 0;
    std::size_t rank = 0;
    T value;
  };
  static bool is_before(const Entry& a, const Entry& b) {
    return a.strength != b.strength ? a.strength > b.strength : a.rank < b.rank;
  }

  std::size_t count_;
  std::vector<Entry> kept_;
};

// Evenly spaced samples of a series: all of up to `most` samples; every 2nd, 4th, ... of longer ones, so that
// between a half of `most` and `most` are kept.
template <class T>
class Decimated {
 public:
  explicit Decimated(std::size_t most) : most_(most) { kept_.reserve(most + 1); }

  void add(const T& value) {
    if (count_++ % stride_ != 0) return;
    kept_.push_back(value);
    if (kept_.size() <= most_) return;
    for (std::size_t k = 0; 2 * k < kept_.size(); ++k) kept_[k] = kept_[2 * k];
    kept_.resize((kept_.size() + 1) / 2);
    stride_ *= 2;
  }
  const std::vector<T>& samples() const { return kept_; }

 private:
  std::size_t most_, count_ = 0, stride_ = 1;
  std::vector<T> kept_;
};

inline constexpr double sample_window = 10;  // s

// Things that happen at times (T::time, s): all of up to `most`; of more, those in every 2nd, 4th, ... window
// of ten seconds, a fair sample of the time. The first window is kept whole however much happens in it.
template <class T>
class TimeSample {
 public:
  explicit TimeSample(std::size_t most) : most_(most) { kept_.reserve(limit_); }

  // `is_wanted(T)` says what of the kept ones may still count: asked when there is no room.
  template <class IsWanted>
  void add(const T& value, const IsWanted& is_wanted) {
    if (!is_in(value.time, stride_)) return;
    kept_.push_back(value);
    if (kept_.size() < limit_) return;
    std::erase_if(kept_, [&](const T& kept) { return !is_wanted(kept); });
    while (kept_.size() > most_ && stride_ < max_stride) thin(2 * stride_);
    limit_ = std::max(2 * most_, 2 * kept_.size());
  }
  void thin(std::size_t stride) {
    stride_ = stride;
    std::erase_if(kept_, [&](const T& value) { return !is_in(value.time, stride); });
  }

  // Every `stride()`th window is kept.
  std::size_t stride() const { return stride_; }
  const std::vector<T>& kept() const { return kept_; }

 private:
  static constexpr std::size_t max_stride = 1 << 20;
  static bool is_in(double time, std::size_t stride) {
    return stride == 1 || time < sample_window || std::size_t(time / sample_window) % stride == 0;
  }

  std::size_t most_, stride_ = 1;
  std::size_t limit_ = 2 * most_;
  std::vector<T> kept_;
};

// How much of 0 to `duration` is in the windows of that stride, s.
inline double covered_time(double duration, std::size_t stride) {
  if (stride == 1) return duration;
  double sum = 0;
  for (double start = 0; start < duration; start += sample_window * double(stride))
    sum += std::min(sample_window, duration - start);
  return sum;
}

}  // namespace intaglio::report
