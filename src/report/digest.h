// A session as its report keeps it: the data that are drawn and measured, taken from the stream as it comes.
//
// Memory does not depend on the duration: 8 MB, and 1.6 MB for each of up to three balls (less for each of
// more). Curves, waveform and spectrogram keep the extremes of every drawn column, so they are exact. Paths
// are exact up to 65,536 samples (fewer with many balls) and evenly spaced samples beyond; touches and onsets
// are exact up to 65,536 and those of evenly spaced windows of time beyond (report/bounded.h). Kinds of data
// do not depend on how they are interleaved, so that a recording gives the same digest as the run that made
// it.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "report/axis.h"
#include "report/bounded.h"
#include "report/contact_digest.h"
#include "report/drawn_curve.h"
#include "report/onsets.h"
#include "report/spectrogram.h"
#include "report/time_spans.h"
#include "session/recording.h"

namespace intaglio::report {

inline constexpr Range track_area = {76, 976};  // drawing units, of the time axis of all tracks

// The correlation of two series, online (Welford).
class Correlation {
 public:
  void add(const Vec2& pair);
  std::size_t count() const { return count_; }
  // Pearson's; NaN with less than two pairs, or where one of the series hardly varies: its variance is below
  // `least`.
  double value(double least) const;

 private:
  std::size_t count_ = 0;
  Vec2 mean_ = Vec2::Zero();
  Eigen::Matrix2d sum_ = Eigen::Matrix2d::Zero();
};

struct PenDigest {
  PenDigest(const session::Run& run, const Axis& time, std::size_t path_samples);
  void add(const haptics::ServoSample& sample, const session::Run& run);

  std::size_t ticks = 0;
  DrawnCurve tip, surface, force;  // mm, mm, N
  Extent heights, forces;          // mm of the surface, and of the tip where it touches; N
  Decimated<Vec3> path;            // m; NaN where it does not touch
  Extent touched_u, touched_v;     // m, on the surface
  bool has_touched = false;        // the surface, within its edges
  TimeSpans touches;               // without gaps that are too short to see
  Correlation relief;              // m; height of the tip, and of the surface under it, while touching
};

struct BallDigest {
  BallDigest(const session::Ball& ball, const session::Run& run, const Axis& time, std::size_t path_samples);

  BodyId body;
  double radius;             // m
  DrawnCurve height, speed;  // m, of the lowest point; m/s
  Decimated<Vec3> path;      // m
  std::optional<Vec3> last;  // m
};

class SoundDigest {
 public:
  SoundDigest(const session::Run& run, const Axis& time);

  void add(float sample);
  // Somebody may be heard in that time.
  void add_busy(TimeSpan span) { busy_.add(span); }
  // After the last sample.
  void finish();

  std::size_t samples() const { return samples_; }
  const DrawnCurve& wave() const { return wave_; }
  const Extent& level() const { return level_; }
  const SpectrogramView& view() const { return view_; }  // its axes
  const SpectrogramPicture& picture() const { return picture_; }
  const OnsetFinder& onsets() const { return onsets_; }
  // Mean power of the long frames that resolve modes, and the width of a bin.
  std::vector<double> mean_power() const { return mean_.mean(); }
  double bin_hz() const { return sample_rate_ / modal_window; }
  double busy_seconds() const { return busy_.total(); }
  // Energy in all time, and while nobody was busy.
  double energy() const { return energy_; }
  double idle_energy() const { return idle_energy_; }

 private:
  static constexpr int drawn_window = 2048, modal_window = 16384;

  double sample_rate_;
  std::size_t samples_ = 0;
  DrawnCurve wave_;
  Extent level_;
  SpectrogramView view_;
  SpectrogramPicture picture_;
  MeanSpectrum mean_;
  SpectrumStream drawn_, modal_;
  OnsetFinder onsets_;
  TimeSpans busy_;
  double energy_ = 0, idle_energy_ = 0;
};

class Digest : public session::Observer {
 public:
  // `run` outlives the digest; the report reads it again.
  explicit Digest(const session::Run& run);
  // With another duration of the time axis, s.
  Digest(const session::Run& run, double duration);

  void on_event(const ContactEvent& event) override;
  void on_tick(const haptics::ServoSample& sample) override { pen_.add(sample, run_); }
  void on_step(std::span<const Vec3> balls) override;
  void on_sound(std::span<const float> stereo) override;
  // After the last of everything, before the report is written.
  void finish();

  const session::Run& run() const { return run_; }
  double duration() const { return time_.values().high; }
  // Seconds to drawing units; shared by all tracks.
  const Axis& time() const { return time_; }
  const PenDigest& pen() const { return pen_; }
  const std::vector<BallDigest>& balls() const { return balls_; }
  const Extent& heights() const { return heights_; }  // m, of all balls
  const Extent& speeds() const { return speeds_; }    // m/s
  const ContactDigest& contacts() const { return contacts_; }
  const SoundDigest& sound() const { return sound_; }

 private:
  const session::Run& run_;
  Axis time_;
  double ring_;  // s, after which a sound is over
  PenDigest pen_;
  std::vector<BallDigest> balls_;
  Extent heights_, speeds_;
  ContactDigest contacts_;
  SoundDigest sound_;
};

// The digest of a recording; its time axis is as long as the longest series where `duration` makes no sense.
std::unique_ptr<Digest> digest_of(const session::Recording& recording);

// The voice's name, otherwise "floor", "pen" or "ball 3".
std::string body_name(const session::Run& run, BodyId body);

}  // namespace intaglio::report
