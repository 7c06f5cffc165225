#include "sound/synthesizer.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "core/portable_math.h"
#include "sound/contact_pair.h"
#include "sound/ensemble.h"

namespace intaglio::sound {

EarGains ear_gains(const Listener& listener, const Vec3& source) {
  const Vec3 to_source = source - listener.position;
  const double distance = to_source.norm();
  if (!std::isfinite(distance)) return {0, 0};
  const double loudness = 1 / std::max(distance, Listener::nearest);
  const double side = distance > 0 ? std::clamp(to_source.dot(listener.right) / distance, -1.0, 1.0) : 0;
  const double angle = 0.25 * std::numbers::pi * (side + 1);
  const auto [sine, cosine] = elementary::sin_cos(angle);
  return {float(std::numbers::sqrt2 * loudness * cosine), float(std::numbers::sqrt2 * loudness * sine)};
}

namespace {

constexpr std::size_t reserved_events = 4096;
constexpr std::int64_t steal_interval = 16 * block_samples;  // samples between two rounds of voice stealing

double step_start(const ContactEvent& event) {
  return event.time - event.duration;
}

// Events in the order in which their steps begin. They are pushed in the order in which steps end, which is a
// different one when loops of different rates report: a long step that began early must not wait behind a
// short one. The queue compacts before it grows when more than half has been consumed.
class EventQueue {
 public:
  EventQueue() { events_.reserve(reserved_events); }

  bool empty() const { return first_ == events_.size(); }
  bool has_room() const { return events_.size() < events_.capacity() || 2 * first_ >= events_.size(); }
  const ContactEvent& front() const { return events_[first_]; }
  void pop() { ++first_; }
  void push(const ContactEvent& event) {
    if (events_.size() == events_.capacity() && has_room()) {
      events_.erase(events_.begin(), events_.begin() + std::ptrdiff_t(first_));
      first_ = 0;
    }
    events_.push_back(event);
    for (std::size_t k = events_.size() - 1; k > first_ && step_start(event) < step_start(events_[k - 1]);
         --k) {
      std::swap(events_[k], events_[k - 1]);
    }
  }

 private:
  std::vector<ContactEvent> events_;
  std::size_t first_ = 0;
};

}  // namespace

class Synthesizer::Engine {
 public:
  Engine(const SynthesizerOptions& options, std::vector<SoundBody> bodies)
      : options_(options), ensemble_(std::move(bodies), options) {
    const auto all = std::size_t(ensemble_.size()) * std::size_t(ensemble_.size());
    const std::size_t count = std::min(all, std::size_t(options.max_pairs));
    pairs_.reserve(count);
    for (std::size_t k = 0; k < count; ++k) pairs_.emplace_back(ensemble_, options);
    ensemble_.reserve_drives(count);
  }

  void push(const ContactEvent& event);
  bool has_room() const { return events_.has_room(); }
  void render(std::span<float> out, std::size_t channels);
  void set_listener(const Listener& listener) { ensemble_.set_listener(listener); }
  double sample_rate() const { return options_.sample_rate; }
  double time() const { return double(sample_) / options_.sample_rate; }
  bool is_silent() const;
  SynthesizerStatus status() const;

 private:
  using Sample = std::int64_t;

  Sample sample_at(double time) const { return Sample(std::floor(time * options_.sample_rate)); }

  ContactPair* find_or_assign_pair(const ContactEvent& event);
  void take_due_events();
  Sample next_change() const;

