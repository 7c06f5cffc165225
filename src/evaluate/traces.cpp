#include "evaluate/traces.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/portable_math.h"
#include "evaluate/delay.h"
#include "report/percepts.h"

namespace intaglio::evaluate {

const char* name_of(Sense sense) {
  constexpr std::array<const char*, senses> names = {"picture", "touch", "motion", "sound"};
  return names[std::size_t(sense)];
}

std::vector<std::size_t> extrema(const std::vector<double>& series, double least) {
  std::vector<std::size_t> found;
  if (series.empty()) return found;
  // Alternating turning points: a new one counts when the series has come back by `least`.
  std::size_t high = 0, low = 0;
  int direction = 0;
  for (std::size_t k = 0; k < series.size(); ++k) {
    if (series[k] > series[high]) high = k;
    if (series[k] < series[low]) low = k;
    if (direction >= 0 && series[high] - series[k] >= least) {
      if (high > 0) found.push_back(high);
      direction = -1;
      low = k;
      high = k;
    } else if (direction <= 0 && series[k] - series[low] >= least) {
      if (low > 0) found.push_back(low);
      direction = 1;
      high = k;
      low = k;
    }
  }
  return found;
}

namespace {

using report::smoothed;
using report::value_at;
using Series = std::vector<double>;

constexpr double trace_rate = 2000;     // Hz
constexpr double border = 0.16;         // s at both ends, without features: a window and the furthest lag
constexpr double prominence = 0.05;     // of the depth
constexpr double least_reach = 0.0025;  // m: half the width of a fingertip's contact
constexpr double heard = 0.5;           // correlation of a sound with what causes it

Series derivative(const Series& series, double rate) {
  Series out(series.size(), 0.0);
  for (std::size_t k = 1; k + 1 < series.size(); ++k) out[k] = 0.5 * rate * (series[k + 1] - series[k - 1]);
  return out;
}

struct Relief {
  Series distance, height;  // m, along the reference's path; filtered at the probe's radius
  Series touching;          // more than 0 where it touches
};

// Values at which the reference's probe crosses a feature.
std::vector<std::size_t> features_of(const Relief& relief, double radius, double depth, double rate) {
  std::vector<std::size_t> found = extrema(relief.height, prominence * depth);
  // A bend counts when the height leaves its tangent by the prominence within a radius.
  const Series speed = derivative(relief.distance, rate);
  const auto by_distance = [&](const Series& of) {
    Series out = derivative(of, rate);
    for (std::size_t k = 0; k < out.size(); ++k) out[k] = speed[k] > 1e-3 ? out[k] / speed[k] : 0;
    return out;
  };
  const double reach = std::max(radius, least_reach);
  for (const std::size_t k :
       extrema(by_distance(by_distance(relief.height)), 2 * prominence * depth / (reach * reach)))
    found.push_back(k);
  std::sort(found.begin(), found.end());
  std::vector<std::size_t> kept;
  const auto ends = std::size_t(border * rate), near = std::size_t(0.01 * rate);
  for (const std::size_t k : found) {
    if (k < ends || k + ends >= relief.distance.size()) continue;
    // One place is one feature.
    if (!kept.empty() && relief.distance[k] - relief.distance[kept.back()] < reach) continue;
    // In flight nothing is crossed.
    const bool touches =
        std::any_of(relief.touching.begin() + std::ptrdiff_t(k - near),
                    relief.touching.begin() + std::ptrdiff_t(k + near), [](double t) { return t > 0; });
    if (touches) kept.push_back(k);
  }
  return kept;
}

// For each value of a crossing's series: the value of the reference's at which its probe is at the same
// place along the path. Where both rest, time goes on.
Series same_places(const Crossing& crossing, const Crossing& reference, const report::Path& true_path) {
  const double seconds = double(reference.place.size()) / reference.rate;
  const double creep = 0.05 * true_path.distance.back() / std::max(seconds, 1e-9);  // m/s
  Series progress = true_path.distance;
  for (std::size_t k = 0; k < progress.size(); ++k) progress[k] += creep * double(k) / reference.rate;
  Series out;
  for (std::size_t k = 0; k < crossing.place.size(); ++k) {
    const double at = (crossing.time(k) - reference.start) * reference.rate;
    const auto now = std::size_t(std::clamp(at, 0.0, double(progress.size() - 1)));
    const Vec2 off = crossing.place[k].head<2>() - true_path.place[now];
    const double wanted = value_at(progress, at) + off.dot(true_path.direction[now]);
    const auto after = std::lower_bound(progress.begin(), progress.end(), wanted);
    if (after == progress.begin() || after == progress.end()) {
      out.push_back(after == progress.begin() ? 0 : double(progress.size() - 1));
      continue;
    }
    const double step = *after - *(after - 1);
    out.push_back(double(after - progress.begin()) - (step > 0 ? (*after - wanted) / step : 0));
  }
  return out;
}

// Slopes as sines of their angles, as force directions are.
double lean(double slope) {
  return slope / std::sqrt(1 + slope * slope);
}

// Leans along a direction as the picture shows them, and as they are (both, without a picture): means over a
// disc of half the probe's radius, because a ball meets the relief beside its middle, too.
std::pair<double, double> seen_around(const Sight* sight, const Reference& truth, const Vec3& place,
                                      const Vec2& direction, double radius) {
  double seen = 0, there = 0;
  constexpr int points = 7;
  for (int k = 0; k < points; ++k) {
    Vec3 at = place;
    if (k > 0) {
      const auto turn = elementary::sin_cos(2 * std::numbers::pi * k / (points - 1));
      at.head<2>() += 0.5 * radius * Vec2(turn.cos, turn.sin);
    }
    const double true_lean = lean(truth.slope(at.head<2>()).dot(direction));
    seen += sight ? lean(sight->slope(at).dot(direction)) : true_lean;
    there += true_lean;
  }
  return {seen / points, there / points};
}

// The lean that a tip of the probe's radius shows where it is drawn: of the mean slope over the tip.
Series lean_under(const Subject& subject, const Crossing& crossing, const report::Path& path) {
  constexpr int rings = 3;
  Series out;
  for (std::size_t k = 0; k < crossing.place.size(); ++k) {
    if (!crossing.touching[k]) {
      out.push_back(0);
      continue;
    }
    Vec2 sum = Vec2::Zero();
    int points = 0;
    for (int i = -rings; i <= rings; ++i)
      for (int j = -rings; j <= rings; ++j) {
        if (i * i + j * j > rings * rings) continue;
        sum += subject.reference().slope(crossing.place[k].head<2>() + crossing.radius / rings * Vec2(i, j));
        ++points;
      }
    out.push_back(lean((sum / points).dot(path.direction[k])));
  }
  return out;
}

// Square roots, because loudness grows less than in proportion.
Series change_of(const Crossing& crossing) {
  Series change(crossing.place.size(), 0.0);
  for (std::size_t k = 1; k < change.size(); ++k)
    change[k] = std::sqrt(crossing.probe == Probe::pen
                              ? (crossing.force[k] - crossing.force[k - 1]).norm() * crossing.rate
                              : crossing.acceleration[k].norm());
  return change;
}

Series excitation_of(const Crossing& crossing) {
  Series excited = report::excitation(crossing.sound, crossing.sample_rate, trace_rate);
  for (double& value : excited) value = std::sqrt(value);
  return excited;
}

// Makes the traces of one crossing.
class TraceMaker {
 public:
  TraceMaker(const Subject& subject, const Crossing& crossing, const Crossing& reference)
      : subject_(subject),
        crossing_(crossing),
        reference_(reference),
        path_(report::path_of(crossing.place, crossing.rate, smooth)),
        true_path_(report::path_of(reference.place, reference.rate, smooth)) {
    out_.probe = crossing.probe;
    out_.rate = trace_rate;
    out_.start = std::max(crossing.start, reference.start);
    out_.hand_scale = subject.hand_scale;
    const double end = std::min(crossing.time(crossing.place.size()), reference.time(reference.place.size()));
    length_ = std::size_t(std::max(0.0, end - out_.start) * trace_rate);
  }

