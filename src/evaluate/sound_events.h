// When a sound is excited, compared between two sounds: onsets, trains of impulses, decay.
//
// Onsets are the loud ones of report/onsets.h, matched one to one, the nearest first, within 25 ms. Impulses
// are the maxima of report::excitation (1000 a second) that exceed a fifth of its 98th percentile and every
// value within 4 ms; the distance of two trains is the mean difference of the quantiles of their intervals
// (Wasserstein's distance), in ms: 0 for the same rhythm, whenever it begins. Scraping over a grating of
// wavelength l at speed v gives intervals l / v. Decay is spectrum_distance.h's. Pure; any thread; about
// 50 ms for a second of sound.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace intaglio::evaluate {

struct OnsetMatch {
  std::size_t wanted = 0, missed = 0, false_alarms = 0;
  std::vector<double> late_ms;  // of each matched onset; negative: early
};
// Onsets of `sound` beside those of `reference`; both start at the same time, in samples at `rate` Hz.
OnsetMatch match_onsets(std::span<const float> sound, std::span<const float> reference, double rate);
// The same of times in s, ascending.
OnsetMatch match_times(std::span<const double> times, std::span<const double> wanted);

// Times of the impulses, s, ascending.
std::vector<double> impulses(std::span<const float> sound, double rate);
// ms between the intervals of two trains; not a number if either has fewer than three impulses.
double interval_distance(std::span<const double> one, std::span<const double> other);

}  // namespace intaglio::evaluate
