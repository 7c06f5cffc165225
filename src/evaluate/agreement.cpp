#include "evaluate/agreement.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/bootstrap.h"
#include "evaluate/delay.h"
#include "report/percepts.h"

namespace intaglio::evaluate {

namespace {

using report::value_at;
using Series = std::vector<double>;

constexpr double furthest_lag = 0.1;       // s: beyond it an event is another event
constexpr double window = 0.06;            // s, to either side of a feature
constexpr double nearest = 0.02;           // s: a single delay's greatest distance from the crossing's
constexpr double least_correlation = 0.5;  // below it a feature is missed
constexpr double least_gain = 0.1;         // of the reference's variation
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

// One sense's delay and error of place at each feature.
struct Told {
  std::vector<std::optional<double>> delay;  // s
  std::vector<double> displaced;             // m
};

// Measures the delays of one crossing's senses.
class Delays {
 public:
  Delays(const Traces& traces) : traces_(traces), length_(std::int64_t(traces.distance.size())) {}

  Told of(Sense sense) const {
    if (sense == Sense::picture) return picture();
    if (sense == Sense::sound) return sound();
    return from_reference(*traces_.of[std::size_t(sense)], false);
  }

 private:
  std::int64_t values(double seconds) const { return std::int64_t(seconds * traces_.rate); }
  std::int64_t feature(std::size_t k) const { return std::int64_t(traces_.features[k]); }

  // The delay of the whole crossing first, because a periodic texture would match a feature with its
  // neighbour; then those of the features, around it.
  std::vector<Lag> lags(const Series& reference, const Series& delivered, double& whole) const {
    whole = best_lag(reference, delivered, 0, length_, 0, values(furthest_lag)).values;
    std::vector<Lag> out;
    for (std::size_t k = 0; k < traces_.features.size(); ++k)
      out.push_back(best_lag(reference, delivered, feature(k) - values(window), feature(k) + values(window),
                             std::lround(whole), values(nearest)));
    return out;
  }

  bool is_told(const Traces::Series& series, const Lag& lag, std::int64_t at, bool is_sound) const {
    const std::int64_t half = values(window), shift = std::lround(lag.values);
    const double least = is_sound ? 0 : least_gain * variation(series.reference, at - half, at + half);
    return lag.correlation >= least_correlation && std::abs(lag.values) <= double(values(furthest_lag)) &&
           variation(series.delivered, at - half + shift, at + half + shift) >= least;
  }

  Told from_reference(const Traces::Series& series, bool is_sound) const {
    double whole = 0;
    const std::vector<Lag> found = lags(series.reference, series.delivered, whole);
    Told out;
    std::vector<Lag> told;
    for (std::size_t k = 0; k < found.size(); ++k)
      if (is_told(series, found[k], feature(k), is_sound)) told.push_back(found[k]);
    const std::vector<double> drawn = drawn_together(told, whole);
    auto next = drawn.begin();
    for (std::size_t k = 0; k < found.size(); ++k)
      out.delay.push_back(is_told(series, found[k], feature(k), is_sound)
                              ? std::optional(*next++ / traces_.rate)
                              : std::nullopt);
    return out;
  }

  // One delay, and for each feature the error of place that is left, by the same series over the way.
  Told picture() const {
    const Traces::Series& series = *traces_.of[std::size_t(Sense::picture)];
    const double whole =
        best_lag(series.reference, series.delivered, 0, length_, 0, values(furthest_lag)).values;
    const double step = traces_.distance.back() / double(std::max<std::int64_t>(1, length_));
    Told out;
    std::vector<Lag> told;
    for (std::size_t k = 0; k < traces_.features.size(); ++k) {
      const Lag lag = lag_of_place(series, whole, feature(k), step);
      const std::int64_t half = values(window), shift = std::lround(whole);
      const bool is_shown =
          lag.correlation >= least_correlation &&
          variation(series.delivered, feature(k) - half + shift, feature(k) + half + shift) >=
              least_gain * variation(series.reference, feature(k) - half, feature(k) + half);
      out.delay.push_back(is_shown ? std::optional(whole / traces_.rate) : std::nullopt);
      if (is_shown) told.push_back(lag);
    }
    const std::vector<double> drawn = drawn_together(told, 0);
    auto next = drawn.begin();
    for (const auto& delay : out.delay) out.displaced.push_back(delay ? *next++ * step : 0);
    return out;
  }

  // Steps of the way by which a picture that is `whole` values late has what is at a value farther on.
  Lag lag_of_place(const Traces::Series& series, double whole, std::int64_t at, double step) const {
    const double reach = window * traces_.rate * step, near = nearest * traces_.rate * step;
    const auto half = std::int64_t((reach + near) / step) + 2;
    Series reference, delivered;
    const double middle = traces_.distance[std::size_t(at)];
    for (std::int64_t k = -half; k <= half; ++k) {
      const auto after =
          std::lower_bound(traces_.distance.begin(), traces_.distance.end(), middle + double(k) * step);
      const auto place = double(std::min(after - traces_.distance.begin(), length_ - 1));
      reference.push_back(value_at(series.reference, place));
      delivered.push_back(value_at(series.delivered, place + whole));
    }
    return best_lag(reference, delivered, half - values(window), half + values(window), 0, values(nearest));
  }

