#include "evaluate/sound_events.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "core/bootstrap.h"
#include "report/onsets.h"
#include "report/percepts.h"

namespace intaglio::evaluate {

namespace {

constexpr double match_within = 0.025;    // s
constexpr double impulse_rate = 1000;     // Hz
constexpr std::size_t impulse_apart = 4;  // values

std::vector<double> onsets_of(std::span<const float> sound, double rate) {
  report::OnsetFinder finder(rate);
  for (const float sample : sound) finder.add(sample);
  return finder.onsets(finder.stride());
}

std::vector<double> intervals_of(std::span<const double> times) {
  std::vector<double> out;
  for (std::size_t k = 1; k < times.size(); ++k) out.push_back(times[k] - times[k - 1]);
  return out;
}

}  // namespace

OnsetMatch match_times(std::span<const double> times, std::span<const double> wanted) {
  std::vector<std::tuple<double, std::size_t, std::size_t>> pairs;
  for (std::size_t a = 0; a < times.size(); ++a)
    for (std::size_t b = 0; b < wanted.size(); ++b)
      if (const double apart = std::abs(times[a] - wanted[b]); apart <= match_within)
        pairs.emplace_back(apart, a, b);
  std::sort(pairs.begin(), pairs.end());
  std::vector<bool> used(times.size()), found(wanted.size());
  OnsetMatch out;
  out.wanted = wanted.size();
  for (const auto& [apart, a, b] : pairs) {
    if (used[a] || found[b]) continue;
    used[a] = found[b] = true;
    out.late_ms.push_back(1000 * (times[a] - wanted[b]));
  }
  out.missed = wanted.size() - out.late_ms.size();
  out.false_alarms = times.size() - out.late_ms.size();
  return out;
}

OnsetMatch match_onsets(std::span<const float> sound, std::span<const float> reference, double rate) {
  return match_times(onsets_of(sound, rate), onsets_of(reference, rate));
}

std::vector<double> impulses(std::span<const float> sound, double rate) {
  const std::vector<double> series = report::excitation(sound, rate, impulse_rate);
  if (series.empty()) return {};
  const double least = 0.2 * quantile(series, 0.98);
  std::vector<double> out;
  for (std::size_t k = 0; k < series.size(); ++k) {
    if (!(series[k] > least)) continue;
    const std::size_t from = k >= impulse_apart ? k - impulse_apart : 0;
    const std::size_t to = std::min(series.size(), k + impulse_apart + 1);
    bool is_peak = true;
    for (std::size_t j = from; j < to && is_peak; ++j)
      is_peak = j < k ? series[j] < series[k] : series[j] <= series[k];
    if (is_peak) out.push_back(double(k) / impulse_rate);
  }
  return out;
}

double interval_distance(std::span<const double> one, std::span<const double> other) {
  if (one.size() < 3 || other.size() < 3) return std::numeric_limits<double>::quiet_NaN();
  std::vector<double> a = intervals_of(one), b = intervals_of(other);
  std::sort(a.begin(), a.end());
  std::sort(b.begin(), b.end());
  constexpr int quantiles = 200;
  double sum = 0;
  for (int k = 0; k < quantiles; ++k) {
    const double share = (k + 0.5) / quantiles;
    sum += std::abs(a[std::size_t(share * double(a.size()))] - b[std::size_t(share * double(b.size()))]);
  }
  return 1000 * sum / quantiles;
}

}  // namespace intaglio::evaluate
