#include "intaglio/session/report_contacts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace intaglio::session {

namespace {

constexpr double impact_seconds = 0.010;

double series_seconds(std::size_t samples, int rate) {
  return rate > 0 ? static_cast<double>(samples) / rate : 0;
}

}  // namespace

double shown_duration(const Recording& recording) {
  if (std::isfinite(recording.duration) && recording.duration > 1e-6 && recording.duration < 1e6)
    return recording.duration;
  double longest = std::max(series_seconds(recording.audio.size(), recording.sample_rate),
                            series_seconds(recording.servo.size(), recording.servo_rate));
  for (const BallTrack& ball : recording.balls) {
    longest = std::max(longest, series_seconds(ball.position.size(), recording.physics_rate));
  }
  return longest > 0 ? longest : 1;
}

std::vector<Impact> impacts_of(const Recording& recording) {
  std::vector<Impact> impacts;
  std::map<BodyId, std::size_t> last;  // of each body, an index into impacts
  for (const ContactEvent& event : recording.events) {
    const bool of_ball = event.body != recording.pen && event.body != floor_body;
    if (!of_ball || event.phase == ContactPhase::end || !std::isfinite(event.time)) continue;
    const double impulse = event.impulse.norm();
    const auto open = last.find(event.body);
    if (open != last.end() && event.time - impacts[open->second].time <= impact_seconds) {
      if (std::isfinite(impulse)) impacts[open->second].impulse += impulse;
    } else if (event.phase == ContactPhase::begin) {
      last[event.body] = impacts.size();
      impacts.push_back({event.time, event.body, std::isfinite(impulse) ? impulse : 0});
    }
  }
  return impacts;
}

std::vector<Impact> strongest(std::vector<Impact> impacts, std::size_t count, double apart) {
  std::stable_sort(impacts.begin(), impacts.end(),
                   [](const Impact& a, const Impact& b) { return a.impulse > b.impulse; });
  std::vector<Impact> kept;
  for (const Impact& impact : impacts) {
    if (kept.size() == count || impact.impulse < 0.1 * impacts.front().impulse) break;
    const auto near = [&](const Impact& other) { return std::abs(other.time - impact.time) < apart; };
    if (std::none_of(kept.begin(), kept.end(), near)) kept.push_back(impact);
  }
  std::stable_sort(kept.begin(), kept.end(),
                   [](const Impact& a, const Impact& b) { return a.time < b.time; });
  return kept;
}

std::string body_name(const Recording& recording, BodyId body) {
  for (const Voice& voice : recording.voices) {
    if (voice.body == body && !voice.name.empty()) return voice.name;
  }
  if (body == floor_body) return "floor";
  return body == recording.pen ? "pen" : fmt::format("ball {}", body);
}

std::vector<TimeSpan> pen_touches(const Recording& recording) {
  std::vector<TimeSpan> spans;
  if (recording.servo_rate <= 0) return spans;
  const double tick = 1.0 / recording.servo_rate;
  bool touching = false;
  for (std::size_t k = 0; k < recording.servo.size(); ++k) {
    const double time = static_cast<double>(k) * tick;
    if (recording.servo[k].touching) {
      if (!touching) spans.push_back({time, time});
      spans.back().end = time + tick;
    }
    touching = recording.servo[k].touching;
  }
  return joined(std::move(spans), shown_duration(recording));
}

std::vector<TimeSpan> joined(std::vector<TimeSpan> spans, double duration) {
  std::sort(spans.begin(), spans.end(),
            [](const TimeSpan& a, const TimeSpan& b) { return a.begin < b.begin; });
  std::vector<TimeSpan> out;
  for (TimeSpan span : spans) {
    span = {std::max(span.begin, 0.0), std::min(span.end, duration)};
    if (!(span.begin < span.end)) continue;
    if (!out.empty() && span.begin <= out.back().end) {
      out.back().end = std::max(out.back().end, span.end);
    } else {
      out.push_back(span);
    }
  }
  return out;
}

double total_seconds(std::span<const TimeSpan> spans) {
  double sum = 0;
  for (const TimeSpan& span : spans) sum += span.end - span.begin;
  return sum;
}

}  // namespace intaglio::session