  Told sound() const {
    const Traces::Series& series = *traces_.of[std::size_t(Sense::sound)];
    Told out = from_reference(series, true);
    const Sense cause = traces_.probe == Probe::pen ? Sense::touch : Sense::motion;
    const auto& moved = traces_.of[std::size_t(cause)];
    if (!moved || moved->change.empty()) return out;
    double whole = 0;
    const std::vector<Lag> found = lags(moved->change, series.delivered, whole);
    const Told of_cause = from_reference(*moved, false);
    std::vector<Lag> told;
    std::vector<std::size_t> which;
    for (std::size_t k = 0; k < found.size(); ++k) {
      // The cause says when, not whether: a sound may follow a force that is wrong.
      if (!out.delay[k] || !of_cause.delay[k] || !is_told(series, found[k], feature(k), true)) continue;
      told.push_back(found[k]);
      which.push_back(k);
    }
    const std::vector<double> drawn = drawn_together(told, whole);
    for (std::size_t k = 0; k < which.size(); ++k)
      out.delay[which[k]] = drawn[k] / traces_.rate + *of_cause.delay[which[k]];
    return out;
  }

  const Traces& traces_;
  std::int64_t length_;
};

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

// Takes the feature's displacement as part of the picture's place.
void add_pair(const Traces& traces, FeatureCrossed& feature, const PairOfSenses& senses_of,
              const Thresholds& thresholds, PairAgreement& out) {
  if (!feature.is_heard && senses_of.second == Sense::sound) return;
  const auto a = feature.delay[std::size_t(senses_of.first)];
  const auto b = feature.delay[std::size_t(senses_of.second)];
  if (!a || !b) {
    ++out.missed;
    out.jnd.push_back(missed_jnd);
    feature.worst = missed_jnd;
    return;
  }
  const double dt = *a - *b;
  const auto where = [&](double delay) {
    return value_at(traces.distance, (feature.time + delay - traces.start) * traces.rate);
  };
  const double displaced = senses_of.first == Sense::picture ? feature.displaced : 0;
  const double ds = (where(*a) - where(*b) + displaced) / traces.hand_scale;
  const First first = first_of(senses_of.pair, dt < 0 ? senses_of.first : senses_of.second);
  // A picture is late by what its motion is late, and both are drawn at once: only their places can differ.
  const bool is_place_only = senses_of.pair == Pair::picture_motion;
  const double T =
      is_place_only ? std::numeric_limits<double>::infinity() : thresholds.T(senses_of.pair, first);
  out.ms.push_back(1000 * std::abs(dt));
  out.mm.push_back(1000 * std::abs(ds));
  out.jnd.push_back(std::min(jnd(dt, ds, T, thresholds.S(senses_of.pair)), missed_jnd));
  feature.worst = std::max(feature.worst, out.jnd.back());
}

}  // namespace

Agreement measure_agreement(const Traces& traces, const Thresholds& thresholds) {
  Agreement out;
  const std::vector<std::size_t>& features = traces.features;
  const Delays delays(traces);
  std::array<Told, senses> told;
  for (std::size_t s = 0; s < senses; ++s)
    if (traces.of[s]) told[s] = delays.of(Sense(s));
  for (std::size_t k = 0; k < features.size(); ++k) {
    FeatureCrossed& feature = out.features.emplace_back();
    feature.time = traces.start + double(features[k]) / traces.rate;
    feature.distance = traces.distance[features[k]];
    feature.is_heard = traces.is_heard.empty() || traces.is_heard[k];
    for (std::size_t s = 0; s < senses; ++s)
      if (traces.of[s]) feature.delay[s] = told[s].delay[k];
    const auto& displaced = told[std::size_t(Sense::picture)].displaced;
    if (!displaced.empty()) feature.displaced = displaced[k];
  }
  for (const PairOfSenses& pair : traces.probe == Probe::pen ? pen_pairs : ball_pairs) {
    if (!traces.of[std::size_t(pair.first)] || !traces.of[std::size_t(pair.second)]) continue;
    PairAgreement& sum = out.pairs.emplace_back();
    sum.first = pair.first;
    sum.second = pair.second;
    for (FeatureCrossed& feature : out.features) add_pair(traces, feature, pair, thresholds, sum);
  }
  for (const FeatureCrossed& feature : out.features)
    for (std::size_t s = 0; s < senses; ++s)
      if (traces.of[s] && !feature.delay[s] && (Sense(s) != Sense::sound || feature.is_heard)) ++out.missed;
  out.false_alarms = alarms(traces, features);
  return out;
}

double Agreement::score() const {
  if (features.empty()) return std::numeric_limits<double>::quiet_NaN();
  return double(std::count_if(features.begin(), features.end(), [](const auto& f) { return f.worst >= 1; })) /
         double(features.size());
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
