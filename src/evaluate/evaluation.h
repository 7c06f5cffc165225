// `intaglio evaluate`: how true and how consistent each representation of a texture is, and what it costs.
//
// One evaluation compares seven representations of a texture (subject.h) with a reference made by brute
// force (reference.h, reference_motion.h), over seeded strokes of a pen and rolls of a ball.
// docs/evaluate.md explains every number. A quick one takes under a minute on two cores, a whole one under
// five. Deterministic but for costs.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/bootstrap.h"
#include "evaluate/agreement.h"
#include "evaluate/picture_truth.h"
#include "evaluate/resting.h"
#include "evaluate/subject.h"
#include "evaluate/vibration.h"
#include "scene/cues.h"

namespace intaglio::evaluate {

struct EvaluateOptions {
  SubjectOptions subject;
  std::uint64_t seed = 1;
  bool quick = false;  // fewer runs, smaller pictures, a coarser reference
  scene::Cues faults;  // applied to what the senses deliver
  Thresholds thresholds = builtin_thresholds();
  std::function<void(double done, const std::string& what)> progress = {};

  std::optional<int> wanted_runs;  // of each probe; unset: 4 of a quick one, otherwise 20

  int drops() const { return quick ? 3 : 102; }  // bodies that are dropped, whatever wanted_runs
  // Runs that also throw and strike with bodies.
  int thrown() const { return quick ? 1 : runs(); }
  int runs() const { return wanted_runs.value_or(quick ? 4 : 20); }
};

// Differences from the reference; a mean with a 95 % interval over runs.
struct Measured {
  double value = 0;
  Interval interval;
};

// A thrown box or hull.
struct BodyTruth {
  Measured place_mm, height_mm;  // after 0.1 s from the reference's state, as those of the ball
  Measured turn;                 // degrees, of the orientation, likewise
  Measured normal_angle;         // degrees, of the deepest contact
};

// Dropped balls, boxes and hulls after 3 s (resting.h).
struct RestTruth {
  RestStatistics all;
  Measured height_mm, tilt, creep_mm;  // of those at rest
};

struct MotionTruth {
  Measured place_mm;      // after 0.1 s from the reference's state, along the surface
  Measured height_mm;     // likewise, across it; of a representation that is drawn flat: of the flat place
  Measured normal_angle;  // degrees, of the deepest contact
  BodyTruth box = {}, hull = {};
  // A ball without rolling resistance gains energy on its own way: J, and a share of its kinetic energy.
  Measured gained_j = {}, gained_share = {};
  RestTruth rest = {};
};

struct TouchTruth {
  Measured force_n;           // root mean square of the difference of forces
  Measured direction;         // degrees, between them, mean while both touch
  double loop_energy_mj = 0;  // that a closed loop gives to the hand; above 0: the surface is not passive
  Measured buzz_n;            // force above 100 Hz beyond the reference's
  Measured bands_db;          // distance of the energies in nine vibration bands
  Measured intensity_steps;   // just noticeable steps between the intensities of vibration
  Measured pacinian_steps = {}, non_pacinian_steps = {};  // likewise, of each channel
};

// The sounds of one way of touching.
struct SoundsTruth {
  Measured spectrum_db;                                  // log-spectral distance, gain ignored
  Measured loudness_sone;                                // loudness distance
  std::size_t onsets = 0, missed = 0, false_alarms = 0;  // of the reference; over all runs
  Measured late_ms;                                      // of matched onsets, absolute
  Measured intervals_ms;                                 // between the trains of impulses
  Measured decay;  // mean of |ln(T1 / T2)| over third octaves; 0.05 is noticed
};

struct SoundTruth {
  Measured spectrum_db, loudness_sone;  // scraping and rolling together
  SoundsTruth striking = {}, scraping = {}, rolling = {};
};

struct Cost {
  double picture_ms = 0;  // a picture of 1024 x 1024 with two samples a side, process CPU
  double motion_us = 0, touch_us = 0, sound_us = 0;  // a step, a tick, a block of 64 samples
  std::size_t runtime_bytes = 0;                     // relief for motion, touch and picture
  double offline_s = 0;                              // import or mesh building
};

// One probe's agreement over all runs.
struct ProbeAgreement {
  Agreement all;
  std::vector<double> run_scores, run_means;  // of each run
};

struct RepresentationResult {
  Candidate candidate;
  PictureTruth picture;
  MotionTruth motion;
  TouchTruth touch;
  SoundTruth sound;
  ProbeAgreement pen, ball;
  Cost cost;
  Traces example;  // of the first stroke

  // Over both probes.
  Measured score() const;     // share of features with a pair at x >= 1
  Measured mean_jnd() const;  // mean x
  // Percentile of absolute delays (ms), distances (mm in the hand) or x over all features and pairs.
  double percentile_ms(double fraction) const;
  double percentile_mm(double fraction) const;
  double percentile_jnd(double fraction) const;
  std::size_t missed() const, false_alarms() const, features() const;
  // The same as a screen of 60 Hz and a block of sound add: the second row.
  double displayed_ms() const;
};

struct ReferenceError {
  double height_um = 0;               // difference of half the grid, root mean square
  double motion_mm = 0;               // difference of half the rate, after 0.1 s
  double body_mm = 0, body_turn = 0;  // likewise of boxes and hulls; degrees
  double gained_share = 0;            // energy that its own ball gains, as MotionTruth's
};

struct Recommendation {
  Kind kind = Kind::relief;
  std::vector<std::string> reasons;  // sentences
};

struct Evaluation {
  EvaluateOptions options;
  std::vector<std::string> notes;  // of the import
  double depth = 0;                // m
  std::string reference;           // what it is: one sentence
  ReferenceError reference_error;
  std::vector<RepresentationResult> representations;
  Recommendation recommendation;
  double seconds = 0;  // wall
};

Result<Evaluation> evaluate(const EvaluateOptions& options);

// Seconds by which a sense is presented later than it is computed, as "as displayed" assumes: a screen of 60
// Hz shows a frame half a period later on average, and the middle of its picture another half; a sound card
// holds two blocks of 256 samples; a device answers within a tick.
double displayed_late(Sense sense);

// One object; keys in docs/evaluate.md.
std::string evaluation_json(const Evaluation& evaluation);
// A page without requests to others.
std::string evaluation_html(const Evaluation& evaluation);

}  // namespace intaglio::evaluate
