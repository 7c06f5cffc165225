#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "evaluate/evaluation_page.h"
#include "report/drawn_curve.h"
#include "report/html.h"
#include "report/svg_plot.h"

namespace intaglio::evaluate {

namespace {

using report::Axis;
using report::DrawnCurve;
using report::format_number;
using report::Range;
using report::SvgPlot;
using report::TextAnchor;

constexpr double conflict_width = 480, row_height = 48, conflict_top = 34;

void conflict_row(SvgPlot& plot, const Axis& x, const RepresentationResult& result, double top,
                  bool is_chosen) {
  const Measured mean_x = result.mean_jnd();
  const double y = top + 32, value = mean_x.value;
  const std::string family = family_of(result.candidate);
  if (is_chosen) plot.rectangle(0, top - 4, conflict_width, row_height - 2, "chosen");
  plot.text(x.units().low, top + 14, result.candidate.title, is_chosen ? "label strong" : "label");
  const std::string low = format_number(mean_x.interval.low, 2),
                    high = format_number(mean_x.interval.high, 2);
  const bool is_known = std::isfinite(mean_x.interval.low) && low != high;
  const std::string interval = is_known ? fmt::format(" ({} – {})", low, high) : "";
  plot.text(conflict_width - 8, top + 14, format_number(value, 2) + interval,
            is_chosen ? "label strong" : "label", TextAnchor::end);
  plot.line(x(0), y, x(x.values().high), y, "track");
  if (!std::isfinite(value)) return;
  const auto at = [&](double v) { return x(std::clamp(v, 0.0, x.values().high)); };
  plot.line(x(0), y, at(value), y, "bar " + family);
  plot.line(at(mean_x.interval.low), y, at(mean_x.interval.high), y, "interval " + family);
  plot.circle(at(value), y, 6, "mark " + family,
              fmt::format("{}: {}{}", result.candidate.title, format_number(value, 2), interval));
}

}  // namespace

const char* family_of(const Candidate& candidate) {
  if (candidate.kind == Kind::flat) return "flat";
  if (candidate.is_papers) return "papers";
  return candidate.mesh_cells > 0 ? "meshes" : "ours";
}

const RepresentationResult& chosen(const Evaluation& evaluation) {
  const auto& all = evaluation.representations;
  const auto found = std::find_if(all.begin(), all.end(), [&](const RepresentationResult& result) {
    return result.candidate.kind == evaluation.recommendation.kind;
  });
  return found == all.end() ? all.front() : *found;
}

std::string conflict_plot(const Evaluation& evaluation) {
  const auto& all = evaluation.representations;
  const double bottom = conflict_top + row_height * double(all.size());
  SvgPlot plot(conflict_width, bottom + 30, "plot conflict", "Conflict between the senses",
               "Mean difference between senses of each representation, in just noticeable differences");
  const Axis x({0, missed_jnd}, {12, conflict_width - 12});
  plot.rectangle(x(0), 22, x(1) - x(0), bottom - 22, "calm");
  const RepresentationResult& recommended = chosen(evaluation);
  for (std::size_t k = 0; k < all.size(); ++k)
    conflict_row(plot, x, all[k], conflict_top + row_height * double(k), &all[k] == &recommended);
  plot.line(x(1), 22, x(1), bottom, "limit");
  plot.text(x(1), 14, "people just notice", "label", TextAnchor::middle);
  for (const int tick : {0, 1, 2})
    plot.text(x(tick), bottom + 20, std::to_string(tick), "tick",
              tick == 0 ? TextAnchor::start : TextAnchor::middle);
  plot.text(x(missed_jnd), bottom + 20, "3: missed", "tick", TextAnchor::end);
  return plot.finish();
}

report::Range busiest_part(const Traces& traces, double seconds) {
  const double start = traces.start, end = start + (traces.rate > 0 ? traces.seconds() : 0);
  if (!(end - start > seconds)) return {start, std::max(end, start + 1e-3)};
  const auto time = [&](std::size_t feature) { return start + double(feature) / traces.rate; };
  double best = start;
  std::ptrdiff_t most = 0;
  for (auto first = traces.features.begin(); first != traces.features.end(); ++first) {
    const double from = std::clamp(time(*first) - 0.04 * seconds, start, end - seconds);
    const auto count = std::count_if(traces.features.begin(), traces.features.end(), [&](std::size_t f) {
      return time(f) >= from && time(f) <= from + seconds;
    });
    if (count > most) most = count, best = from;
  }
  return {best, best + seconds};
}

namespace {

// How a series is drawn: its mean is at the middle of the lane, `reach` at its edge.
struct LaneScale {
  double middle = 0, reach = 1;

