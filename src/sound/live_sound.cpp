#include "sound/live_sound.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sound/synthesizer.h"

namespace intaglio::sound {

namespace {

constexpr double creep = 0.01;  // of too long a delay, each buffer

}  // namespace

LiveSound::LiveSound(const SynthesizerOptions& synthesizer, std::vector<SoundBody> bodies,
                     const LiveOptions& options)
    : synthesizer_(synthesizer, std::move(bodies)),
      options_(options),
      queue_(static_cast<std::size_t>(options.queue)),
      known_(std::numeric_limits<double>::quiet_NaN()),
      gain_db_(options.gain_db) {
  listener_.publish({});
}

void LiveSound::push(const ContactEvent& event) {
  if (!queue_.push({event, std::chrono::steady_clock::now()}))
    dropped_.fetch_add(1, std::memory_order_relaxed);
}

void LiveSound::advance(double time) {
  known_.store(time, std::memory_order_release);
}

// Keeps `known`, in audio time, at or beyond `end`, the end of what is rendered now.
void LiveSound::keep_pace(double known, double end) {
  if (std::isnan(known)) return;
  if (!has_begun_) {
    has_begun_ = true;
    offset_ = end + options_.delay - known;
  }
  const double ahead = known + offset_ - end;
  if (ahead < 0) {
    offset_ -= ahead;
    ++now_.waits;
  } else if (ahead > options_.delay) {
    offset_ -= creep * (ahead - options_.delay);
  }
  now_.delay = std::max(ahead, 0.0);
}

// Events cannot be placed before the first advance(). Those of a step that is not over wait for the rest of
// it: a step's points are one contact only together, and the offset may change in between.
void LiveSound::take_events(double known) {
  if (!has_begun_) return;
  const auto now = std::chrono::steady_clock::now();
  while (const Item* const item = queue_.front()) {
    ContactEvent event = item->event;
    if (event.time > known) break;
    const std::chrono::duration<double> waited = now - item->pushed;
    event.time += offset_;
    const double latency = waited.count() + std::max(0.0, event.time - synthesizer_.time());
    total_latency_ += latency;
    now_.worst_latency = std::max(now_.worst_latency, latency);
    now_.mean_latency = total_latency_ / static_cast<double>(++now_.events);
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
  const double known = known_.load(std::memory_order_acquire);
  keep_pace(known, end);
  take_events(known);
  synthesizer_.set_listener(listener_.fetch());
  synthesizer_.render_stereo(stereo);
  to_full_scale(stereo, stereo, {gain_db_.load(std::memory_order_relaxed)});
  now_.dropped_events = dropped_.load(std::memory_order_relaxed);
  now_.synthesizer = synthesizer_.status();
  status_.publish(now_);
}

}  // namespace intaglio::sound
