#include "intaglio/session/live/audio_tap.h"

#include <algorithm>
#include <thread>

namespace intaglio::session {

void AudioTap::play(sound::AudioSource* source) {
  source_.store(source);
  while (busy_.load()) std::this_thread::yield();
}

void AudioTap::render(std::span<float> stereo) noexcept {
  busy_.store(true);
  sound::AudioSource* source = source_.load();
  if (source != nullptr) {
    source->render(stereo);
  } else {
    std::fill(stereo.begin(), stereo.end(), 0.0f);
  }
  busy_.store(false);
  for (const float sample : stereo)
    if (!played_.push(sample))
      lost_.store(lost_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
}

void AudioTap::take(std::vector<float>& stereo) {
  while (const float* sample = played_.front()) {
    stereo.push_back(*sample);
    played_.pop();
  }
}

}  // namespace intaglio::session
