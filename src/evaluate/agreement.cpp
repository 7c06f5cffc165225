#include "evaluate/agreement.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/portable_math.h"
#include "evaluate/bootstrap.h"
#include "report/percepts.h"

namespace intaglio::evaluate {

namespace {

using report::smoothed;
using report::value_at;
using Series = std::vector<double>;

constexpr double trace_rate = 2000;        // Hz
constexpr double furthest_lag = 0.1;       // s: beyond it an event is another event
constexpr double window = 0.06;            // s, to either side of a feature
constexpr double least_correlation = 0.5;  // below it a feature is missed
constexpr double least_gain = 0.1;         // of the reference's variation
constexpr double prominence = 0.05;        // of the depth
constexpr double least_reach = 0.0025;     // m: half the width of a fingertip's contact
constexpr double alarm_level = 0.3;        // of the strongest excitation

struct PairOfSenses {
  Sense first, second;
  Pair pair;
};
constexpr std::array<PairOfSenses, 3> pen_pairs = {{
    {Sense::picture, Sense::touch, Pair::sight_touch},
    {Sense::touch, Sense::sound, Pair::touch_sound},
    {Sense::picture, Sense::sound, Pair::sight_sound},
}};
// A ball's motion is seen.
constexpr std::array<PairOfSenses, 3> ball_pairs = {{
    {Sense::picture, Sense::motion, Pair::picture_motion},
    {Sense::motion, Sense::sound, Pair::sight_sound},
    {Sense::picture, Sense::sound, Pair::sight_sound},
}};

First first_of(Pair pair, Sense sense) {
  if (sense == Sense::sound) return First::sound;
  if (sense == Sense::touch) return First::touch;
  return pair == Pair::picture_motion ? First::either : First::sight;
}

Series derivative(const Series& series, double rate) {
  Series out(series.size(), 0.0);
  for (std::size_t k = 1; k + 1 < series.size(); ++k) out[k] = 0.5 * rate * (series[k + 1] - series[k - 1]);
  return out;
}

}  // namespace

const char* name_of(Sense sense) {
  constexpr std::array<const char*, senses> names = {"picture", "touch", "motion", "sound"};
  return names[std::size_t(sense)];
}

namespace {

// Indices of the extrema of a series whose prominence, to either side, is at least `least`.
std::vector<std::size_t> extrema(const Series& series, double least) {
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
  const auto ends = std::size_t((window + furthest_lag) * rate), near = std::size_t(0.01 * rate);
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

// Leans along a direction as the picture shows them, and as they are: means over a disc of half the probe's
// radius, because a ball meets the relief beside its middle, too.
std::pair<double, double> seen_around(const Sight& sight, const Reference& truth, const Vec3& place,
                                      const Vec2& direction, double radius) {
  double seen = 0, there = 0;
  constexpr int points = 7;
  for (int k = 0; k < points; ++k) {
    Vec3 at = place;
    if (k > 0) {
      const auto turn = elementary::sin_cos(2 * std::numbers::pi * k / (points - 1));
      at.head<2>() += 0.5 * radius * Vec2(turn.cos, turn.sin);
    }
    seen += lean(sight.slope(at).dot(direction));
    there += lean(truth.slope(at.head<2>()).dot(direction));
  }
  return {seen / points, there / points};
}

struct Delivered {
  std::array<std::optional<Series>, senses> of;
};

Delivered reference_series(const Crossing& reference, const report::Path& path) {
  Delivered out;
  Series change(reference.place.size(), 0.0);
  if (reference.probe == Probe::pen) {
    out.of[std::size_t(Sense::touch)] = report::felt_lean(reference.force, path);
    for (std::size_t k = 1; k < change.size(); ++k)
      change[k] = (reference.force[k] - reference.force[k - 1]).norm() * reference.rate;
  } else {
    out.of[std::size_t(Sense::motion)] = report::acceleration_along(reference.acceleration, path);
    for (std::size_t k = 0; k < change.size(); ++k) change[k] = reference.acceleration[k].norm();
  }
  // Loudness grows less than in proportion.
  for (double& value : change) value = std::sqrt(value);
  out.of[std::size_t(Sense::sound)] = std::move(change);
  return out;
}

}  // namespace

Traces make_traces(const Subject& subject, const Crossing& crossing, const Crossing& reference,
                   const Sight* sight) {
  constexpr double smooth = 0.004;  // s, of directions and speeds
  const report::Path path = report::path_of(crossing.place, crossing.rate, smooth);
  const report::Path true_path = report::path_of(reference.place, reference.rate, smooth);
  Traces out;
  out.probe = crossing.probe;
  out.rate = trace_rate;
  out.start = std::max(crossing.start, reference.start);
  out.hand_scale = subject.hand_scale;
  const double end = std::min(crossing.time(crossing.place.size()), reference.time(reference.place.size()));
  const auto length = std::size_t(std::max(0.0, end - out.start) * trace_rate);
  if (length == 0) return out;
  const auto resampled = [&](const Series& from, double start, double rate) {
    Series to(length);
    for (std::size_t k = 0; k < length; ++k)
      to[k] = value_at(from, (out.start + double(k) / trace_rate - start) * rate);
    return to;
  };
  // The filter: half the probe's radius, in time at its mean speed.
  const double speed = true_path.distance.back() / (double(length) / trace_rate);
  const double sigma = std::clamp(0.5 * crossing.radius / std::max(speed, 1e-3), 0.004, 0.02) * trace_rate;
  Relief relief;
  Series rest, touching;
  for (std::size_t k = 0; k < reference.place.size(); ++k) {
    rest.push_back(subject.reference().rest_on(true_path.place[k], crossing.radius).z);
    touching.push_back(reference.touching[k] ? 1 : 0);
  }
  relief.distance = resampled(true_path.distance, reference.start, reference.rate);
  relief.height = smoothed(resampled(rest, reference.start, reference.rate), sigma);
  relief.touching = resampled(touching, reference.start, reference.rate);
  // The reference at the places of this crossing.
  const Series same = resampled(same_places(crossing, reference, true_path), crossing.start, crossing.rate);
  const double middle = crossing.probe == Probe::ball ? 0.5 : 0;
  const auto at_same = [&](const Series& from, double off = 0) {
    Series to(length);
    for (std::size_t k = 0; k < length; ++k) to[k] = value_at(from, same[k] + off);
    return to;
  };
  out.distance = at_same(true_path.distance);
  for (const std::size_t k : features_of(relief, crossing.radius, subject.reference().depth(), trace_rate)) {
    const double wanted = (out.start + double(k) / trace_rate - reference.start) * reference.rate;
    const auto first = std::find_if(same.begin(), same.end(), [&](double at) { return at >= wanted; });
    if (first != same.end()) out.features.push_back(std::size_t(first - same.begin()));
  }
  Delivered wanted = reference_series(reference, true_path), delivered;
  if (sight != nullptr) {
    // Judged where the probe is drawn, so that its motion's errors are not the picture's.
    Series seen, there;
    for (std::size_t k = 0; k < crossing.place.size(); ++k) {
      const auto [shown, true_lean] =
          seen_around(*sight, subject.reference(), crossing.place[k], path.direction[k], crossing.radius);
      seen.push_back(shown);
      there.push_back(true_lean);
    }
    const auto filtered = [&](const Series& from) {
      return smoothed(resampled(from, crossing.start, crossing.rate), sigma);
    };
    out.of[std::size_t(Sense::picture)] = {filtered(seen), filtered(there)};
  }
  if (crossing.probe == Probe::pen) {
    delivered.of[std::size_t(Sense::touch)] = report::felt_lean(crossing.force, path);
  } else {
    delivered.of[std::size_t(Sense::motion)] = report::acceleration_along(crossing.acceleration, path);
  }
  for (std::size_t s = 0; s < senses; ++s)
    if (delivered.of[s])
      // A step's acceleration belongs in its middle.
      out.of[s] = {
          smoothed(resampled(*delivered.of[s], crossing.start - middle / crossing.rate, crossing.rate),
                   sigma),
          smoothed(at_same(*wanted.of[s], middle), sigma)};
  const double sound_sigma = 0.002 * trace_rate;
  Series excited = report::excitation(crossing.sound, crossing.sample_rate, trace_rate);
  for (double& value : excited) value = std::sqrt(value);
  excited = smoothed(excited, sound_sigma);
  // A value of `excited` is the mean over its time, in whose middle it belongs.
  out.of[std::size_t(Sense::sound)] = {
      resampled(excited, 0.5 / trace_rate, trace_rate),
      smoothed(at_same(*wanted.of[std::size_t(Sense::sound)], middle), sound_sigma)};
  return out;
}

Traces with_fault(const Traces& traces, Sense sense, const StreamFault& fault) {
  Traces out = traces;
  auto& series = out.of[std::size_t(sense)];
  if (!series) return out;
  Series from = series->delivered;
  if (fault.other != nullptr && fault.other->of[std::size_t(sense)])
    from = fault.other->of[std::size_t(sense)]->delivered;
  from.resize(series->delivered.size(), 0.0);
  for (std::size_t k = 0; k < from.size(); ++k) {
    double at = double(k) - fault.delay * traces.rate;
    if (fault.shift != 0 && at >= 0) {
      // The value delivered where the probe was the shift earlier.
      const double wanted = value_at(traces.distance, at) - fault.shift;
      at = double(std::lower_bound(traces.distance.begin(), traces.distance.end(), wanted) -
                  traces.distance.begin());
    }
    series->delivered[k] = fault.off || at < 0 ? 0 : value_at(from, at);
  }
  return out;
}

namespace {

// Pearson's correlation of reference[from..to) with delivered shifted by `lag`; 0 where one does not vary.
double correlation(const Traces::Series& series, std::int64_t from, std::int64_t to, std::int64_t lag) {
  const auto size = std::int64_t(series.reference.size());
  double a = 0, b = 0, aa = 0, bb = 0, ab = 0;
  std::int64_t n = 0;
  for (std::int64_t k = std::max({from, std::int64_t(0), -lag}); k < std::min({to, size, size - lag}); ++k) {
    const double x = series.reference[std::size_t(k)], y = series.delivered[std::size_t(k + lag)];
    a += x, b += y, aa += x * x, bb += y * y, ab += x * y;
    ++n;
  }
  if (n < 8) return 0;
  const double vx = aa - a * a / double(n), vy = bb - b * b / double(n);
  if (!(vx > 1e-12 * double(n)) || !(vy > 1e-12 * double(n))) return 0;
  return (ab - a * b / double(n)) / std::sqrt(vx * vy);
}

// Root mean square of a part about its mean.
double variation(const Series& series, std::int64_t from, std::int64_t to) {
  double sum = 0, squares = 0;
  std::int64_t n = 0;
  for (std::int64_t k = std::max<std::int64_t>(from, 0); k < std::min(to, std::int64_t(series.size())); ++k) {
    sum += series[std::size_t(k)];
    squares += series[std::size_t(k)] * series[std::size_t(k)];
    ++n;
  }
  return n > 0 ? std::sqrt(std::max(0.0, squares / double(n) - sum * sum / double(n * n))) : 0;
}

// The lag of the best correlation within `reach` of `around`, with the vertex of the parabola through it.
struct Lag {
  double values = 0, correlation = 0;
};
Lag best_lag(const Traces::Series& series, std::int64_t from, std::int64_t to, std::int64_t around,
             std::int64_t reach) {
  // If two lags fit equally well, the nearer one is right.
  constexpr double pull = 0.1;
  std::vector<double> at;
  for (std::int64_t lag = around - reach - 1; lag <= around + reach + 1; ++lag) {
    const double off = double(lag - around) / double(reach);
    at.push_back(correlation(series, from, to, lag) - pull * off * off);
  }
  std::size_t best = 1;
  for (std::size_t k = 1; k + 1 < at.size(); ++k)
    if (at[k] > at[best]) best = k;
  const double bend = at[best - 1] - 2 * at[best] + at[best + 1];
  const double vertex = bend < 0 ? std::clamp(0.5 * (at[best - 1] - at[best + 1]) / bend, -0.5, 0.5) : 0;
  const double lag = double(around - reach - 1) + double(best) + vertex,
               off = (lag - double(around)) / double(reach);
  return {lag, at[best] + pull * off * off};
}

// The delay of each feature in one sense. First that of the whole crossing, because a periodic texture would
// match a feature with its neighbour; then that of each feature, around it.
std::vector<std::optional<double>> delays(const Traces& traces, const Traces::Series& series,
                                          const std::vector<std::size_t>& features, bool is_sound) {
  const auto furthest = std::int64_t(furthest_lag * traces.rate);
  const auto length = std::int64_t(series.reference.size());
  const Lag whole = best_lag(series, 0, length, 0, furthest);
  std::vector<std::optional<double>> out;
  const auto half = std::int64_t(window * traces.rate), near = std::int64_t(0.02 * traces.rate);
  for (const std::size_t feature : features) {
    const auto k = std::int64_t(feature);
    const Lag lag = best_lag(series, k - half, k + half, std::int64_t(std::lround(whole.values)), near);
    const auto shift = std::int64_t(std::lround(lag.values));
    const double least = is_sound ? 0 : least_gain * variation(series.reference, k - half, k + half);
    const bool is_delivered = lag.correlation >= least_correlation &&
                              std::abs(lag.values) <= double(furthest) &&
                              variation(series.delivered, k - half + shift, k + half + shift) >= least;
    out.push_back(is_delivered ? std::optional(lag.values / traces.rate) : std::nullopt);
  }
  return out;
}

std::size_t alarms(const Traces& traces, const std::vector<std::size_t>& features) {
  const auto& sound = traces.of[std::size_t(Sense::sound)];
  if (!sound || sound->delivered.empty()) return 0;
  const double strongest = *std::max_element(sound->delivered.begin(), sound->delivered.end());
  if (!(strongest > 0)) return 0;
  std::size_t count = 0;
  const auto reach = furthest_lag * traces.rate;
  for (const std::size_t k : extrema(sound->delivered, alarm_level * strongest)) {
    if (sound->delivered[k] < alarm_level * strongest) continue;
    const bool is_near = std::any_of(features.begin(), features.end(), [&](std::size_t feature) {
      return std::abs(double(feature) - double(k)) <= reach;
    });
    const bool is_inside = double(k) > reach && double(k) + reach < double(sound->delivered.size());
    if (!is_near && is_inside) ++count;
  }
  return count;
}

void add_pair(const Traces& traces, const FeatureCrossed& feature, const PairOfSenses& senses_of,
              const Thresholds& thresholds, PairAgreement& out) {
  const auto a = feature.delay[std::size_t(senses_of.first)];
  const auto b = feature.delay[std::size_t(senses_of.second)];
  if (!a || !b) {
    ++out.missed;
    out.jnd.push_back(missed_jnd);
    return;
  }
  const double dt = *a - *b;
  const auto where = [&](double delay) {
    return value_at(traces.distance, (feature.time + delay - traces.start) * traces.rate);
  };
  const double ds = (where(*a) - where(*b)) / traces.hand_scale;
  const First first = first_of(senses_of.pair, dt < 0 ? senses_of.first : senses_of.second);
  // A picture is late by what its motion is late, and both are drawn at once: only their places can differ.
  const bool is_place_only = senses_of.pair == Pair::picture_motion;
  const double T =
      is_place_only ? std::numeric_limits<double>::infinity() : thresholds.T(senses_of.pair, first);
  out.ms.push_back(1000 * std::abs(dt));
  out.mm.push_back(1000 * std::abs(ds));
  out.jnd.push_back(std::min(jnd(dt, ds, T, thresholds.S(senses_of.pair)), missed_jnd));
}

}  // namespace

Agreement measure_agreement(const Traces& traces, const Thresholds& thresholds) {
  Agreement out;
  const std::vector<std::size_t>& features = traces.features;
  std::array<std::vector<std::optional<double>>, senses> delay;
  for (std::size_t s = 0; s < senses; ++s)
    if (traces.of[s]) delay[s] = delays(traces, *traces.of[s], features, Sense(s) == Sense::sound);
  for (std::size_t k = 0; k < features.size(); ++k) {
    FeatureCrossed& feature = out.features.emplace_back();
    feature.time = traces.start + double(features[k]) / traces.rate;
    feature.distance = traces.distance[features[k]];
    for (std::size_t s = 0; s < senses; ++s)
      if (traces.of[s]) feature.delay[s] = delay[s][k];
  }
  for (const PairOfSenses& pair : traces.probe == Probe::pen ? pen_pairs : ball_pairs) {
    if (!traces.of[std::size_t(pair.first)] || !traces.of[std::size_t(pair.second)]) continue;
    PairAgreement& sum = out.pairs.emplace_back();
    sum.first = pair.first;
    sum.second = pair.second;
    for (const FeatureCrossed& feature : out.features) add_pair(traces, feature, pair, thresholds, sum);
  }
  for (const FeatureCrossed& feature : out.features)
    for (std::size_t s = 0; s < senses; ++s)
      if (traces.of[s] && !feature.delay[s]) ++out.missed;
  out.false_alarms = alarms(traces, features);
  return out;
}

std::vector<double> Agreement::worst() const {
  std::vector<double> out(features.size(), 0.0);
  for (const PairAgreement& pair : pairs)
    for (std::size_t k = 0; k < pair.jnd.size(); ++k) out[k] = std::max(out[k], pair.jnd[k]);
  return out;
}

double Agreement::score() const {
  const std::vector<double> all = worst();
  if (all.empty()) return std::numeric_limits<double>::quiet_NaN();
  return double(std::count_if(all.begin(), all.end(), [](double x) { return x >= 1; })) / double(all.size());
}

double Agreement::mean_jnd() const {
  std::vector<double> all;
  for (const PairAgreement& pair : pairs) all.insert(all.end(), pair.jnd.begin(), pair.jnd.end());
  return mean(all);
}

void append(Agreement& sum, const Agreement& more) {
  sum.features.insert(sum.features.end(), more.features.begin(), more.features.end());
  sum.false_alarms += more.false_alarms;
  sum.missed += more.missed;
  if (sum.pairs.empty()) {
    sum.pairs = more.pairs;
    return;
  }
  for (std::size_t p = 0; p < sum.pairs.size(); ++p) {
    const auto add = [](std::vector<double>& to, const std::vector<double>& from) {
      to.insert(to.end(), from.begin(), from.end());
    };
    add(sum.pairs[p].ms, more.pairs[p].ms);
    add(sum.pairs[p].mm, more.pairs[p].mm);
    add(sum.pairs[p].jnd, more.pairs[p].jnd);
    sum.pairs[p].missed += more.pairs[p].missed;
  }
}

}  // namespace intaglio::evaluate