  Traces make(const Sight* sight, bool sees_truth) {
    if (length_ == 0) return out_;
    // The filter: half the probe's radius, in time at its mean speed.
    const double speed = true_path_.distance.back() / (double(length_) / trace_rate);
    sigma_ = std::clamp(0.5 * crossing_.radius / std::max(speed, 1e-3), 0.004, 0.02) * trace_rate;
    same_ = resampled(same_places(crossing_, reference_, true_path_), crossing_.start, crossing_.rate);
    out_.distance = at_same(true_path_.distance);
    find_features();
    if (sight != nullptr || sees_truth) add_picture(sight);
    crossing_.probe == Probe::pen ? add_touch() : add_motion();
    add_sound();
    return out_;
  }

 private:
  static constexpr double smooth = 0.004;                    // s, of directions and speeds
  static constexpr double sound_sigma = 0.002 * trace_rate;  // values

  Series resampled(const Series& from, double start, double rate) const {
    Series to(length_);
    for (std::size_t k = 0; k < length_; ++k)
      to[k] = value_at(from, (out_.start + double(k) / trace_rate - start) * rate);
    return to;
  }
  // The reference's values at the places of this crossing. A ball's step is centred in its middle.
  Series at_same(const Series& from, double off = 0) const {
    Series to(length_);
    for (std::size_t k = 0; k < length_; ++k) to[k] = value_at(from, same_[k] + off);
    return to;
  }
  double middle() const { return crossing_.probe == Probe::ball ? 0.5 : 0; }
  Series filtered(const Series& from) const {
    return smoothed(resampled(from, crossing_.start, crossing_.rate), sigma_);
  }

