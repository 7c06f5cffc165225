#include "report/digest.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace intaglio::report {

namespace {

constexpr double still_speed = 0.005;  // m/s, below which a touching body rests
constexpr std::size_t most_path_samples = 1 << 16, all_path_samples = 1 << 18;

double step_of(int rate) {
  return rate > 0 ? 1.0 / rate : std::nan("");
}

double series_seconds(std::size_t samples, int rate) {
  return rate > 0 ? double(samples) / rate : 0;
}

bool is_drawable(double duration) {
  return std::isfinite(duration) && duration > 1e-6 && duration < 1e6;
}

// For each of a session's paths.
std::size_t path_samples(const session::Run& run) {
  return std::clamp<std::size_t>(all_path_samples / (run.balls.size() + 1), 1024, most_path_samples);
}

double longest_ring(const session::Run& run) {
  double longest = 0;
  for (const scene::Voice& voice : run.voices) {
    for (const double t60 : voice.t60) {
      if (std::isfinite(t60)) longest = std::max(longest, t60);
    }
  }
  return longest > 0 ? longest : 0.5;
}

// Height over the base plane, m.
double height_of(const session::Run& run, const Vec3& point) {
  return run.surface ? run.surface->placement().to_local(point).z() : point.y();
}

SpectrogramView heard_view(const session::Run& run, const Axis& time) {
  SpectrogramView view;
  view.duration = time.values().high;
  view.high_hz = std::max(std::min(20000.0, 0.5 * run.sample_rate), 2 * view.low_hz);
  return view;
}

}  // namespace

void Correlation::add(const Vec2& pair) {
  const Vec2 from_mean = pair - mean_;
  mean_ += from_mean / double(++count_);
  sum_ += from_mean * (pair - mean_).transpose();
}

double Correlation::value(double least) const {
  if (count_ < 2 || !(sum_.diagonal().minCoeff() > least * double(count_))) return std::nan("");
  return sum_(0, 1) / std::sqrt(sum_(0, 0) * sum_(1, 1));
}

PenDigest::PenDigest(const session::Run& run, const Axis& time, std::size_t path_samples)
    : tip(time, 0, step_of(run.servo_rate)),
      surface(tip),
      force(tip),
      path(path_samples),
      touches(time.values().high) {}

void PenDigest::add(const haptics::ServoSample& sample, const session::Run& run) {
  const double tip_height = height_of(run, sample.tip);
  tip.add(1e3 * tip_height);
  surface.add(1e3 * sample.surface_height);
  force.add(sample.force.norm());
  forces.add(sample.force.norm());
  heights.add(1e3 * sample.surface_height);
  path.add(sample.touching ? sample.tip : Vec3::Constant(std::nan("")).eval());
  const double tick = step_of(run.servo_rate), begin = double(ticks++) * tick;
  if (!sample.touching) return;
  heights.add(1e3 * tip_height);
  // A tenth of a drawing unit.
  const double unseen = touches.duration() / (10 * track_area.size());
  touches.add({touches.spans().empty() || begin - touches.spans().back().end > unseen
                   ? begin
                   : touches.spans().back().end,
               begin + tick});
  if (!run.surface) return;
  const Vec3 local = run.surface->placement().to_local(sample.tip);
  if (local.allFinite() && run.surface->placement().covers(local)) {
    has_touched = true;
    touched_u.add(local.x());
    touched_v.add(local.y());
  }
  // Outliers beyond a kilometre are faults of the simulation.
  const Vec2 pair(local.z(), sample.surface_height);
  if (pair.allFinite() && pair.cwiseAbs().maxCoeff() < 1e3) relief.add(pair);
}

BallDigest::BallDigest(const session::Ball& ball, const session::Run& run, const Axis& time,
                       std::size_t path_samples)
    : body(ball.body),
      radius(ball.radius),
      height(time, step_of(run.physics_rate), step_of(run.physics_rate)),
      speed(height),
      path(path_samples) {}

