// Real-time sound: a physics thread pushes contact events, the audio device's thread renders them.
//
// The two never wait for each other: events cross in a bounded lock-free queue. advance() publishes the
// simulated time, and an event is heard `delay` after it happened, by the audio device's clock: a constant
// delay, long enough for a step to be complete. The two clocks may drift apart: when physics falls behind (a
// pause, a slow frame), the delay grows by what is missing, and then slowly shrinks back. Nothing here
// allocates, locks or throws after construction.
#pragma once

#include <atomic>
#include <chrono>

#include "core/lock_free.h"
#include "sound/audio_device.h"
#include "sound/synthesizer.h"

namespace intaglio::sound {

struct LiveSoundOptions {
  double delay = 0.01;        // s; grows to the time between two advance() calls, if that is longer
  double gain_db = 0;         // see synthesizer.h
  int queue_capacity = 4096;  // events
};

struct LiveSoundStatus {
  std::uint64_t events = 0;  // passed to the synthesizer
  // The queue was full: the device has stopped, or events come faster than it renders.
  std::uint64_t dropped_events = 0;
  std::uint64_t stalls = 0;  // buffers rendered before physics had reached their end
  double delay = 0;          // s, from an event to its sample, current
  double mean_latency = 0;   // s, over all events, from push() to the sample leaving render()
  double worst_latency = 0;  // s
  SynthesizerStatus synthesizer;
};

class LiveSound : public AudioSource {
 public:
  // `synthesizer.sample_rate` must be the device's.
  LiveSound(const SynthesizerOptions& synthesizer, std::vector<SoundBody> bodies,
            const LiveSoundOptions& options = {});

  // Physics thread. Events in order of time; then, after each step, the simulated time. Time may pause but
  // never goes back.
  void push(const ContactEvent& event);
  void advance(double time);
  // Callable from one thread of your choice.
  void set_listener(const Listener& listener) { listener_.publish(listener); }
  void set_gain_db(double gain_db) { gain_db_.store(gain_db, std::memory_order_relaxed); }

  // The device's thread.
  void render(std::span<float> stereo) noexcept override;

  // Any one thread; never waits.
  LiveSoundStatus status() { return status_.fetch(); }

 private:
  struct Item {
    ContactEvent event;
    std::chrono::steady_clock::time_point pushed;
  };

  void adjust_offset(double physics_time, double end);
  void push_due_events(double physics_time);

  Synthesizer synthesizer_;
  LiveSoundOptions options_;
  SpscQueue<Item> queue_;
  std::atomic<double> physics_time_;  // NaN before the first advance()
  std::atomic<std::uint64_t> dropped_{0};
  std::atomic<double> gain_db_;
  Latest<Listener> listener_;
  Latest<LiveSoundStatus> status_;
  // The device's thread only.
  double offset_ = 0;  // audio time minus simulated time
  bool has_begun_ = false;
  double total_latency_ = 0;
  LiveSoundStatus now_;
};

}  // namespace intaglio::sound
