// How far the senses agree on what a probe crosses, in just noticeable differences. docs/evaluate.md defines
// it and says what is borrowed from the literature and what is unproven.
//
// A feature is an extremum of the height, or of the curvature, of the relief that the reference's probe
// rests on, filtered at the probe's radius, along its path; one list serves all representations. Each
// sense's output is a series in time: slopes that are seen and felt, accelerations, and how strongly the
// sound is excited; the reference has the same series, each at the moment at which the probe is drawn at the
// same place. A sense delivers a feature when, around it, its series correlates with the reference's at some
// lag within +-100 ms; the lag of the best correlation is its delay. A series that does not correlate, or
// hardly varies, misses the feature. Excitations far from any feature are false alarms.
//
// For a pair of senses x = sqrt((dt / T)^2 + (ds / S)^2): dt is the difference of their delays, ds the
// distance that the hand moves in it, T and S the thresholds of the pair (thresholds.h). A feature that a
// sense misses counts x = 3. Pure; any thread.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "evaluate/crossing.h"
#include "evaluate/sight.h"
#include "evaluate/thresholds.h"

namespace intaglio::evaluate {

enum class Sense { picture, touch, motion, sound };
inline constexpr std::size_t senses = 4;
const char* name_of(Sense sense);

// The series of one crossing, all at `rate` from `start`.
struct Traces {
  Probe probe = Probe::pen;
  double rate = 0, start = 0;         // Hz, s
  double hand_scale = 1;              // scene metres per hand metre
  std::vector<double> distance;       // m along the path
  std::vector<std::size_t> features;  // where in the series the features are crossed
  struct Series {
    std::vector<double> delivered, reference;
  };
  std::array<std::optional<Series>, senses> of;  // picture, touch or motion, sound

  double seconds() const { return double(distance.size()) / rate; }
};

// `reference`: the same crossing on the reference. `sight` is the picture's; null: not looked at.
Traces make_traces(const Subject& subject, const Crossing& crossing, const Crossing& reference,
                   const Sight* sight);

// Faults of one sense, applied to a recorded crossing: what another time, place or texture would have given.
struct StreamFault {
  double delay = 0;               // s, later
  double shift = 0;               // m in the scene, along the path
  const Traces* other = nullptr;  // of another texture along the same path
  bool off = false;
};
Traces with_fault(const Traces& traces, Sense sense, const StreamFault& fault);

struct FeatureCrossed {
  double time = 0;                                  // s, in the session
  double distance = 0;                              // m along the path
  std::array<std::optional<double>, senses> delay;  // s; empty: missed, or not a sense of this probe
};

struct PairAgreement {
  Sense first = Sense::picture, second = Sense::touch;
  std::vector<double> ms, mm, jnd;  // one for each feature: absolute; in the hand; x. Missed: jnd only
  std::size_t missed = 0;
};

struct Agreement {
  std::vector<FeatureCrossed> features;
  std::vector<PairAgreement> pairs;
  std::size_t false_alarms = 0;
  std::size_t missed = 0;  // by any sense

  // The worst pair's x of each feature.
  std::vector<double> worst() const;
  // Share of features with a pair at x >= 1; not a number without features.
  double score() const;
  double mean_jnd() const;  // over features and pairs
};

Agreement measure_agreement(const Traces& traces, const Thresholds& thresholds);

// Adds a crossing's features and pairs to those of others with the same probe.
void append(Agreement& sum, const Agreement& more);

}  // namespace intaglio::evaluate
