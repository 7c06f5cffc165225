#include "evaluate/delay.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace intaglio::evaluate {

namespace {

// Sums over reference[k] = x and delivered[k + lag] = y.
struct Pairs {
  std::int64_t from, to;
  double mean_x = 0, mean_y = 0, xx = 0, yy = 0, xy = 0;

  Pairs(std::span<const double> reference, std::span<const double> delivered, std::int64_t first,
        std::int64_t last, std::int64_t lag) {
    const auto size = std::int64_t(reference.size()), other = std::int64_t(delivered.size());
    from = std::max({first, std::int64_t(0), -lag});
    to = std::min({last, size, other - lag});
    double a = 0, b = 0, aa = 0, bb = 0, ab = 0;
    for (std::int64_t k = from; k < to; ++k) {
      const double x = reference[std::size_t(k)], y = delivered[std::size_t(k + lag)];
      a += x, b += y, aa += x * x, bb += y * y, ab += x * y;
    }
    const double n = std::max(1.0, double(to - from));
    mean_x = a / n, mean_y = b / n;
    xx = aa - a * a / n, yy = bb - b * b / n, xy = ab - a * b / n;
  }
  std::int64_t count() const { return to - from; }
  // 0 where one does not vary.
  double correlation() const {
    const double least = 1e-12 * double(count());
    return count() >= 8 && xx > least && yy > least ? xy / std::sqrt(xx * yy) : 0;
  }
};

double standard_error(std::span<const double> reference, std::span<const double> delivered,
                      std::int64_t first, std::int64_t last, std::int64_t lag) {
  const Pairs pairs(reference, delivered, first, last, lag);
  if (pairs.correlation() <= 0) return std::numeric_limits<double>::infinity();
  const double gain = pairs.xy / pairs.xx;
  std::vector<double> slope, pull;
  double bend = 0;
  for (std::int64_t k = std::max<std::int64_t>(pairs.from, 1);
       k < std::min(pairs.to, std::int64_t(reference.size()) - 1); ++k) {
    const double dx = 0.5 * (reference[std::size_t(k + 1)] - reference[std::size_t(k - 1)]);
    const double left =
        delivered[std::size_t(k + lag)] - pairs.mean_y - gain * (reference[std::size_t(k)] - pairs.mean_x);
    bend += dx * dx;
    pull.push_back(dx * left);
  }
  if (!(bend > 0)) return std::numeric_limits<double>::infinity();
  // Bartlett's weights, over a quarter of the part.
  const auto n = std::int64_t(pull.size()), width = std::max<std::int64_t>(1, n / 4);
  double variance = 0;
  for (std::int64_t off = 0; off < width; ++off) {
    double sum = 0;
    for (std::int64_t k = 0; k + off < n; ++k) sum += pull[std::size_t(k)] * pull[std::size_t(k + off)];
    variance += (off == 0 ? 1 : 2) * (1 - double(off) / double(width)) * sum;
  }
  return std::sqrt(std::max(variance, 0.0)) / (gain * bend);
}

}  // namespace

Lag best_lag(std::span<const double> reference, std::span<const double> delivered, std::int64_t from,
             std::int64_t to, std::int64_t around, std::int64_t reach) {
  constexpr double pull = 0.1;
  const std::int64_t first = around - reach - 1;
  std::vector<double> at;
  for (std::int64_t lag = first; lag <= around + reach + 1; ++lag)
    at.push_back(Pairs(reference, delivered, from, to, lag).correlation());
  const auto preferred = [&](std::size_t k) {
    const double off = double(first + std::int64_t(k) - around) / double(reach);
    return at[k] - pull * off * off;
  };
  std::size_t best = 1;
  for (std::size_t k = 1; k + 1 < at.size(); ++k)
    if (preferred(k) > preferred(best)) best = k;
  // The preference may have stopped short of the peak by a value or two.
  for (int step = 0; step < 2; ++step) {
    if (best + 2 < at.size() && at[best + 1] > at[best]) ++best;
    if (best > 1 && at[best - 1] > at[best]) --best;
  }
  const double bend = at[best - 1] - 2 * at[best] + at[best + 1];
  const double vertex = bend < 0 ? std::clamp(0.5 * (at[best - 1] - at[best + 1]) / bend, -0.5, 0.5) : 0;
  return {double(first) + double(best) + vertex, at[best],
          standard_error(reference, delivered, from, to, first + std::int64_t(best))};
}

std::vector<double> drawn_together(std::span<const Lag> lags, double common) {
  // The spread by moments, each lag weighted by how surely it is known.
  double weights = 0, squares = 0, errors = 0;
  for (const Lag& lag : lags) {
    if (!std::isfinite(lag.error)) continue;
    const double off = lag.values - common, weight = 1 / (1 + lag.error * lag.error);
    weights += weight;
    squares += weight * off * off;
    errors += weight * lag.error * lag.error;
  }
  const double spread = weights > 0 ? std::max(0.0, (squares - errors) / weights) : 0;
  std::vector<double> out;
  for (const Lag& lag : lags) {
    const double whole = spread + lag.error * lag.error;
    out.push_back(whole > 0 && std::isfinite(whole) ? common + spread / whole * (lag.values - common)
                                                    : (std::isfinite(whole) ? lag.values : common));
  }
  return out;
}

}  // namespace intaglio::evaluate
