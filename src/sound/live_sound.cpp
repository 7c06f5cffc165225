#include "sound/live_sound.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sound/synthesizer.h"

namespace intaglio::sound {

namespace {

constexpr double catch_up_rate = 0.01;  // share of the excess delay removed per buffer

}  // namespace

LiveSound::LiveSound(const SynthesizerOptions& synthesizer, std::vector<SoundBody> bodies,
                     const LiveSoundOptions& options)
    : synthesizer_(synthesizer, std::move(bodies)),
      options_(options),
      queue_(std::size_t(options.queue_capacity)),
      physics_time_(std::numeric_limits<double>::quiet_NaN()),
      gain_db_(options.gain_db) {
  listener_.publish({});
}

void LiveSound::push(const ContactEvent& event) {
  if (!queue_.push({event, std::chrono::steady_clock::now()}))
    dropped_.fetch_add(1, std::memory_order_relaxed);
}

void LiveSound::advance(double time) {
  physics_time_.store(time, std::memory_order_release);
}

// Keeps `physics_time`, in audio time, at or beyond `end`, the end of the current buffer.
void LiveSound::adjust_offset(double physics_time, double end) {
  if (std::isnan(physics_time)) return;
  if (!has_begun_) {
    has_begun_ = true;
    offset_ = end + options_.delay - physics_time;
  }
  const double ahead = physics_time + offset_ - end;
  if (ahead < 0) {
    offset_ -= ahead;
    ++now_.stalls;
  } else if (ahead > options_.delay) {
    offset_ -= catch_up_rate * (ahead - options_.delay);
  }
  now_.delay = std::max(ahead, 0.0);
}

// Events cannot be placed before the first advance(). Those of an incomplete step wait for the rest of it:
// the points of a step form one contact only if they are placed together, and the offset may change in
// between.
void LiveSound::push_due_events(double physics_time) {
  if (!has_begun_) return;
  const auto now = std::chrono::steady_clock::now();
  while (const Item* const item = queue_.front()) {
    ContactEvent event = item->event;
    if (event.time > physics_time) break;
    const std::chrono::duration<double> waited = now - item->pushed;
    event.time += offset_;
    const double latency = waited.count() + std::max(0.0, event.time - synthesizer_.time());
    total_latency_ += latency;
    now_.worst_latency = std::max(now_.worst_latency, latency);
    now_.mean_latency = total_latency_ / double(++now_.events);
    if (synthesizer_.has_room()) {
      synthesizer_.push(event);
    } else {
      dropped_.fetch_add(1, std::memory_order_relaxed);
    }
    queue_.pop();
  }
}

void LiveSound::render(std::span<float> stereo) noexcept {
  const double end = synthesizer_.time() + double(stereo.size() / 2) / synthesizer_.sample_rate();
  const double physics_time = physics_time_.load(std::memory_order_acquire);
  adjust_offset(physics_time, end);
  push_due_events(physics_time);
  synthesizer_.set_listener(listener_.fetch());
  synthesizer_.render_stereo(stereo);
  to_full_scale(stereo, stereo, {gain_db_.load(std::memory_order_relaxed)});
  now_.dropped_events = dropped_.load(std::memory_order_relaxed);
  now_.synthesizer = synthesizer_.status();
  status_.publish(now_);
}

}  // namespace intaglio::sound