  SynthesizerOptions options_;
  Ensemble ensemble_;
  std::vector<ContactPair> pairs_;  // fixed at construction
  EventQueue events_;
  SynthesizerStatus status_;
  Sample sample_ = 0;  // the next one
};

// The event's pair. A new pair takes the slot that has been idle longest; null if all are touching.
ContactPair* Synthesizer::Engine::find_or_assign_pair(const ContactEvent& event) {
  const int body = ensemble_.find(event.body), other = ensemble_.find(event.other);
  ContactPair* free = nullptr;
  for (ContactPair& pair : pairs_) {
    if (pair.body() == body && pair.other() == other) return &pair;
    if (!pair.is_touching() && (!free || pair.last_time() < free->last_time())) free = &pair;
  }
  if (free) free->assign(body, other);
  return free;
}

void Synthesizer::Engine::push(const ContactEvent& event) {
  const int body = ensemble_.find(event.body), other = ensemble_.find(event.other);
  if (body < 0 || other < 0) {
    ++status_.unknown_bodies;
    return;
  }
  if (sample_at(step_start(event)) + 1 < sample_) ++status_.late_events;
  events_.push(event);
}

// Every step that begins before the next sample ends is processed now, complete.
void Synthesizer::Engine::take_due_events() {
  const double now = time();
  while (!events_.empty() && sample_at(step_start(events_.front())) <= sample_) {
    const ContactEvent& event = events_.front();
    if (ContactPair* const pair = find_or_assign_pair(event)) {
      ensemble_.move(pair->body(), event.body_pose);
      if (event.other_pose) ensemble_.move(pair->other(), *event.other_pose);
      ensemble_.set_touch_point(pair->other(), event.point);
      pair->add(event, now);
    } else {
      ++status_.dropped_pairs;
    }
    events_.pop();
  }
  for (ContactPair& pair : pairs_) pair.finish_step(now);
}

// The next sample at which the contacts change: blocks end there, so that the output does not depend on how
// it is divided.
Synthesizer::Engine::Sample Synthesizer::Engine::next_change() const {
  Sample next = (sample_ / block_samples + 1) * block_samples;
  if (!events_.empty()) next = std::min(next, sample_at(step_start(events_.front())));
  return next;
}

void Synthesizer::Engine::render(std::span<float> out, std::size_t channels) {
  std::fill(out.begin(), out.end(), 0.0f);
  while (!out.empty()) {
    take_due_events();
    const auto length = std::min(out.size() / channels, std::size_t(next_change() - sample_));
    for (ContactPair& pair : pairs_) {
      if (pair.is_touching()) pair.drive(sample_, length);
    }
    ensemble_.render(sample_, length, out.first(channels * length));
    sample_ += Sample(length);
    if (sample_ % block_samples == 0) ensemble_.sleep_when_silent();
    if (sample_ % steal_interval == 0) ensemble_.steal_quietest();
    out = out.subspan(channels * length);
  }
}

bool Synthesizer::Engine::is_silent() const {
  return events_.empty() && ensemble_.is_silent();
}

SynthesizerStatus Synthesizer::Engine::status() const {
  SynthesizerStatus status = status_;
  status.dropped_pulses = ensemble_.dropped_pulses();
  status.stolen_groups = ensemble_.stolen_groups();
  for (const ContactPair& pair : pairs_) status.truncated_paths += pair.truncated_paths();
  return status;
}

Synthesizer::Synthesizer(const SynthesizerOptions& options, std::vector<SoundBody> bodies)
    : engine_(std::make_unique<Engine>(options, std::move(bodies))) {}
Synthesizer::Synthesizer(Synthesizer&&) noexcept = default;
Synthesizer& Synthesizer::operator=(Synthesizer&&) noexcept = default;
Synthesizer::~Synthesizer() = default;

void Synthesizer::push(const ContactEvent& event) {
  engine_->push(event);
}
bool Synthesizer::has_room() const {
  return engine_->has_room();
}
void Synthesizer::render(std::span<float> out) {
  engine_->render(out, 1);
}
void Synthesizer::render_stereo(std::span<float> out) {
  engine_->render(out, 2);
}
void Synthesizer::set_listener(const Listener& listener) {
  engine_->set_listener(listener);
}
double Synthesizer::sample_rate() const {
  return engine_->sample_rate();
}
double Synthesizer::time() const {
  return engine_->time();
}
bool Synthesizer::is_silent() const {
  return engine_->is_silent();
}
SynthesizerStatus Synthesizer::status() const {
  return engine_->status();
}

float soft_limit(float x) {
  const float magnitude = std::abs(x);
  if (!(magnitude > limiter_knee)) return std::isnan(x) ? 0.0f : x;
  constexpr float room = 1 - limiter_knee;
  const auto beyond = float(elementary::tanh((magnitude - limiter_knee) / room));
  return std::copysign(limiter_knee + room * beyond, x);
}

void to_full_scale(std::span<const float> pascals, std::span<float> out, const LevelOptions& options) {
  assert(out.size() == pascals.size());
  const auto scale = float(elementary::pow(10.0, options.gain_db / 20) / full_scale_pascal);
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = soft_limit(scale * pascals[i]);
}

}  // namespace intaglio::sound
