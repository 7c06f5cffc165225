#include "report/time_spans.h"

#include <algorithm>
#include <iterator>

namespace intaglio::report {

void TimeSpans::add(TimeSpan span) {
  span = {std::max(span.begin, 0.0), std::min(span.end, duration_)};
  if (!(span.begin < span.end)) return;
  auto at = std::upper_bound(spans_.begin(), spans_.end(), span.begin,
                             [](double begin, const TimeSpan& other) { return begin < other.begin; });
  if (at != spans_.begin() && span.begin <= std::prev(at)->end) {
    --at;
    at->end = std::max(at->end, span.end);
  } else {
    at = spans_.insert(at, span);
  }
  auto after = std::next(at);
  for (; after != spans_.end() && after->begin <= at->end; ++after) at->end = std::max(at->end, after->end);
  spans_.erase(std::next(at), after);
}

void TimeSpans::forget_before(double time) {
  for (; !spans_.empty() && spans_.front().end <= time; spans_.pop_front())
    forgotten_ += spans_.front().end - spans_.front().begin;
}

double TimeSpans::total() const {
  double sum = forgotten_;
  for (const TimeSpan& span : spans_) sum += span.end - span.begin;
  return sum;
}

}  // namespace intaglio::report
