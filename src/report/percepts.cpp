#include "report/percepts.h"

#include <algorithm>
#include <cmath>

#include "core/portable_math.h"

namespace intaglio::report {

Path path_of(std::span<const Vec3> points, double rate, double smooth) {
  Path path;
  const auto n = std::int64_t(points.size());
  const auto half = std::max<std::int64_t>(1, std::int64_t(std::lround(0.5 * smooth * rate)));
  Vec2 direction = Vec2::UnitX();
  double distance = 0;
  for (std::int64_t k = 0; k < n; ++k) {
    const auto at = [&](std::int64_t i) {
      return Vec2(points[std::size_t(std::clamp<std::int64_t>(i, 0, n - 1))].head<2>());
    };
    const std::int64_t from = std::max<std::int64_t>(0, k - half), to = std::min(n - 1, k + half);
    const Vec2 step = at(to) - at(from);
    const double seconds = double(to - from) / rate;
    if (step.norm() > 1e-9) direction = step.normalized();
    if (k > 0) distance += (at(k) - at(k - 1)).norm();
    path.place.push_back(at(k));
    path.direction.push_back(direction);
    path.distance.push_back(distance);
    path.speed.push_back(seconds > 0 ? step.norm() / seconds : 0);
  }
  return path;
}

std::vector<double> felt_lean(std::span<const Vec3> force, const Path& path, double least) {
  std::vector<double> lean;
  lean.reserve(force.size());
  for (std::size_t k = 0; k < force.size(); ++k) {
    const Vec3& f = force[k];
    lean.push_back(f.norm() < least ? 0 : -f.head<2>().dot(path.direction[k]) / f.norm());
  }
  return lean;
}

std::vector<double> acceleration_along(std::span<const Vec3> acceleration, const Path& path) {
  std::vector<double> out;
  out.reserve(acceleration.size());
  for (std::size_t k = 0; k < acceleration.size(); ++k)
    out.push_back(acceleration[k].head<2>().dot(path.direction[k]));
  return out;
}

namespace {

// Coefficients a of the prediction x[n] = sum a[k] x[n - 1 - k], by autocorrelation and Levinson's recursion.
std::vector<double> prediction(std::span<const float> x, std::size_t order) {
  std::vector<double> r(order + 1, 0.0);
  for (std::size_t lag = 0; lag <= order; ++lag)
    for (std::size_t n = lag; n < x.size(); ++n) r[lag] += double(x[n]) * double(x[n - lag]);
  std::vector<double> a(order, 0.0), before;
  double error = r[0] * (1 + 1e-9);
  if (!(error > 0)) return a;
  for (std::size_t k = 0; k < order; ++k) {
    double sum = r[k + 1];
    for (std::size_t i = 0; i < k; ++i) sum -= a[i] * r[k - i];
    const double reflection = sum / error;
    before.assign(a.begin(), a.begin() + std::ptrdiff_t(k));
    a[k] = reflection;
    for (std::size_t i = 0; i < k; ++i) a[i] = before[i] - reflection * before[k - 1 - i];
    error *= 1 - reflection * reflection;
  }
  return a;
}

}  // namespace

std::vector<double> excitation(std::span<const float> sound, double sample_rate, double rate) {
  constexpr std::size_t order = 48;
  const std::vector<double> a = prediction(sound, order);
  std::vector<double> power(std::size_t(double(sound.size()) / sample_rate * rate) + 1, 0.0);
  std::vector<std::size_t> count(power.size(), 0);
  for (std::size_t n = 0; n < sound.size(); ++n) {
    double left = double(sound[n]);
    for (std::size_t k = 0; k < std::min(order, n); ++k) left -= a[k] * double(sound[n - 1 - k]);
    const auto bin = std::size_t(double(n) / sample_rate * rate);
    power[bin] += left * left;
    ++count[bin];
  }
  for (std::size_t k = 0; k < power.size(); ++k)
    power[k] = count[k] > 0 ? std::sqrt(power[k] / double(count[k])) : 0;
  return power;
}

std::vector<double> smoothed(std::span<const double> series, double sigma) {
  std::vector<double> out(series.begin(), series.end());
  if (!(sigma > 0) || series.empty()) return out;
  const auto reach = std::int64_t(std::ceil(4 * sigma));
  std::vector<double> weight;
  double sum = 0;
  for (std::int64_t k = -reach; k <= reach; ++k) {
    weight.push_back(elementary::exp(-0.5 * double(k * k) / (sigma * sigma)));
    sum += weight.back();
  }
  const auto n = std::int64_t(series.size());
  for (std::int64_t k = 0; k < n; ++k) {
    double value = 0;
    for (std::int64_t i = -reach; i <= reach; ++i)
      value +=
          weight[std::size_t(i + reach)] * series[std::size_t(std::clamp<std::int64_t>(k + i, 0, n - 1))];
    out[std::size_t(k)] = value / sum;
  }
  return out;
}

double value_at(std::span<const double> series, double position) {
  if (series.empty()) return 0;
  const double clamped = std::clamp(position, 0.0, double(series.size() - 1));
  const auto k = std::size_t(clamped);
  if (k + 1 >= series.size()) return series.back();
  const double f = clamped - double(k);
  return (1 - f) * series[k] + f * series[k + 1];
}

}  // namespace intaglio::report
