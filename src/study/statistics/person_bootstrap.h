// Bootstrap over persons: an interval that counts people, not trials, because one person's trials are alike.
//
// Persons are drawn with replacement, each with all trials, as often as there are persons; the interval
// holds the middle `level` of the statistic of these draws (percentile method). With few persons it is too
// narrow, as core/bootstrap.h says: about 0.93 at 20 persons for 0.95. Draws without a number (a statistic
// of nobody's right answers) are left out and counted. Fewer than two persons: not a number and a note.
// Seeded, the same bits on every machine if the statistic's are. Source: Davison and Hinkley 1997, section
// 3.8. Any thread; resamples times the cost of the statistic.
#pragma once

#include <functional>
#include <span>
#include <string>

#include "core/bootstrap.h"
#include "intaglio/error.h"

namespace intaglio::statistics {

// A statistic of persons, by their numbers from 0, of which some come more than once and others never.
using PersonStatistic = std::function<double(std::span<const std::size_t> persons)>;

struct PersonBootstrap {
  double value = 0;  // of everybody, once
  Interval interval;
  std::size_t persons = 0;
  int without_number = 0;  // draws
  std::string note;
};

// Errors: wrong options, no person.
Result<PersonBootstrap> bootstrap_persons(std::size_t persons, const PersonStatistic& statistic,
                                          const BootstrapOptions& options = {});

// The mean of all values, each of the person of its number; missing values are left out.
Result<PersonBootstrap> bootstrap_mean(std::span<const double> values, std::span<const int> persons,
                                       const BootstrapOptions& options = {});

}  // namespace intaglio::statistics