SoundDigest::SoundDigest(const session::Run& run, const Axis& time)
    : sample_rate_(run.sample_rate),
      wave_(time, 0, 1.0 / run.sample_rate),
      view_(heard_view(run, time)),
      picture_(run.sample_rate, drawn_window, view_, 1200, 320),
      drawn_(drawn_window, [this](std::span<const float> frame) { picture_.add(frame); }),
      modal_(modal_window, [this](std::span<const float> frame) { mean_.add(frame); }),
      onsets_(run.sample_rate),
      busy_(time.values().high) {}

void SoundDigest::add(float sample) {
  const double time = double(samples_++) / sample_rate_;
  wave_.add(double(sample));
  level_.add(double(sample));
  drawn_.add(sample);
  modal_.add(sample);
  onsets_.add(sample);
  busy_.forget_before(time);
  const double energy = std::isfinite(sample) ? double(sample) * double(sample) : 0;
  energy_ += energy;
  if (busy_.spans().empty() || time < busy_.spans().front().begin) idle_energy_ += energy;
}

void SoundDigest::finish() {
  drawn_.finish();
  modal_.finish();
}

Digest::Digest(const session::Run& run) : Digest(run, is_drawable(run.duration) ? run.duration : 1) {}

Digest::Digest(const session::Run& run, double duration)
    : run_(run),
      time_({0, duration}, track_area),
      ring_(longest_ring(run)),
      pen_(run, time_, path_samples(run)),
      contacts_(run.pen),
      sound_(run, time_) {
  balls_.reserve(run.balls.size());
  for (const session::Ball& ball : run.balls) balls_.emplace_back(ball, run, time_, path_samples(run));
  heights_.add(0);
  speeds_.add(0);
}

void Digest::on_event(const ContactEvent& event) {
  contacts_.add(event);
  const bool sounds =
      event.phase == ContactPhase::begin || event.v_t.norm() > still_speed || event.spin.norm() > still_speed;
  if (sounds && std::isfinite(event.time) && std::isfinite(event.duration))
    sound_.add_busy({event.time - event.duration, event.time + ring_});
}

void Digest::on_step(std::span<const Vec3> positions) {
  for (std::size_t k = 0; k < std::min(positions.size(), balls_.size()); ++k) {
    BallDigest& ball = balls_[k];
    const Vec3& centre = positions[k];
    const double height = height_of(run_, centre) - ball.radius;
    const double speed = ball.last ? (centre - *ball.last).norm() * run_.physics_rate : std::nan("");
    ball.last = centre;
    ball.height.add(height);
    ball.speed.add(speed);
    ball.path.add(centre);
    heights_.add(height);
    speeds_.add(speed);
  }
}

void Digest::on_sound(std::span<const float> stereo) {
  for (std::size_t k = 0; k + 1 < stereo.size(); k += 2) sound_.add(0.5f * (stereo[k] + stereo[k + 1]));
}

void Digest::finish() {
  contacts_.finish();
  sound_.finish();
}

std::unique_ptr<Digest> digest_of(const session::Recording& recording) {
  double duration = recording.duration;
  if (!is_drawable(duration)) {
    duration = std::max(series_seconds(recording.audio.size(), recording.sample_rate),
                        series_seconds(recording.servo.size(), recording.servo_rate));
    for (const auto& track : recording.tracks)
      duration = std::max(duration, series_seconds(track.size(), recording.physics_rate));
    if (!(duration > 0)) duration = 1;
  }
  auto digest = std::make_unique<Digest>(recording, duration);
  recording.play_back(*digest);
  digest->finish();
  return digest;
}

std::string body_name(const session::Run& run, BodyId body) {
  for (const scene::Voice& voice : run.voices) {
    if (voice.body == body && !voice.name.empty()) return voice.name;
  }
  if (body == floor_body) return "floor";
  return body == run.pen ? "pen" : fmt::format("ball {}", body);
}

}  // namespace intaglio::report
