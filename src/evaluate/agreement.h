// How far the senses agree on what a probe crosses, in just noticeable differences. docs/evaluate.md defines
// it and says what is borrowed from the literature and what is unproven.
//
// A feature is an extremum of the height, or of the curvature, of the relief that the reference's probe
// rests on, filtered at the probe's radius, along its path; one list serves all representations. Around each
// feature, a sense's series is compared with the reference's (traces.h): at some lag within +-100 ms it must
// correlate, and vary at least a tenth as much, or the sense misses the feature.
//
// When: the lag of the best correlation is the sense's delay. A picture is drawn whole, so its delay is one
// for the crossing, and what is left at a feature is an error of place. A sound is made by what changes at
// the probe: where it tells the feature and follows the delivered force or motion, they say when. Single
// delays are drawn together by what their error explains (delay.h).
//
// For a pair of senses x = sqrt((dt / T)^2 + (ds / S)^2): dt is the difference of their delays, ds the
// distance that the hand moves in it and the picture's error of place, T and S the thresholds of the pair
// (thresholds.h). A feature that a sense misses counts x = 3; one that the reference's own sound does not
// tell counts in no pair with sound. Excitations far from any feature are false alarms. Pure; any thread.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "evaluate/thresholds.h"
#include "evaluate/traces.h"

namespace intaglio::evaluate {

struct FeatureCrossed {
  double time = 0;                                  // s, in the session
  double distance = 0;                              // m along the path
  std::array<std::optional<double>, senses> delay;  // s; empty: missed, or not a sense of this probe
  double displaced = 0;  // m along the path, by which the picture has it farther on
  bool is_heard = true;  // the reference's own sound tells it
  double worst = 0;      // greatest x of its pairs
};

struct PairAgreement {
  Sense first = Sense::picture, second = Sense::touch;
  std::vector<double> ms, mm, jnd;  // one a feature that counts: absolute; in the hand; x. Missed: jnd only
  std::size_t missed = 0;
};

struct Agreement {
  std::vector<FeatureCrossed> features;
  std::vector<PairAgreement> pairs;
  std::size_t false_alarms = 0;
  std::size_t missed = 0;  // by any sense

  // Share of features with a pair at x >= 1; not a number without features.
  double score() const;
  double mean_jnd() const;  // over features and pairs
};

Agreement measure_agreement(const Traces& traces, const Thresholds& thresholds);

// Adds a crossing's features and pairs to those of others with the same probe.
void append(Agreement& sum, const Agreement& more);

}  // namespace intaglio::evaluate