  double operator()(double value) const { return std::clamp((value - middle) / reach, -1.0, 1.0); }
};

// Deviations from the mean to both sides.
LaneScale scale_about_mean(const std::vector<double>& series) {
  LaneScale scale{mean(series), 1};
  if (!std::isfinite(scale.middle)) return {};
  std::vector<double> sizes;
  for (const double value : series) sizes.push_back(std::abs(value - scale.middle));
  const double reach = 1.15 * quantile(sizes, 0.998);
  if (reach > 1e-9) scale.reach = reach;
  return scale;
}

// For series that are never negative: 0 is at the lower edge.
LaneScale scale_from_zero(const std::vector<double>& series) {
  const double half = 0.55 * quantile(series, 0.998);
  return half > 1e-9 ? LaneScale{half, half} : LaneScale{1, 1};
}

struct LaneName {
  const char *name, *what;
};

LaneName lane_name(Sense sense) {
  constexpr std::array<LaneName, senses> names = {{{"seen", "slopes in the picture"},
                                                   {"felt", "how the force leans"},
                                                   {"moves", "acceleration"},
                                                   {"heard", "what excites the sound"}}};
  return names[std::size_t(sense)];
}

// Features that the reference's own sound does not tell count for no sound.
bool counts(const FeatureCrossed& feature, Sense sense) {
  return sense != Sense::sound || feature.is_heard;
}

std::string delay_text(const Agreement& agreement, Sense sense) {
  std::vector<double> delays;
  std::size_t count = 0;
  for (const FeatureCrossed& feature : agreement.features) {
    if (!counts(feature, sense)) continue;
    ++count;
    if (const auto delay = feature.delay[std::size_t(sense)]) delays.push_back(1000 * *delay);
  }
  const std::size_t missed = count - delays.size();
  if (count == 0) return "";
  if (delays.empty()) return fmt::format("misses all {}", count);
  const double median = quantile(delays, 0.5);
  const std::string late =
      std::abs(median) < 0.05
          ? "on time"
          : fmt::format("{} ms {}", format_number(std::abs(median), 1), median > 0 ? "late" : "early");
  return missed == 0 ? late : fmt::format("{}, misses {} of {}", late, missed, count);
}

// One lane: its middle is `middle`, its curves reach `half` to both sides.
struct Lane {
  Axis x, y;
  const Traces& traces;
  const Traces::Series& series;
  LaneScale delivered, reference;

