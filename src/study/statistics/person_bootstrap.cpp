#include "study/statistics/person_bootstrap.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <numeric>
#include <vector>

#include "core/portable_math.h"
#include "study/statistics/distributions.h"

namespace intaglio::statistics {
namespace {

constexpr const char* bootstrap_name = "bootstrap over persons";

}  // namespace

Result<PersonBootstrap> bootstrap_persons(std::size_t persons, const PersonStatistic& statistic,
                                          const BootstrapOptions& options) {
  if (persons == 0) return fail(bootstrap_name, "there is no person", "give at least one");
  if (options.resamples < 1 || !(options.level > 0 && options.level < 1))
    return fail(bootstrap_name, fmt::format("{} draws for a level of {}", options.resamples, options.level),
                "there is at least 1 draw, and a level lies between 0 and 1");
  std::vector<std::size_t> drawn(persons);
  std::iota(drawn.begin(), drawn.end(), std::size_t{0});
  PersonBootstrap out{statistic(drawn), {undefined, undefined}, persons, 0, ""};
  if (persons < 2) {
    out.note = "one person says nothing about others: there is no interval";
    return out;
  }
  Random random(options.seed);
  std::vector<double> values;
  for (int k = 0; k < options.resamples; ++k) {
    for (std::size_t& person : drawn) person = std::size_t(random.uniform() * double(persons));
    const double value = statistic(drawn);
    if (std::isnan(value))
      ++out.without_number;
    else
      values.push_back(value);
  }
  if (out.without_number > 0)
    out.note = fmt::format("{} of {} draws have no number", out.without_number, options.resamples);
  const double tail = (1 - options.level) / 2;
  out.interval = {quantile(values, tail), quantile(values, 1 - tail)};
  return out;
}

Result<PersonBootstrap> bootstrap_mean(std::span<const double> values, std::span<const int> persons,
                                       const BootstrapOptions& options) {
  if (values.size() != persons.size())
    return fail(bootstrap_name, fmt::format("{} values have {} persons", values.size(), persons.size()),
                "give each value its person");
  struct Part {
    double sum = 0, count = 0;
  };
  std::map<int, Part> parts;
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (std::isinf(values[k]))
      return fail(bootstrap_name, fmt::format("value {} is infinite", k + 1), "give finite values");
    if (std::isnan(values[k])) continue;
    parts[persons[k]].sum += values[k];
    ++parts[persons[k]].count;
  }
  std::vector<Part> each;
  for (const auto& [person, part] : parts) each.push_back(part);
  const auto statistic = [&](std::span<const std::size_t> drawn) {
    Part all;
    for (const std::size_t person : drawn) {
      all.sum += each[person].sum;
      all.count += each[person].count;
    }
    return all.sum / all.count;
  };
  return bootstrap_persons(each.size(), statistic, options);
}

}  // namespace intaglio::statistics