  void find_features() {
    Relief relief;
    Series rest, touching;
    for (std::size_t k = 0; k < reference_.place.size(); ++k) {
      rest.push_back(subject_.reference().rest_on(true_path_.place[k], crossing_.radius).z);
      touching.push_back(reference_.touching[k] ? 1 : 0);
    }
    relief.distance = resampled(true_path_.distance, reference_.start, reference_.rate);
    relief.height = smoothed(resampled(rest, reference_.start, reference_.rate), sigma_);
    relief.touching = resampled(touching, reference_.start, reference_.rate);
    // Whether they are heard is asked on the reference's own time.
    const Series change = smoothed(
        resampled(change_of(reference_), reference_.start - middle() / reference_.rate, reference_.rate),
        sound_sigma);
    const Series excited =
        smoothed(resampled(excitation_of(reference_), 0.5 / trace_rate, trace_rate), sound_sigma);
    const auto half = std::int64_t(0.06 * trace_rate), near = std::int64_t(0.01 * trace_rate);
    for (const std::size_t k :
         features_of(relief, crossing_.radius, subject_.reference().depth(), trace_rate)) {
      const double wanted = (out_.start + double(k) / trace_rate - reference_.start) * reference_.rate;
      const auto first = std::find_if(same_.begin(), same_.end(), [&](double at) { return at >= wanted; });
      if (first == same_.end()) continue;
      out_.features.push_back(std::size_t(first - same_.begin()));
      const auto at = std::int64_t(k);
      out_.is_heard.push_back(best_lag(change, excited, at - half, at + half, 0, near).correlation >= heard);
    }
  }

  void add_picture(const Sight* sight) {
    Series seen, there;
    for (std::size_t k = 0; k < crossing_.place.size(); ++k) {
      const auto [shown, true_lean] =
          seen_around(sight, subject_.reference(), crossing_.place[k], path_.direction[k], crossing_.radius);
      seen.push_back(shown);
      there.push_back(true_lean);
    }
    out_.of[std::size_t(Sense::picture)] = {filtered(seen), filtered(there)};
  }

  void add_touch() {
    Traces::Series series{filtered(report::felt_lean(crossing_.force, path_)),
                          filtered(lean_under(subject_, crossing_, path_))};
    series.change = smoothed(resampled(change_of(crossing_), crossing_.start, crossing_.rate), sound_sigma);
    out_.of[std::size_t(Sense::touch)] = std::move(series);
  }

  void add_motion() {
    const double start = crossing_.start - middle() / crossing_.rate;
    Traces::Series series{
        smoothed(resampled(report::acceleration_along(crossing_.acceleration, path_), start, crossing_.rate),
                 sigma_),
        smoothed(at_same(report::acceleration_along(reference_.acceleration, true_path_), middle()), sigma_)};
    series.change = smoothed(resampled(change_of(crossing_), start, crossing_.rate), sound_sigma);
    out_.of[std::size_t(Sense::motion)] = std::move(series);
  }

  void add_sound() {
    // A value of the excitation is the mean over its time, in whose middle it belongs.
    out_.of[std::size_t(Sense::sound)] = {
        smoothed(resampled(excitation_of(crossing_), 0.5 / trace_rate, trace_rate), sound_sigma),
        smoothed(at_same(change_of(reference_), middle()), sound_sigma)};
  }

  const Subject& subject_;
  const Crossing& crossing_;
  const Crossing& reference_;
  report::Path path_, true_path_;
  std::size_t length_ = 0;
  double sigma_ = 0;  // values
  Series same_;       // places of the reference's series
  Traces out_;
};

}  // namespace

Traces make_traces(const Subject& subject, const Crossing& crossing, const Crossing& reference,
                   const Sight* sight) {
  return TraceMaker(subject, crossing, reference).make(sight, false);
}

Traces reference_traces(const Subject& subject, const Crossing& reference) {
  return TraceMaker(subject, reference, reference).make(nullptr, true);
}

Traces with_fault(const Traces& traces, Sense sense, const StreamFault& fault) {
  Traces out = traces;
  auto& series = out.of[std::size_t(sense)];
  if (!series) return out;
  const Traces::Series* from = &*traces.of[std::size_t(sense)];
  if (fault.other != nullptr && fault.other->of[std::size_t(sense)])
    from = &*fault.other->of[std::size_t(sense)];
  for (std::size_t k = 0; k < series->delivered.size(); ++k) {
    double at = double(k) - fault.delay * traces.rate;
    if (fault.shift != 0 && at >= 0) {
      // The value delivered where the probe was the shift earlier.
      const double wanted = value_at(traces.distance, at) - fault.shift;
      at = double(std::lower_bound(traces.distance.begin(), traces.distance.end(), wanted) -
                  traces.distance.begin());
    }
    const bool is_silent = fault.off || at < 0;
    series->delivered[k] = is_silent ? 0 : value_at(from->delivered, at);
    if (!series->change.empty()) series->change[k] = is_silent ? 0 : value_at(from->change, at);
  }
  return out;
}

}  // namespace intaglio::evaluate
