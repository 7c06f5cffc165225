// Between an audio device and what it plays: the source may be changed while the device runs, and what is
// played can be looked at (a scope) and kept (a recording).
//
// play() from one thread, render() from the device's, take() from one. render() neither allocates nor waits;
// play() waits until no render() uses the old source any more.
#pragma once

#include <atomic>
#include <span>
#include <vector>

#include "intaglio/core/spsc_queue.h"
#include "intaglio/sound/outputs/audio_device.h"

namespace intaglio::session {

class AudioTap : public sound::AudioSource {
 public:
  void play(sound::AudioSource* source);
  void render(std::span<float> stereo) noexcept override;

  // What was played since the last call, left and right by turns; what nobody takes in two seconds is lost.
  void take(std::vector<float>& stereo);
  std::uint64_t lost() const { return lost_.load(std::memory_order_relaxed); }

 private:
  std::atomic<sound::AudioSource*> source_{nullptr};
  std::atomic<bool> busy_{false};
  SpscQueue<float> played_{2 * 2 * 48'000};
  std::atomic<std::uint64_t> lost_{0};
};

}  // namespace intaglio::session