  DrawnCurve curve(const std::vector<double>& values, const LaneScale& scale) const {
    const auto at = [&](double seconds) { return (seconds - traces.start) * traces.rate; };
    const auto first = std::size_t(std::max(0.0, std::ceil(at(x.values().low))));
    const auto last = std::min(double(values.size()), std::floor(at(x.values().high)) + 1);
    DrawnCurve curve(x, traces.start + double(first) / traces.rate, 1 / traces.rate);
    for (std::size_t k = first; double(k) < last; ++k) curve.add(scale(values[k]));
    return curve;
  }
  // Height of the delivered curve at a time.
  double at(double seconds) const {
    const double position = std::max(0.0, (seconds - traces.start) * traces.rate);
    const std::size_t k = std::min(std::size_t(std::lround(position)), series.delivered.size() - 1);
    return y(delivered(series.delivered[k]));
  }
};

Lane make_lane(const Traces& traces, Sense sense, const Axis& x, double middle, double half) {
  const Traces::Series& series = *traces.of[std::size_t(sense)];
  const bool is_sound = sense == Sense::sound;
  const LaneScale reference =
      is_sound ? scale_from_zero(series.reference) : scale_about_mean(series.reference);
  // Sound has a unit of its own, all else has the reference's.
  const double level = mean(series.delivered);
  const LaneScale delivered = is_sound ? scale_from_zero(series.delivered)
                                       : LaneScale{std::isfinite(level) ? level : 0, reference.reach};
  return {x, Axis({-1, 1}, {middle + half, middle - half}), traces, series, delivered, reference};
}

void draw_features(SvgPlot& plot, const Lane& lane, const Agreement& agreement, Sense sense,
                   const std::string& family) {
  const Range& shown = lane.x.values();
  const double floor = lane.y(-1) + 5;
  for (const FeatureCrossed& feature : agreement.features) {
    if (feature.time < shown.low || feature.time > shown.high || !counts(feature, sense)) continue;
    const double from = lane.x(feature.time);
    if (const auto delay = feature.delay[std::size_t(sense)]) {
      const double to = lane.x(std::clamp(feature.time + *delay, shown.low, shown.high));
      plot.line(from, floor, to, floor, "late");
      plot.circle(to, lane.at(feature.time + *delay), 3, "mark " + family,
                  fmt::format("{} ms", format_number(1000 * *delay, 1)));
    } else {
      plot.line(from - 4, floor - 4, from + 4, floor + 4, "missed");
      plot.line(from - 4, floor + 4, from + 4, floor - 4, "missed");
    }
  }
}

}  // namespace

std::string trace_plot(const RepresentationResult& result, const Thresholds& thresholds, const Range& seconds,
                       const TracePlotSize& size) {
  const Traces& traces = result.example;
  const Agreement agreement = measure_agreement(traces, thresholds);
  std::vector<Sense> lanes;
  for (std::size_t s = 0; s < senses; ++s)
    if (traces.of[s] && !traces.of[s]->delivered.empty()) lanes.push_back(Sense(s));
  if (lanes.empty()) return "<p class=\"note\">No crossing was recorded.</p>\n";
  constexpr double heading = 24, foot = 26;
  const double lane_height = size.lane + heading, bottom = lane_height * double(lanes.size()) + 6;
  SvgPlot plot(size.width, bottom + foot, "plot traces",
               fmt::format("One crossing, {}", result.candidate.title),
               "The output of each sense over the reference, and where features are crossed");
  const Axis x(seconds, {0, size.width});
  for (const FeatureCrossed& feature : agreement.features)
    if (feature.time >= seconds.low && feature.time <= seconds.high)
      plot.line(x(feature.time), heading, x(feature.time), bottom, "feature");
  const std::string family = family_of(result.candidate);
  for (std::size_t k = 0; k < lanes.size(); ++k) {
    const double top = lane_height * double(k) + heading, half = 0.5 * size.lane - 8;
    const Lane lane = make_lane(traces, lanes[k], x, top + 0.5 * size.lane - 4, half);
    plot.rectangle(0, top - heading + 2, size.width, heading - 2, "behind");
    plot.text(0, top - 8, lane_name(lanes[k]).name, "label");
    if (size.width >= 400) plot.text(46, top - 8, lane_name(lanes[k]).what, "what");
    plot.text(size.width, top - 8, delay_text(agreement, lanes[k]), "label strong", TextAnchor::end);
    plot.curve(lane.y, lane.curve(lane.series.reference, lane.reference), "truth");
    plot.curve(lane.y, lane.curve(lane.series.delivered, lane.delivered), "curve " + family);
    draw_features(plot, lane, agreement, lanes[k], family);
  }
  plot.line(0, bottom, size.width, bottom, "axis");
  const auto ticks = x.ticks(4);
  for (const double tick : ticks) {
    plot.line(x(tick), bottom, x(tick), bottom + 5, "axis");
    const TextAnchor anchor = x(tick) < 20                ? TextAnchor::start
                              : x(tick) > size.width - 20 ? TextAnchor::end
                                                          : TextAnchor::middle;
    plot.text(x(tick), bottom + 20, format_number(tick, 1) + (tick == ticks.front() ? " s" : ""), "tick",
              anchor);
  }
  return plot.finish();
}

}  // namespace intaglio::evaluate
