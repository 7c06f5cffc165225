#include "study/statistics/sample.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/bootstrap.h"
#include "study/statistics/distributions.h"

namespace intaglio::statistics {
namespace {

Error infinite_value(const std::string& what, std::size_t index) {
  return {what, fmt::format("value {} is infinite", index + 1),
          "give finite values, and not a number for a missing one"};
}

double mean_of(const std::vector<double>& values) {
  const double first = mean(values);
  double rest = 0;
  for (const double value : values) rest += value - first;
  return first + rest / double(values.size());
}

}  // namespace

Result<Sample> observed(std::span<const double> values, const std::string& what) {
  Sample sample;
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (std::isinf(values[k])) return tl::unexpected(infinite_value(what, k));
    if (std::isnan(values[k]))
      ++sample.missing;
    else
      sample.values.push_back(values[k]);
  }
  if (sample.values.empty())
    return fail(what, fmt::format("has no value ({} are missing)", sample.missing), "give at least one");
  return sample;
}

Summary summary_of(const Sample& sample) {
  const std::vector<double>& values = sample.values;
  Summary result{values.size(), sample.missing, undefined, undefined};
  if (values.empty()) return result;
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  // Rounding would give equal values a deviation of some 1e-17, and a t of 1e17.
  result.mean = *least == *most ? *least : mean_of(values);
  if (values.size() < 2) return result;
  double squares = 0;
  for (const double value : values) squares += (value - result.mean) * (value - result.mean);
  result.sd = std::sqrt(squares / double(values.size() - 1));
  return result;
}

Result<Summary> summary(std::span<const double> values, const std::string& what) {
  const auto sample = observed(values, what);
  if (!sample) return tl::unexpected(sample.error());
  return summary_of(*sample);
}

Result<Pairs> complete_pairs(std::span<const double> first, std::span<const double> second,
                             const std::string& what) {
  if (first.size() != second.size())
    return fail(what, fmt::format("has {} first and {} second values", first.size(), second.size()),
                "give as many of each, and not a number for a missing one");
  Pairs pairs;
  for (std::size_t k = 0; k < first.size(); ++k) {
    if (std::isinf(first[k]) || std::isinf(second[k])) return tl::unexpected(infinite_value(what, k));
    if (std::isnan(first[k]) || std::isnan(second[k])) {
      ++pairs.missing;
      continue;
    }
    pairs.first.push_back(first[k]);
    pairs.second.push_back(second[k]);
    pairs.differences.push_back(first[k] - second[k]);
  }
  if (pairs.first.empty())
    return fail(what, fmt::format("has no complete pair ({} are missing)", pairs.missing),
                "give at least one");
  return pairs;
}

double correlation(std::span<const double> first, std::span<const double> second) {
  if (first.size() != second.size() || first.size() < 2) return undefined;
  const Summary a = summary_of({{first.begin(), first.end()}, 0});
  const Summary b = summary_of({{second.begin(), second.end()}, 0});
  double products = 0;
  for (std::size_t k = 0; k < first.size(); ++k) products += (first[k] - a.mean) * (second[k] - b.mean);
  if (a.sd == 0 || b.sd == 0) return undefined;
  return products / (double(first.size() - 1) * a.sd * b.sd);
}

}  // namespace intaglio::statistics
