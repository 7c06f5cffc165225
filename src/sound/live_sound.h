// Sound while it happens: a physics thread pushes contact events, the audio device's thread renders them.
//
// The two never wait for each other: events cross in a bounded lock-free queue. Physics says by advance()
// how far it has come, and an event is heard `delay` after it happened, by the audio device's clock: late
// enough that the whole step is known, and always equally late. The two clocks may drift apart: when
// physics falls behind (a pause, a slow frame), the delay grows by what is missing, and then creeps back.
// Nothing here allocates, locks or throws after construction.
#pragma once

#include <atomic>
#include <chrono>

#include "core/lock_free.h"
#include "sound/audio_device.h"
#include "sound/synthesizer.h"

namespace intaglio::sound {

struct LiveOptions {
  double delay = 0.01;  // s; at least the time between two advance() calls, or it will grow to that
  double gain_db = 0;   // see synthesizer.h
  int queue = 4096;     // events
};

struct LiveStatus {
  std::uint64_t events = 0;          // heard or to be heard
  std::uint64_t dropped_events = 0;  // the queue was full: the device has stopped, or physics is too eager
  std::uint64_t waits = 0;           // buffers that physics had not come far enough for
  double delay = 0;                  // s, from an event to its sample, as it is now
  double mean_latency = 0;           // s, of all events, from push() to the sample leaving render()
  double worst_latency = 0;          // s
  SynthesizerStatus synthesizer;
};

class LiveSound : public AudioSource {
 public:
  // `synthesizer.sample_rate` must be the device's.
  LiveSound(const SynthesizerOptions& synthesizer, std::vector<SoundBody> bodies,
            const LiveOptions& options = {});

  // Physics thread. Events in order of time; then, after each step, how far time has come. Time may pause
  // but never goes back.
  void push(const ContactEvent& event);
  void advance(double time);
  // Any one thread: where the listener is from now on.
  void set_listener(const Listener& listener) { listener_.publish(listener); }
  void set_gain_db(double gain_db) { gain_db_.store(gain_db, std::memory_order_relaxed); }

  // The device's thread.
  void render(std::span<float> stereo) noexcept override;

  // Any one thread; never waits.
  LiveStatus status() { return status_.fetch(); }

 private:
  struct Item {
    ContactEvent event;
    std::chrono::steady_clock::time_point pushed;
  };

  void keep_pace(double known, double end);
  void take_events(double known);

  Synthesizer synthesizer_;
  LiveOptions options_;
  SpscQueue<Item> queue_;
  std::atomic<double> known_;  // how far physics has come; not a number before it has begun
  std::atomic<std::uint64_t> dropped_{0};
  std::atomic<double> gain_db_;
  Latest<Listener> listener_;
  Latest<LiveStatus> status_;
  // The device's thread only.
  double offset_ = 0;  // audio time less simulated time
  bool has_begun_ = false;
  double total_latency_ = 0;
  LiveStatus now_;
};

}  // namespace intaglio::sound
