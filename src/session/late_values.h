// A value as it was some time ago: poses that are drawn late, positions that are logged late.
//
// Keeps what was put within the delay, and one value before that. With a delay of 0 it holds the newest value
// only. One thread.
#pragma once

#include <deque>
#include <utility>

namespace intaglio::session {

template <class Time, class Value>
class LateValues {
 public:
  // `first`: the value before the first that is put.
  LateValues(Time delay, Value first) : delay_(delay), first_(std::move(first)) {}

  // Times ascend.
  void put(Time time, Value value) { kept_.emplace_back(time, std::move(value)); }
  // Forgets all that was put.
  void restart(Value first) {
    kept_.clear();
    first_ = std::move(first);
  }
  // The value that was the newest at `now` minus the delay; `now` ascends.
  const Value& at(Time now) {
    for (; !kept_.empty() && !(kept_.front().first > now - delay_); kept_.pop_front())
      first_ = std::move(kept_.front().second);
    return first_;
  }

 private:
  Time delay_;
  Value first_;
  std::deque<std::pair<Time, Value>> kept_;
};

}  // namespace intaglio::session
