// A set of times, as the union of spans: sorted, disjoint, within 0 to a duration.
#pragma once

#include <deque>

namespace intaglio::report {

struct TimeSpan {
  double begin = 0;  // s
  double end = 0;    // s
};

class TimeSpans {
 public:
  explicit TimeSpans(double duration) : duration_(duration) {}

  // In any order. Clipped; what is not a span of time is ignored.
  void add(TimeSpan span);
  // Drops the spans that end by `time`; total() still counts them. Later spans begin after it.
  void forget_before(double time);
  double duration() const { return duration_; }
  const std::deque<TimeSpan>& spans() const { return spans_; }
  double total() const;  // s

 private:
  double duration_, forgotten_ = 0;
  std::deque<TimeSpan> spans_;
};

}  // namespace intaglio::report
